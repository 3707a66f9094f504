// Gives the messages of a file the frames of TinyOS.
#include <algorithm>
#include <iterator>
#include <utility>

#include "spec/compiler/load/load.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

// The shipped spec with the frames, and the one that they import.
constexpr const char* kFrames = "none";
constexpr const char* kHeaders = "tinyos";
constexpr const char* kPrefix = "tinyos_";

Spec* find_spec(Model& model, std::string_view id) {
  const auto at = std::find_if(model.specs.begin(), model.specs.end(),
                               [&](const auto& spec) { return spec->id == id; });
  return at == model.specs.end() ? nullptr : at->get();
}

// Returns a case for each AM type of the messages.
std::vector<SwitchCase> cases_of(const Spec& spec) {
  std::vector<SwitchCase> cases;
  for (const auto& type : spec.types) {
    for (const std::int64_t am_type : type->am_types) {
      SwitchCase one;
      one.place = place_of(type->places, "-am-type", type->place);
      one.key_expr = std::make_unique<Expr>();
      one.key_expr->place = one.place;
      one.key_expr->value = am_type;
      one.type_name = type->id;
      cases.push_back(std::move(one));
    }
  }
  return cases;
}

}  // namespace

void add_am_frames(const Library& library, Model& model, Diagnostics& diagnostics) {
  diagnostics.pardon_code();  // What is read at run time.
  if (model.specs.empty() || !diagnostics.empty()) return;
  Spec& spec = *model.specs.back();
  const auto has_carrier = [](const auto& type) { return !type->carrier.empty(); };
  const bool complete = std::any_of(spec.types.begin(), spec.types.end(), has_carrier);
  if (complete || cases_of(spec).empty()) return;

  if (find_spec(model, kHeaders) == nullptr) {
    load_shipped_spec(kHeaders, library, model, diagnostics);
    std::rotate(model.specs.begin(), std::prev(model.specs.end()), model.specs.end());
    model.specs.front()->named = false;
  }
  const Spec* const headers = find_spec(model, kHeaders);
  if (std::find(spec.imports.begin(), spec.imports.end(), headers) == spec.imports.end()) {
    spec.imports.push_back(headers);
    spec.import_names.emplace_back(kHeaders);
    spec.import_places.push_back({spec.file, 1, 1});
  }

  int budget = kNodeBudget;
  const std::string text(library.at(kFrames));
  const auto frames = read_spec(kFrames, text, diagnostics, budget);
  for (auto& type : frames->types) {
    if (type->carrier.empty()) continue;
    type->id = kPrefix + type->id;
    type->name = type->id;
    type->spec = &spec;
    for (auto& field : type->fields) {
      if (!field->choice) continue;
      field->choice->cases = cases_of(spec);
      field->choice->otherwise.reset();
    }
    spec.types.push_back(std::move(type));
  }
}

}  // namespace rubricc
