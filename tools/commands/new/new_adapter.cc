#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "codec/text/text.h"
#include "conformance/test/report/known_list.h"
#include "tools/commands/commands.h"
#include "tools/commands/new/new_files.h"

namespace rubric::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNewAdapterFooter =
    "The skeleton answers every command of rct/1 with a node that does almost nothing; TODO marks\n"
    "where your implementation goes; known.yaml lists the cases that it cannot decide yet.\n"
    "conformance/PORTING.md says how to go on.\n"
    "Files that exist are never overwritten.\n"
    "Exit codes: 0 written, 64 usage, 74 something is in the way or could not be written.";

constexpr const char* kKnown = "known.yaml";

struct Language {
  const char* name;
  const char* build;   ///< Within the folder; empty: nothing to build.
  const char* target;  ///< For rubric test.
};
constexpr Language kLanguages[] = {
    {"python", "", "python3 adapter.py"},
    {"cpp", "g++ -std=c++17 -O2 -Wall -Wextra -o my_node adapter.cc", "./my_node"},
    {"java", "javac *.java", "java -cp . Adapter"},
};

/// Returns names and texts of a language's files. Python's loop is that of the adapter that ships.
std::vector<std::pair<fs::path, std::string>> skeleton_of(std::string_view language) {
  constexpr std::string_view kShipped = "rubric_python_mote 1.0";
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& [path, content] : skeleton_files()) {
    const fs::path file(path);
    if (file.parent_path().filename() != language) continue;
    std::string own(content);
    const std::size_t name = own.find(kShipped);
    if (name != own.npos) own.replace(name, kShipped.size(), "my_mote 0.1");
    files.emplace_back(file.filename(), own);
  }
  return files;
}

struct NewAdapterOptions {
  std::string language;
  std::string out = ".";
};

const Language& language_of(const std::string& name) {
  for (const Language& one : kLanguages) {
    if (name == one.name) return one;
  }
  throw cli::UsageError("LANGUAGE", "python, cpp or java, not '" + name + "'");
}

void write_skeleton(const NewAdapterOptions& options) {
  const Language& language = language_of(options.language);
  std::vector<std::pair<fs::path, std::string>> files = skeleton_of(language.name);
  files.emplace_back(kKnown, suite::list_to_begin_with(suite::Cases::own(), machine::Role::kMote));
  write_new_files("new-adapter", options.out, files);
  text::print(stdout, "Next:\n");
  if (options.out != ".") text::print(stdout, "  cd {}\n", options.out);
  if (*language.build) text::print(stdout, "  {}\n", language.build);
  text::print(stdout, "  rubric test --target '{}' --expect {}\n", language.target, kKnown);
}

}  // namespace

void add_new_adapter(cli::Command& app) {
  auto options = std::make_shared<NewAdapterOptions>();
  cli::Command& sub = app.add_subcommand("new-adapter", "Write the skeleton of an adapter");
  sub.footer(kNewAdapterFooter);
  sub.add_option("LANGUAGE", options->language, "python, cpp or java")
      .required()
      .one_of({"python", "cpp", "java"});
  sub.add_option("-o,--out", options->out, "Write its files into this folder");
  sub.callback([options] { write_skeleton(*options); });
}

}  // namespace rubric::tools
