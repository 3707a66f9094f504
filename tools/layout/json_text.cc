#include "tools/layout/json_text.h"

#include "tools/format/put.h"

namespace rubric::layout {

std::string json_string(std::string_view text) {
  std::string out(6 * text.size() + 2, '\0');
  out.resize(static_cast<std::size_t>(format::put_json_string(out.data(), text) - out.data()));
  return out;
}

}  // namespace rubric::layout
