// Property: any text read as a catalogue of rules, as a profile and as a golden trace gives
// mistakes at places within it, or is emitted whole and the same each time.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/support/embedded_files.h"
#include "fuzz/support/places.h"
#include "fuzz/support/require.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/load/load.h"

namespace {

using rubric::fuzz::require;
using rubricc::Diagnostics;
using rubricc::Model;

std::string text_of(const rubricc::GeneratedFiles& files) {
  std::string out;
  for (const auto& file : files) out += file.path + '\n' + file.text;
  return out;
}

void as_catalogue(const std::string& text) {
  Model model;
  Diagnostics diagnostics;
  rubricc::load_requirements_text("input.yaml", text, model, diagnostics);
  rubric::fuzz::places_are_within(diagnostics, "input.yaml", text);
  if (!diagnostics.empty()) return;
  const std::string out = text_of(rubricc::emit_requirements(model, "input.yaml"));
  require(out == text_of(rubricc::emit_requirements(model, "input.yaml")), "rules are emitted");
  for (const rubricc::Requirement& one : model.requirements) {
    require(out.find('"' + one.id + '"') != std::string::npos, "each rule is emitted");
  }
}

void with_rules(const std::string& text, const char* name,
                void (*load)(const std::string&, const std::string&, Model&, Diagnostics&)) {
  Model model;
  Diagnostics diagnostics;
  model.requirements = rubric::fuzz::rules();
  load(name, text, model, diagnostics);
  rubric::fuzz::places_are_within(diagnostics, name, text);
  if (!diagnostics.empty()) return;
  const std::string profiles = text_of(rubricc::emit_profiles(model));
  require(profiles.empty() == model.profiles.empty(), "a profile is emitted");
  require(!text_of(rubricc::emit_cases(model, "cases")).empty(), "uses of rules are emitted");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  as_catalogue(text);
  with_rules(text, "input.yaml", &rubricc::load_profile_text);
  with_rules(text, "input.rtr", &rubricc::load_case_text);
  return 0;
}
