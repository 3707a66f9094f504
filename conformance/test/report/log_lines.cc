#include "conformance/test/report/log_lines.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <unordered_map>

#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using trace::Line;
using trace::NodeHeader;
using trace::Op;
using trace::Value;

// How long a frame is on its way in a golden trace: a serial line takes some ticks a message.
constexpr std::int64_t kOnItsWayTicks = 40;

bool is_meant(std::optional<std::uint16_t> id, const Value& address) {
  if (address.is(Value::Kind::kNames)) return address.text == "all";
  if (!address.is(Value::Kind::kNumber)) return false;
  return address.number == trace::kAmAll || (id && *id == address.number);
}

void keep_of_island(const std::vector<NodeHeader>& nodes, const Line& line,
                    std::vector<std::size_t>& senders) {
  const Value* island = line.message.find("island_addr");
  const Value* src = line.message.find("src");
  if (!island && src && src->items.size() == 2) island = &src->items[0];
  if (!island || !island->is(Value::Kind::kNumber)) return;
  std::erase_if(senders, [&](std::size_t i) {
    return !nodes[i].island || *nodes[i].island != island->number;
  });
}

// Returns the parts of an ack that it has whichever its body is; empty if it is none.
std::string ack_text(const trace::Message& message) {
  const Value* const kind = message.find("payload.trans_id");
  if (kind == nullptr || kind->text != "rubicon_ack") return {};
  std::string out;
  for (const char* path : {"dest", "src", "seq_num", "payload.app_id", "payload.body.seq_num"}) {
    const Value* const value = message.find(path);
    if (value == nullptr) return {};
    out += trace::value_text(*value) + ' ';
  }
  return out;
}

// Returns what lines that show the same frame have in common: all but the AM addresses of a serial
// line and the bytes after a message.
std::string frame_text(const Line& line, bool acks_in_any_form) {
  std::string out = line.link + ' ';
  if (!line.link.starts_with("ser")) {
    out += trace::value_text(line.am->source) + "->" + trace::value_text(line.am->dest) + ' ';
  }
  const std::string ack = acks_in_any_form ? ack_text(line.message) : std::string();
  return out + (ack.empty() ? trace::print(line.message) : "ack " + ack);
}

}  // namespace

std::vector<std::size_t> peers_of(const std::vector<NodeHeader>& nodes, const Line& line) {
  std::vector<std::size_t> out;
  const auto self = std::find_if(nodes.begin(), nodes.end(),
                                 [&](const NodeHeader& node) { return node.name == line.node; });
  if (!line.am || self == nodes.end()) return out;
  const Value& address = line.op == Op::kGiven ? line.am->source : line.am->dest;
  const bool serial = line.link.starts_with("ser");
  const bool peis = line.link == "peis";
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeHeader& node = nodes[i];
    if (&node == &*self) continue;
    const bool base = !trace::role_info(node.role).radio;
    if (serial) {
      const bool other_end = base == trace::role_info(self->role).radio;
      if (other_end && trace::role_info(node.role).serial && node.island == self->island) {
        out.push_back(i);
      }
    } else if (base == peis && is_meant(peis ? node.island : node.id, address)) {
      out.push_back(i);
    }
  }
  if (line.op == Op::kGiven && out.size() > 1) keep_of_island(nodes, line, out);
  return out;
}

std::string short_text(const trace::Message& message) {
  const std::string& name = message.name;
  if (name == "*") return "no active message";
  const Value* kind = message.find("payload.trans_id");
  if (kind && kind->text == "rubicon_ack") {
    const Value* number = message.find("payload.body.seq_num");
    return number ? "ack of " + trace::value_text(*number) : "ack";
  }
  for (const trace::FieldValue& field : message.fields) {
    const bool number = field.path == "seq_num" || field.path.ends_with(".seq_num");
    if (!number && field.path != "result" && field.path != "acked") continue;
    if (field.value.is(Value::Kind::kNames)) return name + " " + field.value.text;
    if (!field.value.is(Value::Kind::kNumber)) continue;
    return name + " " + std::to_string(field.value.number);
  }
  return name;
}

bool is_broken_by(const runner::Failure& failure, const Line& line) {
  return failure.forbidden && line.op == Op::kEmits && line.node == failure.node &&
         line.time.from == static_cast<std::int64_t>(failure.time) &&
         failure.text.ends_with(line.link + " " + trace::print(line.message));
}

std::string elsewhere_text(const runner::Failure& failure) {
  return failure.elsewhere ? ", it came at " + std::to_string(*failure.elsewhere) : "";
}

std::optional<Line> asked_line(const runner::Failure& failure) {
  const trace::Parsed parsed =
      trace::parse_syntax("%rtr 1\ncase x\n" + failure.expected + "\n", "expected");
  if (parsed.file.cases.empty() || parsed.file.cases[0].lines().empty()) return std::nullopt;
  return *parsed.file.cases[0].lines()[0];
}

std::vector<std::size_t> first_seen(const std::vector<const Line*>& lines, bool acks_in_any_form) {
  // Those that a node may yet be given, the latest last: given the same frame of the same sender
  // again, it is another frame.
  struct Open {
    std::vector<std::size_t> lines;
    std::size_t known = 0;  // Of the frame's first lines.
  };
  struct Frame {
    std::vector<std::size_t> firsts;
    std::map<std::string_view, Open> by_node;
  };
  std::unordered_map<std::string, Frame> frames;
  std::vector<std::size_t> out(lines.size(), kNoLine);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = *lines[i];
    if (!line.am) continue;
    Frame& frame = frames[frame_text(line, acks_in_any_form)];
    if (line.op == Op::kGiven && line.bytes) {
      Open& open = frame.by_node[line.node];
      for (; open.known < frame.firsts.size(); ++open.known) {
        const std::size_t first = frame.firsts[open.known];
        if (lines[first]->node != line.node) open.lines.push_back(first);
      }
      while (out[i] == kNoLine && !open.lines.empty()) {
        const Line& before = *lines[open.lines.back()];
        const std::int64_t ago = line.time.from - before.time.from;
        if (ago > kOnItsWayTicks) break;
        if (before.op != Op::kGiven || ago == 0) out[i] = open.lines.back();
        open.lines.pop_back();  // What was given earlier is not given again.
      }
    }
    if (out[i] == kNoLine) frame.firsts.push_back(i);
  }
  return out;
}

}  // namespace rubric::suite
