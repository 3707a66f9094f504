#include "tools/cli/text_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "codec/text/packed.h"

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
  if (broken) return false;
  const Bytes all(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const text::Packing packing = text::packing_of(all);
  if (packing == text::Packing::kNone) return true;
  try {
    text = text::unpacked(packing, text);
  } catch (const text::PackedDamage& damage) {
    error = path + ": " + damage.what();
    return false;
  }
  return true;
}

bool is_packed(const std::string& path) {
  std::uint8_t first[4] = {};
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (!file) return false;
  const std::size_t size = std::fread(first, 1, sizeof first, file);
  std::fclose(file);
  return text::packing_of(Bytes(first, size)) != text::Packing::kNone;
}

}  // namespace rubric::cli
