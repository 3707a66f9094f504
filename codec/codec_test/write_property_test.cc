// Parse and write as each other's opposite, over all structures: what write makes, parse takes, and
// the other way round.
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "codec/codec_test/every_view.h"

namespace rubric {
namespace {

// More cases than rapidcheck's hundred, unless the environment says how many.
const int kMoreCases = setenv("RC_PARAMS", "max_success=1000 max_size=200", 0);

// Fills a value's fields with anything, mostly of lengths that are allowed.
class Fill {
 public:
  template <class T>
  void operator()(const char*, T& field) {
    fill(field);
  }

 private:
  template <class T>
  static T number() {
    // Bounds are where faults are.
    const auto any = *rc::gen::weightedOneOf<T>(
        {{4, rc::gen::arbitrary<T>()},
         {2, rc::gen::inRange<T>(0, 3)},
         {2, rc::gen::element<T>(2, 102, 114, 23, 24, 63, 65, 67, 68, 10)}});
    return any;
  }
  template <class T>
  void fill(T& field) {
    if constexpr (std::is_enum_v<T>) {
      field = static_cast<T>(number<std::underlying_type_t<T>>());
    } else if constexpr (std::is_same_v<T, float>) {
      field = float_of_bits(*rc::gen::arbitrary<std::uint32_t>());
    } else if constexpr (std::is_integral_v<T>) {
      field = number<T>();
    } else if constexpr (requires { field.raw(); }) {
      field = T(*rc::gen::arbitrary<decltype(field.raw())>());
    } else {
      visit_fields(field, *this);
    }
  }
  void fill(Bytes& field) {
    const auto size = *rc::gen::weightedOneOf<std::size_t>(
        {{6, rc::gen::inRange<std::size_t>(0, 20)}, {1, rc::gen::inRange<std::size_t>(90, 130)}});
    arena_.emplace_back(*rc::gen::container<std::vector<std::uint8_t>>(
        size, rc::gen::arbitrary<std::uint8_t>()));
    field = Bytes(arena_.back().data(), size);
  }
  template <class T, std::size_t kCount>
  void fill(T (&field)[kCount]) {
    for (T& item : field) fill(item);
  }
  template <class T, std::size_t kCapacity>
  void fill(Array<T, kCapacity>& field) {
    field.count = *rc::gen::inRange<std::uint16_t>(0, kCapacity + 1);
    for (std::size_t i = 0; i < field.count; ++i) fill(field.items[i]);
  }

  std::vector<std::vector<std::uint8_t>> arena_;
};

template <class View>
void write_then_parse(const std::string& name, int& written) {
  typename View::Value value;
  Fill fill;
  visit_fields(value, fill);
  std::uint8_t out[512];
  const Result<MutableBytes> bytes = write(value, MutableBytes(out));
  if (!bytes) {
    RC_ASSERT(bytes.error().fault != Fault::kNoRoom);
    return;
  }
  ++written;
  const Result<View> view = View::parse(*bytes);
  if (!view) RC_FAIL(name + ": parse refuses what write made");
  RC_ASSERT(view->bytes().size() == bytes->size());
  RC_ASSERT(view->stale().empty());
  // What is absent is not part of the value: write it once more.
  std::uint8_t again[512];
  const Result<MutableBytes> second = write(view->to_value(), MutableBytes(again));
  RC_ASSERT(second.has_value());
  RC_ASSERT(equal(*bytes, *second));
  if (name != "tinyos.serial_frame") RC_ASSERT(view->to_value() == value);
  // A byte less of room is too little, and nothing else is wrong.
  if (!bytes->empty()) {
    const auto less = write(value, MutableBytes(out).first(bytes->size() - 1));
    RC_ASSERT(!less.has_value());
    RC_ASSERT(less.error().fault == Fault::kNoRoom);
    RC_ASSERT(less.error().offset_bytes == bytes->size() - 1);
  }
}

TEST(WriteProperty, ParseGivesTheValueBack) {
  ASSERT_EQ(kMoreCases, 0);
  int structures = 0;
  int all = 0;
  for_each_view_of_all([&structures, &all]<class View>(const std::string& name, ViewTag<View>) {
    int written = 0;
    const bool good = rc::check(name, [&] { write_then_parse<View>(name, written); });
    EXPECT_TRUE(good) << name;
    EXPECT_GE(written, 3) << name << ": nearly all values were refused";
    ++structures;
    all += written;
  });
  std::cout << structures << " structures, " << all << " values written and parsed\n";
}

// Bytes that look like the structure: its own writing of anything, then changed; or anything.
std::vector<std::uint8_t> near_bytes(const MessageCodec& codec) {
  const std::size_t most = codec.max_size_bytes > 140 ? 140 : codec.max_size_bytes + 8;
  auto bytes = *rc::gen::container<std::vector<std::uint8_t>>(
      *rc::gen::inRange<std::size_t>(0, most), rc::gen::arbitrary<std::uint8_t>());
  // Small numbers are what counts and lengths accept.
  const int small = *rc::gen::inRange<int>(0, 14);
  for (int i = 0; i < small && !bytes.empty(); ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, std::min<std::size_t>(bytes.size(), 16));
    bytes[at] = *rc::gen::element<std::uint8_t>(0, 0, 1, 2, 3, 5, 14, 15, 28, 63, 67, 68, 102, 255);
  }
  return bytes;
}

TEST(WriteProperty, ParseTakesOnlyWhatWriteMakesAgain) {
  int structures = 0;
  long all_taken = 0;
  long all_refused = 0;
  for (const auto& [name, codec] : all_codecs()) {
    long taken = 0;
    long refused = 0;
    const bool good = rc::check(name, [&, &codec = codec] {
      const std::vector<std::uint8_t> bytes = near_bytes(codec);
      const Bytes given(bytes.data(), bytes.size());
      const Result<Bytes> meant = codec.parse(given);
      ++(meant ? taken : refused);
      if (!meant) {
        // The place of the fault is within the bytes or right behind them.
        RC_ASSERT(meant.error().offset_bytes <= bytes.size());
        RC_ASSERT((meant.error().fault == Fault::kTruncated ||
                   meant.error().fault == Fault::kUnexpected ||
                   meant.error().fault == Fault::kOutOfRange));
        return;
      }
      std::uint8_t out[512];
      const Result<MutableBytes> again = codec.rewrite(given, MutableBytes(out));
      RC_ASSERT(again.has_value());
      RC_ASSERT(equal(*meant, *again));
    });
    EXPECT_TRUE(good) << name;
    EXPECT_GE(taken, 3) << name << ": nearly all bytes were refused";
    ++structures;
    all_taken += taken;
    all_refused += refused;
  }
  std::cout << structures << " structures, " << all_taken << " byte strings taken, "
            << all_refused << " refused\n";
}

// What is wrong stays wrong while the bytes up to it are there, whatever follows or is missing.
TEST(WriteProperty, LaterBytesDoNotHealAFault) {
  for (const auto& [name, codec] : all_codecs()) {
    const bool good = rc::check(name, [&, &codec = codec] {
      const std::vector<std::uint8_t> bytes = near_bytes(codec);
      const Result<Bytes> whole = codec.parse(Bytes(bytes.data(), bytes.size()));
      if (whole || whole.error().fault == Fault::kTruncated) return;
      for (std::size_t n = whole.error().offset_bytes + 1; n <= bytes.size(); ++n) {
        RC_ASSERT(!codec.parse(Bytes(bytes.data(), n)).has_value());
      }
    });
    EXPECT_TRUE(good) << name;
  }
}

}  // namespace
}  // namespace rubric
