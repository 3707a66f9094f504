// Property: no spec, however broken, crashes or hangs the compiler; mistakes are shown at places
// within it; one that is accepted is emitted in every form, the same each time.
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

constexpr const char* kInput = "spec/wire/input.ksy";
constexpr const char* kImport = "spec/wire/tinyos.ksy";

// Loads the input with the catalogue that it may quote, beside the spec that it may import.
void load(const std::string& text, rubricc::Model& model, rubricc::Diagnostics& diagnostics) {
  model.requirements = rubric::fuzz::rules();
  if (text.find("tinyos") != std::string::npos) {
    rubricc::load_spec_text(kImport, rubric::fuzz::embedded_files().at(kImport), model,
                            diagnostics);
  }
  rubricc::load_spec_text(kInput, text, model, diagnostics);
  rubricc::check_model(model, diagnostics);
}

std::string emitted(const rubricc::Model& model) {
  std::string out;
  const auto add = [&out](const rubricc::GeneratedFiles& files) {
    require(!files.empty(), "an emitter has something to say");
    for (const auto& file : files) out += file.path + '\n' + file.text;
  };
  for (const auto& spec : model.specs) {
    if (spec->file != kInput) continue;
    add(rubricc::emit_tables(*spec));
    add(rubricc::emit_messages(*spec));
    if (spec->types.empty()) continue;
    add(rubricc::emit_dictionary(*spec));
    add(rubricc::emit_cpp(*spec));
    add(rubricc::emit_java(*spec));
  }
  add(rubricc::emit_json(model));
  for (const auto& file : rubricc::emit_protocols(model)) out += file.text;
  for (const auto& file : rubricc::emit_lua(model)) out += file.text;
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  rubricc::Model model;
  rubricc::Diagnostics diagnostics;
  load(text, model, diagnostics);
  rubric::fuzz::places_are_within(diagnostics, kInput, text);
  if (!diagnostics.empty()) return 0;
  require(emitted(model) == emitted(model), "what is emitted depends on the spec alone");
  return 0;
}
