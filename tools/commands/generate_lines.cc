#include "tools/commands/generate_lines.h"

#include <fmt/format.h>

#include <iterator>

#include "codec/reflect/fault_text.h"
#include "codec/text/json.h"
#include "tools/format/put.h"
#include "tools/format/record.h"

namespace rubric::tools {
namespace {

using generate::Framed;
using report::Json;

Json error_json(const Error& error, const Json::Members& more = {}) {
  if (error.fault == Fault::kNone) return Json::raw("");
  Json::Members out = {{"fault", reflect::fault_name(error.fault)},
                       {"offset", error.offset_bytes},
                       {"requirement", reflect::requirement(error.requirement).id}};
  out.insert(out.end(), more.begin(), more.end());
  return Json::object(out);
}

Json number_json(const generate::NumberAt& number) {
  const std::string field = fmt::format("{}.{}", number.message->name, number.field->name);
  return Json::object({{"field", field}, {"offset", number.offset_bytes}, {"value", number.value}});
}

}  // namespace

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += between;
    text += word;
  }
  return text;
}

std::string expectation(std::uint64_t number, const std::string& offset, const Framed& framed,
                        bool with_fields) {
  const Json null = Json::raw("");
  const bool valid = framed.valid();
  std::string raw(2 * framed.bytes.size(), '0');
  format::put_hex(raw.data(), framed.view().bytes);
  Json::Members out = {
      {"schema", "rubric.generate/1"},
      {"number", number},
      {"offset", Json::raw(offset)},
      {"carrier", framed.route->carrier},
      {"framing", format::framing_name(framed.packet.framing)},
      {"message", framed.route->type->name},
      {"verdict", valid ? "valid" : "malformed"},
      {"path", valid ? Json::array(framed.path, &reflect::Type::name) : null},
      {"error", error_json(framed.error)},
      {"unfit", framed.unfit_message
                    ? error_json(framed.unfit, {{"message", framed.unfit_message->name}})
                    : null},
      {"what", framed.what}};
  if (with_fields) {
    out.emplace_back("fields", valid ? Json::array(framed.numbers, number_json) : null);
  }
  out.emplace_back("raw", raw);
  return Json::object(out).text();
}

std::string comment(const Framed& framed) {
  if (framed.valid()) return "valid: " + framed.what;
  return fmt::format("malformed: {} at {} ({}): {}", reflect::fault_name(framed.error.fault),
                     framed.error.offset_bytes, reflect::requirement(framed.error.requirement).id,
                     framed.what);
}

}  // namespace rubric::tools
