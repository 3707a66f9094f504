// Reads the answer to a command of rct/1, line by line, and trusts none of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/targets/attachment.h"
#include "conformance/test/targets/rct_text.h"

namespace rubric::targets {

struct Answer {
  std::vector<Output> outputs;
  bool has_next = false;
  std::optional<Ticks> next;  ///< From a `next` line; nothing: never.
  Ticks done = 0;
  std::vector<std::string> notes;    ///< The first kNotesBytesMax bytes of them.
  std::size_t notes_bytes = 0;       ///< Of those kept, with a line feed each.
  std::uint64_t notes_left_out = 0;  ///< How many did not fit.
};

/// The bytes of notes that are kept of an answer, and of a case.
constexpr std::size_t kNotesBytesMax = 65536;

/// The answers that a command allows.
struct Asked {
  std::string command;
  std::string closing = "done";  ///< Its word: done, ready or hello. `unsupported` always may.
  Ticks from = 0;                ///< No T lies before it.
  Ticks to = 0;                  ///< Nor after it.
  bool passes_time = false;      ///< It is `until`.
  bool real_time = false;        ///< Nobody turns the clock: T may be after `to`.
};

class AnswerReader {
 public:
  explicit AnswerReader(const Asked& asked) : asked_(asked) {}

  /// Takes a line. Returns true if it closed the answer. Throws runner::TargetBroken, with the
  /// number of the line and what is wrong with it, and runner::Unsupported.
  bool take(std::string_view line);

  const Answer& answer() const { return answer_; }
  /// Returns the whole closing line.
  const std::string& closing() const { return closing_; }

 private:
  void tx(Words words);
  void up(Words words);
  void next(Words words);
  void done(Words words);
  Ticks time(std::string_view word) const;
  Ticks output_time(Words& words);
  ReqId requirement(std::string_view& line) const;
  void add(Output output);
  [[noreturn]] void fail(const std::string& what) const;

  const Asked& asked_;
  Answer answer_;
  std::string closing_;
  std::size_t lines_ = 0;
};

/// Quotes a line for an error: its first bytes, unprintable ones as \xff.
std::string shown(std::string_view line);

/// Returns the identity in a closing `hello` line. Throws runner::TargetBroken.
Identity read_hello(const std::string& line);

}  // namespace rubric::targets
