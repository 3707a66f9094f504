#include "tools/commands/stats/counters.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tools/format/json_nodes.h"
#include "tools/format/record.h"

namespace rubric::stats {

using reflect::Decoded;
using reflect::Frame;
using reflect::Node;
using reflect::NodeKind;

namespace {

constexpr double kNsPerSecond = 1e9;
constexpr int kBroadcast = 0xffff;

// Damaged stamps can be anything, so their difference may not fit.
std::int64_t difference(std::int64_t later, std::int64_t earlier) {
  const auto gap = static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
  return static_cast<std::int64_t>(
      std::min<std::uint64_t>(gap, static_cast<std::uint64_t>(INT64_MAX)));
}

double length_of_file(const Flow& flow) {
  return flow.first_ns == kNoTime
             ? 0
             : static_cast<double>(difference(flow.last_ns, flow.first_ns)) / kNsPerSecond;
}

// Returns the time since the frame before; -1 if that is unknown, or this one is older.
std::int64_t note_time(Flow& flow, const Place& place) {
  const Place& last = flow.last;
  if (flow.frames > 0 && last.file != place.file) {
    flow.seconds_before += length_of_file(flow);
    flow.first_ns = flow.last_ns = kNoTime;
  }
  if (place.time_ns == kNoTime) return -1;
  ++flow.timed;
  flow.first_ns = flow.first_ns == kNoTime ? place.time_ns : std::min(flow.first_ns, place.time_ns);
  flow.last_ns = std::max(flow.last_ns, place.time_ns);  // kNoTime is below all.
  if (flow.frames == 0 || last.file != place.file || last.time_ns == kNoTime) return -1;
  if (place.time_ns < last.time_ns) {
    ++flow.backward;
    return -1;
  }
  const std::int64_t gap_ns = difference(place.time_ns, last.time_ns);
  if (gap_ns > flow.gap_ns) {
    flow.gap_ns = gap_ns;
    flow.gap_from = last;
    flow.gap_to = place;
  }
  return gap_ns;
}

std::int64_t add(Flow& flow, const Frame& frame, const Place& place, bool repeated) {
  const std::int64_t gap_ns = note_time(flow, place);
  ++flow.frames;
  flow.bytes += frame.packet->bytes.size();
  flow.malformed += frame.malformed();
  flow.repeated += repeated;
  flow.last = place;
  return gap_ns;
}

void append_number(const Node& node, std::string& out) {
  const char* name =
      node.field->enumeration ? reflect::enum_name(*node.field->enumeration, node.value) : nullptr;
  if (name) {
    out += name;
  } else {
    char digits[format::kMaxIntChars];
    out.append(digits, format::put_integer(digits, *node.field, node.value));
  }
}

// An address may be a number or a structure of some.
void append_address(const Decoded& decoded, std::size_t i, std::string& out) {
  const char* separator = "";
  for (std::size_t k = i; k < decoded[i].end; ++k) {
    if (decoded[k].kind != NodeKind::kNumber) continue;
    out += separator;
    separator = ":";
    append_number(decoded[k], out);
  }
}

void append_am_address(std::uint16_t address, std::string& out) {
  if (address == kBroadcast) {
    out += "broadcast";
  } else {
    fmt::format_to(std::back_inserter(out), "{}", address);
  }
}

}  // namespace

double Flow::seconds() const { return seconds_before + length_of_file(*this); }

double Flow::rate() const { return seconds() > 0 ? static_cast<double>(timed) / seconds() : 0; }

void Signal::Range::take(double value) {
  min = count == 0 ? value : std::min(min, value);
  max = count == 0 ? value : std::max(max, value);
  sum += value;
  ++count;
}

std::string message_label(const Frame& frame) {
  if (frame.decoded.message()) return frame.decoded.message()->name;
  if (frame.malformed()) return "(malformed)";
  if (frame.am.present) return fmt::format("(AM type {})", frame.am.type);
  if (frame.packet->framing != Framing::kHdlc) return "(other)";
  const std::string_view kind = format::serial_kind_name(frame.packet->kind);
  return kind.empty() ? fmt::format("(serial kind {})", frame.packet->kind)
                      : fmt::format("(serial {})", kind);
}

std::string pair_label(const Frame& frame) {
  const Decoded& decoded = frame.decoded;
  std::string out;
  if (frame.has_payload && frame.payload_node < decoded.node_count()) {
    const std::size_t src = decoded.child(frame.payload_node, "src");
    const std::size_t dest = decoded.child(frame.payload_node, "dest");
    if (src && dest) {
      append_address(decoded, src, out);
      const std::size_t src_size = out.size();
      out += '>';
      append_address(decoded, dest, out);
      if (src_size > 0 && out.size() > src_size + 1) return out;  // Else cut off in the middle.
    }
  }
  if (!frame.am.present) return out;
  out = "AM ";
  append_am_address(frame.am.src, out);
  out += '>';
  append_am_address(frame.am.dest, out);
  return out;
}

bool Counters::is_repeated(const Frame& frame, const Origin& origin) {
  const Decoded& decoded = frame.decoded;
  if (!frame.has_payload || !decoded.message() || frame.malformed()) return false;
  if (frame.payload_node >= decoded.node_count()) return false;
  const std::size_t field = decoded.child(frame.payload_node, "seq_num");
  if (!field || decoded[field].kind != NodeKind::kNumber) return false;
  // The same message on its way through another interface is no repetition.
  key_ = pair_;
  key_ += '\n';
  key_ += decoded.path()[0]->name;
  key_ += '\n';
  key_ += origin.interface_name;
  key_ += static_cast<char>('0' + static_cast<int>(frame.packet->direction));
  if (last_sequence_.size() >= 4 * kMaxPairs && !last_sequence_.contains(key_)) return false;
  const auto [at, is_new] = last_sequence_.try_emplace(key_, -1);
  const bool repeated = at->second == decoded[field].value;
  at->second = decoded[field].value;
  return repeated && !is_new;
}

void Counters::take_signal(const Frame& frame) {
  const RadioFacts& facts = frame.packet->radio;
  if (facts.channel != kAbsent) ++channels_[facts.channel];
  const bool stated = facts.rssi || facts.lqi != kAbsent;
  if (!stated || !frame.mac.has_addresses || links_.size() >= kMaxPairs) return;
  std::string link = std::to_string(frame.mac.src) + '>';
  link += frame.mac.dest == kBroadcast ? "broadcast" : std::to_string(frame.mac.dest);
  Signal& signal = links_[link];
  ++signal.frames;
  if (facts.rssi) signal.rssi.take(*facts.rssi);
  if (facts.lqi != kAbsent) signal.lqi.take(facts.lqi);
}

void Counters::take(const Frame& frame, const Origin& origin) {
  const Packet& packet = *frame.packet;
  const Place place{std::string(origin.file), origin.index, origin.number, packet.offset_bytes,
                    packet.time_ns};
  if (place.file != all_.last.file) last_sequence_.clear();
  pair_ = pair_label(frame);
  const bool repeated = is_repeated(frame, origin);
  const std::int64_t gap_ns = add(all_, frame, place, repeated);
  if (gap_ns >= 0) gaps_.take(gap_ns);
  if (packet.time_ns != kNoTime) time_line_.take(packet.time_ns);
  if (packet.radio.any()) take_signal(frame);
  add(messages_[message_label(frame)], frame, place, repeated);
  if (!pair_.empty()) {
    if (pairs_.size() >= kMaxPairs && !pairs_.contains(pair_)) pair_ = kOtherPairs;
    add(pairs_[pair_], frame, place, repeated);
    const std::string source = pair_.substr(0, pair_.find('>'));
    add(sources_[source], frame, place, repeated);
  }
  if (frame.has_error()) {
    FaultCount& fault = faults_[{frame.error.fault, frame.error.requirement}];
    if (fault.frames++ == 0) fault.first = place;
  }
  for (std::size_t i = 0; i < frame.decoded.note_count(); ++i) {
    ++notes_[frame.decoded.notes()[i].kind];
  }
  const auto known = interfaces_.find(origin.interface_name);
  if (known != interfaces_.end()) {
    ++known->second;
  } else if (interfaces_.size() < kMaxPairs) {
    interfaces_.emplace(origin.interface_name, 1);
  }
}

}  // namespace rubric::stats
