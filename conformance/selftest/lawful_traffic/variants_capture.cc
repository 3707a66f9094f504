// Variants of other traffic on the air, and of the contents of a capture.
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::uint16_t kFirstForeignAm = 200;
constexpr std::uint16_t kFirstAnchorAm = 100;
constexpr std::uint8_t kAnchors = 5;

void foreign_protocols(Plan& plan, Random& random) {
  // CTP routing, data and forwarding, FTSP, dissemination, Oscilloscope.
  const std::uint8_t types[] = {0x70, 0x71, 0x72, 0x3E, 0x60, 0x93};
  for (std::int64_t time = 100'000; time < plan.end_us; time += random.between(50'000, 250'000)) {
    const std::uint8_t type = types[random.below(std::size(types))];
    const auto am = static_cast<std::uint16_t>(kFirstForeignAm + random.below(4));
    const std::uint16_t dst = random.chance(60) ? kAllNodes : std::uint16_t{kFirstForeignAm};
    Octets payload(random.below(40) + 1);
    for (std::uint8_t& byte : payload) byte = random.byte();
    plan.at(time,
            [=](World& world) { world.outsider(am, Role::kOutsider).send(dst, type, payload); });
  }
}
void rssi_beacons(Plan& plan, Random&) {
  for (std::int64_t time = 100'000; time < plan.end_us; time += 500'000) {
    for (std::uint8_t anchor = 1; anchor <= kAnchors; ++anchor) {
      plan.at(time + anchor * 15'000, [anchor](World& world) {
        world.outsider(kFirstAnchorAm + anchor, Role::kOutsider)
            .send(kAllNodes, static_cast<std::uint8_t>(rubicon::AmType::kTemp), {anchor});
      });
    }
  }
}
void corrupt_frames(Plan& plan, Random&) {
  plan.corrupt_percent = 7;
  plan.traits.ack_join_max = 5;
  plan.all_well_formed = false;
}
void lossy(Plan& plan, Random&) {
  plan.net_loss_percent = 30;
  plan.chats = 20;
  plan.losses.push_back([](World& world, const RadioFrame& frame, const Device&) {
    return frame.type != static_cast<std::uint8_t>(rubicon::AmType::kNet) &&
           world.random().chance(30);
  });
}
void sniffer_gaps(Plan& plan, Random&) {
  plan.sniffer_misses_percent = 15;
  plan.chats = 20;
}
void starts_in_middle(Plan& plan, Random& random) {
  plan.capture_from_us = random.between(700'000, 5'000'000);
  plan.chats = 20;
}
void radio_only(Plan& plan, Random&) { plan.capture_serial = false; }
void serial_only(Plan& plan, Random&) { plan.capture_radio = false; }

}  // namespace

std::vector<Variant> capture_variants() {
  return {
      mixing("foreign_protocols", "CTP, FTSP and other protocols on the same channel", {},
             foreign_protocols),
      mixing("rssi_beacons", "five RSSI anchors", {}, rssi_beacons),
      mixing("corrupt_frames", "collisions: frames with a wrong FCS, which no node takes", {},
             corrupt_frames),
      alone("lossy", "nodes miss 30 percent of all frames", {}, lossy),
      mixing("sniffer_gaps", "the sniffer misses 15 percent of the frames", {}, sniffer_gaps),
      alone("starts_in_middle", "the capture begins when the network runs", {}, starts_in_middle),
      alone("radio_only", "a sniffer's capture alone", {}, radio_only),
      alone("serial_only", "a capture of the serial line alone", {}, serial_only),
  };
}

}  // namespace rubric::lawful
