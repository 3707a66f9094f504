#include "tools/cli/text_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace rubric::cli {

bool read_file(const std::string& path, std::string& text, std::string& error) {
  text.clear();
  std::FILE* const file = path == "-" ? stdin : std::fopen(path.c_str(), "rb");
  if (!file) {
    error = path + ": " + std::strerror(errno);
    return false;
  }
  char chunk[65536];
  for (std::size_t n = 0; (n = std::fread(chunk, 1, sizeof chunk, file)) > 0;) {
    text.append(chunk, n);
  }
  const bool broken = std::ferror(file) != 0;
  if (broken) error = path + ": " + std::strerror(errno);
  if (file != stdin) std::fclose(file);
  return !broken;
}

}  // namespace rubric::cli
