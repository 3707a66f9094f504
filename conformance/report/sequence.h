// Sequence charts of messages between nodes, as text (here) and as a picture (sequence_svg.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace rubric::report {

/// Index of a node without a column.
constexpr std::size_t kNoColumn = std::numeric_limits<std::size_t>::max();

/// A message that was sent, or an event at one node.
struct SequenceRow {
  std::string time;  ///< May be empty.
  std::string number;
  std::string label;
  std::size_t from = kNoColumn;
  std::vector<std::size_t> to;  ///< Columns.
  bool sent = false;            ///< Somebody may take it, though no column does.
  bool marked = false;          ///< "<<<" follows it, and its arrow is doubled.
  std::string note;             ///< Printed after the row: "ignored: J4-SEQ".

  // For pictures.
  enum class Way : std::uint8_t { kRadio, kSerial, kPeis, kCall, kState };
  Way way = Way::kRadio;                ///< kCall: between a node and its application.
  std::string detail;                   ///< The label with what matters of the message.
  std::string full;                     ///< All of it.
  std::vector<std::size_t> missed;      ///< Columns that it was for and that never got it.
  bool absent = false;                  ///< It should have happened: its arrow ends in a cross.
  bool stimulus = false;                ///< Given from outside, by nobody that is drawn.
  std::vector<std::size_t> ignored_by;  ///< Columns of `to` that made nothing of it.
  std::vector<std::size_t> lines;       ///< Lines of the log that this row shows.
};

/// A chart: one column a node, one row an event. `|` is a node's time line, `*` an arrow's end at
/// no known node.
struct Sequence {
  std::vector<std::string> columns;
  std::vector<std::string> about;  ///< For pictures: a few words on each column, or empty.
  std::string number_title = "frame";
  std::vector<SequenceRow> rows;
};

/// Returns the chart as text. Fits `width` where it can; each line begins with `indent` blanks.
/// Empty without columns.
std::string sequence_text(const Sequence& sequence, std::size_t indent, std::size_t width);

}  // namespace rubric::report
