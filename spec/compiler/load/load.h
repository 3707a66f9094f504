// Loads files into a checked model.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "spec/compiler/diagnostics.h"

namespace rubricc {

/// Texts of specs that imports find where no file of the name is beside the importing one.
using Library = std::map<std::string, std::string_view, std::less<>>;

/// Reads `files` and their imports (beside them, "name.ksy") into `model`, imports first.
void load_specs(const std::vector<std::string>& files, Model& model, Diagnostics& diagnostics,
                const Library& library = {});
/// Reads a spec of the library, as "<shipped>/name.ksy".
void load_shipped_spec(const std::string& name, const Library& library, Model& model,
                       Diagnostics& diagnostics);
/// Where the last spec has messages with `-am-type` and no `-carrier`, adds the frames of the
/// library's spec none: TinyOS's, on serial lines and on the radio.
void add_am_frames(const Library& library, Model& model, Diagnostics& diagnostics);
/// Whose requirements a catalogue has: those of other protocols have fewer keys.
enum class Catalogue : std::uint8_t { kRubicon, kOther };
/// Reads a catalogue of requirements.
void load_requirements(const std::string& file, Model& model, Diagnostics& diagnostics,
                       Catalogue of = Catalogue::kRubicon);
/// Reads a profile, or all of a folder; the requirements come first.
void load_profile(const std::string& file, Model& model, Diagnostics& diagnostics);
void load_profiles(const std::string& folder, Model& model, Diagnostics& diagnostics);
/// Finds the rules that golden traces name; the requirements come first.
void load_cases(const std::vector<std::string>& files, Model& model, Diagnostics& diagnostics);
/// Returns the traces (.rtr) in `folder` and below, by name; none if there is no such folder.
std::vector<std::string> case_files(const std::string& folder);

// Reads from text in memory, for the fuzzer and the tests; `file` is shown in diagnostics.
void load_spec_text(const std::string& file, const std::string& text, Model& model,
                    Diagnostics& diagnostics);
void load_requirements_text(const std::string& file, const std::string& text, Model& model,
                            Diagnostics& diagnostics, Catalogue of = Catalogue::kRubicon);
void load_profile_text(const std::string& file, const std::string& text, Model& model,
                       Diagnostics& diagnostics);
void load_case_text(const std::string& file, const std::string& text, Model& model,
                    Diagnostics& diagnostics);

/// Resolves names, expressions, sizes and offsets, and reports everything that breaks a rule of
/// the profile. Emitters may run only when nothing was reported. kRunTime is for tables in memory
/// and dissectors: a type needs no requirement, one that is not in the catalogue counts as none,
/// and names and sizes need not suit C++.
enum class CheckFor { kCode, kRunTime };
void check_model(Model& model, Diagnostics& diagnostics, CheckFor what = CheckFor::kCode);

}  // namespace rubricc
