// Traffic as files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/writer.h"
#include "conformance/selftest/lawful_traffic/generate.h"

namespace rubric::lawful {
namespace {

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

std::string to_pcapng(const Traffic& traffic) {
  PcapngWriter writer;
  std::string out;
  writer.begin(out);
  for (const LegalPacket& from : traffic.packets) {
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
      "{{\n  \"schema\": \"rubric.legal/1\",\n  \"variant\": \"{}\",\n  \"variants\": [{}],\n"
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
