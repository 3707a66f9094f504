// Keeps and prints diagnostics, and suggests names.
#include "spec/compiler/diagnostics.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "codec/reflect/suggest.h"

namespace rubricc {
namespace {

constexpr std::size_t kShownMax = 500;       // Diagnostics printed in a run.
constexpr std::size_t kSourceLineMax = 200;  // Bytes of a source line that are shown.
constexpr std::size_t kListedMax = 12;       // Names in a list of known ones.

std::string_view first_line(std::string_view text) {
  text = text.substr(0, text.find('\n'));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

/// Returns blanks as wide as the first `count` bytes of `line`: tabs stay tabs, a UTF-8 character
/// is one column.
std::string blank_like(std::string_view line, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned char c = i < line.size() ? static_cast<unsigned char>(line[i]) : ' ';
    if ((c & 0xC0) == 0x80) continue;
    out += c == '\t' ? '\t' : ' ';
  }
  return out;
}

}  // namespace

void Diagnostics::add_source(const std::string& file, std::string text) {
  Source& source = sources_[file];
  source.lines = {0};
  for (std::size_t end = text.find('\n'); end != text.npos; end = text.find('\n', end + 1)) {
    source.lines.push_back(end + 1);
  }
  source.text = std::move(text);
}

std::string_view Diagnostics::source_from(const std::string& file, int line) const {
  const auto found = sources_.find(file);
  if (found == sources_.end() || line < 1) return {};
  const Source& source = found->second;
  const auto index = static_cast<std::size_t>(line - 1);
  if (index >= source.lines.size()) return {};
  return std::string_view(source.text).substr(source.lines[index]);
}

void Diagnostics::error(const SourcePlace& place, std::string what, std::string_view expected) {
  if (!expected.empty()) what.append("; ").append(expected);
  found_.try_emplace(Key{place.file, place.line, place.column, what},
                     Diagnostic{place, what, false});
}

void Diagnostics::error_in_code(const SourcePlace& place, std::string what,
                                std::string_view expected) {
  if (!expected.empty()) what.append("; ").append(expected);
  found_.try_emplace(Key{place.file, place.line, place.column, what},
                     Diagnostic{place, what, true});
}

void Diagnostics::pardon_code() {
  std::erase_if(found_, [](const auto& one) { return one.second.in_code; });
}

std::vector<Diagnostic> Diagnostics::sorted() const {
  std::vector<Diagnostic> out;
  for (const auto& [key, diagnostic] : found_) out.push_back(diagnostic);
  return out;
}

void Diagnostics::note(const SourcePlace& place, std::string what) {
  notes_.try_emplace(Key{place.file, place.line, place.column, what},
                     Diagnostic{place, what, false});
}

std::string Diagnostics::print() const { return print(found_, "error"); }
std::string Diagnostics::print_notes() const { return print(notes_, "note"); }

std::string Diagnostics::print(const std::map<Key, Diagnostic>& list, std::string_view kind) const {
  std::string out;
  std::size_t shown = 0;
  for (const auto& [key, found] : list) {
    if (shown == kShownMax) {
      out += fmt::format("{} more {}s\n", list.size() - shown, kind);
      break;
    }
    ++shown;
    const SourcePlace& place = found.place;
    std::string file = place.file;
    std::replace(file.begin(), file.end(), '\n', '?');  // Else it would look like one more.
    if (place.line == 0) {
      out += fmt::format("{}: {}: {}\n", file, kind, found.text);
      continue;
    }
    out += fmt::format("{}:{}:{}: {}: {}\n", file, place.line, place.column, kind, found.text);
    if (!sources_.contains(place.file)) continue;
    const std::string_view line =
        first_line(source_from(place.file, place.line)).substr(0, kSourceLineMax);
    const std::size_t before = static_cast<std::size_t>(std::max(place.column - 1, 0));
    if (before > line.size()) continue;
    out += fmt::format("    {}\n    {}^\n", line, blank_like(line, before));
  }
  return out;
}

std::optional<std::string> text_of_file(const std::string& file, Diagnostics& diagnostics) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error && size > kFileBytesMax) {
    diagnostics.error({file, 0, 0}, "the file is too large", "at most 1 MiB is read");
    return std::nullopt;
  }
  // A pipe or a device may never end, nor even open.
  const bool regular = std::filesystem::is_regular_file(file, error);
  std::ifstream in;
  if (regular) in.open(file, std::ios::binary);
  if (in.is_open()) {
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  const bool other = !regular && std::filesystem::exists(file, error);
  diagnostics.error({file, 0, 0}, other ? "not a regular file" : "cannot be read");
  return std::nullopt;
}

std::string quote(std::string_view word) {
  std::string out = "'";
  for (const char c : word.substr(0, 80)) out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  if (word.size() > 80) out += "...";
  return out + "'";
}

std::string bytes_text(std::uint64_t count) {
  return fmt::format("{} byte{}", count, count == 1 ? "" : "s");
}

std::string nearest(std::string_view word, std::span<const std::string_view> candidates) {
  std::string_view best;
  std::size_t best_distance = word.size() / 3 + 2;
  if (word.size() > 80) return {};
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > 80) continue;
    const auto d = static_cast<std::size_t>(rubric::reflect::edit_distance(word, candidate));
    if (d < best_distance && d < candidate.size()) {
      best = candidate;
      best_distance = d;
    }
  }
  return std::string(best);
}

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string near = nearest(word, candidates);
  if (!near.empty()) return fmt::format("did you mean {}?", quote(near));
  if (candidates.empty()) return "there is none here";
  std::string list;
  for (std::size_t i = 0; i < candidates.size() && i < kListedMax; ++i) {
    if (i > 0) list += ", ";
    list += candidates[i];
  }
  if (candidates.size() > kListedMax) list += ", ...";
  return "known are " + list;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  return suggestion(word, std::span<const std::string_view>(views));
}

}  // namespace rubricc
