// Property: no spec, however broken, crashes or hangs the compiler; one that it accepts is emitted.
#include <cstddef>
#include <cstdint>
#include <string>

#include "spec/compiler/emit.h"
#include "spec/compiler/emit_cpp.h"
#include "spec/compiler/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rubricc::Model model;
  rubricc::Diagnostics diagnostics;
  const std::string text(reinterpret_cast<const char*>(data), size);
  rubricc::load_spec_text("input.ksy", text, model, diagnostics);
  rubricc::check_model(model, diagnostics);
  if (!diagnostics.empty()) return 0;
  for (const auto& spec : model.specs) {
    rubricc::emit_tables(*spec);
    rubricc::emit_dictionary(*spec);
    rubricc::emit_messages(*spec);
    rubricc::emit_cpp(*spec);
  }
  rubricc::emit_doc(model);
  return 0;
}
