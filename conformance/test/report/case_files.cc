#include "conformance/test/report/case_files.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "codec/containers/link_record.h"
#include "codec/containers/writer.h"
#include "codec/reflect/am_frames.h"
#include "codec/runtime/bytes.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/hdlc.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "conformance/machine/ticks.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/report/words.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"

namespace rubric::suite {
namespace {

using trace::Line;
using trace::LinkKind;
using trace::Op;

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kSafeNameMax = 80;

std::vector<std::uint8_t> radio_frame(const trace::AmFrame& am, std::uint8_t dsn) {
  const std::uint16_t fcf = reflect::fcf_of(tinyos::FrameControl::kData);
  return reflect::radio_frame(
      {.fcf = fcf, .dsn = dsn, .destpan = am.group, .dest = am.dest, .src = am.src}, am.type,
      Bytes(am.payload.data(), am.payload.size()));
}

/// Writes the frames of one case, each once, however many nodes hear it.
class Capture {
 public:
  explicit Capture(const CaseRun& one) : one_(one) {
    scope_.nodes = one.nodes;
    scope_.links = one.links;
    writer_.begin(out_);
  }

  std::string run() {
    const trace::Case log = one_.result.log.read();
    const std::vector<const Line*> lines = log.lines();
    const std::vector<std::size_t> before = first_seen(lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (before[i] == kNoLine && lines[i]->bytes) add(*lines[i]);
    }
    if (packets_ == 0) return {};
    writer_.finish(out_);
    return std::move(out_);
  }

 private:
  void add(const Line& line) {
    trace::AmFrame frame;
    if (!trace::parse_packet(*line.bytes, frame)) return;
    const LinkKind kind = scope_.link(line.link).value_or(LinkKind::kAny);
    if (kind == LinkKind::kRadio) add_radio(line, frame);
    if (kind == LinkKind::kSerial) add_serial(line);
  }

  void add_radio(const Line& line, const trace::AmFrame& frame) {
    // Each sender counts its own; of those that the case plays its address is known.
    const std::string sender = line.op == Op::kEmits ? line.node : std::string();
    const std::vector<std::uint8_t> bytes = radio_frame(frame, dsns_[{sender, frame.src}]++);
    Packet packet{.framing = Framing::kRadio,
                  .bytes = Bytes(bytes.data(), bytes.size()),
                  .link_type = kLinkRadioFcs};
    packet.fcs = fcs(packet.bytes);
    write(line, packet);
  }

  void add_serial(const Line& line) {
    const auto node = std::find_if(one_.nodes.begin(), one_.nodes.end(),
                                   [&](const auto& each) { return each.name == line.node; });
    const bool at_base = node != one_.nodes.end() && !trace::role_info(node->role).radio;
    Packet packet{.framing = Framing::kHdlc, .link_type = kLinkSerial};
    packet.direction =
        at_base == (line.op == Op::kEmits) ? Direction::kInbound : Direction::kOutbound;
    packet.kind = kSerialPacketNoAck;
    packet.bytes =
        Bytes(reinterpret_cast<const std::uint8_t*>(line.bytes->data()), line.bytes->size());
    packet.crc = crc16(packet.bytes, crc16_step(0, kSerialPacketNoAck));
    write(line, packet);
  }

  void write(const Line& line, Packet& packet) {
    packet.time_ns = line.time.from * kNsPerSecond / machine::kTicksPerSecond;
    if (writer_.write(packet, line.link, out_)) ++packets_;
  }

  const CaseRun& one_;
  trace::Scope scope_;
  PcapngWriter writer_;
  std::string out_;
  std::size_t packets_ = 0;
  std::map<std::pair<std::string, std::uint16_t>, std::uint8_t> dsns_;
};

}  // namespace

std::string case_rtr(const CaseRun& one) {
  trace::File file = trace::File::begin(one.profile);
  for (trace::NodeHeader node : one.nodes) {
    node.whole = node.iut && one.whole;
    file.node(node);
  }
  for (const trace::LinkHeader& link : one.links) file.header({link, {}, {}});
  if (one.seed != 0) file.header({trace::SeedHeader{one.seed}, {}, {}});
  file.cases.push_back(one.result.log.read());
  file.cases.back().name = one.name;
  for (const trace::NodeHeader& node : one.nodes) {
    if (!node.iut || !one.whole) continue;
    Line end;  // Nothing else came, until then.
    end.time = {trace::Time::Base::kStart, 0, static_cast<std::int64_t>(one.result.length), {}};
    end.node = node.name;
    end.op = Op::kMustNot;
    end.link = "*";
    file.cases.back().add(std::move(end));
  }
  return trace::print(file);
}

std::string case_pcapng(const CaseRun& one) { return Capture(one).run(); }

std::string safe_name(std::string_view text) {
  std::string out(text.substr(0, kSafeNameMax));
  for (char& c : out) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '.' || c == '-' || c == '_' || c == '~';
    if (c == '#') {
      c = '~';
    } else if (!plain) {
      c = '_';
    }
  }
  if (out.empty() || out.front() == '.') out.insert(out.begin(), '_');
  return out;
}

}  // namespace rubric::suite
