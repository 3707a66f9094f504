// What new-adapter and new-protocol share: files that must not be there yet.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubric::tools {

/// Returns the texts of all skeletons by their paths in the project, generated when the program is
/// built.
const std::map<std::string, std::string_view>& skeleton_files();

/// Writes files, by their names in a folder, and prints these. Ends the subcommand with 74 if one
/// of them exists or cannot be written; then none is there.
void write_new_files(const std::string& command, const std::filesystem::path& folder,
                     const std::vector<std::pair<std::filesystem::path, std::string>>& files);

}  // namespace rubric::tools
