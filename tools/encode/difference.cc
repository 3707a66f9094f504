#include "tools/encode/difference.h"

#include <cmath>

namespace rubric::encode {

using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

namespace {

std::string hex(Bytes bytes) {
  std::string text = "\"";
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text + '"';
}

std::string number_text(const Field& field, std::int64_t value) {
  if (field.kind != Kind::kFloat) return std::to_string(value);
  return std::to_string(float_of_bits(static_cast<std::uint32_t>(value)));
}

bool same_number(const Field& field, std::int64_t a, std::int64_t b) {
  if (a == b || field.kind != Kind::kFloat) return a == b;
  const float x = float_of_bits(static_cast<std::uint32_t>(a));
  const float y = float_of_bits(static_cast<std::uint32_t>(b));
  return x == y || (std::isnan(x) && std::isnan(y));
}

std::string describe(const Decoded& decoded, const Node& node) {
  switch (node.kind) {
    case NodeKind::kNumber: return number_text(*node.field, node.value);
    case NodeKind::kBytes: return hex(decoded.bytes.sub(node.offset, node.size));
    case NodeKind::kStruct: return std::string("a ") + node.type->name;
    default: return std::to_string(node.count) + " elements";
  }
}

/// Walks two lists of nodes in step.
class Walk {
 public:
  Walk(const Decoded& a, const Decoded& b) : a_(a), b_(b) {}

  std::optional<Difference> node(std::size_t i, std::size_t k, const std::string& path) {
    const Node& a = a_[i];
    const Node& b = b_[k];
    const bool same_shape = a.kind == b.kind && a.type == b.type && a.count == b.count;
    if (!same_shape) return differ(path, describe(a_, a), describe(b_, b));
    switch (a.kind) {
      case NodeKind::kNumber:
        if (same_number(*a.field, a.value, b.value)) return std::nullopt;
        return differ(path, describe(a_, a), describe(b_, b));
      case NodeKind::kNumberArray: return numbers(a, b, path);
      case NodeKind::kBytes:
        if (equal(a_.bytes.sub(a.offset, a.size), b_.bytes.sub(b.offset, b.size))) {
          return std::nullopt;
        }
        return differ(path, describe(a_, a), describe(b_, b));
      default: return children(i, k, path);
    }
  }

  std::optional<Difference> stale() {
    const auto text = [](const Decoded& decoded) {
      std::string all = "\"";
      for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
        const reflect::Range range = decoded.stale()[i];
        const std::string part = hex(decoded.bytes.sub(range.offset, range.size));
        all.append(part, 1, part.size() - 2);
      }
      return all + '"';
    };
    if (text(a_) == text(b_)) return std::nullopt;
    return differ("stale", text(a_), text(b_));
  }

 private:
  static Difference differ(const std::string& path, std::string a, std::string b) {
    return {path, std::move(a), std::move(b)};
  }

  std::optional<Difference> numbers(const Node& a, const Node& b, const std::string& path) {
    const Field& field = *a.field;
    for (std::uint32_t i = 0; i < a.count; ++i) {
      const std::size_t at = i * field.width_bytes;
      const std::int64_t x = reflect::load_number(field, a_.bytes.data() + a.offset + at);
      const std::int64_t y = reflect::load_number(field, b_.bytes.data() + b.offset + at);
      if (same_number(field, x, y)) continue;
      return differ(path + '[' + std::to_string(i) + ']', number_text(field, x),
                    number_text(field, y));
    }
    return std::nullopt;
  }

  std::optional<Difference> children(std::size_t i, std::size_t k, const std::string& path) {
    std::size_t x = i + 1;
    std::size_t y = k + 1;
    const bool is_array = a_[i].kind == NodeKind::kStructArray;
    for (std::size_t n = 0; x < a_[i].end && y < b_[k].end; ++n) {
      const Field* field = a_[x].field;
      const std::string inner = is_array ? path + '[' + std::to_string(n) + ']'
                                         : path + (path.empty() ? "" : ".") + field->name;
      if (field != b_[y].field) return differ(inner, "this field", b_[y].field->name);
      if (auto found = node(x, y, inner)) return found;
      x = a_[x].end;
      y = b_[y].end;
    }
    if (x < a_[i].end) return differ(path + '.' + a_[x].field->name, describe(a_, a_[x]), "none");
    if (y < b_[k].end) return differ(path + '.' + b_[y].field->name, "none", describe(b_, b_[y]));
    return std::nullopt;
  }

  const Decoded& a_;
  const Decoded& b_;
};

}  // namespace

std::optional<Difference> first_difference(const Decoded& a, const Decoded& b) {
  Walk walk(a, b);
  if (a.node_count() && b.node_count()) {
    if (auto found = walk.node(0, 0, {})) return found;
  }
  return walk.stale();
}

}  // namespace rubric::encode
