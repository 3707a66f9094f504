#include "tools/commands/generate_lines.h"

#include <fmt/format.h>

#include <iterator>

#include "codec/reflect/fault_text.h"
#include "conformance/report/text.h"
#include "tools/format/put.h"
#include "tools/format/record.h"

namespace rubric::tools {
namespace {

using generate::Framed;
using report::json_string;

std::string error_json(const Error& error, std::string_view more = {}) {
  if (error.fault == Fault::kNone) return "null";
  return fmt::format("{{\"fault\":\"{}\",\"offset\":{},\"requirement\":\"{}\"{}}}",
                     reflect::fault_name(error.fault), error.offset_bytes,
                     reflect::requirement(error.requirement).id, more);
}

std::string fields_json(const Framed& framed) {
  if (!framed.valid()) return "null";
  std::string text;
  for (const generate::NumberAt& number : framed.numbers) {
    fmt::format_to(std::back_inserter(text), "{}{{\"field\":\"{}.{}\",\"offset\":{},\"value\":{}}}",
                   text.empty() ? "[" : ",", number.message->name, number.field->name,
                   number.offset_bytes, number.value);
  }
  return text + "]";
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
  std::vector<std::string> path;
  for (const reflect::Type* type : framed.path) path.push_back(json_string(type->name));
  std::string raw(2 * framed.bytes.size(), '0');
  format::put_hex(raw.data(), framed.view().bytes);
  const std::string unfit =
      framed.unfit_message
          ? error_json(framed.unfit, fmt::format(",\"message\":\"{}\"", framed.unfit_message->name))
          : "null";
  return fmt::format(
      "{{\"schema\":\"rubric.generate/1\",\"number\":{},\"offset\":{},\"carrier\":\"{}\","
      "\"framing\":\"{}\",\"message\":\"{}\",\"verdict\":\"{}\",\"path\":{},\"error\":{},"
      "\"unfit\":{},\"what\":{},{}\"raw\":\"{}\"}}",
      number, offset, framed.route->carrier, format::framing_name(framed.packet.framing),
      framed.route->type->name, framed.valid() ? "valid" : "malformed",
      framed.valid() ? fmt::format("[{}]", joined(path, ",")) : "null", error_json(framed.error),
      unfit, json_string(framed.what), with_fields ? "\"fields\":" + fields_json(framed) + "," : "",
      raw);
}

std::string comment(const Framed& framed) {
  if (framed.valid()) return "valid: " + framed.what;
  return fmt::format("malformed: {} at {} ({}): {}", reflect::fault_name(framed.error.fault),
                     framed.error.offset_bytes, reflect::requirement(framed.error.requirement).id,
                     framed.what);
}

}  // namespace rubric::tools
