#include "codec/text/json.h"

namespace rubric::text {

Json Json::raw(std::string text) {
  Json out(0);
  out.text_ = text.empty() ? "null" : std::move(text);
  return out;
}

Json Json::object(const Members& members, std::string_view between) {
  std::string out = "{";
  for (const auto& [key, value] : members) {
    if (out.size() > 1) out.append(",").append(between);
    out.append("\"").append(key).append("\":").append(value.text_);
  }
  return raw(out + "}");
}

}  // namespace rubric::text
