#include "tools/cli/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>
#include <type_traits>

#include "codec/reflect/suggest.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/terminal.h"

namespace rubric::cli {
namespace {

/// Thrown by exit_with().
struct Exit : Ending {
  explicit Exit(int with) : Ending("exit"), code(with) {}
  int code;
};

bool is_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

/// Returns the members of a set, which CLI11 lists in the name of the type:
/// "TEXT:{text,jsonl,csv}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}');
  std::vector<std::string> out;
  if (open == type.npos || close == type.npos) return out;
  for (std::size_t at = open + 1; at < close;) {
    const std::size_t end = std::min(type.find(',', at), close);
    out.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// Help that fits the terminal, and says types as people do: "--seed N (0 to 99)=1".
class Help final : public CLI::Formatter {
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    constexpr std::size_t kTextColumn = 30;
    std::string head = make_option_name(option, is_positional) + make_option_opts(option);
    const std::string& text = option->get_description();
    if (head.size() + 4 <= kTextColumn) {
      head.resize(kTextColumn - 2, ' ');
      return lines("  " + head, text, kTextColumn);
    }
    return lines("  ", head, 6) + lines(std::string(kTextColumn, ' '), text, kTextColumn);
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return {};
    // The library has "UINT:1 to 4", "TEXT:{text,json}", "TEXT".
    const std::string type = option->get_type_name();
    const std::string base = type.substr(0, type.find(':'));
    const std::string rest = base == type ? "" : type.substr(base.size() + 1);
    const bool choice = rest.starts_with('{');
    std::string out = choice                            ? " " + rest
                      : base == "UINT" || base == "INT" ? " N"
                      : base == "FLOAT"                 ? " NUMBER"
                      : base.empty()                    ? ""
                                                        : " " + base;
    std::string value = option->get_default_str();
    const bool byte = value.size() == 1 && static_cast<unsigned char>(value[0]) < ' ';
    if (byte) value = std::to_string(static_cast<int>(value[0]));  // A number of one byte.
    if (value.find_first_not_of(' ') != value.npos) out += "=" + value;
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) out += " ...";
    if (!choice && !rest.empty()) out += " (" + rest + ")";
    for (const CLI::Option* other : option->get_needs()) out += ", with " + other->get_name();
    return out;
  }

  std::string make_subcommand(const CLI::App* sub) const override {
    return lines(fmt::format("  {:<28}", sub->get_name()), sub->get_description(), 30);
  }

  // Examples, which begin with a blank, stay as they are; a table's rows go on in their column.
  std::string make_footer(const CLI::App* app) const override {
    std::string out;
    std::istringstream footer(app->get_footer());
    for (std::string line; std::getline(footer, line);) {
      const std::size_t gap = line.find("  ", line.find_first_not_of(' '));
      const std::size_t text = std::min(line.find_first_not_of(' ', gap), line.size());
      if (!line.starts_with(' ')) {
        out += lines("", line, 0);
      } else if (gap == line.npos || line[text] == '#') {
        out += line + "\n";
      } else {
        out += lines(line.substr(0, text), line.substr(text), text);
      }
    }
    return out;
  }

  static std::string lines(const std::string& first, const std::string& text, std::size_t hang) {
    return text::broken_at_blanks(first, text, columns(0, STDOUT_FILENO), hang);
  }
};

/// Returns whether an option without a value on the command line has one all the same.
template <class Target>
bool has_default(const Target& target) {
  if constexpr (requires { target.empty(); }) return !target.empty();
  if constexpr (requires { target.has_value(); }) return target.has_value();
  return true;
}

/// Refuses an empty text, such as that of a shell's unset variable.
std::string given(const std::string& text) { return text.empty() ? "is empty" : ""; }

template <class Number>
CLI::Validator range(Number min, Number max) {
  const std::string bounds = fmt::format("{} to {}", min, max);
  const auto mistake = [min, max, bounds](const std::string& text) -> std::string {
    Number value{};
    if (CLI::detail::lexical_cast(text, value) && min <= value && value <= max) return {};
    return fmt::format("expected a {} from {}, given '{}'",
                       std::is_integral_v<Number> ? "whole number" : "number", bounds, text);
  };
  return CLI::Validator(mistake, bounds);
}

}  // namespace

void exit_with(int code) { throw Exit(code); }

int code_of(const Ending& ending) {
  const auto* const exit = dynamic_cast<const Exit*>(&ending);
  return exit == nullptr ? -1 : exit->code;
}

std::string whole_number(const std::string& text) {
  if (is_digits(text)) return {};
  return fmt::format("expected a whole number of 0 or more, given '{}'", text);
}

std::string at_least_one(const std::string& text) {
  if (is_digits(text) && text.find_first_not_of('0') != text.npos) return {};
  return fmt::format("expected a whole number of 1 or more, given '{}'", text);
}

Check expect_one_of(std::vector<std::string> values) {
  return [values = std::move(values)](const std::string& text) -> std::string {
    if (std::find(values.begin(), values.end(), text) != values.end()) return {};
    return fmt::format("expected one of {}; given '{}'{}", fmt::join(values, ", "), text,
                       reflect::did_you_mean(text, values));
  };
}

Option& Option::one_of(std::vector<std::string> values) {
  const std::string shown = fmt::format("{{{}}}", fmt::join(values, ","));
  return check(expect_one_of(std::move(values)), shown);
}

Option& Option::between(int min, int max) {
  option_->check(range(min, max));
  return *this;
}

Option& Option::between(std::uint64_t min, std::uint64_t max) {
  option_->check(range(min, max));
  return *this;
}

Option& Option::between(double min, double max) {
  option_->check(range(min, max));
  return *this;
}

Option& Option::check(Check check, const std::string& type_name) {
  option_->check(CLI::Validator(
      [check = std::move(check)](const std::string& text) { return check(text); }, type_name));
  return *this;
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::one_at_a_time() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::repeatable() {
  option_->expected(1)->take_all()->allow_extra_args(false);
  return *this;
}

Option& Option::joined_by(char separator) {
  option_->join(separator);
  return *this;
}

Option& Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::description(const std::string& text) {
  option_->description(text);
  return *this;
}

Option& Option::delimiter(char separator) {
  option_->delimiter(separator);
  return *this;
}

Option& Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}

bool Option::is_given() const { return option_->count() != 0; }

Command::Command(const std::string& name, const std::string& description)
    : own_(std::make_unique<CLI::App>(description)), app_(own_.get()) {
  app_->name(name);
  app_->formatter(std::make_shared<Help>());  // Subcommands inherit it.
}

Command::Command(CLI::App& app, const Command& parent) : app_(&app), parent_(&parent) {}

Command::~Command() = default;

Command& Command::add_subcommand(const std::string& name, const std::string& description) {
  app_->require_subcommand(1);
  return subcommands_.emplace_back(*app_->add_subcommand(name, description), *this);
}

template <class Target>
Option Command::add_option(const std::string& names, Target& target,
                           const std::string& description) {
  CLI::Option* const option = app_->add_option(names, target, description);
  if (has_default(target) && description.find("(default: ") == description.npos) {
    option->capture_default_str();
  }
  return Option(*option).check(given);
}

#define RUBRIC_OPTION_TARGET(...) \
  template Option Command::add_option(const std::string&, __VA_ARGS__&, const std::string&)
RUBRIC_OPTION_TARGET(std::string);
RUBRIC_OPTION_TARGET(std::vector<std::string>);
RUBRIC_OPTION_TARGET(int);
RUBRIC_OPTION_TARGET(unsigned char);
RUBRIC_OPTION_TARGET(unsigned short);
RUBRIC_OPTION_TARGET(unsigned int);
RUBRIC_OPTION_TARGET(unsigned long);
RUBRIC_OPTION_TARGET(double);
RUBRIC_OPTION_TARGET(std::optional<int>);
RUBRIC_OPTION_TARGET(std::optional<unsigned long>);
RUBRIC_OPTION_TARGET(std::optional<double>);
#undef RUBRIC_OPTION_TARGET

Option Command::add_flag(const std::string& names, bool& target, const std::string& description) {
  return Option(*app_->add_flag(names, target, description));
}

Option Command::get_option(const std::string& name) { return Option(*app_->get_option(name)); }

void Command::exclude_all_but(Option option, std::initializer_list<std::string_view> allowed) {
  for (CLI::Option* other : app_->get_options()) {
    const bool fits = other == option.option_ || other == app_->get_help_ptr() ||
                      std::find(allowed.begin(), allowed.end(), other->get_name()) != allowed.end();
    if (!fits) option.option_->excludes(other);
  }
}

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::version(const std::string& text) { app_->set_version_flag("--version", text); }

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

void Command::exit_code_of(std::function<int()> run) {
  callback([run = std::move(run)] { exit_with(run()); });
}

std::string Command::name() const { return app_->get_name(); }

std::string Command::description() const { return app_->get_description(); }

std::vector<OptionInfo> Command::options() const {
  std::vector<OptionInfo> out;
  for (const CLI::Option* option : app_->get_options()) {
    if (!option->nonpositional() || option->get_group().empty()) continue;
    out.push_back({option->get_lnames(), option->get_snames(), choices_of(*option),
                   option->get_description(), option->get_items_expected_max() > 0});
  }
  return out;
}

std::vector<std::string> Command::subcommand_names() const {
  std::vector<std::string> names;
  for (const Command& command : subcommands_) names.push_back(command.name());
  return names;
}

/// Returns the given subcommand, or the program itself.
const Command& Command::innermost() const {
  for (const Command& command : subcommands_) {
    if (command.app_->parsed()) return command.innermost();
  }
  return *this;
}

int Command::complain(const std::string& what, const std::string& excerpt) const {
  const std::string full = parent_ ? parent_->name() + " " + name() : name();
  text::print(stderr, "{}: {}", full, what);
  text::print_harmless(stderr, excerpt);
  text::print(stderr, "\nTry '{} --help'.\n", full);
  return kExitUsage;
}

int Command::complain_about_option(const std::string& bare) const {
  // Without the hyphens, which would make short names look alike.
  std::vector<std::string> names;
  for (const std::string& name : option_names(*app_)) {
    if (name.starts_with("--")) names.push_back(name.substr(2));
  }
  const std::size_t begin = std::min(bare.find_first_not_of('-'), bare.size());
  const std::string_view meant = reflect::nearest(std::string_view(bare).substr(begin), names);
  return complain(fmt::format("unknown option {}{}", bare,
                              meant.empty() ? "" : fmt::format(" (did you mean '--{}'?)", meant)));
}

int Command::complain_about_extras() const {
  const std::vector<std::string> extras = app_->remaining();
  const std::string word = extras.empty() ? std::string{} : extras.front();
  if (word.starts_with('-')) return complain_about_option(word.substr(0, word.find('=')));
  return complain(fmt::format("unexpected argument '{}'", word));
}

int Command::parse_and_run(int argc, char** argv) {
  const std::vector<std::string> commands = subcommand_names();
  if (!commands.empty() && argc == 1) return complain("a command is needed");
  const std::string_view first = argc > 1 ? argv[1] : "";
  if (!commands.empty() && first.starts_with('-')) {
    const std::string bare(first.substr(0, first.find('=')));
    const std::vector<std::string> known = option_names(*app_);
    // The command that is missing, too, would hide it.
    const bool is_known = std::find(known.begin(), known.end(), bare) != known.end();
    if (!is_known) return complain_about_option(bare);
  }
  if (!commands.empty() && argc > 1 && argv[1][0] != '-' &&
      std::find(commands.begin(), commands.end(), argv[1]) == commands.end()) {
    return complain(
        fmt::format("unknown command '{}'{}", argv[1], reflect::did_you_mean(argv[1], commands)));
  }
  try {
    app_->parse(argc, argv);
  } catch (const Exit& exit) {
    return exit.code;
  } catch (const UsageError& error) {
    return innermost().complain(error.what(), error.excerpt());
  } catch (const CLI::ExtrasError&) {
    return innermost().complain_about_extras();
  } catch (const CLI::ConversionError& error) {
    // "Could not convert: --id = x"; all that is converted is a number.
    const std::string what = error.what();
    const std::size_t option = what.find("--");
    const std::size_t value = what.find(" = ");
    if (option == what.npos || value == what.npos) return innermost().complain(what);
    return innermost().complain(fmt::format("{}: expected a number, given '{}'",
                                            what.substr(option, value - option),
                                            what.substr(value + 3)));
  } catch (const CLI::ArgumentMismatch& error) {
    // "--id: 1 required TEXT missing"; all that may miss a value is an option.
    const std::string what = error.what();
    return innermost().complain(
        what.ends_with(" missing") ? what.substr(0, what.find(':')) + " needs a value" : what);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app_->exit(error);  // --help, --version
    return innermost().complain(error.what());
  } catch (const std::system_error& error) {  // By fmt::print(), if it is a closed pipe.
    if (error.code() == std::errc::broken_pipe) return kExitOutput;
    text::print(stderr, "{}: {}\n", name(), error.what());
    return kExitInput;
  } catch (const std::exception& error) {
    text::print(stderr, "{}: {}\n", name(), error.what());
    return kExitBroken;
  }
  return kExitClean;
}

}  // namespace rubric::cli
