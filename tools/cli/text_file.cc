#include "tools/cli/text_file.h"

#include <cstring>

#include "codec/text/files.h"
#include "codec/text/packed.h"
#include "tools/cli/terminal.h"

namespace rubric::cli {

bool read_file(const std::string& path, std::string& text, std::string& error) {
  if (path == "-") say_what_is_awaited();
  if (const int code = text::read_file(path, text)) {
    error = path + ": " + std::strerror(code);
    return false;
  }
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

}  // namespace rubric::cli
