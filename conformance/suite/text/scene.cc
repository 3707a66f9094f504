#include "conformance/suite/text/scene.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "conformance/report/sequence.h"
#include "conformance/report/text.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using report::kNoColumn;
using trace::Line;
using trace::Op;

constexpr std::size_t kBefore = 6;
constexpr std::size_t kAfter = 3;

// A line of the log, or nothing for the place where one is missing.
struct Row {
  const Line* line = nullptr;
  bool marked = false;
};

std::optional<Line> line_of(const runner::Failure& failure) {
  const trace::Parsed parsed =
      trace::parse_syntax("%rtr 1\ncase x\n" + failure.expected + "\n", "expected");
  if (parsed.file.cases.empty() || parsed.file.cases[0].lines().empty()) return std::nullopt;
  return *parsed.file.cases[0].lines()[0];
}

runner::Ticks time_of(const Line& line) { return static_cast<runner::Ticks>(line.time.from); }

// What the failure's text says of an output: "rA ack_join(seq_num=7 ...)".
std::string words_of(const Line& line) {
  return line.link + " " + trace::print(line.message);
}

std::vector<Row> rows_around(const CaseRun& one, const runner::Failure& failure) {
  const std::vector<const Line*> lines = one.result.log.lines();
  std::size_t at = 0;  // Behind what led to it.
  bool breaks = false;
  for (std::size_t i = 0; i < lines.size() && !breaks; ++i) {
    if (time_of(*lines[i]) > failure.time) break;
    at = i + 1;
    breaks = failure.forbidden && lines[i]->op == Op::kEmits &&
             time_of(*lines[i]) == failure.time &&
             failure.text.ends_with(words_of(*lines[i]));
  }
  std::vector<Row> rows;
  for (std::size_t i = at - std::min(at, kBefore); i < at; ++i) {
    rows.push_back({lines[i], breaks && i + 1 == at});
  }
  if (!breaks && !failure.expected.empty()) rows.push_back({nullptr, true});
  for (std::size_t i = at; i < std::min(at + kAfter, lines.size()); ++i) {
    rows.push_back({lines[i], false});
  }
  return rows;
}

// The nodes of a case as columns, and among whom a line passes.
class Stage {
 public:
  explicit Stage(const CaseRun& one) : nodes_(one.nodes) {
    const auto tested = std::count_if(nodes_.begin(), nodes_.end(),
                                      [](const trace::NodeHeader& node) { return node.iut; });
    app_ = tested == 1;
    if (app_) names_.emplace_back("app");
    for (const bool under_test : {true, false}) {  // The others beside whom they talk to.
      for (const trace::NodeHeader& node : nodes_) {
        if (node.iut == under_test) names_.push_back(node.name);
      }
    }
  }

  const std::vector<std::string>& names() const { return names_; }

  std::size_t column(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? kNoColumn : static_cast<std::size_t>(found - names_.begin());
  }

  report::SequenceRow row(const Line& line) const {
    report::SequenceRow row;
    row.label = label(line);
    const std::size_t node = column(line.node);
    const bool given = line.op == Op::kGiven;
    const bool frame = line.am.has_value();
    std::vector<std::size_t> peers;
    if (frame) {
      peers = peers_of(line, given ? line.am->source : line.am->dest);
      if (given && peers.size() > 1) keep_of_island(line, peers);
    } else if (app_ && line.link == "app") {
      peers = {0};
    }
    if (!given) {
      row.from = node;
      row.to = peers;
      row.sent = frame;
    } else {
      if (peers.size() == 1) row.from = peers.front();
      row.to = {node};
    }
    return row;
  }

  static std::string label(const Line& line) {
    std::string out = line.message.name;
    const trace::Value* kind = line.message.find("payload.trans_id");
    if (kind && kind->text == "rubicon_ack") {
      const trace::Value* number = line.message.find("payload.body.seq_num");
      return number ? "ack of " + trace::value_text(*number) : "ack";
    }
    for (const trace::FieldValue& field : line.message.fields) {
      const bool number = field.path == "seq_num" || field.path.ends_with(".seq_num");
      if (!number && field.path != "result" && field.path != "acked") continue;
      if (field.value.is(trace::Value::Kind::kNames)) return out + " " + field.value.text;
      if (!field.value.is(trace::Value::Kind::kNumber)) continue;
      return out + " " + std::to_string(field.value.number);
    }
    return out;
  }

 private:
  // Nodes that an AM address (an island, over PEIS) stands for, as seen from the line's node.
  std::vector<std::size_t> peers_of(const Line& line, const trace::Value& address) const {
    std::vector<std::size_t> out;
    const bool serial = line.link.starts_with("ser");
    const bool peis = line.link == "peis";
    const trace::NodeHeader* self = nullptr;
    for (const trace::NodeHeader& node : nodes_) {
      if (node.name == line.node) self = &node;
    }
    for (const trace::NodeHeader& node : nodes_) {
      if (&node == self || !self) continue;
      const bool base = node.role == trace::Role::kBaseStation;
      if (serial) {
        const bool other = base != (self->role == trace::Role::kBaseStation);
        if (other && node.role != trace::Role::kMote && node.island == self->island) {
          out.push_back(column(node.name));
        }
      } else if (base == peis && is_meant(peis ? node.island : node.id, address)) {
        out.push_back(column(node.name));
      }
    }
    return out;
  }

  // Sinks share an address: of several senders the one whose island the message names.
  void keep_of_island(const Line& line, std::vector<std::size_t>& senders) const {
    const trace::Value* island = line.message.find("island_addr");
    const trace::Value* src = line.message.find("src");
    if (!island && src && src->items.size() == 2) island = &src->items[0];
    if (!island || !island->is(trace::Value::Kind::kNumber)) return;
    std::erase_if(senders, [&](std::size_t c) {
      return std::none_of(nodes_.begin(), nodes_.end(), [&](const trace::NodeHeader& node) {
        return node.name == names_[c] && node.island && *node.island == island->number;
      });
    });
  }

  static bool is_meant(std::optional<std::uint16_t> id, const trace::Value& address) {
    if (address.is(trace::Value::Kind::kNames)) return address.text == "all";
    if (!address.is(trace::Value::Kind::kNumber)) return false;
    return address.number == trace::kAmAll || (id && *id == address.number);
  }

  const std::vector<trace::NodeHeader>& nodes_;
  std::vector<std::string> names_;
  bool app_ = false;
};

std::string window_text(const runner::Failure& failure) {
  return failure.from == failure.to ? fmt::format("@{}", failure.from)
                                    : fmt::format("@{}..{}", failure.from, failure.to);
}

}  // namespace

std::string log_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                       std::size_t width) {
  std::string out;
  for (const Row& row : rows_around(one, failure)) {
    const std::string head = std::string(indent, ' ') + (row.marked ? "> " : "  ");
    if (!row.line) {
      const std::optional<Line> asked = line_of(failure);
      out += report::wrapped(
          head + fmt::format("{:<9} ", window_text(failure)),
          failure.forbidden || !asked
              ? "here"
              : fmt::format("no {} that is as the line says", asked->message.name),
          width);
      continue;
    }
    Line line = *row.line;
    line.bytes.reset();
    line.requirements.clear();
    const std::string am = line.am ? fmt::format("am={}->{} ", trace::value_text(line.am->source),
                                                 trace::value_text(line.am->dest))
                                   : std::string();
    out += report::wrapped(
        head + fmt::format("{:<9} ", fmt::format("@{}", line.time.from)),
        fmt::format("{} {} {} {}{}", line.node, trace::op_text(line.op), line.link, am,
                    trace::print(line.message)),
        width);
  }
  return out;
}

std::string chart_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                         std::size_t width) {
  const Stage stage(one);
  report::Sequence sequence;
  sequence.columns = stage.names();
  sequence.number_title = "tick";
  for (const Row& row : rows_around(one, failure)) {
    report::SequenceRow drawn;
    if (row.line) {
      drawn = stage.row(*row.line);
      drawn.number = std::to_string(row.line->time.from);
    } else {
      const std::optional<Line> asked = line_of(failure);
      if (asked) drawn.from = stage.column(asked->node);
      drawn.number = std::to_string(failure.to);
      drawn.label = asked ? "no " + asked->message.name : "here";
    }
    drawn.marked = row.marked;
    sequence.rows.push_back(std::move(drawn));
  }
  return report::sequence_text(sequence, indent, width);
}

}  // namespace rubric::suite
