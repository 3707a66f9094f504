// Parse and write are inverse over all structures: parse takes what write makes, and the other way
// round.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <iostream>
#include <vector>

#include "codec/codec_test/every_view.h"

namespace rubric {
namespace {

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
    arena_.emplace_back(
        *rc::gen::container<std::vector<std::uint8_t>>(size, rc::gen::arbitrary<std::uint8_t>()));
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

// Fills `value` with anything and writes it to `out`, at most `attempts` times until one is
// allowed.
template <class Value>
Result<MutableBytes> write_any(Value& value, Fill& fill, MutableBytes out, int attempts) {
  while (true) {
    visit_fields(value, fill);
    const Result<MutableBytes> bytes = write(value, out);
    if (bytes || --attempts <= 0) return bytes;
  }
}

template <class View>
void write_then_parse(const std::string& name, int& written) {
  typename View::Value value;
  Fill fill;
  std::uint8_t out[512];
  const auto bytes = write_any(value, fill, MutableBytes(out), *rc::gen::element(1, 1, 1, 300));
  if (!bytes) {
    RC_ASSERT(bytes.error().fault != Fault::kNoRoom);
    return;
  }
  ++written;
  const Result<View> view = View::parse(*bytes);
  if (!view) RC_FAIL(name + ": parse refuses what write made");
  RC_ASSERT(view->bytes().size() == bytes->size());
  RC_ASSERT(view->stale().empty());
  // An absent field is not part of the value: write it once more.
  std::uint8_t again[512];
  const Result<MutableBytes> second = write(view->to_value(), MutableBytes(again));
  RC_ASSERT(second.has_value());
  RC_ASSERT(equal(*bytes, *second));
  if (name != "tinyos.serial_frame") RC_ASSERT(view->to_value() == value);
  // One byte less of room is too little, and nothing else is wrong.
  if (!bytes->empty()) {
    const auto less = write(value, MutableBytes(out).first(bytes->size() - 1));
    RC_ASSERT(!less.has_value());
    RC_ASSERT(less.error().fault == Fault::kNoRoom);
    RC_ASSERT(less.error().offset_bytes == bytes->size() - 1);
  }
}

TEST(WriteProperty, ParseGivesTheValueBack) {
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

// Returns bytes that look like the structure: written from anything, or anything; then changed, cut
// or lengthened.
template <class View>
std::vector<std::uint8_t> near_bytes() {
  std::vector<std::uint8_t> bytes;
  const int attempts = *rc::gen::element(0, 1, 10, 300);
  if (attempts > 0) {
    typename View::Value value;
    Fill fill;
    std::uint8_t out[512];
    const auto written = write_any(value, fill, MutableBytes(out), attempts);
    if (written) bytes.assign(written->data(), written->data() + written->size());
  }
  if (bytes.empty()) {
    const std::size_t most = View::kMaxSizeBytes > 140 ? 140 : View::kMaxSizeBytes + 8;
    bytes = *rc::gen::container<std::vector<std::uint8_t>>(*rc::gen::inRange<std::size_t>(0, most),
                                                           rc::gen::arbitrary<std::uint8_t>());
  }
  // Small numbers are what counts and lengths accept.
  const int changes = *rc::gen::inRange<int>(0, 4);
  for (int i = 0; i < changes && !bytes.empty(); ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
    bytes[at] = *rc::gen::element<std::uint8_t>(0, 1, 2, 3, 5, 14, 15, 28, 63, 67, 68, 102, 255);
  }
  const int resized = *rc::gen::inRange(0, 4);
  if (resized == 0) bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 1));
  if (resized == 1) bytes.resize(bytes.size() + *rc::gen::inRange<std::size_t>(0, 9), 0xa5);
  return bytes;
}

struct Tally {
  long taken = 0;
  long refused = 0;
};

template <class View>
void parse_then_write(Tally& tally) {
  const std::vector<std::uint8_t> bytes = near_bytes<View>();
  const Result<View> view = View::parse(Bytes(bytes.data(), bytes.size()));
  ++(view ? tally.taken : tally.refused);
  if (!view) {
    // The place of the fault is within the bytes or right after them.
    RC_ASSERT(view.error().offset_bytes <= bytes.size());
    RC_ASSERT((view.error().fault == Fault::kTruncated ||
               view.error().fault == Fault::kUnexpected ||
               view.error().fault == Fault::kOutOfRange));
    return;
  }
  std::uint8_t out[512];
  const Result<MutableBytes> again = write(view->to_value(), MutableBytes(out));
  RC_ASSERT(again.has_value());
  RC_ASSERT(equal(view->bytes(), *again));
}

TEST(WriteProperty, ParseTakesOnlyWhatWriteMakesAgain) {
  Tally all;
  for_each_view_of_all([&all]<class View>(const std::string& name, ViewTag<View>) {
    Tally tally;
    EXPECT_TRUE(rc::check(name, [&tally] { parse_then_write<View>(tally); })) << name;
    EXPECT_GE(tally.taken * 50, tally.refused) << name;
    EXPECT_GE(tally.refused * 50, View::kMinSizeBytes > 0 ? tally.taken : 0) << name;
    all.taken += tally.taken;
    all.refused += tally.refused;
  });
  std::cout << all.taken << " byte strings taken, " << all.refused << " refused\n";
}

// A fault stays while the bytes up to it are there, whatever follows or is missing.
TEST(WriteProperty, LaterBytesDoNotHealAFault) {
  long faults = 0;
  for_each_view_of_all([&faults]<class View>(const std::string& name, ViewTag<View>) {
    const bool good = rc::check(name, [&faults] {
      const std::vector<std::uint8_t> bytes = near_bytes<View>();
      const Result<View> whole = View::parse(Bytes(bytes.data(), bytes.size()));
      if (whole || whole.error().fault == Fault::kTruncated) return;
      ++faults;
      for (std::size_t n = whole.error().offset_bytes + 1; n <= bytes.size(); ++n) {
        RC_ASSERT(!View::parse(Bytes(bytes.data(), n)).has_value());
      }
    });
    EXPECT_TRUE(good) << name;
  });
  EXPECT_GE(faults, 100);
  std::cout << faults << " faults\n";
}

}  // namespace
}  // namespace rubric
