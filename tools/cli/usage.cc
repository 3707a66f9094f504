#include "tools/cli/usage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "codec/reflect/suggest.h"
#include "tools/cli/exit_codes.h"

namespace rubric::cli {
namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::map<const CLI::App*, int>& usage_codes() {
  static std::map<const CLI::App*, int> codes;
  return codes;
}

int complain(const CLI::App& app, const std::string& what) {
  const std::string name =
      app.get_parent() ? app.get_parent()->get_name() + " " + app.get_name() : app.get_name();
  fmt::print(stderr, "{}: {}\nTry '{} --help'.\n", name, what, name);
  const auto code = usage_codes().find(&app);
  return code == usage_codes().end() ? kExitUsage : code->second;
}

// Returns the given subcommand, or the program itself.
const CLI::App& innermost(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().back();
  return *at;
}

int complain_about_extras(const CLI::App& app) {
  const CLI::App& where = innermost(app);
  const std::vector<std::string> extras = where.remaining();
  const std::string word = extras.empty() ? std::string{} : extras.front();
  const std::string bare = word.substr(0, word.find('='));
  if (word.starts_with('-')) {
    return complain(where, fmt::format("unknown option {}{}", bare,
                                       reflect::did_you_mean(bare, option_names(where))));
  }
  return complain(where, fmt::format("unexpected argument '{}'", word));
}

int report(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RuntimeError*>(&error)) return error.get_exit_code();  // exit_with
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) return complain_about_extras(app);
  return complain(innermost(app), error.what());
}

}  // namespace

void set_usage_exit_code(const CLI::App& command, int code) { usage_codes()[&command] = code; }

void exit_with(int code) { throw CLI::RuntimeError(code); }

int parse_and_run(CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> commands = subcommand_names(app);
  if (argc > 1 && argv[1][0] != '-' &&
      std::find(commands.begin(), commands.end(), argv[1]) == commands.end()) {
    return complain(app, fmt::format("unknown command '{}'{}", argv[1],
                                     reflect::did_you_mean(argv[1], commands)));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report(app, error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return kExitInput;
  }
  return kExitClean;
}

}  // namespace rubric::cli
