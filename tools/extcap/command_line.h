// What Wireshark asks of an extcap program.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::extcap {

/// The name of our only interface, as in `tshark -i rubric`.
inline constexpr std::string_view kInterface = "rubric";

/// The protocol of the capture filter, where none is named.
inline constexpr std::string_view kDefaultSpec = "rubicon";

/// A command line of which only what is known is kept: newer Wiresharks pass more than older ones.
class CommandLine {
 public:
  /// Takes `--name value` as well as `--name=value`; of an option given twice the last.
  explicit CommandLine(const std::vector<std::string>& words);

  bool has(std::string_view name) const { return values_.find(name) != values_.end(); }
  /// Of an option that takes one; `otherwise` where it is not given.
  std::string value(std::string_view name, std::string_view otherwise = {}) const;
  /// An option that lacks its value, being the last word; empty if there is none.
  const std::string& unfinished() const { return unfinished_; }

 private:
  std::map<std::string, std::string, std::less<>> values_;
  std::string unfinished_;
};

/// What is printed for --help.
std::string help_text();

}  // namespace rubric::extcap
