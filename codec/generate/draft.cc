#include "codec/generate/draft.h"

#include <algorithm>

namespace rubric::generate {

std::uint32_t Draft::limit(std::uint32_t scope) const {
  const Scope& s = scopes[scope];
  const std::uint32_t end = s.end != kNone      ? s.end
                            : s.parent == kNone ? static_cast<std::uint32_t>(bytes.size())
                                                : limit(s.parent);
  return end - s.base > s.type->max_size ? s.base + s.type->max_size : end;
}

std::uint32_t Draft::first_cut(std::uint32_t limit, std::uint32_t from, std::uint32_t to,
                               const std::vector<std::uint32_t>& passed, bool hard) const {
  for (std::uint32_t i = from; i < to; ++i) {
    const Part& part = parts[i];
    if ((hard && !part.hard) || part.at + part.size <= limit) continue;
    if (std::find(passed.begin(), passed.end(), i) != passed.end()) continue;
    // The rest of an open array must still be whole elements.
    if (!part.open || (limit - part.at) % part.element_bytes != 0) return i;
  }
  return kNone;
}

}  // namespace rubric::generate
