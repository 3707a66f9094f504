#include "conformance/test/report/text/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "codec/text/text.h"
#include "conformance/report/sequence.h"
#include "conformance/test/report/chart.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/trace/print.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using trace::Line;
using trace::Op;

constexpr std::size_t kBefore = 6;
constexpr std::size_t kAfter = 3;

// A line of the log, or nothing at the place of a missing one.
struct Row {
  const Line* line = nullptr;
  bool marked = false;
};

runner::Ticks time_of(const Line& line) { return static_cast<runner::Ticks>(line.time.from); }

std::vector<Row> rows_around(const CaseRun& one, const runner::Failure& failure) {
  const std::vector<const Line*> lines = one.result.log.lines();
  std::size_t at = 0;  // After its cause.
  bool breaks = false;
  for (std::size_t i = 0; i < lines.size() && !breaks; ++i) {
    if (time_of(*lines[i]) > (failure.forbidden ? failure.time : failure.to)) break;
    at = i + 1;
    breaks = is_broken_by(failure, *lines[i]);
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

// Returns the message with the last names of paths, where these are enough: "led" for
// "mote_desc.led".
trace::Message with_short_paths(trace::Message message) {
  const auto tail = [](const trace::FieldValue& field) {
    return field.path.substr(field.path.rfind('.') + 1);
  };
  std::map<std::string, int> counts;
  for (const trace::FieldValue& field : message.fields) ++counts[tail(field)];
  for (trace::FieldValue& field : message.fields) {
    if (counts[tail(field)] == 1) field.path = tail(field);
  }
  return message;
}

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
      const std::optional<Line> asked = asked_line(failure);
      out +=
          report::wrapped(head + fmt::format("{:<9} ", window_text(failure)),
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
    out += report::wrapped(head + fmt::format("{:<9} ", fmt::format("@{}", line.time.from)),
                           fmt::format("{} {} {} {}{}", line.node, trace::op_text(line.op),
                                       line.link, am, trace::print(with_short_paths(line.message))),
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
      const std::optional<Line> asked = asked_line(failure);
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
