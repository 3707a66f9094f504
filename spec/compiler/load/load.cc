// Loads specs and their imports.
#include "spec/compiler/load/load.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr std::size_t kSpecsMax = 100;
constexpr int kFoldersAround = 8;
const Library kNoLibrary;

std::string beside(const std::string& file, const std::string& name) {
  const std::size_t slash = file.rfind('/');
  return (slash == file.npos ? "" : file.substr(0, slash + 1)) + name + ".ksy";
}

std::string shipped_file(const std::string& name) { return "<shipped>/" + name + ".ksy"; }

bool is_plain(const std::string& name) {
  return !name.empty() && name.size() < 100 && name.find("..") == name.npos;
}

/// Returns the file that an import means: one beside the importing file, or for "/name" below it or
/// one of the folders around it.
std::string file_of(const std::string& importing, const std::string& name) {
  if (!name.starts_with('/')) return beside(importing, name);
  std::filesystem::path folder = std::filesystem::path(importing).parent_path();
  std::string file = beside(importing, name.substr(1));
  for (int i = 0; i < kFoldersAround && !std::filesystem::exists(file); ++i) {
    folder = folder.empty() ? ".." : folder / "..";
    file = (folder / (name.substr(1) + ".ksy")).lexically_normal().string();
  }
  return file;
}

class Loader {
 public:
  Loader(Model& model, Diagnostics& diagnostics, const Library& library)
      : model_(model), diagnostics_(diagnostics), library_(library) {}

  void named(const std::string& file) {
    const auto text = text_of_file(file, diagnostics_);
    Spec* const spec = text ? load(file, *text) : nullptr;
    if (spec) spec->named = true;
  }

  Spec* load(const std::string& file, const std::string& text) {
    for (const auto& spec : model_.specs) {
      if (spec->file == file) return spec.get();
    }
    diagnostics_.add_source(file, text);
    auto spec = read_spec(file, text, diagnostics_, budget_);
    if (spec == nullptr || budget_ < 0) return nullptr;
    open_.push_back(spec.get());
    for (std::size_t i = 0; i < spec->import_names.size(); ++i) {
      import(*spec, spec->import_names[i], spec->import_places[i]);
    }
    open_.pop_back();
    check_name(*spec);
    model_.specs.push_back(std::move(spec));
    return model_.specs.back().get();
  }

 private:
  void import(Spec& spec, const std::string& name, const SourcePlace& place) {
    std::string file = file_of(spec.file, name);
    std::optional<std::string> text;
    if (is_plain(name) && open_.size() < kSpecsMax && std::filesystem::exists(file)) {
      text = text_of_file(file, diagnostics_);
      if (!text) return;
    }
    if (const auto shipped = library_.find(name); !text && shipped != library_.end()) {
      file = shipped_file(name);
      text = shipped->second;
    }
    const bool again = std::any_of(spec.imports.begin(), spec.imports.end(),
                                   [&](const Spec* one) { return one->file == file; });
    if (again) {
      diagnostics_.error(place, fmt::format("{} is imported twice", quote(name)));
      return;
    }
    const auto around = std::find_if(open_.begin(), open_.end(),
                                     [&](const Spec* one) { return one->file == file; });
    if (around != open_.end()) {
      diagnostics_.error_in_code(place, fmt::format("{} imports itself in a circle", quote(name)),
                                 "imports must end");
      spec.imports.push_back(*around);
      return;
    }
    if (!text) {
      diagnostics_.error(place, fmt::format("import {} not found", quote(name)),
                         fmt::format("{} was expected", quote(file)));
      return;
    }
    if (const Spec* found = load(file, *text)) spec.imports.push_back(found);
  }

  void check_name(const Spec& spec) {
    for (const auto& other : model_.specs) {
      if (other->id != spec.id || spec.id.empty()) continue;
      diagnostics_.error(place_of(spec.places, "id", {spec.file, 1, 1}),
                         fmt::format("a second spec {}", quote(spec.id)),
                         fmt::format("{} has that id", quote(other->file)));
    }
  }

  Model& model_;
  Diagnostics& diagnostics_;
  const Library& library_;
  int budget_ = kNodeBudget;
  std::vector<const Spec*> open_;  // Those whose imports are being read.
};

}  // namespace

void load_specs(const std::vector<std::string>& files, Model& model, Diagnostics& diagnostics,
                const Library& library) {
  Loader loader(model, diagnostics, library);
  for (const std::string& file : files) loader.named(file);
}

void load_shipped_spec(const std::string& name, const Library& library, Model& model,
                       Diagnostics& diagnostics) {
  const std::string text(library.at(name));
  Spec* spec = Loader(model, diagnostics, library).load(shipped_file(name), text);
  if (spec) spec->named = true;
}

void load_spec_text(const std::string& file, const std::string& text, Model& model,
                    Diagnostics& diagnostics) {
  if (Spec* spec = Loader(model, diagnostics, kNoLibrary).load(file, text)) spec->named = true;
}

}  // namespace rubricc
