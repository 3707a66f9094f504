// Changes one field of a frame, valid or not, by the result of a decoder.
#include <algorithm>

#include "codec/generate/frame_generator.h"
#include "codec/generate/values.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/frame.h"

namespace rubric::generate {
namespace {

using reflect::Expr;
using reflect::Extent;
using reflect::Field;
using reflect::Node;
using reflect::NodeKind;
using reflect::Op;
using reflect::Repeat;

/// The number in a structure that is the whole of an expression.
struct Load {
  bool lone = false;
  std::size_t offset = 0;  ///< From the start of the structure.
  Field number{};          ///< Width and byte order alone.
};

Load lone_load(const Expr& expr) {
  Load load;
  if (expr.count != 1 || expr.steps[0].op == Op::kConst) return load;
  const Op op = expr.steps[0].op;
  load.lone = true;
  load.offset = static_cast<std::size_t>(expr.steps[0].value);
  const bool byte = op == Op::kLoadU8;
  const bool half = op == Op::kLoadBe16 || op == Op::kLoadLe16;
  load.number.width_bytes = static_cast<std::uint8_t>(byte ? 1 : half ? 2 : 4);
  load.number.little_endian = op == Op::kLoadLe16 || op == Op::kLoadLe32;
  return load;
}

class FieldChange {
 public:
  FieldChange(const reflect::Decoded& decoded, std::vector<std::uint8_t>& bytes,
              std::size_t max_size, Random& random)
      : decoded_(decoded), bytes_(bytes), max_size_(max_size), random_(random) {}

  bool run() {
    constexpr int kTries = 20;
    for (int i = 0; i < kTries; ++i) {
      const std::size_t node = 1 + random_.below(decoded_.node_count() - 1);
      if (change(node)) return true;
    }
    return false;
  }

 private:
  bool change(std::size_t node) {
    const Node& n = decoded_[node];
    switch (n.kind) {
      case NodeKind::kNumber: return number(*n.field, n.offset, is_measure(node));
      case NodeKind::kNumberArray:
        if (n.count != 0 && random_.chance(0.6)) {
          const std::size_t i = random_.below(n.count);
          return number(*n.field, n.offset + i * n.field->width_bytes, false);
        }
        return elements(node, n.field->width_bytes);
      case NodeKind::kStructArray: return elements(node, n.field->type->max_size);
      case NodeKind::kBytes:
        if (n.size != 0 && random_.chance(0.6)) {
          bytes_[n.offset + random_.below(n.size)] = any_byte(random_);
          return true;
        }
        return elements(node, 1);
      case NodeKind::kStruct: return false;  // Its fields are nodes of their own.
    }
    return false;
  }

  bool number(const Field& f, std::size_t at, bool measure) {
    // A size or count alone mostly breaks the frame; elements come and go with theirs.
    if (measure && random_.chance(0.8)) return false;
    const std::int64_t now = reflect::load_number(f, bytes_.data() + at);
    std::int64_t value = now;
    const std::size_t way = random_.below(8);
    if (way < 5) {
      value = allowed_value(f, random_);
    } else if (way == 5) {
      value = now + (random_.chance(0.5) ? 1 : -1);
    } else if (way == 6) {
      value = now ^ std::int64_t{1} << random_.below(8u * f.width_bytes);
    } else if (!refused_value(f, random_, value)) {
      value = held(f).max;
    }
    if (value == now) return false;
    reflect::store_number(f, value, bytes_.data() + at);
    return true;
  }

  std::size_t parent_of(std::size_t node) const {
    std::size_t parent = 0;
    for (std::size_t i = 1; i < node; ++i) {
      if (decoded_[i].end > node) parent = i;
    }
    return parent;
  }

  bool is_measure(std::size_t node) const {
    const Node& parent = decoded_[parent_of(node)];
    if (!parent.type) return false;
    for (int i = 0; i < parent.type->field_count; ++i) {
      for (const Expr* expr : {&parent.type->fields[i].size, &parent.type->fields[i].count}) {
        const Load load = lone_load(*expr);
        if (load.lone && parent.offset + load.offset == decoded_[node].offset) return true;
      }
    }
    return false;
  }

  /// Adds or removes an element of `width` bytes.
  bool elements(std::size_t node, std::size_t width) {
    const Node& n = decoded_[node];
    const Field& f = *n.field;
    // A constant number of elements is always whole.
    if (f.repeat == Repeat::kCount && !lone_load(f.count).lone) return false;
    if (f.kind == reflect::Kind::kStruct && f.type && f.type->min_size != width) return false;
    const std::size_t count = n.size / width;
    const bool more = count == 0 || random_.chance(0.5);
    if (more && bytes_.size() + width > max_size_) return false;
    const std::size_t at = n.offset + random_.below(count + (more ? 1 : 0)) * width;
    const auto place = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    const auto bytes = static_cast<std::ptrdiff_t>(width);
    if (more) {
      std::vector<std::uint8_t> element(width);
      for (std::uint8_t& byte : element) byte = any_byte(random_);
      bytes_.insert(place, element.begin(), element.end());
    } else {
      bytes_.erase(place, place + bytes);
    }
    const std::int64_t sign = more ? 1 : -1;
    const Node& parent = decoded_[parent_of(node)];
    if (f.repeat == Repeat::kCount) add(f.count, parent.offset, sign);
    repair(node, sign * bytes);
    return true;
  }

  /// Repairs the sizes around the node.
  void repair(std::size_t node, std::int64_t delta) {
    for (std::size_t at = node; at != 0;) {
      const std::size_t parent = parent_of(at);
      const Field* f = decoded_[at].field;
      if (f && f->extent == Extent::kSize) add(f->size, decoded_[parent].offset, delta);
      at = parent;
    }
  }

  void add(const Expr& expr, std::size_t base, std::int64_t delta) {
    const Load load = lone_load(expr);
    const std::size_t at = base + load.offset;
    if (!load.lone || at + load.number.width_bytes > bytes_.size()) return;
    const std::int64_t now = reflect::load_number(load.number, bytes_.data() + at);
    reflect::store_number(load.number, now + delta, bytes_.data() + at);
  }

  const reflect::Decoded& decoded_;
  std::vector<std::uint8_t>& bytes_;
  std::size_t max_size_;
  Random& random_;
};

}  // namespace

bool change_field(const reflect::Protocol& protocol, Framing framing,
                  std::vector<std::uint8_t>& bytes, std::size_t max_size, Random& random) {
  Packet packet;
  packet.framing = framing == Framing::kHdlc ? Framing::kSf : framing;
  packet.bytes = Bytes(bytes.data(), bytes.size());
  const reflect::FrameDecoder decoder(protocol);
  reflect::Frame frame;
  decoder.decode(packet, frame);
  if (frame.decoded.node_count() < 2) return false;
  return FieldChange(frame.decoded, bytes, max_size, random).run();
}

}  // namespace rubric::generate
