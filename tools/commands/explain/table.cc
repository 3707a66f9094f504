#include "tools/commands/explain/table.h"

#include <algorithm>

#include "codec/text/text.h"

namespace rubric::explain {
namespace {

constexpr std::size_t kGap = 2;
constexpr std::size_t kLeastRoom = 24;  // For a column that is broken into lines.

// Returns characters, not bytes: UTF-8 continuation bytes take no room.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

// Returns the text harmless, except that it keeps kFirmBlank.
std::string harmless_but_firm(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(kFirmBlank, at), text.size());
    out += text::harmless(text.substr(at, end - at), text::Keep::kLines);
    if (end < text.size()) out += kFirmBlank;
    at = end + 1;
  }
  return out;
}

}  // namespace

void Table::add(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = harmless_but_firm(cell);
  rows_.push_back(std::move(cells));
}

// Returns widths; 0 for a column without any text.
std::vector<std::size_t> Table::widths() const {
  std::vector<std::size_t> widths(headings_.size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (widths[i]) widths[i] = std::max(widths[i], width_of(headings_[i]));
  }
  return widths;
}

std::string Table::text(std::size_t indent) const {
  const std::vector<std::size_t> widths = this->widths();
  std::string out;
  const auto put = [&](const std::vector<std::string>& row) {
    std::string line(indent, ' ');
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (widths[i] == 0) continue;
      const std::string blanks(widths[i] - width_of(row[i]), ' ');
      const bool right = std::find(right_.begin(), right_.end(), i) != right_.end();
      line += right ? blanks + row[i] : row[i] + blanks;
      line.append(kGap, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  };
  put(headings_);
  for (const auto& row : rows_) put(row);
  return out;
}

std::string Table::text_within(std::size_t columns, std::size_t indent) const {
  const std::vector<std::size_t> widths = this->widths();
  std::size_t before = indent;  // The last column.
  for (std::size_t i = 0; i + 1 < widths.size(); ++i) before += widths[i] ? widths[i] + kGap : 0;
  if (before + widths.back() <= columns) return text(indent);
  if (before + kLeastRoom > columns) return with_last_below(columns, indent);
  Table broken(headings_);
  broken.right_ = right_;
  for (std::vector<std::string> row : rows_) {
    std::vector<std::string> lines = lines_of(wrapped(row.back(), 0, columns - before));
    if (lines.empty()) lines.emplace_back();
    for (std::string& line : lines) {
      row.back() = std::move(line);
      broken.add(row);
      row.assign(row.size(), {});
    }
  }
  return broken.text(indent);
}

std::string Table::with_last_below(std::size_t columns, std::size_t indent) const {
  Table others(std::vector<std::string>(headings_.begin(), headings_.end() - 1));
  others.right_ = right_;
  for (const auto& row : rows_) others.add({row.begin(), row.end() - 1});
  const std::size_t below = indent + widths().front() + kGap;
  std::string out;
  std::size_t next = 0;  // The heading goes first.
  for (const std::string& line : lines_of(others.text(indent))) {
    out += line + '\n';
    if (next > 0) out += wrapped(rows_[next - 1].back(), below, columns);
    ++next;
  }
  return out;
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
  if (text.find_first_not_of(" \n") == std::string::npos) return {};
  std::string out = text::broken_at_blanks(std::string(indent, ' '), text, columns, indent);
  std::replace(out.begin(), out.end(), kFirmBlank, ' ');
  return out;
}

}  // namespace rubric::explain
