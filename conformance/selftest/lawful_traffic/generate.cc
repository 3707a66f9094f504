// Turns a variant's name into traffic, and traffic into files.

#include "conformance/selftest/lawful_traffic/generate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/writer.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::size_t kMixedMin = 2;
constexpr std::size_t kMixedMax = 5;

std::uint64_t hash(std::string_view text) {
  std::uint64_t out = 14695981039346656037u;  // FNV-1a.
  for (const char c : text) out = (out ^ static_cast<std::uint8_t>(c)) * 1099511628211u;
  return out;
}

std::vector<const Variant*> choose_mixed(Random& random) {
  std::vector<const Variant*> possible;
  for (const Variant& variant : variants()) {
    if (variant.mixes) possible.push_back(&variant);
  }
  std::vector<const Variant*> chosen;
  const std::size_t count = kMixedMin + random.below(kMixedMax - kMixedMin + 1);
  while (chosen.size() < count) {
    const std::size_t at = random.below(possible.size());
    chosen.push_back(possible[at]);
    possible.erase(possible.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return chosen;
}

constexpr std::int64_t kNsPerUs = 1000;

const char* name_of(Role role) {
  switch (role) {
    case Role::kMote: return "mote";
    case Role::kSink: return "sink";
    case Role::kBaseStation: return "base_station";
    case Role::kTester: return "tester";
    case Role::kOutsider: return "outsider";
  }
  return "";
}

std::vector<std::string> quoted(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) out.push_back('"' + name + '"');
  return out;
}

}  // namespace

Traffic generate(std::string_view variant, std::uint64_t seed) {
  Random random(seed ^ hash(variant));
  std::vector<const Variant*> chosen;
  if (variant == "mixed") {
    chosen = choose_mixed(random);
  } else if (const Variant* one = find_variant(variant)) {
    chosen.push_back(one);
  } else {
    throw std::invalid_argument("no lawful variant is named " + std::string(variant));
  }
  Plan plan = common_plan(random);
  for (const Variant* part : chosen) part->configure(plan, random);
  // With nbytes 102 the paper's form of an ack would be unrecognizable.
  if (plan.traits.ack_form != AckForm::kDeployed) plan.traits.serial_true_nbytes = true;
  Traffic traffic = World(std::move(plan), random.next()).run();
  traffic.variant = variant;
  traffic.seed = seed;
  for (const Variant* part : chosen) {
    traffic.variants.emplace_back(part->name);
    traffic.decisions.insert(traffic.decisions.end(), part->decisions.begin(),
                             part->decisions.end());
    traffic.worst = std::max(traffic.worst, part->worst);
    traffic.stated += part->stated;
  }
  std::sort(traffic.decisions.begin(), traffic.decisions.end());
  traffic.decisions.erase(std::unique(traffic.decisions.begin(), traffic.decisions.end()),
                          traffic.decisions.end());
  return traffic;
}

std::string to_pcapng(const Traffic& traffic) {
  PcapngWriter writer;
  std::string out;
  writer.begin(out);
  for (const LawfulPacket& from : traffic.packets) {
    Packet packet;
    packet.time_ns = from.time_us * kNsPerUs;
    packet.direction = from.direction;
    packet.link_type = from.link_type;
    const Bytes record(from.record.data(), from.record.size());
    if (from.link_type == kLinkSerial) {
      packet.framing = Framing::kHdlc;
      decode_serial_content(record, packet);
    } else {
      decode_radio_record(record, from.link_type, packet);
    }
    writer.write(packet, from.interface, out);
  }
  writer.finish(out);
  return out;
}

std::string to_truth_json(const Traffic& traffic) {
  std::string nodes;
  for (const NodeInfo& node : traffic.nodes) {
    const bool serial = node.role == Role::kSink;
    nodes += fmt::format("{}    {{\"node\": {}, \"role\": \"{}\", \"id\": {}, \"island\": {}{}}}",
                         nodes.empty() ? "" : ",\n", node.number, name_of(node.role), node.id,
                         node.island,
                         serial ? fmt::format(", \"interface\": \"serial:{}\"", node.number) : "");
  }
  return fmt::format(
      "{{\n  \"schema\": \"rubric.lawful/1\",\n  \"variant\": \"{}\",\n  \"variants\": [{}],\n"
      "  \"decisions\": [{}],\n  \"seed\": {},\n  \"profile\": \"paper\",\n  \"worst\": \"{}\",\n"
      "  \"options\": {{\"sniffer\": \"{}\", \"start\": \"{}\", \"radio\": {}, \"serial\": {}, "
      "\"well_formed\": {}}},\n  \"packets\": {},\n  \"nodes\": [\n{}\n  ]\n}}\n",
      traffic.variant, fmt::join(quoted(traffic.variants), ", "),
      fmt::join(traffic.decisions, ", "), traffic.seed,
      traffic.worst == Worst::kPass ? "pass" : "weak",
      traffic.sniffer_complete ? "complete" : "unknown", traffic.cold_start ? "cold" : "unknown",
      traffic.has_radio, traffic.has_serial, traffic.all_well_formed, traffic.packets.size(),
      nodes);
}

std::string to_app_jsonl(const Traffic& traffic) {
  std::string out;
  for (const AppEvent& event : traffic.events) {
    out += fmt::format(
        "{{\"t_us\":{},\"node\":{},\"tos_id\":{},\"role\":\"{}\",\"dir\":\"app\",\"event\":\"{}\""
        "{}}}\n",
        event.time_us, event.node, event.tos_id, event.role, event.name, event.fields);
  }
  return out;
}

}  // namespace rubric::lawful
