#include "conformance/test/runner/case_files.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace rubric::runner {

std::vector<trace::Parsed> load_cases(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": no such folder; golden traces are in " +
                             "conformance/cases of the project");
  }
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".rtr") paths.push_back(entry.path());
  }
  if (paths.empty()) throw std::runtime_error(folder.string() + ": no .rtr file");
  std::sort(paths.begin(), paths.end());
  std::vector<trace::Parsed> files;
  std::string errors;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    files.push_back(trace::parse(text, path.generic_string()));
    errors += files.back().errors();
  }
  if (!errors.empty()) throw std::runtime_error(errors);
  return files;
}

}  // namespace rubric::runner
