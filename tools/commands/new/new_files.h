// What new-adapter and new-protocol share: files that must not be there yet.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rubric::tools {

/// Writes files, by their names in a folder, and prints these. Ends the subcommand with 74 if one
/// of them exists or cannot be written.
void write_new_files(const std::string& command, const std::filesystem::path& folder,
                     const std::vector<std::pair<std::filesystem::path, std::string>>& files);

}  // namespace rubric::tools
