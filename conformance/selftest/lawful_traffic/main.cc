// rubric_lawful: writes captures of lawful networks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/recorder.h"
#include "tools/cli/command.h"

namespace {

using namespace rubric::lawful;

constexpr int kCannotWrite = 3;

void list() {
  for (const Variant& variant : variants()) {
    fmt::print(
        "{:<27} {:<11} {}{}\n", variant.name,
        variant.decisions.empty() ? "-" : fmt::format("{}", fmt::join(variant.decisions, ",")),
        variant.summary, variant.worst == Worst::kWeak ? " (weak)" : "");
  }
  for (const WithoutVariant& none : without_variant()) {
    fmt::print("decision {} has none: {}\n", none.decision, none.reason);
  }
  for (const Recorder& recorder : recorders()) {
    fmt::print("recorder {:<18} {}\n", recorder.name, recorder.summary);
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

struct LawfulOptions {
  std::string variant = "all";
  std::string recorder = "exact";
  std::string folder;
  std::uint64_t seed = 1;
  std::uint64_t count = 1;
  bool list = false;
};

std::vector<std::string> chosen(const std::string& variant) {
  if (variant == "mixed" || find_variant(variant) != nullptr) return {variant};
  if (variant != "all") {
    throw rubric::cli::UsageError("no variant is named " + variant + "; --list shows them");
  }
  std::vector<std::string> names;
  for (const Variant& each : variants()) names.emplace_back(each.name);
  return names;
}

int run(const LawfulOptions& options) {
  if (options.list) {
    list();
    return 0;
  }
  const std::vector<std::string> names = chosen(options.variant);
  const auto named = [&](const Recorder& one) { return one.name == options.recorder; };
  if (std::none_of(recorders().begin(), recorders().end(), named)) {
    throw rubric::cli::UsageError("no recorder is named " + options.recorder +
                                  "; --list shows them");
  }
  if (options.folder.empty()) throw rubric::cli::UsageError("--out is required");
  std::error_code ignored;
  std::filesystem::create_directories(options.folder, ignored);
  for (const std::string& name : names) {
    for (std::uint64_t i = 0; i < options.count; ++i) {
      Traffic traffic = generate(name, options.seed + i);
      record(traffic, options.recorder, options.seed + i);
      if (!write_traffic(options.folder, traffic)) return kCannotWrite;
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  rubric::cli::Command program(
      "rubric_lawful",
      "Write captures of lawful RUBICON networks, to test checkers for false alarms.");
  LawfulOptions options;
  program.add_option("--variant", options.variant, "Write this variant, all (each once) or mixed");
  program.add_option("--recorder", options.recorder, "Record the traffic in this way");
  program.add_option("--seed", options.seed, "Begin with this seed");
  program.add_option("--count", options.count,
                     "Write this many networks of each variant, with seeds that count up");
  program.add_option("--out", options.folder,
                     "Write NAME-SEED.pcapng, .json and .app.jsonl into this folder");
  program.add_flag(
      "--list", options.list,
      "Print the variants, each with the decisions that it reads in its own way, and the "
      "recorders");
  program.footer("Exit codes: 0 written, 2 usage, 3 cannot be written.");
  program.exit_code_of([&] { return run(options); });
  return program.parse_and_run(argc, argv);
}
