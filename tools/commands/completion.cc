#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/registry.h"
#include "codec/reflect/requirements.h"
#include "conformance/generated/cases.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/specs.h"
#include "tools/commands/commands.h"
#include "tools/format/message_types.h"
#include "tools/format/path.h"

namespace rubric::tools {
namespace {

struct NamedCommand {
  std::string name;
  std::string description;
  std::vector<cli::OptionInfo> flags;
  std::vector<std::string> words;  ///< Of its arguments; empty: files.
};

constexpr std::string_view kSpec = "spec";

std::vector<std::string> rule_names() {
  std::vector<std::string> names;
  for (const reflect::Requirement& rule : reflect::requirements()) {
    if (*rule.id != '\0') names.emplace_back(rule.id);
  }
  return names;
}

std::vector<std::string> message_names() {
  std::vector<std::string> names;
  for (const reflect::Type* type : format::message_types(*reflect::find_protocol("rubicon"))) {
    names.emplace_back(type->name);
  }
  return names;
}

std::vector<std::string> case_names() {
  std::set<std::string> names;
  for (const cases::CaseUse& use : cases::kCaseUses) names.insert(use.name);
  return {names.begin(), names.end()};
}

/// Returns the names that an option's value can be where it may be something else, too: a file, a
/// pattern, a longer expression.
std::vector<std::string> usual_values(const std::string& command, const cli::OptionInfo& flag) {
  const std::string name = flag.long_names.empty() ? "" : flag.long_names.front();
  if (!flag.takes_value || !flag.choices.empty()) return flag.choices;
  if (name == kSpec) return cli::protocol_names();
  if (name == "as" || name == "message") return message_names();
  if (name == "rule") return rule_names();
  const bool names_cases = name == "case" || name == "except" || name == "cases";
  if (names_cases && command != "coverage") return case_names();
  if (name == "fields" || name == "filter") {
    return format::known_names(*reflect::find_protocol("rubicon"));
  }
  return {};
}

/// Returns the first sentence of a description, on one line.
std::string brief(const std::string& text) { return text.substr(0, text.find_first_of(";\n")); }

std::vector<NamedCommand> commands_of(const cli::Command& program) {
  std::vector<NamedCommand> out;
  for (const cli::Command& command : program.subcommands()) {
    out.push_back({command.name(), brief(command.description()), command.options(), {}});
    for (cli::OptionInfo& flag : out.back().flags) {
      flag.description = brief(flag.description);
      flag.choices = usual_values(command.name(), flag);
    }
    if (command.name() != "explain") continue;
    out.back().words = message_names();
    for (std::string& rule : rule_names()) out.back().words.push_back(std::move(rule));
  }
  return out;
}

std::string spaced(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string names_of(const std::vector<NamedCommand>& commands) {
  std::vector<std::string> names;
  for (const NamedCommand& command : commands) names.push_back(command.name);
  return spaced(names);
}

std::vector<std::string> dashed(const cli::OptionInfo& flag) {
  std::vector<std::string> out;
  for (const std::string& name : flag.short_names) out.push_back("-" + name);
  for (const std::string& name : flag.long_names) out.push_back("--" + name);
  return out;
}

/// Returns text in single quotes as every shell reads them, without characters that are special in
/// zsh.
std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c == '[' ? '(' : c == ']' ? ')' : c;
    }
  }
  return out + "'";
}

void print_bash(const std::vector<NamedCommand>& commands) {
  fmt::print(R"(# bash completion for rubric, written by `rubric completion bash`.
_rubric() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words=
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{} --help --version' -- "$word")
    return
  fi
  case "${{COMP_WORDS[1]}} $before" in
)",
             names_of(commands));
  for (const NamedCommand& command : commands) {
    for (const cli::OptionInfo& flag : command.flags) {
      if (flag.choices.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : dashed(flag)) {
        patterns.push_back(fmt::format("'{} {}'", command.name, name));
      }
      fmt::print("    {}) words='{}' ;;\n", fmt::join(patterns, " | "), spaced(flag.choices));
    }
  }
  fmt::print(R"(  esac
  if [[ -z $words && $word == -* ]]; then
    case ${{COMP_WORDS[1]}} in
)");
  for (const NamedCommand& command : commands) {
    std::vector<std::string> names;
    for (const cli::OptionInfo& flag : command.flags) {
      for (std::string& name : dashed(flag)) names.push_back(std::move(name));
    }
    fmt::print("      {}) words='{}' ;;\n", command.name, spaced(names));
  }
  fmt::print(R"(    esac
  elif [[ -z $words ]]; then
    case ${{COMP_WORDS[1]}} in
)");
  for (const NamedCommand& command : commands) {
    if (command.words.empty()) continue;
    fmt::print("      {}) words='{}' ;;\n", command.name, spaced(command.words));
  }
  fmt::print(R"(    esac
  fi
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(
      compgen -W "$words" -- "$word"
      if [[ $before == --spec ]]; then compgen -f -X '!*.ksy' -- "$word"; fi
    )
  else
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}}
complete -F _rubric rubric
)");
}

bool is_spec(const cli::OptionInfo& flag) {
  return !flag.long_names.empty() && flag.long_names.front() == kSpec;
}

/// Returns '(-o --out)'{-o,--out}'[what it is]:value:(a b)'.
std::string zsh_argument(const cli::OptionInfo& flag) {
  const std::vector<std::string> names = dashed(flag);
  const std::string help = shell_quoted("[" + flag.description + "]");
  std::string tail;
  if (flag.takes_value) {
    const std::string values = spaced(flag.choices);
    if (flag.choices.empty()) {
      tail = ":value:_files";
    } else if (is_spec(flag)) {
      tail = ":value:{compadd -- " + values + "; _files -g \"*.ksy\"}";
    } else {
      tail = ":value:(" + values + ")";
    }
  }
  // The brackets around the description are special; those within it were replaced.
  std::string body = "'[" + help.substr(2, help.size() - 4) + "]" + tail + "'";
  if (names.size() == 1) return names[0] + body;
  return fmt::format("'({})'{{{}}}{}", spaced(names), fmt::join(names, ","), body);
}

void print_zsh(const std::vector<NamedCommand>& commands) {
  fmt::print(R"(#compdef rubric
# zsh completion for rubric, written by `rubric completion zsh`.
_rubric() {{
  if ((CURRENT == 2)); then
    local -a commands=(
)");
  for (const NamedCommand& command : commands) {
    fmt::print("      {}\n", shell_quoted(command.name + ":" + command.description));
  }
  fmt::print(R"(    )
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
)");
  for (const NamedCommand& command : commands) {
    fmt::print("    {})\n      _arguments", command.name);
    for (const cli::OptionInfo& flag : command.flags)
      fmt::print(" \\\n        {}", zsh_argument(flag));
    const std::string words = command.words.empty() ? "_files" : "(" + spaced(command.words) + ")";
    fmt::print(" \\\n        '*:word:{}' ;;\n", words);
  }
  fmt::print("  esac\n}}\n_rubric \"$@\"\n");
}

void print_fish(const std::vector<NamedCommand>& commands) {
  fmt::print("# fish completion for rubric, written by `rubric completion fish`.\n");
  for (const NamedCommand& command : commands) {
    fmt::print("complete -c rubric -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
               shell_quoted(command.description));
    for (const cli::OptionInfo& flag : command.flags) {
      fmt::print("complete -c rubric -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& name : flag.short_names) fmt::print(" -s {}", name);
      for (const std::string& name : flag.long_names) fmt::print(" -l {}", name);
      if (!flag.choices.empty()) {
        fmt::print(" {} -a '{}'", is_spec(flag) ? "-r -F" : "-x", spaced(flag.choices));
      } else if (flag.takes_value) {
        fmt::print(" -r");
      }
      fmt::print(" -d {}\n", shell_quoted(flag.description));
    }
    if (command.words.empty()) continue;
    fmt::print("complete -c rubric -n '__fish_seen_subcommand_from {}' -f -a '{}'\n", command.name,
               spaced(command.words));
  }
}

}  // namespace

void add_completion(cli::Command& app) {
  auto shell = std::make_shared<std::string>();
  cli::Command& sub = app.add_subcommand("completion", "Print the completion script of a shell");
  sub.add_option("SHELL", *shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
  sub.footer(
      "Examples:\n"
      "  rubric completion bash > ~/.local/share/bash-completion/completions/rubric\n"
      "  rubric completion zsh > ~/.zfunc/_rubric      # a folder of $fpath\n"
      "  rubric completion fish > ~/.config/fish/completions/rubric.fish");
  sub.callback([&app, shell] {
    const std::vector<NamedCommand> commands = commands_of(app);
    if (*shell == "bash") {
      print_bash(commands);
    } else if (*shell == "zsh") {
      print_zsh(commands);
    } else {
      print_fish(commands);
    }
  });
}

}  // namespace rubric::tools
