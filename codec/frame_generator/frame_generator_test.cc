// The generator and the decoder agree about the generator's frames.
#include "codec/frame_generator/frame_generator.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "codec/frame_generator/known_protocols.h"
#include "codec/frame_generator/values.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/frame.h"

namespace rubric::generate {
namespace {

constexpr int kSeeds = 2000;

Packet packet_of(const Generated& made) {
  return {.framing = made.framing, .bytes = Bytes(made.bytes.data(), made.bytes.size())};
}

/// Expects the bytes that do not fit to stay opaque, and to be refused, as the message that they
/// were meant to be, with the fault that the generator names.
void check_unfit(const Generated& made, const reflect::Decoded& decoded) {
  ASSERT_TRUE(made.valid());
  ASSERT_EQ(names(made.path.data(), made.path.size()), names(decoded.path(), decoded.path_count()))
      << described(made);
  ASSERT_GE(decoded.note_count(), 1U);
  const reflect::Note& note = decoded.notes()[decoded.note_count() - 1];
  ASSERT_EQ(note.kind, reflect::NoteKind::kDoesNotFit) << described(made);
  std::size_t opaque = 0;
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    if (decoded[i].kind == reflect::NodeKind::kBytes && decoded[i].offset == note.offset) {
      opaque = i;
    }
  }
  ASSERT_NE(opaque, 0U);
  const Bytes body(made.bytes.data() + note.offset, decoded[opaque].size);
  reflect::Decoded alone;
  // If several are tried, the note is about the last, which does not fit either.
  reflect::decode(*note.type, body, reflect::Tail::kStale, true, alone);
  ASSERT_NE(alone.error.fault, Fault::kNone) << described(made);
  reflect::decode(*made.unfit_message, body, reflect::Tail::kStale, true, alone);
  Error error = alone.error;
  error.offset_bytes += note.offset;
  ASSERT_EQ(error, made.unfit) << described(made) << "\nthe decoder: " << text(error)
                               << "\nthe generator: " << text(made.unfit);
}

/// Expects the generator to name exactly the numbers that the decoder reads.
void check_numbers(const Generated& made, const reflect::Decoded& decoded) {
  std::size_t met = 0;
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const reflect::Node& node = decoded[i];
    if (node.kind != reflect::NodeKind::kNumber) continue;
    ASSERT_LT(met, made.numbers.size()) << described(made);
    const NumberAt& number = made.numbers[met++];
    ASSERT_EQ(number.offset_bytes, node.offset) << described(made);
    ASSERT_EQ(number.value, node.value) << described(made);
    ASSERT_STREQ(number.field->name, node.field->name) << described(made);
  }
  ASSERT_EQ(met, made.numbers.size()) << described(made);
}

class Generator : public ::testing::TestWithParam<Known> {
 protected:
  const Known& known() const { return GetParam(); }
};

TEST_P(Generator, ValidFramesLeadToTheirMessage) {
  const reflect::FrameDecoder decoder(known().reader);
  reflect::Frame frame;
  FrameGenerator generator(known().protocol, known().routes, 1);
  for (int i = 0; i < known().routes.count; ++i) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Generated made = generator.valid(known().routes.routes[i]);
      const Packet packet = packet_of(made);
      decoder.decode(packet, frame);
      ASSERT_TRUE(made.valid());
      ASSERT_FALSE(frame.malformed()) << text(frame.error) << "\n" << described(made);
      ASSERT_EQ(names(made.path.data(), made.path.size()),
                names(frame.decoded.path(), frame.decoded.path_count()))
          << described(made);
      check_numbers(made, frame.decoded);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(Generator, NearValidFramesBreakWhatTheySay) {
  const reflect::FrameDecoder decoder(known().reader);
  reflect::Frame frame;
  FrameGenerator generator(known().protocol, known().routes, 2);
  for (int i = 0; i < known().routes.count; ++i) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Generated made = generator.near_valid(known().routes.routes[i]);
      const Packet packet = packet_of(made);
      decoder.decode(packet, frame);
      ASSERT_TRUE(!made.valid() || !made.fits()) << described(made);
      if (!made.fits()) check_unfit(made, frame.decoded);
      if (!made.fits()) check_numbers(made, frame.decoded);
      if (HasFatalFailure()) return;
      ASSERT_EQ(frame.error, made.error)
          << described(made) << "\nthe decoder: " << text(frame.error);
    }
  }
}

TEST_P(Generator, SameSeedSameFrames) {
  FrameGenerator one(known().protocol, known().routes, 77);
  FrameGenerator same(known().protocol, known().routes, 77);
  FrameGenerator other(known().protocol, known().routes, 78);
  int differ = 0;
  for (int i = 0; i < known().routes.count; ++i) {
    const reflect::Route& route = known().routes.routes[i];
    for (int k = 0; k < 20; ++k) {
      const Generated a = k % 2 ? one.valid(route) : one.near_valid(route);
      const Generated b = k % 2 ? same.valid(route) : same.near_valid(route);
      const Generated c = k % 2 ? other.valid(route) : other.near_valid(route);
      ASSERT_EQ(a.bytes, b.bytes);
      ASSERT_EQ(a.what, b.what);
      differ += a.bytes != c.bytes;
    }
  }
  EXPECT_GT(differ, known().routes.count * 15);
}

TEST_P(Generator, ChangedFieldsMostlyLeaveFramesValid) {
  const reflect::FrameDecoder decoder(known().reader);
  reflect::Frame frame;
  FrameGenerator generator(known().protocol, known().routes, 3);
  long changed = 0;
  long valid = 0;
  long resized = 0;
  for (int i = 0; i < known().routes.count; ++i) {
    for (int k = 0; k < 200; ++k) {
      Generated made = generator.valid(known().routes.routes[i]);
      const std::vector<std::uint8_t> before = made.bytes;
      const std::size_t most = before.size() + 4;
      if (!change_field(known().reader, made.framing, made.bytes, most, generator.random())) {
        EXPECT_EQ(made.bytes, before);
        continue;
      }
      EXPECT_LE(made.bytes.size(), most);
      ++changed;
      resized += made.bytes.size() != before.size();
      const Packet packet = packet_of(made);
      decoder.decode(packet, frame);
      valid += !frame.malformed();
    }
  }
  std::printf("%ld changed, %ld of them valid, %ld resized\n", changed, valid, resized);
  EXPECT_GT(changed, known().routes.count * 195L);
  EXPECT_GT(valid, changed * 8 / 10);
}

TEST(ChangeField, LeavesAloneWhatCannotBeRead) {
  Random random(1);
  std::vector<std::uint8_t> none;
  EXPECT_FALSE(change_field(rubicon::tables::kProtocol, Framing::kSf, none, 100, random));
  std::vector<std::uint8_t> foreign{1, 2, 3};
  const std::vector<std::uint8_t> before = foreign;
  EXPECT_FALSE(change_field(rubicon::tables::kProtocol, Framing::kSf, foreign, 100, random));
  EXPECT_EQ(foreign, before);
}

/// With the bound moved by one a decoder must take the frames whose number is just beyond it, else
/// they prove nothing about the bound.
TEST(NearValid, NumbersBeyondABoundOfASizeComeWithTheBytes) {
  FrameGenerator generator(rubicon::tables::kProtocol, rubicon::messages::kRoutes, 4);
  std::map<std::string, int> met;
  for (int i = 0; i < rubicon::messages::kRoutes.count; ++i) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Generated made = generator.near_valid(rubicon::messages::kRoutes.routes[i]);
      const std::size_t size = made.bytes.size();
      if (made.error == Error{Fault::kOutOfRange, 5, "WIRE-AM-LENGTH"_rule}) {
        met["length"] += size == 8u + 115u && made.bytes[5] == 115;
      }
      if (made.error.requirement != "WIRE-NET-NBYTES"_rule) continue;
      const std::size_t at = made.error.offset_bytes;
      met["nbytes"] += made.bytes[at] == 103 && size > at + 103;
    }
  }
  EXPECT_GT(met["length"], 100);
  EXPECT_GT(met["nbytes"], 100);
}

const reflect::Route& serial_route(const char* message) {
  const reflect::RouteTable& all = rubicon::messages::kRoutes;
  for (int i = 0; i < all.count; ++i) {
    const reflect::Route& route = all.routes[i];
    if (std::string_view(route.carrier) != "serial") continue;
    if (std::string_view(route.type->id) == message) return route;
  }
  ADD_FAILURE() << "no route to " << message;
  return all.routes[0];
}

TEST(NearValid, CutAtEachPlace) {
  FrameGenerator generator(rubicon::tables::kProtocol, rubicon::messages::kRoutes, 6);
  std::set<std::uint32_t> plain;
  std::set<std::uint32_t> repaired;  // The AM length agrees.
  for (int k = 0; k < kSeeds; ++k) {
    const Generated made = generator.near_valid(serial_route("config"));
    const std::size_t size = made.bytes.size();
    if (made.error.fault != Fault::kTruncated || made.error.offset_bytes != size) continue;
    const bool agrees = size >= 8 && made.bytes[5] == size - 8;
    (agrees ? repaired : plain).insert(made.error.offset_bytes);
  }
  for (std::uint32_t at = 1; at < 11; ++at) EXPECT_TRUE(plain.contains(at)) << at;
  EXPECT_EQ(repaired, (std::set<std::uint32_t>{8, 9, 10}));
}

/// Counts how often the number at `at` is off by -1 and by +1 from what it counts, and nothing else
/// is.
std::map<int, int> off_by_one(const char* message, std::size_t at, std::size_t from, ReqId rule) {
  FrameGenerator generator(rubicon::tables::kProtocol, rubicon::messages::kRoutes, 7);
  std::map<int, int> met;
  for (int k = 0; k < kSeeds; ++k) {
    const Generated made = generator.near_valid(serial_route(message));
    if (made.error.requirement != rule || made.bytes.size() <= at) continue;
    if (made.what.find(" is ") == std::string::npos) continue;  // A cut, or bytes after the end.
    ++met[made.bytes[at] - static_cast<int>(made.bytes.size() - from)];
  }
  return met;
}

TEST(NearValid, LengthsAreOffByOneInBothDirections) {
  std::map<int, int> length = off_by_one("command", 5, 8, "WIRE-AM-LENGTH"_rule);
  EXPECT_GT(length[1], 20);
  EXPECT_GT(length[-1], 20);
  std::map<int, int> nbytes = off_by_one("app_msg", 19, 20, "WIRE-NET-PAYLOAD"_rule);
  EXPECT_GT(nbytes[1], 20);
  std::map<int, int> count =
      off_by_one("learning_module_cmd", 15, 16, "WIRE-LEARNING-MODULE-CMD"_rule);
  EXPECT_GT(count[1], 20);
}

TEST(Values, OfSixtyFourBitsReachBothEndsOfTheirRange) {
  constexpr std::int64_t kLeast = 10;
  constexpr std::int64_t kMost = -3;  // The bits of 2^64 - 3.
  const reflect::Field field{.kind = reflect::Kind::kUint,
                             .width_bytes = 8,
                             .valid = {reflect::ValidKind::kRange, kLeast, kMost, nullptr, 0},
                             .expect = -1};
  Random random(8);
  std::map<std::int64_t, int> met;
  int above_int64 = 0;
  for (int i = 0; i < kSeeds; ++i) {
    const std::int64_t value = allowed_value(field, random);
    ASSERT_TRUE(is_allowed(field, value)) << value;
    above_int64 += value < 0;
    ++met[value];
    std::int64_t refused = 0;
    ASSERT_TRUE(refused_value(field, random, refused));
    ASSERT_TRUE((refused >= 0 && refused < kLeast) || (refused > kMost && refused < 0)) << refused;
    ++met[refused];
  }
  EXPECT_GT(above_int64, kSeeds / 4);
  for (const std::int64_t end : {kLeast - 1, kLeast, kMost, kMost + 1}) EXPECT_GT(met[end], 20);
}

INSTANTIATE_TEST_SUITE_P(Protocols, Generator, ::testing::ValuesIn(all_known()),
                         [](const auto& one) { return std::string(one.param.protocol.id); });

}  // namespace
}  // namespace rubric::generate
