#include "conformance/test/runner/case_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "codec/text/files.h"
#include "codec/text/text.h"

namespace rubric::runner {

std::vector<std::filesystem::path> case_paths(const std::filesystem::path& folder) {
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
  return paths;
}

std::vector<trace::Parsed> load_cases(const std::filesystem::path& folder) {
  std::vector<trace::Parsed> files;
  std::string errors;
  for (const auto& path : case_paths(folder)) {
    std::string text;
    if (const int code = text::read_file(path, text)) {
      errors += fmt::format("{}: {}\n", text::harmless(path.generic_string()), std::strerror(code));
      continue;
    }
    files.push_back(trace::parse(text, path.generic_string()));
    errors += files.back().errors();
  }
  if (!errors.empty()) throw std::runtime_error(errors);
  return files;
}

}  // namespace rubric::runner
