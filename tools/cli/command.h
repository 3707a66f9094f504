// Commands and their options. The command line library is seen by command.cc alone: its headers
// cost more to compile than all that a command does.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/cli/exit_codes.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rubric::cli {

/// Ends a command early: a UsageError or an exit code.
class Ending : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A mistake in the command line; parse_and_run() prints it with the place to look for help.
class UsageError : public Ending {
 public:
  explicit UsageError(const std::string& what) : Ending(what) {}
  /// Prints as "OPTION: what".
  UsageError(const std::string& option, const std::string& what, std::string excerpt = {})
      : Ending(option + ": " + what), excerpt_(std::move(excerpt)) {}
  /// Returns the lines below it, which show the place, each after a line end.
  const std::string& excerpt() const { return excerpt_; }

 private:
  std::string excerpt_;
};

/// Returns what is wrong with an option's text, empty if nothing is.
using Check = std::function<std::string(const std::string& text)>;

/// Accepts a whole number of 1 or more.
std::string at_least_one(const std::string& text);
/// Accepts a whole number of 0 or more; the library alone takes -1 for the greatest number.
std::string whole_number(const std::string& text);
/// Returns a check that accepts one of the values. It does not show them in the help, as
/// Option::one_of() does.
Check expect_one_of(std::vector<std::string> values);

/// An option or a positional argument of a command. A handle, as long-lived as its command.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option& one_of(std::vector<std::string> values);
  Option& between(int min, int max);
  Option& between(std::uint64_t min, std::uint64_t max);
  Option& between(double min, double max);
  /// `type_name` replaces the type that the help shows, unless it is empty.
  Option& check(Check check, const std::string& type_name = {});
  Option& required();
  /// Takes one value each time the option is given, so that positional arguments may follow.
  Option& one_at_a_time();
  /// Does the same as one_at_a_time(); the help shows a single value.
  Option& repeatable();
  /// Takes the option more than once, as one text with `separator` between the values.
  Option& joined_by(char separator);
  Option& type_name(const std::string& name);
  Option& description(const std::string& text);
  Option& delimiter(char separator);
  Option& needs(Option other);
  Option& excludes(Option other);
  /// Returns whether the command line has it.
  bool is_given() const;

 private:
  friend class Command;

  CLI::Option* option_;
};

/// The facts about an option that a completion needs.
struct OptionInfo {
  std::vector<std::string> long_names;   ///< Without dashes.
  std::vector<std::string> short_names;  ///< Without dashes.
  std::vector<std::string> choices;      ///< The allowed values, where they are listed.
  std::string description;
  bool takes_value = false;
};

/// A program, or one of its subcommands.
class Command {
 public:
  /// A program.
  Command(const std::string& name, const std::string& description);
  /// A subcommand of `parent`.
  Command(CLI::App& app, const Command& parent);
  ~Command();
  Command(const Command&) = delete;

  Command& add_subcommand(const std::string& name, const std::string& description);
  /// Adds an option; `names` as in "-o,--out" or, for a positional argument, "FILE". Targets are
  /// texts, whole and floating-point numbers, std::optional of these, and vectors of texts. An
  /// empty text is refused. The help shows the target's present value, unless it is empty or the
  /// description says "(default: ...)".
  template <class Target>
  Option add_option(const std::string& names, Target& target, const std::string& description = {});
  Option add_flag(const std::string& names, bool& target, const std::string& description = {});
  /// Returns an existing option; throws if there is none of that name.
  Option get_option(const std::string& name);
  /// Forbids `option` together with any other option present now, but for those named.
  void exclude_all_but(Option option, std::initializer_list<std::string_view> allowed);
  void footer(const std::string& text);
  void version(const std::string& text);
  /// Sets what runs when the command is given.
  void callback(std::function<void()> run);
  /// Does the same as callback(); the program ends with the code that `run` returns.
  void exit_code_of(std::function<int()> run);

  std::string name() const;
  std::string description() const;
  /// Returns the options that the help lists, without positional arguments.
  std::vector<OptionInfo> options() const;
  const std::deque<Command>& subcommands() const { return subcommands_; }

  /// Parses, runs the chosen command and returns the program's exit code. Mistakes go to stderr,
  /// with the nearest subcommand or option.
  int parse_and_run(int argc, char** argv);

 private:
  const Command& innermost() const;
  int complain(const std::string& what, const std::string& excerpt = {}) const;
  int complain_about_option(const std::string& bare) const;
  int complain_about_extras() const;
  std::vector<std::string> subcommand_names() const;

  std::unique_ptr<CLI::App> own_;
  CLI::App* app_;
  const Command* parent_ = nullptr;
  std::deque<Command> subcommands_;
};

}  // namespace rubric::cli
