#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "codec/text/text.h"
#include "tools/commands/commands.h"
#include "tools/commands/new/new_files.h"

namespace rubric::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNewProtocolFooter =
    "The folder has a wire spec, rules, two golden traces, a node in Python that passes them, and\n"
    "README.md, which says how to go on. Files that exist are never overwritten.\n"
    "Exit codes: 0 written, 64 usage, 74 something is in the way or could not be written.";

constexpr std::string_view kFolder = "tools/skeletons/protocol/";
// The loop of the node that ships.
constexpr std::string_view kLoop = "conformance/protocols/ctp/rct.py";
constexpr std::string_view kPlaceholder = "@name@";
constexpr std::string_view kFileStem = "protocol.";  // Of files that are named like the protocol.

struct NewProtocolOptions {
  std::string name;
  std::string out;
};

std::string lower_snake_case(const std::string& text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  const bool good = !text.empty() && text[0] >= 'a' && text[0] <= 'z' &&
                    std::all_of(text.begin(), text.end(), fits);
  return good ? "" : "expected lower-case letters, digits and _, given '" + text + "'";
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

void write_protocol(const NewProtocolOptions& options) {
  const std::string out = options.out.empty() ? options.name : options.out;
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& [path, content] : skeleton_files()) {
    std::string name = path == kLoop ? fs::path(path).filename().string() : path;
    if (name.starts_with(kFolder)) name.erase(0, kFolder.size());
    if (name == path) continue;  // Another skeleton's.
    files.emplace_back(replaced(name, kFileStem, options.name + "."),
                       replaced(std::string(content), kPlaceholder, options.name));
  }
  write_new_files("new-protocol", out, files);
  text::print(stdout, "Next:\n  rubric test --protocol {0} --target 'python3 {0}/node.py'\n", out);
}

}  // namespace

void add_new_protocol(cli::Command& app) {
  auto options = std::make_shared<NewProtocolOptions>();
  cli::Command& sub =
      app.add_subcommand("new-protocol", "Write the folder of a new protocol to be tested");
  sub.footer(kNewProtocolFooter);
  sub.add_option("NAME", options->name, "The protocol's name, as my_protocol")
      .required()
      .check(lower_snake_case);
  sub.add_option("-o,--out", options->out, "Write into this folder (default: NAME)");
  sub.callback([options] { write_protocol(*options); });
}

}  // namespace rubric::tools
