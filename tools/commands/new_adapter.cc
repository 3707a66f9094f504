#include "tools/commands/new_adapter.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"

namespace rubric::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNewAdapterFooter =
    "The skeleton answers every command of rct/1 with a node that does almost nothing; TODO marks\n"
    "where your implementation goes. conformance/PORTING.md says how to go on.\n"
    "Files that exist are never overwritten.\n"
    "Exit codes: 0 written, 2 usage, 3 something could not be written, and then nothing was.";

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

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  fmt::print(stderr, "rubric new-adapter: cannot write {}: {}\n", path, why);
  cli::exit_with(cli::kExitInput);
}

void write_skeleton(const NewAdapterOptions& options) {
  const Language& language = language_of(options.language);
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) refuse(options.out, error.message());
  std::vector<const SkeletonFile*> files;
  for (const SkeletonFile& file : skeleton_files()) {
    if (file.language != language.name) continue;
    const fs::path path = fs::path(options.out) / file.name;
    if (fs::exists(fs::symlink_status(path, error))) {
      refuse(path.string(), "it exists, and may hold your work");
    }
    files.push_back(&file);
  }
  for (const SkeletonFile* file : files) {
    const fs::path path = fs::path(options.out) / file->name;
    if (!cli::write_file(path.string(), file->text)) cli::exit_with(cli::kExitInput);
    fmt::print("wrote {}\n", path.lexically_normal().string());
  }
  fmt::print("Next:\n");
  if (options.out != ".") fmt::print("  cd {}\n", options.out);
  if (*language.build) fmt::print("  {}\n", language.build);
  fmt::print("  rubric test --target '{}'\n", language.target);
}

}  // namespace

void add_new_adapter(cli::Command& app) {
  auto options = std::make_shared<NewAdapterOptions>();
  cli::Command& sub = app.add_subcommand("new-adapter", "Write the skeleton of an adapter");
  sub.footer(kNewAdapterFooter);
  sub.add_option("LANGUAGE", options->language, "python, cpp or java")
      .required()
      .one_of({"python", "cpp", "java"});
  sub.add_option("--out", options->out, "Write its files into this folder").show_default();
  sub.callback([options] { write_skeleton(*options); });
}

}  // namespace rubric::tools
