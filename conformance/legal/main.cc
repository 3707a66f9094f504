// rubric_legal: writes captures of legal networks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "conformance/legal/generate.h"

namespace {

using namespace rubric::legal;

constexpr int kCannotWrite = 3;

void list() {
  for (const Variant& variant : variants()) {
    fmt::print("{:<27} {:<11} {}{}\n", variant.name,
               variant.decisions.empty() ? "-"
                                         : fmt::format("{}", fmt::join(variant.decisions, ",")),
               variant.summary, variant.worst == Worst::kWeak ? " (weak)" : "");
  }
  for (const WithoutVariant& none : without_variant()) {
    fmt::print("decision {} has none: {}\n", none.decision, none.reason);
  }
}

bool write_file(const std::filesystem::path& path, const std::string& content) {
  std::ofstream out(path, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) fmt::print(stderr, "{}: cannot be written\n", path.string());
  return static_cast<bool>(out);
}

bool write_traffic(const std::filesystem::path& folder, const Traffic& traffic) {
  const std::string name = fmt::format("{}-{}", traffic.variant, traffic.seed);
  return write_file(folder / (name + ".pcapng"), to_pcapng(traffic)) &&
         write_file(folder / (name + ".json"), to_truth_json(traffic)) &&
         write_file(folder / (name + ".app.jsonl"), to_app_jsonl(traffic));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Captures of legal RUBICON networks, to test checkers for false alarms."};
  app.name("rubric_legal");
  std::string variant = "all";
  std::string folder;
  std::uint64_t seed = 1;
  std::uint64_t count = 1;
  bool only_list = false;
  app.add_option("--variant", variant, "A variant's name, all (each once), or mixed")
      ->capture_default_str();
  app.add_option("--seed", seed, "The first seed")->capture_default_str();
  app.add_option("--count", count, "Networks of each variant, with seeds that count up")
      ->capture_default_str();
  app.add_option("--out", folder, "Folder for NAME-SEED.pcapng, .json and .app.jsonl");
  app.add_flag("--list", only_list, "Print the variants with the decisions they are readings of");
  app.footer("Exit codes: 0 written, 2 usage, 3 cannot be written.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (only_list) {
    list();
    return 0;
  }
  std::vector<std::string> names;
  if (variant == "all") {
    for (const Variant& one : variants()) names.emplace_back(one.name);
  } else if (variant == "mixed" || find_variant(variant) != nullptr) {
    names.push_back(variant);
  } else {
    fmt::print(stderr, "no variant is named {}; --list shows them\n", variant);
    return 2;
  }
  if (folder.empty()) {
    fmt::print(stderr, "--out is required\n");
    return 2;
  }
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  for (const std::string& name : names) {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!write_traffic(folder, generate(name, seed + i))) return kCannotWrite;
    }
  }
  return 0;
}
