// All errors of the input, collected in one run and printed in order.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

struct Diagnostic {
  SourcePlace place;
  std::string text;  // "what is wrong; what was expected"
  bool in_code = false;
};

class Diagnostics {
 public:
  /// Remembers a file's text so that its lines can be shown.
  void add_source(const std::string& file, std::string text);
  /// Returns that text from a line on, which counts from 1; empty if there is no such file or line.
  std::string_view source_from(const std::string& file, int line) const;

  /// Adds an error; `expected` may be empty. The same error at the same place is kept once: an
  /// aliased YAML node is read as often as it is used.
  void error(const SourcePlace& place, std::string what, std::string_view expected = {});

  /// The same for what generated code cannot have, but tables in memory can.
  void error_in_code(const SourcePlace& place, std::string what, std::string_view expected = {});
  /// Forgets the errors of error_in_code.
  void pardon_code();

  /// Keeps something that is accepted, but worth to be known.
  void note(const SourcePlace& place, std::string what);
  /// Returns the notes as print() does errors.
  std::string print_notes() const;

  bool empty() const { return found_.empty(); }
  /// Returns the diagnostics by file, line and column.
  std::vector<Diagnostic> sorted() const;
  /// Returns each as "file:line:column: error: text", the source line and a caret.
  std::string print() const;

 private:
  using Key = std::tuple<std::string, int, int, std::string>;
  struct Source {
    std::string text;
    std::vector<std::size_t> lines;  // Begins of lines.
  };
  std::map<std::string, Source> sources_;
  std::string print(const std::map<Key, Diagnostic>& list, std::string_view kind) const;

  std::map<Key, Diagnostic> found_;
  std::map<Key, Diagnostic> notes_;
};

/// More than any spec, catalogue or trace has.
inline constexpr std::size_t kFileBytesMax = 1 << 20;
/// Returns the text of a regular file; nothing, after an error, if it cannot be read or is larger
/// than kFileBytesMax.
std::optional<std::string> text_of_file(const std::string& file, Diagnostics& diagnostics);

/// Returns `'word'`.
std::string quote(std::string_view word);

/// Returns "1 byte", "2 bytes".
std::string bytes_text(std::uint64_t count);

/// Returns the candidate that `word` was probably meant to be; empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string_view> candidates);
/// Returns "did you mean 'x'?" if something is near, else "known are a, b, c".
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

/// Returns the ids of a list of pointers, for `suggestion`: enough of them, not all of very many.
template <class List>
std::vector<std::string> ids_of(const List& list) {
  constexpr std::size_t kEnough = 300;
  std::vector<std::string> out;
  for (const auto& one : list) {
    if (out.size() < kEnough) out.push_back(one->id);
  }
  return out;
}

}  // namespace rubricc
