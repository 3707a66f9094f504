// A sink's and a base station's island changes. A test's name may begin with its rule.
#include "conformance/machine/test/machine_fixture.h"

namespace rubric::machine {
namespace {

using Payload = std::vector<std::uint8_t>;

TEST(IslandId, SameIslandKeepsMembers) {
  Device sink(sink_config());
  list_member(sink, 5);
  EXPECT_EQ(sink.hear(set_island_id(kIsland)).labels(), (std::vector{followed("N9-SET"_rule)}));
  EXPECT_NE(find_member(sink.state.sink, 5), nullptr);
}

TEST(IslandId, N9Other_OtherConfigChangesNothing) {
  Device sink(sink_config());
  list_member(sink, 5);
  const State before = sink.state;
  for (int code = 0; code < 256; ++code) {
    if (code == 10) continue;
    sink.hear(config(static_cast<std::uint8_t>(code), kOther));
    EXPECT_EQ(sink.labels(), (std::vector{ignored("N9-OTHER"_rule)}));
  }
  OwnFrame cut = set_island_id(kOther);
  cut.payload.pop_back();
  EXPECT_EQ(sink.hear(cut).labels(), (std::vector{ignored("WIRE-CONFIG"_rule)}));
  EXPECT_EQ(sink.state, before);
}

TEST(IslandId, N9Other_ReservedIslandsAreNotTaken) {
  constexpr std::uint16_t kReserved[] = {0xFFFD, 0xFFFE, 0xFFFF};
  for (const std::uint16_t island : kReserved) {
    Device sink(sink_config());
    list_member(sink, 5);
    const State before = sink.state;
    EXPECT_EQ(sink.hear(set_island_id(island)).labels(), (std::vector{ignored("N9-OTHER"_rule)}));
    EXPECT_EQ(sink.state, before);
    Device base(base_config());
    base.call(SetIslandId{island});
    EXPECT_EQ(base.labels(), (std::vector{told("N9-OTHER"_rule)}));
    EXPECT_FALSE(base.notice<OperationResult>().success);
    EXPECT_EQ(base.state.island, kIsland);
  }
  Device sink(sink_config());
  EXPECT_EQ(sink.hear(set_island_id(0xFFFC)).labels()[0], followed("N9-SET"_rule));
}

TEST(IslandId, BaseStationTellsItsSink) {
  Device base(base_config());
  base.call(SetIslandId{12});
  const Transmit& frame = base.only_frame();
  EXPECT_EQ(frame.link, Link::kSerial);
  EXPECT_EQ(frame.dest, 1);
  EXPECT_EQ(frame.src, 0);
  EXPECT_EQ(frame.type, 37);
  EXPECT_EQ(base.only_payload(), (Payload{0x0A, 0x00, 0x0C}));  // The original sends it so.
  EXPECT_TRUE(base.notice<OperationResult>().success);
  EXPECT_EQ(own_address(base.state), (Address{12, kNullDevid}));
}

TEST(IslandId, NobodyElseMayTell) {
  for (const Config& config : {sink_config(), mote_config(5)}) {
    Device node(config);
    node.call(SetIslandId{kOther});
    EXPECT_FALSE(node.notice<OperationResult>().success);
    EXPECT_NE(own_address(node.state).pid, kOther);
  }
}

}  // namespace
}  // namespace rubric::machine
