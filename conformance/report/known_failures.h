// Known failures that people keep beside a run, as YAML, each with the reason why it is known.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::report {

/// A failure that is known, or cases that are known not to be decided. Requirement, message and
/// reason are required, and of `rubric test` the cases; an entry of undecided cases has no
/// requirement and no message. Other texts are empty where the file does not limit the entry by
/// them.
struct KnownFailure {
  std::string requirement;  ///< "J4-SEQ"; of `rubric test` also "J4", or "none".
  std::string message;      ///< Part of what the failure says.
  std::string reason;
  std::string profile;     ///< "paper" or "deployed": holds under that one only.
  std::string node;        ///< `rubric check`: the finding's node, exactly.
  std::string file;        ///< `rubric check`: a glob that the file's path or name matches.
  std::string cases;       ///< `rubric test`: a name, or a glob: each of them fails so.
  std::string target;      ///< `rubric test`: a glob for the target or the implementation's name.
  bool skip = false;       ///< `rubric test`: its cases are not decided.
  std::uint32_t line = 0;  ///< In its file, from 1.
};

struct KnownFailures {
  std::string name;  ///< Of the file.
  std::vector<KnownFailure> entries;
};

enum class KnownTo : std::uint8_t { kCheck, kTest };

/// Returns whether the words, numbers and signs of `message` occur in `text`, in this order and
/// with nothing else between them. Blanks between them do not count.
bool has_tokens(std::string_view text, std::string_view message);

/// Reads a YAML list of maps; an empty text is an empty list. `mistake` says what is wrong with a
/// requirement, or returns an empty text. Throws std::runtime_error with "name:line: what".
KnownFailures parse_known_failures(std::string_view text, const std::string& name, KnownTo command,
                                   const std::function<std::string(const std::string&)>& mistake);

}  // namespace rubric::report
