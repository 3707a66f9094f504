// rubric new-adapter and new-protocol: write skeletons that work, to be filled.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rubric::tools {

/// Writes files, by name, into a folder, and prints their names. Ends the subcommand with 74 if one
/// of them exists or cannot be written.
void write_new_files(const std::string& command, const std::string& folder,
                     std::vector<std::pair<std::string, std::string>> files);

}  // namespace rubric::tools
