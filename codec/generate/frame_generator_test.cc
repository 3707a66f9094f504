// What the generator says of its frames is what the decoder says of them.
#include "codec/generate/frame_generator.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <set>
#include <string>

#include "codec/containers/testing.h"
#include "codec/generated/oscilloscope/messages.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/frame.h"

namespace rubric::generate {
namespace {

constexpr int kSeeds = 2000;

struct Known {
  const reflect::Protocol& protocol;
  const reflect::RouteTable& routes;
};
const Known kKnown[] = {
    {rubicon::tables::kProtocol, rubicon::messages::kRoutes},
    {oscilloscope::tables::kProtocol, oscilloscope::messages::kRoutes},
};

Packet packet_of(const Generated& made) {
  Packet packet;
  packet.framing = made.framing;
  packet.bytes = Bytes(made.bytes.data(), made.bytes.size());
  return packet;
}

std::string text(const Error& error) {
  return std::string(reflect::fault_name(error.fault)) + " at " +
         std::to_string(error.offset_bytes) + " by " +
         reflect::requirement(error.requirement).id;
}

std::string text(const Generated& made) {
  return std::string(made.route->carrier) + "/" + made.route->type->id + ", " + made.what + ": " +
         rubric::testing::to_hex(Bytes(made.bytes.data(), made.bytes.size()));
}

std::vector<std::string> names(const reflect::Type* const* path, std::size_t count) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(path[i]->id);
  return out;
}

class Generator : public ::testing::TestWithParam<int> {
 protected:
  const Known& known() const { return kKnown[GetParam()]; }
};

TEST_P(Generator, ValidFramesLeadToTheirMessage) {
  const reflect::FrameDecoder decoder(known().protocol);
  reflect::Frame frame;
  FrameGenerator generator(known().protocol, known().routes, 1);
  for (int i = 0; i < known().routes.count; ++i) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Generated made = generator.valid(known().routes.routes[i]);
      const Packet packet = packet_of(made);
      decoder.decode(packet, frame);
      ASSERT_TRUE(made.valid());
      ASSERT_FALSE(frame.malformed()) << text(frame.error) << "\n" << text(made);
      ASSERT_EQ(names(made.path.data(), made.path.size()),
                names(frame.decoded.path(), frame.decoded.path_count())) << text(made);
    }
  }
}

TEST_P(Generator, NearValidFramesBreakWhatTheySay) {
  const reflect::FrameDecoder decoder(known().protocol);
  reflect::Frame frame;
  FrameGenerator generator(known().protocol, known().routes, 2);
  for (int i = 0; i < known().routes.count; ++i) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Generated made = generator.near_valid(known().routes.routes[i]);
      const Packet packet = packet_of(made);
      decoder.decode(packet, frame);
      ASSERT_FALSE(made.valid()) << text(made);
      ASSERT_EQ(frame.error, made.error)
          << text(made) << "\nthe decoder: " << text(frame.error)
          << "\nthe generator: " << text(made.error);
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
  const reflect::FrameDecoder decoder(known().protocol);
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
      if (!change_field(known().protocol, made.framing, made.bytes, most, generator.random())) {
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

INSTANTIATE_TEST_SUITE_P(Protocols, Generator, ::testing::Values(0, 1));

}  // namespace
}  // namespace rubric::generate
