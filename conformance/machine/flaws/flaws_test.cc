#include "conformance/machine/flaws/flaws.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "codec/generated/rubicon/join_reply.h"
#include "conformance/machine/messages.h"

namespace rubric::flaws {
namespace {

machine::Config mote() { return {.id = 5, .first_seq = 100}; }

machine::Config sink() { return {.role = machine::Role::kSink, .id = 1, .island = 11}; }

TEST(Flaws, HaveNamesRulesAndSteps) {
  std::set<std::string> names;
  for (const Flaw& flaw : all()) {
    EXPECT_TRUE(names.insert(flaw.name).second) << flaw.name;
    EXPECT_NE(flaw.requirements[0], ReqId::kNone) << flaw.name;
    EXPECT_EQ(find(flaw.name), &flaw);
  }
  EXPECT_EQ(find("none"), nullptr);
}

// Apart from its flaw a flawed node equals the machine.
TEST(Flaws, LeaveAnUndisturbedJoinAlone) {
  for (const Flaw& flaw : all()) {
    machine::State honest = machine::start(mote());
    machine::State flawed = honest;
    machine::Actions expected;
    machine::Actions actions;
    const machine::Event call = machine::Called{machine::JoinIsland{{3, 1, 3}}};
    machine::step(honest, 0, call, expected);
    flaw.step(flawed, 0, call, actions);
    ASSERT_EQ(actions.transmits().size(), 1U) << flaw.name;
    EXPECT_TRUE(equal(actions.transmits()[0].bytes(), expected.transmits()[0].bytes()));

    std::array<std::uint8_t, 10> reply{};
    const auto seq = honest.join.seq_num;
    rubicon::JoinReplyLayout::store({11, 5, 70000, seq}, reply.data());
    const machine::Event heard = machine::Heard{
        {machine::Link::kRadio, 5, 1, machine::am::kJoinReply, Bytes(reply.data(), reply.size())}};
    const machine::Event done = machine::SendDone{};
    machine::step(honest, 2, done, expected);
    flaw.step(flawed, 2, done, actions);
    machine::step(honest, 5, heard, expected);
    flaw.step(flawed, 5, heard, actions);
    EXPECT_EQ(flawed.join, honest.join) << flaw.name;
    EXPECT_EQ(actions.notices().size(), 1U) << flaw.name;
  }
}

TEST(Flaws, ALongSendKillsTheFirmware) {
  const std::array<std::uint8_t, 101> bytes{};
  const Flaw* const firmware = find("release_1_0_firmware");
  for (const machine::Config& config : {mote(), sink()}) {
    machine::State state = machine::start(config);
    machine::Actions actions;
    machine::Send send{{11, 2}, 5, false, Bytes(bytes.data(), 100)};
    firmware->step(state, 0, machine::Called{send}, actions);
    send.data = Bytes(bytes.data(), bytes.size());
    EXPECT_THROW(firmware->step(state, 1, machine::Called{send}, actions), Died);
  }
}

// cur_time is invisible where time does not run, so the explorer does not check it.
TEST(Flaws, TimeOfBootTellsNoOtherTime) {
  machine::State state = machine::start(sink());
  machine::Actions actions;
  const std::array<std::uint8_t, 6> request{0, 7, 3, 0, 3, 1};
  const machine::Event heard = machine::Heard{
      {machine::Link::kRadio, 1, 5, machine::am::kJoin, Bytes(request.data(), request.size())}};
  find("time_of_boot")->step(state, 10240, heard, actions);
  ASSERT_EQ(actions.transmits().size(), 1U);
  EXPECT_EQ(rubicon::JoinReplyView::parse(actions.transmits()[0].bytes())->cur_time(), 0U);
}

}  // namespace
}  // namespace rubric::flaws
