#include "tools/format/plain_value.h"

#include <cmath>

#include "codec/text/text.h"
#include "tools/format/put.h"

namespace rubric::format {
namespace {

// Appends a real. NaN and infinities have quotes in JSON, and none here.
void append_real(double value, bool binary32, Buffer& out) {
  if (!std::isfinite(value)) {
    return out.append(std::isnan(value) ? "NaN" : value > 0 ? "Infinity" : "-Infinity");
  }
  char* at = out.reserve(kMaxFloatChars);
  out.commit(binary32 ? put_float(at, bits_of_float(static_cast<float>(value)))
                      : put_double(at, value));
}

}  // namespace

void append_bits(const reflect::MaskTable& mask, std::int64_t value, Buffer& out) {
  bool first = true;
  for (unsigned bit = 0; bit < mask.width_bits; ++bit) {
    if (!(value >> bit & 1)) continue;
    if (!first) out.append('|');
    first = false;
    if (mask.bit_names[bit]) {
      out.append(mask.bit_names[bit]);
    } else {
      out.append("bit");
      out.commit(put_uint(out.reserve(kMaxIntChars), bit));
    }
  }
  if (first) out.append('0');
}

std::string quoted(std::string_view text) {
  std::string plain;
  for (const char c : text) {
    constexpr std::string_view kFrom = "\"\\\n\r\t";
    const std::size_t at = kFrom.find(c);
    if (at != kFrom.npos) plain += '\\';
    plain += at == kFrom.npos ? c : "\"\\nrt"[at];
  }
  return '"' + text::harmless(plain) + '"';
}

void append_plain_value(const Value& value, const Record& record, const JsonNodes& nodes,
                        Buffer& out) {
  switch (value.kind) {
    case Value::Kind::kAbsent: break;
    case Value::Kind::kInteger: {
      char* const at = out.reserve(kMaxIntChars);
      out.commit(value.field ? put_integer(at, *value.field, value.integer)
                             : put_int(at, value.integer));
      break;
    }
    case Value::Kind::kReal: append_real(value.real, value.field != nullptr, out); break;
    case Value::Kind::kUnit:
      out.commit(put_converted(out.reserve(kMaxFloatChars), *value.field, value.integer));
      break;
    case Value::Kind::kTime: out.commit(put_time(out.reserve(kMaxTimeChars), value.integer)); break;
    case Value::Kind::kText: out.append(text::harmless(value.text)); break;
    case Value::Kind::kBits: append_bits(*value.field->mask, value.integer, out); break;
    case Value::Kind::kBytes:
      out.commit(put_hex(out.reserve(2 * value.bytes.size()), value.bytes));
      break;
    case Value::Kind::kNode: {
      char* at = out.reserve(nodes.room(record.decoded()));
      out.commit(nodes.value(at, record.decoded(), value.node));
      break;
    }
  }
}

void append_plain_values(const Path& path, const Record& record, const JsonNodes& nodes,
                         Buffer& out) {
  const bool list = path.is_list();
  bool first = true;
  auto each = [&](const Value& value) {
    if (!first) out.append(' ');
    first = false;
    append_plain_value(value, record, nodes, out);
    return list;
  };
  path.visit_first(record, each);
}

}  // namespace rubric::format
