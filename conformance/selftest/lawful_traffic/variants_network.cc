// Variants of addressing, broadcast, forwarding and the serial line.
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr auto kMockupType = static_cast<std::uint8_t>(rubicon::Component::kMockup);

/// Makes a mote, the sink and the base station of the first island each send to `devid` of pid, or
/// of their own island if pid is 0.
void everybody_sends(Plan& plan, std::uint16_t pid, std::uint16_t devid, bool reliable) {
  std::int64_t time = 3'000'000;
  for (int round = 0; round < 2; ++round) {
    for (int who = 0; who < 3; ++who) {
      plan.at(time, [pid, devid, reliable, who](World& world) {
        if (who == 0 && !world.mote(0).joined()) return;
        Endpoint* const senders[] = {&world.mote(0), &world.sink(0), &world.base(0)};
        Endpoint& from = *senders[who];
        const Address dest{pid == 0 ? from.address().pid : pid, devid};
        from.send(dest, kMockupType, {0xB0, static_cast<std::uint8_t>(who)}, reliable);
      });
      time += 600'000;
    }
  }
}
void broadcast(Plan& plan, Random&) { everybody_sends(plan, 0, kAllNodes, false); }
void broadcast_reliable(Plan& plan, Random&) { everybody_sends(plan, 0, kAllNodes, true); }
void broadcast_acked(Plan& plan, Random& random) {
  broadcast_reliable(plan, random);
  plan.traits.ack_broadcasts = true;
}
void broadcast_overlap(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  everybody_sends(plan, 0, kAllNodes, false);
}
void wide_ignored(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  everybody_sends(plan, kAllNodes, kAllNodes, false);
}
void wide_refused(Plan& plan, Random& random) {
  wide_ignored(plan, random);
  plan.traits.wide_pid = WidePid::kRefuse;
}
void wide_forwarded(Plan& plan, Random& random) {
  wide_ignored(plan, random);
  plan.traits.wide_pid = WidePid::kForward;
  plan.traits.serial_true_nbytes = true;
}
void wide_to_sink(Plan& plan, Random& random) {
  wide_forwarded(plan, random);
  plan.islands_apart = true;
  plan.traits.wide_pid_to_all = false;
}

/// Makes motes of the first island send to `devid` of the second, or to its motes if devid is 0.
void across(Plan& plan, std::uint16_t devid, bool reliable) {
  for (std::int64_t time = 2'600'000; time < 7'500'000; time += 700'000) {
    plan.at(time, [devid, reliable](World& world) {
      Mote* from = nullptr;
      Mote* to = nullptr;
      for (std::size_t i = 0; i < world.motes(); ++i) {
        Mote& mote = world.mote(i);
        if (!mote.joined()) continue;
        (mote.address().pid == world.sink(0).address().pid ? from : to) = &mote;
      }
      if (from == nullptr || to == nullptr) return;
      const std::uint16_t pid = to->address().pid;
      const Address dest{pid, devid == 0 ? to->am() : devid};
      from->send(dest, kMockupType, {0xC0, 1, 2, 3}, reliable);
    });
  }
}
void other_mote_ignored(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  plan.chats = 4;
  across(plan, 0, true);
}
void other_mote_relayed(Plan& plan, Random& random) {
  other_mote_ignored(plan, random);
  plan.traits.relays_for_others = true;
}
void foreign_source_forwarded(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  plan.chats = 4;
  across(plan, kNull, true);
}
void foreign_source_ignored(Plan& plan, Random& random) {
  foreign_source_forwarded(plan, random);
  plan.traits.forwards_foreign_source = false;
}
void foreign_mote_to_sink(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  plan.chats = 4;
  across(plan, kSinkAm, true);
}
void inter_island_true(Plan& plan, Random& random) {
  two_islands(plan, true, random);
  plan.chats = 40;
  plan.traits.serial_true_nbytes = true;
}
void inter_island_whole(Plan& plan, Random& random) {
  inter_island_true(plan, random);
  plan.traits.serial_true_nbytes = false;
}
void three_islands(Plan& plan, Random& random) {
  two_islands(plan, random.chance(50), random);
  plan.islands.push_back(13);
  for (std::uint16_t id = 6; id <= 7; ++id) {
    plan.motes.push_back(mote_plan(id, 2, random.between(100'000, 1'500'000)));
  }
  plan.chats = 40;
  plan.traits.serial_true_nbytes = true;
}
void serial_true(Plan& plan, Random&) { plan.traits.serial_true_nbytes = true; }
void serial_whole(Plan& plan, Random&) { plan.traits.serial_true_nbytes = false; }
void serial_cut(Plan& plan, Random&) { plan.traits.serial_cut = true; }
void serial_dest_zero(Plan& plan, Random&) { plan.traits.serial_am_dest = 0; }
void serial_resends(Plan& plan, Random&) {
  plan.chats = 25;
  plan.serial_corrupt_percent = 25;
  plan.all_well_formed = false;
  plan.end_us = 14'000'000;
}
void serial_ack_lost(Plan& plan, Random& random) {
  serial_resends(plan, random);
  plan.serial_corrupt_percent = 0;
  plan.serial_ack_corrupt_percent = 25;
}
void host_loops_ignored(Plan& plan, Random& random) {
  two_islands(plan, true, random);
  plan.chats = 4;
  plan.traits.hands_foreign_to_sink = true;
  plan.traits.serial_true_nbytes = true;
  across(plan, 0, true);
}
void host_loops_radiated(Plan& plan, Random& random) {
  host_loops_ignored(plan, random);
  plan.traits.radiates_foreign = true;
}

}  // namespace

std::vector<Variant> network_variants() {
  return {
      mixing("broadcast", "mote, sink and PC broadcast in their island", {114}, broadcast),
      alone("broadcast_reliable", "reliable broadcasts; no node acks", {114}, broadcast_reliable),
      weak("broadcast_acked", "reliable broadcasts; everybody acks", {114}, broadcast_acked),
      alone("broadcast_overlap", "broadcasts where two islands overlap", {114}, broadcast_overlap),
      alone("wide_ignored", "pid 0xFFFF on the air; sinks do not forward it", {114}, wide_ignored),
      alone("wide_refused", "sinks refuse to send pid 0xFFFF, their own and from serial", {114},
            wide_refused),
      alone("wide_forwarded", "pid 0xFFFF on the air; each sink passes it on once", {114},
            wide_forwarded),
      alone("wide_to_sink", "pid 0xFFFF sent to the sink, which passes it on", {114}, wide_to_sink),
      alone("other_mote_ignored",
            "a sink hears messages for other motes of its island, ignores them", {115, 116},
            other_mote_ignored),
      alone("other_mote_relayed",
            "a sink hears messages for other motes, sends them on once by radio",
            {109, 115, 116, 139}, other_mote_relayed),
      alone("foreign_source_forwarded",
            "a sink forwards what foreign motes in range send to its PC", {116},
            foreign_source_forwarded),
      alone("foreign_source_ignored",
            "a sink leaves what foreign motes send to its PC to their sink", {116},
            foreign_source_ignored),
      alone("foreign_mote_to_sink", "a sink delivers what foreign motes in range send to it", {116},
            foreign_mote_to_sink),
      alone("inter_island_true", "messages in every direction between islands; nbytes stays true",
            {}, inter_island_true),
      alone("inter_island_whole", "messages between islands; sinks set nbytes to 102", {},
            inter_island_whole),
      alone("three_islands", "three islands, apart or not", {}, three_islands),
      mixing("serial_true", "forwarded messages keep their nbytes on the serial line", {},
             serial_true),
      alone("serial_whole", "forwarded messages have nbytes 102 and stale bytes", {}, serial_whole),
      weak("serial_cut", "on the serial line messages end after their nbytes", {140}, serial_cut),
      mixing("serial_dest_zero", "serial frames from the host have AM destination 0", {},
             serial_dest_zero),
      weak("serial_resends",
           "damaged frames from the host are sent again by it, so acks may be late", {134},
           serial_resends),
      weak("serial_ack_lost", "the host misses confirmations, so the sink gets messages twice", {},
           serial_ack_lost),
      weak("host_loops_ignored",
           "the host also hands foreign messages to its sink, which ignores them", {126},
           host_loops_ignored),
      weak("host_loops_radiated",
           "the host also hands foreign messages to its sink, which radiates", {126},
           host_loops_radiated),
  };
}

}  // namespace rubric::lawful
