// The command line that Wireshark passes to an extcap program.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::extcap {

/// The name of our only interface, as in `tshark -i rubric`.
inline constexpr std::string_view kInterface = "rubric";

/// The protocol of the capture filter, if none is named.
inline constexpr std::string_view kDefaultSpec = "rubicon";

/// A command line of which only known options are kept: newer Wiresharks pass more than older ones.
class CommandLine {
 public:
  /// Takes `--name value` as well as `--name=value`; the last one if an option is given twice.
  explicit CommandLine(const std::vector<std::string>& words);

  bool has(std::string_view name) const { return values_.find(name) != values_.end(); }
  /// Returns the value of an option that takes one; `otherwise` if it is not given.
  std::string value(std::string_view name, std::string_view otherwise = {}) const;
  /// Returns an option that lacks its value, being the last word; empty if there is none.
  const std::string& unfinished() const { return unfinished_; }

 private:
  std::map<std::string, std::string, std::less<>> values_;
  std::string unfinished_;
};

/// Returns the text of --help.
std::string help_text();

}  // namespace rubric::extcap
