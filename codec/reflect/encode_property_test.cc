// Frames of every message: their values, spelled in any way that encoding takes, make the same
// bytes again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/routes.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/registry.h"

namespace rubric::reflect {
namespace {

using rubric::testing::to_hex;

constexpr int kFrames = 500;  // Of each message, on each way to it.

/// Writes decoded nodes as a tree of values, each in one of its possible ways.
class Speller {
 public:
  Speller(const Decoded& decoded, generate::Random& random) : decoded_(decoded), random_(random) {}

  Value tree(std::size_t i) {
    const Node& node = decoded_[i];
    const Bytes bytes = decoded_.bytes.sub(node.offset, node.size);
    Value value = Value::of_array({});
    switch (node.kind) {
      case NodeKind::kNumber: return plain(*node.field, node.value);
      case NodeKind::kBytes: return Value::of_string(to_hex(bytes));
      case NodeKind::kNumberArray:
        for (std::uint32_t k = 0; k < node.count; ++k) {
          const std::uint8_t* at = bytes.data() + k * node.field->width_bytes;
          value.items.push_back(plain(*node.field, load_number(*node.field, at)));
        }
        return value;
      case NodeKind::kStructArray:
        for (std::size_t k = i + 1; k < node.end; k = decoded_[k].end) {
          value.items.push_back(tree(k));
        }
        return value;
      case NodeKind::kStruct: break;
    }
    value = Value::of_object();
    for (std::size_t k = i + 1; k < node.end; k = decoded_[k].end) {
      const Node& child = decoded_[k];
      if (child.kind != NodeKind::kNumber) {
        value.set(child.field->name, tree(k));
      } else if (!may_lack(node, child) || random_.chance(0.5)) {
        spell(*child.field, child.value, value);
      }
    }
    return value;
  }

  bool has_nan() const { return has_nan_; }

 private:
  Value plain(const Field& f, std::int64_t value) {
    if (f.kind != Kind::kFloat) return Value::of_integer(value);
    const float real = float_of_bits(static_cast<std::uint32_t>(value));
    has_nan_ = has_nan_ || std::isnan(real);
    if (std::isinf(real)) return Value::of_string(real < 0 ? "-Infinity" : "Infinity");
    return Value::of_real(fmt::format("{:.9g}", real));
  }

  // Returns whether encoding finds the number out: the size of what follows, if nothing in it is
  // stale, or the expected value.
  bool may_lack(const Node& structure, const Node& number) const {
    if (number.field->expect >= 0 && number.field->expect == number.value) return true;
    const auto at = static_cast<std::int64_t>(number.offset - structure.offset);
    for (int i = 0; i < structure.type->field_count && decoded_.stale_count() == 0; ++i) {
      const Field& f = structure.type->fields[i];
      for (const Expr* expr : {&f.size, &f.count}) {
        const bool lone = expr->count == 1 && expr->steps[0].op != Op::kConst;
        if (lone && expr->steps[0].value == at) return true;
      }
    }
    return false;
  }

  void spell(const Field& f, std::int64_t value, Value& out) {
    Value other;
    if (f.enumeration && enum_name(*f.enumeration, value)) {
      other = Value::of_string(enum_name(*f.enumeration, value));
    } else if (f.mask) {
      other = Value::of_array({});
      for (int bit = f.mask->width_bits - 1; bit >= 0; --bit) {
        if (!(value >> bit & 1)) continue;
        const char* name = f.mask->bit_names[bit];
        other.items.push_back(Value::of_string(name ? name : "bit" + std::to_string(bit)));
      }
    }
    const std::size_t way = other.is(Value::Kind::kNull) ? 0 : random_.below(4);
    if (way == 0 || way == 3) out.set(f.name, plain(f, value));
    if (way == 1) out.set(f.name, other);
    if (way >= 2) out.set(f.name + std::string(f.mask ? "_bits" : "_name"), other);
  }

  const Decoded& decoded_;
  generate::Random& random_;
  bool has_nan_ = false;
};

void round_trip(const Type& type, Bytes frame, Tail tail, generate::Random& random) {
  Decoded decoded;
  decode(type, frame, tail, true, decoded);
  ASSERT_EQ(decoded.error.fault, Fault::kNone);
  std::vector<std::uint8_t> stale;
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    const Bytes part = frame.sub(decoded.stale()[i].offset, decoded.stale()[i].size);
    stale.insert(stale.end(), part.begin(), part.end());
  }
  Speller speller(decoded, random);
  const Value fields = speller.tree(0);
  if (speller.has_nan()) return;  // Text does not keep which one it was.
  std::vector<std::uint8_t> out;
  try {
    encode(type, fields, Bytes(stale.data(), stale.size()), tail, out);
  } catch (const EncodeError& error) {
    FAIL() << error.what() << " in " << to_hex(frame);
  }
  ASSERT_EQ(to_hex(Bytes(out.data(), out.size())), to_hex(frame));
}

class EncodeProperty : public ::testing::TestWithParam<const Protocol*> {
 protected:
  void frames_of(const Route& route) {
    SCOPED_TRACE(std::string(route.carrier) + "/" + route.type->id);
    const bool bare = generate::is_bare(route);
    const Type& type = bare ? *route.type : *find_carrier(*GetParam(), route.carrier);
    for (int i = 0; i < kFrames && !HasFatalFailure(); ++i) {
      const generate::Generated made = generator_.valid(route);
      round_trip(type, Bytes(made.bytes.data(), made.bytes.size()),
                 bare ? Tail::kStale : Tail::kFault, generator_.random());
    }
  }

  const RouteTable& routes_ = *generate::routes_of(*GetParam());
  generate::FrameGenerator generator_{*GetParam(), routes_, 1};
};

TEST_P(EncodeProperty, FramesOfEveryMessage) {
  for (int i = 0; i < routes_.count; ++i) frames_of(routes_.routes[i]);
}

TEST_P(EncodeProperty, EveryStructureAlone) {
  for (int i = 0; i < GetParam()->type_count; ++i) {
    const Type* const type = GetParam()->types[i];
    bool is_carrier = false;
    for (int c = 0; c < GetParam()->carrier_count; ++c) {
      is_carrier = is_carrier || GetParam()->carriers[c].type == type;
    }
    if (!is_carrier) frames_of({"bare", type, 0, UINT32_MAX, nullptr, 0, nullptr, 0});
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, EncodeProperty, ::testing::ValuesIn(protocols()),
                         [](const auto& one) { return std::string(one.param->id); });

}  // namespace
}  // namespace rubric::reflect
