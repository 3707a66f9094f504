// Equal states hash equal, and every difference between states changes their hashes.
#include <set>

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

using Phase = JoinMote::Phase;

// Returns a state in which every field differs from its start.
State busy_state() {
  Config config = sink_config();
  config.random_seq = true;
  Device node(config);
  node.now = 100;
  list_member(node, 5, 100);
  node.hear(join_request(6, 200, kDescriptor)).done();
  node.call(Send{{kIsland, 5}, 10, true, {}});
  node.call(Send{{kIsland, 5}, 10, true, {}});
  node.step(AppBusy{true});
  node.hear(join_request(7, 300, kDescriptor));
  node.call(CreateChannel{Direction::kOut, {kIsland, 5}, 2, Mode::kPowerSave});
  node.call(CreateChannel{Direction::kIn, {kIsland, 5}, 3, Mode::kReliable});
  node.call(StartAllChannels{});
  JoinMote& join = node.state.join;  // No sink has one, but the hash does not know.
  join = {Phase::kMember, 3, 2, true, 9, 1, {kIsland, 5}, kDescriptor, 77, 66};
  node.state.clock_offset_ms = 5;
  return node.state;
}

TEST(Hash, EveryDifferenceCounts) {
  void (*const kChanges[])(State&) = {
      [](State& s) { s.config.id++; },
      [](State& s) { s.config.role = Role::kMote; },
      [](State& s) { s.config.profile.join_period_ticks++; },
      [](State& s) { s.config.profile.listed_ignored = false; },
      [](State& s) { s.config.profile.short_acks = false; },
      [](State& s) { s.config.profile.join_fail_signalled = false; },
      [](State& s) { s.config.profile.members_max--; },
      [](State& s) { s.config.profile.channels_max++; },
      [](State& s) { s.island++; },
      [](State& s) { s.clock_offset_ms++; },
      [](State& s) { s.app_busy = false; },
      [](State& s) { s.off = true; },
      [](State& s) { s.sequence.last++; },
      [](State& s) { s.sequence.random = false; },
      [](State& s) { s.join.phase = Phase::kOutside; },
      [](State& s) { s.join.requests++; },
      [](State& s) { s.join.acks++; },
      [](State& s) { s.join.acked = false; },
      [](State& s) { s.join.seq_num++; },
      [](State& s) { s.join.sink_devid++; },
      [](State& s) { s.join.address.pid++; },
      [](State& s) { s.join.address.devid++; },
      [](State& s) { s.join.descriptor.transducers++; },
      [](State& s) { s.join.due++; },
      [](State& s) { s.join.accepted++; },
      [](State& s) { s.join.asked = !s.join.asked; },
      [](State& s) { s.sink.members[0].devid++; },
      [](State& s) { s.sink.members[0].seq_num++; },
      [](State& s) { s.sink.members[0].descriptor.mote_type++; },
      [](State& s) { s.sink.members.clear(); },
      [](State& s) { s.sink.pending[0].seq_num++; },
      [](State& s) { s.sink.pending.clear(); },
      [](State& s) { std::swap(s.sink.pending, s.sink.members); },
      [](State& s) { s.sink.unreported.push(s.sink.members[0]); },
      [](State& s) { s.awaited[0].seq_num++; },
      [](State& s) { s.awaited[0].app_id++; },
      [](State& s) { s.awaited[0].dest.devid++; },
      [](State& s) { s.awaited[0].due++; },
      [](State& s) { s.awaited.erase(1); },
      [](State& s) { s.synaptic.due++; },
      [](State& s) { s.synaptic.period_ticks++; },
      [](State& s) { s.synaptic.phase_ticks++; },
      [](State& s) { s.synaptic.out[0].mode = Mode::kReliable; },
      [](State& s) { s.synaptic.out[0].fresh = false; },
      [](State& s) { s.synaptic.out[0].value_bits[0]++; },
      [](State& s) { s.synaptic.out[0].value_bits[1]++; },
      [](State& s) { s.synaptic.in[0].started = false; },
      [](State& s) { s.synaptic.in[0].value_bits[2]++; },
      [](State& s) { s.synaptic.in[0].size++; },
      [](State& s) { s.synaptic.in[0].peer.pid++; },
      [](State& s) { s.radio.on = false; },
      [](State& s) { s.radio.sending = false; },
      [](State& s) { s.radio.sending_ack_join = true; },
      [](State& s) { s.radio.taken = true; },
      [](State& s) { s.serial.on = false; },
      [](State& s) { s.radio.out.front().dest++; },
      [](State& s) { s.radio.out.front().type++; },
      [](State& s) { s.radio.out.front().link_ack = true; },
      [](State& s) { s.radio.out.front().awaited++; },
      [](State& s) { s.radio.out.front().payload[13]++; },
      [](State& s) { s.radio.out.front().size_bytes--; },
      [](State& s) { s.radio.out.clear(); },
      [](State& s) { s.radio.in.front().payload[0]++; },
      [](State& s) { s.waiting.front() = Link::kSerial; },
  };
  const State first = busy_state();
  std::set<std::uint64_t> seen = {hash_value(first)};
  for (const auto& change : kChanges) {
    State other = first;
    change(other);
    const auto index = &change - kChanges;
    EXPECT_FALSE(other == first) << index;
    EXPECT_TRUE(seen.insert(hash_value(other)).second) << index;
  }
}

// The same content reached by two ways compares equal and hashes the same, whatever the memory
// around it.
TEST(Hash, EqualStatesHashEqual) {
  Device turned(mote_config(5));
  for (int i = 0; i < 3; ++i) {  // Turns the circular buffers.
    turned.step(LinkBusy{Link::kRadio, true});
    turned.call(JoinIsland{kDescriptor});
    turned.step(LinkBusy{Link::kRadio, false}).done();
    turned.step(AppBusy{true});
    turned.hear(join_reply(5, {kOther, 9}, 0, 0xABCD));
    turned.step(AppBusy{false});
    for (int k = 0; k < 5; ++k) turned.step(TimerDue{{TimerKind::kJoin, 0}}).done();
  }
  Device fresh(mote_config(5));
  turned.state.sequence = fresh.state.sequence;
  turned.state.join = fresh.state.join;
  EXPECT_EQ(turned.state, fresh.state);
  EXPECT_EQ(hash_value(turned.state), hash_value(fresh.state));
  for (Device* node : {&turned, &fresh}) {
    node->step(LinkBusy{Link::kRadio, true});
    node->call(JoinIsland{kDescriptor});
    node->step(AppBusy{true});
    node->hear(join_reply(5, {kIsland, 5}, 0, node->state.join.seq_num));
  }
  EXPECT_EQ(turned.state, fresh.state);
  EXPECT_EQ(hash_value(turned.state), hash_value(fresh.state));
}

}  // namespace
}  // namespace rubric::machine
