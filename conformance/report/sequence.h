// Sequence charts in text.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace rubric::report {

/// No column: somebody who has none.
constexpr std::size_t kNoColumn = std::numeric_limits<std::size_t>::max();

/// Something that was sent, or that happened at one node.
struct SequenceRow {
  std::string time;                ///< May be empty.
  std::string number;
  std::string label;
  std::size_t from = kNoColumn;
  std::vector<std::size_t> to;     ///< Columns.
  bool sent = false;               ///< Somebody may take it, though no column does.
  bool marked = false;             ///< "<<<" stands behind it, and its arrow is doubled.
};

/// One column a node, one row an event. `|` is a node's time line, `*` what goes to nobody known,
/// or comes from nobody known.
struct Sequence {
  std::vector<std::string> columns;
  std::string number_title = "frame";
  std::vector<SequenceRow> rows;
};

/// Fits `width` where it can; each line behind `indent` blanks. Empty without columns.
std::string sequence_text(const Sequence& sequence, std::size_t indent, std::size_t width);

}  // namespace rubric::report
