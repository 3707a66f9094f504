// The project's wire specs, for tests, which run in the project's folder.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace rubricc {

/// The paths of a folder's files with this extension, sorted.
inline std::vector<std::filesystem::path> files_in(const std::string& folder,
                                                   const std::string& extension) {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == extension) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

inline std::vector<std::string> wire_specs() {
  const auto files = files_in("spec/wire", ".ksy");
  return {files.begin(), files.end()};
}

}  // namespace rubricc
