// Loads files into a checked model.
#pragma once

#include <string>
#include <vector>

#include "spec/compiler/diagnostics.h"

namespace rubricc {

/// Reads `files` and their imports (beside them, "name.ksy") into `model`, imports first.
void load_specs(const std::vector<std::string>& files, Model& model, Diagnostics& diagnostics);
/// Reads the catalogue of requirements.
void load_requirements(const std::string& file, Model& model, Diagnostics& diagnostics);
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
                            Diagnostics& diagnostics);
void load_profile_text(const std::string& file, const std::string& text, Model& model,
                       Diagnostics& diagnostics);
void load_case_text(const std::string& file, const std::string& text, Model& model,
                    Diagnostics& diagnostics);

/// Resolves names, expressions, sizes and offsets, and reports everything that breaks a rule of
/// the profile. Emitters may run only when nothing was reported.
void check_model(Model& model, Diagnostics& diagnostics);

}  // namespace rubricc
