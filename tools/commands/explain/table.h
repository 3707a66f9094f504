// Aligned columns of text.
#pragma once

#include <string>
#include <vector>

namespace rubric::explain {

/// Rows of cells; columns are as wide as their widest cell, and the last one is not padded. Leaves
/// out a column without any text, with its heading.
class Table {
 public:
  explicit Table(std::vector<std::string> headings) : headings_(std::move(headings)) {}

  /// Aligns the cells of a column at the right: numbers.
  void align_right(std::size_t column) { right_.push_back(column); }

  /// Adds a row; what is in the cells need not be harmless to terminals.
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }

  /// Returns all lines, each with its end, after `indent` blanks.
  std::string text(std::size_t indent = 0) const;

  /// Returns the same in `columns` columns, if the last one can be broken at blanks to end there.
  /// If the others leave it no room, its cells come below their rows, without a heading.
  std::string text_within(std::size_t columns, std::size_t indent = 0) const;

 private:
  std::vector<std::size_t> widths() const;
  std::string with_last_below(std::size_t columns, std::size_t indent) const;

  std::vector<std::string> headings_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> right_;
};

/// The width of text on a terminal.
inline constexpr std::size_t kColumns = 110;

/// A blank at which wrapped() does not break.
inline constexpr char kFirmBlank = '\x1f';

/// Returns `text` in lines of at most `columns` characters, broken at blanks, each after `indent`
/// blanks; no line if it is empty.
std::string wrapped(const std::string& text, std::size_t indent = 0, std::size_t columns = 100);

}  // namespace rubric::explain
