// rubricc: the compiler of wire specs. See spec/README.md.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "spec/compiler/emit/emit.h"
#include "spec/compiler/load/load.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"

namespace {

const std::vector<std::string> kEmitters{"cpp",        "tables",   "requirements", "protocols",
                                         "dictionary", "messages", "profiles",     "cases",
                                         "java",       "lua",      "json"};

struct CompilerOptions {
  std::string requirements = "spec/requirements.yaml";
  std::string profiles = "spec/profiles";
  std::string cases = "conformance/cases";
  std::vector<std::string> emit;
  bool check = false;
  std::string out;
  std::vector<std::string> files;
};

bool wants(const CompilerOptions& options, std::string_view emitter) {
  return std::find(options.emit.begin(), options.emit.end(), emitter) != options.emit.end();
}

/// Returns the path, or what was installed beside this program where there is nothing at the path.
std::string found(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  const fs::path shipped = program.parent_path().parent_path() / "share/rubric" / path;
  return !fs::exists(path, none) && fs::exists(shipped, none) ? shipped.string() : path;
}

/// Returns the specs that were installed, by name, for imports.
std::map<std::string, std::string> installed_specs() {
  std::map<std::string, std::string> out;
  std::error_code none;
  const std::filesystem::path folder = found("spec/wire");
  if (folder.is_relative()) return out;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() != ".ksy") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    out[entry.path().stem()] = std::string(std::istreambuf_iterator<char>(in), {});
  }
  return out;
}

void append(rubricc::GeneratedFiles& all, rubricc::GeneratedFiles more) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

rubricc::GeneratedFiles emit(const CompilerOptions& options, const rubricc::Model& model) {
  rubricc::GeneratedFiles out;
  for (const auto& spec : model.specs) {
    if (!spec->named) continue;
    if (wants(options, "tables")) append(out, rubricc::emit_tables(*spec));
    if (wants(options, "dictionary")) append(out, rubricc::emit_dictionary(*spec));
    if (wants(options, "messages")) append(out, rubricc::emit_messages(*spec));
    if (wants(options, "cpp")) append(out, rubricc::emit_cpp(*spec));
    if (wants(options, "java")) append(out, rubricc::emit_java(*spec));
  }
  if (wants(options, "requirements")) {
    append(out, rubricc::emit_requirements(model, options.requirements));
  }
  if (wants(options, "protocols")) append(out, rubricc::emit_protocols(model));
  if (wants(options, "profiles")) append(out, rubricc::emit_profiles(model));
  if (wants(options, "cases")) append(out, rubricc::emit_cases(model, options.cases));
  if (wants(options, "lua")) {
    const rubricc::GeneratedFiles dissector = rubricc::emit_lua(model);
    if (dissector.empty()) {
      std::cerr << "rubricc: no dissector, as no spec has a -carrier; "
                   "'rubric install-wireshark --spec FILE.ksy' needs none\n";
    }
    append(out, dissector);
  }
  if (wants(options, "json")) append(out, rubricc::emit_json(model));
  return out;
}

bool write(const std::filesystem::path& folder, const rubricc::GeneratedFile& file) {
  const std::filesystem::path path = folder / file.path;
  // An unchanged file keeps its time, so that nothing is compiled again for it.
  std::ifstream old(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(old), {}};
  if (old.is_open() && text == file.text) return true;
  std::error_code fault;
  std::filesystem::create_directories(path.parent_path(), fault);
  std::ofstream out(path, std::ios::binary);
  out << file.text;
  out.close();
  if (!out.fail()) return true;
  std::cerr << "rubricc: cannot write " << path.string() << '\n';
  return false;
}

int run(const CompilerOptions& options) {
  std::vector<std::string> inputs = options.files;
  inputs.push_back(options.requirements);
  for (const std::string& input : inputs) {
    if (std::filesystem::exists(input) && !std::filesystem::is_directory(input)) continue;
    std::cerr << "rubricc: cannot read " << input
              << (&input == &inputs.back() ? "; --requirements names another catalogue\n" : "\n");
    return rubric::cli::kExitInput;
  }
  const bool has_profiles = std::filesystem::is_directory(options.profiles);
  if (!has_profiles && wants(options, "profiles")) {
    std::cerr << "rubricc: cannot read " << options.profiles << '\n';
    return rubric::cli::kExitInput;
  }
  rubricc::Model model;
  rubricc::Diagnostics diagnostics;
  rubricc::load_requirements(options.requirements, model, diagnostics);
  if (has_profiles) rubricc::load_profiles(options.profiles, model, diagnostics);
  if (options.check || wants(options, "cases") || wants(options, "json")) {
    rubricc::load_cases(rubricc::case_files(options.cases), model, diagnostics);
  }
  const std::map<std::string, std::string> installed = installed_specs();
  rubricc::load_specs(options.files, model, diagnostics, {installed.begin(), installed.end()});
  rubricc::check_model(model, diagnostics);
  std::cerr << diagnostics.print();
  if (!diagnostics.empty()) return rubric::cli::kExitFindings;
  try {
    for (const auto& file : emit(options, model)) {
      if (!write(options.out, file)) return rubric::cli::kExitOutput;
    }
  } catch (const std::logic_error& e) {  // A check let pass what an emitter cannot print.
    std::cerr << "rubricc: a bug of the compiler: " << e.what() << '\n';
    return rubric::cli::kExitBroken;
  }
  return rubric::cli::kExitClean;
}

}  // namespace

int main(int argc, char** argv) {
  CompilerOptions options;
  rubric::cli::Command program(
      "rubricc",
      "Check wire specs (a strict profile of Kaitai Struct) and generate code from them.");
  const auto requirements = program.add_option("--requirements", options.requirements,
                                               "Read the catalogue of requirements from this file");
  const auto profiles = program.add_option("--profiles", options.profiles,
                                           "Read the profiles (.yaml) from this folder");
  const auto cases = program.add_option("--cases", options.cases,
                                        "Read the golden traces (.rtr) from this folder");
  auto check = program.add_flag("--check", options.check, "Check, and write nothing");
  auto emit = program.add_option("--emit", options.emit, "Generate these, separated by commas")
                  .delimiter(',')
                  .one_of(kEmitters);
  const auto out = program.add_option("--out", options.out, "Write into this folder");
  program.add_option("FILE", options.files, "Wire specs (.ksy)").required();
  program.footer(
      "Default files are those below the working folder, else those installed with this program.\n"
      "Exit codes: 0 fine, 1 mistakes in the input, 64 usage, 66 a file cannot be read, 74 a file\n"
      "cannot be written.");
  check.excludes(emit).excludes(out);
  emit.needs(out);
  program.exit_code_of([&] {
    if (!requirements.is_given()) options.requirements = found(options.requirements);
    if (!profiles.is_given()) options.profiles = found(options.profiles);
    if (!cases.is_given()) options.cases = found(options.cases);
    // Those that ship name the rules of the catalogue that ships, not of another one.
    if (requirements.is_given() && !wants(options, "json")) {
      if (!profiles.is_given() && !wants(options, "profiles")) options.profiles.clear();
      if (!cases.is_given() && !wants(options, "cases")) options.cases.clear();
    }
    if (options.check || !options.emit.empty()) return run(options);
    throw rubric::cli::UsageError("--check or --emit is required");
  });
  return program.parse_and_run(argc, argv);
}
