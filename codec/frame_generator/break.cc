#include "codec/frame_generator/break.h"

#include <algorithm>

#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/routes.h"
#include "codec/frame_generator/values.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/reflect/decode.h"
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
using reflect::Type;
using std::to_string;

constexpr std::uint32_t kMacHeaderBytes = tinyos::MacHeaderView::kMaxSizeBytes;

/// One frame being broken.
class Breaker {
 public:
  Breaker(const Draft& draft, std::size_t max_bytes, const Type* short_radio, Random& random,
          Broken& out)
      : draft_(draft),
        size_(static_cast<std::uint32_t>(draft.bytes.size())),
        max_bytes_(max_bytes),
        short_radio_(short_radio),
        random_(random),
        out_(out) {
    out_ = Broken{draft.bytes, {Fault::kNone, 0, ReqId::kNone}, {}};
  }

  bool value() {
    return value_of(pick([&](const Part& p) {
      // Numbers of its own tell a radio frame's carrier from the others.
      const bool shape = draft_.radio && p.scope == 0;
      return p.kind == PartKind::kNumber && !shape &&
             p.field->valid.kind != reflect::ValidKind::kAny;
    }));
  }
  bool value_of(std::uint32_t part) {
    if (part == kNone) return false;
    const Part& p = draft_.parts[part];
    std::int64_t number = 0;
    if (!refused_value(*p.field, random_, number)) return false;
    store(p, number);
    if (random_.chance(0.8)) agree(part, number);
    const bool range = p.field->valid.kind == reflect::ValidKind::kRange;
    return fault(range ? Fault::kOutOfRange : Fault::kUnexpected, p.at, *p.field,
                 name(p) + ": " + reflect::number_problem(*p.field, number));
  }

  bool cut() { return cut_at(place_of_cut(), {}, ""); }

  bool cut_repaired() {
    const std::uint32_t at = place_of_cut();
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = 0; i < draft_.parts.size(); ++i) {
      const Part& p = draft_.parts[i];
      if (p.kind != PartKind::kRoom || p.measure == kNone || !p.hard) continue;
      if (p.at > at || p.at + p.size <= at) continue;
      if (!is_allowed(*number_of(p).field, at - p.at)) break;
      around.push_back(i);
    }
    if (around.empty()) return false;
    around.resize(1 + random_.below(around.size()));
    std::string repaired;
    for (const std::uint32_t i : around) {
      const Part& p = draft_.parts[i];
      store(number_of(p), at - p.at);
      repaired += ", " + name(number_of(p)) + " agrees";
    }
    return cut_at(at, around, repaired);
  }

  bool more() {
    return more_than(pick([&](const Part& p) { return counts(p); }));
  }
  bool more_than(std::uint32_t part) {
    if (part == kNone) return false;
    const Part& p = draft_.parts[part];
    const Part& measure = number_of(p);
    const std::uint32_t limit = draft_.limit(p.scope);
    const std::int64_t least = (limit - p.at) / p.element_bytes + 1;
    const auto most = static_cast<std::int64_t>(allowed(*measure.field).max);
    if (least > most) return false;
    const std::int64_t number = random_.chance(0.6) ? least : random_.between(least, most);
    if (!is_allowed(*measure.field, number)) return false;
    return lie(measure, number, [&] {
      return fault(
          Fault::kTruncated, limit, *p.field,
          name(measure) + " is " + to_string(number) + ", but " + name(p) + " has " + counted(p));
    });
  }

  bool less() {
    const std::uint32_t part = pick([&](const Part& p) {
      return p.kind == PartKind::kRoom && counts(p) && p.size > 0 && is_last(p);
    });
    if (part == kNone) return false;
    const Part& p = draft_.parts[part];
    const Part& measure = number_of(p);
    const auto least =
        static_cast<std::int64_t>(std::max<reflect::Whole>(0, allowed(*measure.field).min));
    const std::int64_t most = std::int64_t{p.size} - 1;
    if (least > most) return false;
    const std::int64_t number = random_.chance(0.5) ? most : random_.between(least, most);
    if (!is_allowed(*measure.field, number)) return false;
    const auto end = static_cast<std::uint32_t>(p.at + number);
    if (may_end(end)) return false;
    const std::uint32_t first = draft_.first_cut(end, part + 1, p.last_inside, {});
    const std::string text =
        name(measure) + " is " + to_string(number) + ", but " + name(p) + " has " + counted(p);
    if (first != kNone) {
      return lie(measure, number, [&] {
        return fault(Fault::kTruncated, end, *draft_.parts[first].field,
                     text + "; " + name(draft_.parts[first]) + " needs more");
      });
    }
    // Bytes after the end of an inner part are stale; after that of the frame they are too many.
    if (p.scope != 0 || draft_.bare) return false;
    return lie(measure, number, [&] { return fault(Fault::kTrailing, end, *p.field, text); });
  }

  bool body() {
    const Body& b = draft_.body;
    const Part& place = draft_.parts[b.part];
    if (!b.type || place.size == 0) return false;
    const std::size_t way = random_.below(3);
    if (!(way == 0 ? body_value() : way == 1 ? body_more() : body_cut())) return false;
    const std::size_t lost = draft_.bytes.size() - out_.bytes.size();
    const std::size_t end = place.at + place.size - lost;
    const Bytes owner(out_.bytes.data() + b.base, end - b.base);
    return !may_fit_another(*b.owner, b.field, owner, end - place.at, b.type, false);
  }

  bool trailing() {
    const Type& carrier = *draft_.scopes[0].type;
    if (carrier.field_count == 0 || size_ >= max_bytes_ || draft_.bare) return false;
    for (const Part& p : draft_.parts) {
      if (p.open && is_unbounded(p.scope)) return false;
    }
    const std::size_t bytes = 1 + random_.below(std::min<std::size_t>(max_bytes_ - size_, 12));
    for (std::size_t i = 0; i < bytes; ++i) out_.bytes.push_back(any_byte(random_));
    return fault(Fault::kTrailing, size_, carrier.fields[carrier.field_count - 1],
                 to_string(bytes) + " more than the frame has");
  }

 private:
  // Returns whether nothing but the frame's end limits the structure.
  bool is_unbounded(std::uint32_t scope) const {
    while (draft_.scopes[scope].end == kNone && draft_.scopes[scope].parent != kNone) {
      scope = draft_.scopes[scope].parent;
    }
    return draft_.scopes[scope].end == kNone;
  }
  bool may_end(std::uint32_t at) const {
    return std::find(draft_.ends.begin(), draft_.ends.end(), at) != draft_.ends.end();
  }
  const Part& number_of(const Part& p) const { return draft_.parts[p.measure]; }
  std::string name(const Part& p) const {
    return std::string(draft_.scopes[p.scope].type->name) + "." + p.field->name;
  }
  static std::string counted(const Part& p) {
    const std::uint32_t count = p.size / p.element_bytes;
    const char* const unit =
        p.kind == PartKind::kArray && p.element_bytes != 1 ? "element" : "byte";
    return to_string(count) + " " + unit + (count == 1 ? "" : "s");
  }

  /// Returns whether a number alone gives the size of this part, and this is the first such part.
  bool counts(const Part& p) const {
    if (p.measure == kNone) return false;
    for (const Part& other : draft_.parts) {
      if (&other == &p) return true;
      if (other.measure == p.measure) return false;
    }
    return false;
  }
  bool is_last(const Part& p) const {
    const Type& type = *draft_.scopes[p.scope].type;
    return p.field == &type.fields[type.field_count - 1];
  }

  /// Adds bytes where the measure `part` now promises more than there are, if the sizes around
  /// allow it: else a decoder that does not know the rule would refuse the frame for missing bytes.
  void agree(std::uint32_t part, std::int64_t number) {
    const auto parts = static_cast<std::uint32_t>(draft_.parts.size());
    std::uint32_t measured = part + 1;
    while (measured < parts && draft_.parts[measured].measure != part) ++measured;
    if (measured == parts) return;
    const Part& m = draft_.parts[measured];
    const std::int64_t more = number * m.element_bytes - m.size;
    if (more <= 0 || more + size_ > static_cast<std::int64_t>(max_bytes_)) return;
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = 0; i < measured; ++i) {
      const Part& p = draft_.parts[i];
      if (p.measure == kNone || p.last_inside <= measured) continue;
      if (!is_allowed(*number_of(p).field, p.size + more)) return;
      around.push_back(i);
    }
    for (const std::uint32_t i : around) {
      store(number_of(draft_.parts[i]), draft_.parts[i].size + more);
    }
    std::vector<std::uint8_t> noise(static_cast<std::size_t>(more));
    for (std::uint8_t& byte : noise) byte = any_byte(random_);
    out_.bytes.insert(out_.bytes.begin() + m.at + m.size, noise.begin(), noise.end());
  }

  // Breaks of the message in opaque bytes.

  bool body_value() {
    return value_of(pick_inside([&](const Part& p) {
      return p.kind == PartKind::kNumber && p.field->valid.kind != reflect::ValidKind::kAny;
    }));
  }
  bool body_more() {
    return more_than(pick_inside([&](const Part& p) { return counts(p); }));
  }
  // Removes bytes from the message's end, with the stale ones after it, and repairs all sizes.
  bool body_cut() {
    const Body& b = draft_.body;
    const Part& place = draft_.parts[b.part];
    const std::uint32_t end = place.at + place.size;
    const auto at = place.at + 1 + static_cast<std::uint32_t>(random_.below(place.size));
    if (at >= end) return false;
    const std::uint32_t first = draft_.first_cut(at, b.part + 1, b.last_inside, {}, false);
    if (first == kNone) return false;
    for (std::uint32_t i = 0; i < b.part; ++i) {
      const Part& p = draft_.parts[i];
      if (p.kind != PartKind::kRoom || p.measure == kNone) continue;
      const std::int64_t bytes = std::int64_t{p.size} - (end - at);
      if (!is_allowed(*number_of(p).field, bytes)) return false;
      store(number_of(p), bytes);
    }
    out_.bytes.erase(out_.bytes.begin() + at, out_.bytes.begin() + end);
    const Part& p = draft_.parts[first];
    return fault(Fault::kTruncated, at, *p.field,
                 std::string(b.type->name) + " has " + to_string(at - place.at) + " bytes, " +
                     name(p) + " needs more");
  }

  template <class Fits>
  std::uint32_t pick_inside(const Fits& fits) {
    return pick_of(draft_.body.part + 1, draft_.body.last_inside, fits);
  }
  /// Returns one of the parts that a decoder requires and that fit; kNone if there is none.
  template <class Fits>
  std::uint32_t pick(const Fits& fits) {
    const auto parts = static_cast<std::uint32_t>(draft_.parts.size());
    return pick_of(0, parts, [&](const Part& p) { return p.hard && fits(p); });
  }
  template <class Fits>
  std::uint32_t pick_of(std::uint32_t from, std::uint32_t to, const Fits& fits) {
    std::uint32_t chosen = kNone;
    std::size_t met = 0;
    for (std::uint32_t i = from; i < to; ++i) {
      if (!fits(draft_.parts[i])) continue;
      if (random_.below(++met) == 0) chosen = i;
    }
    return chosen;
  }

  void store(const Part& p, std::int64_t number) {
    reflect::store_number(*p.field, number, out_.bytes.data() + p.at);
  }
  template <class Then>
  bool lie(const Part& measure, std::int64_t number, const Then& then) {
    store(measure, number);
    return then();
  }

  bool fault(Fault fault, std::uint32_t at, const Field& field, std::string what) {
    out_.error = Error{fault, at, field.requirement};
    out_.what = std::move(what);
    return true;
  }

  // At least a byte is left; an empty frame is a fault of the framing.
  std::uint32_t place_of_cut() {
    if (size_ < 2) return size_;
    if (random_.chance(0.25)) return size_ - 1;
    const Part& p = draft_.parts[random_.below(draft_.parts.size())];
    if (random_.chance(0.3) && p.at > 0 && p.at < size_) return p.at;
    return 1 + static_cast<std::uint32_t>(random_.below(size_ - 1));
  }

  bool cut_at(std::uint32_t at, const std::vector<std::uint32_t>& repaired,
              const std::string& more) {
    if (may_end(at)) return false;
    if (at >= size_) return false;
    const auto parts = static_cast<std::uint32_t>(draft_.parts.size());
    const std::uint32_t first = draft_.first_cut(at, 0, parts, repaired);
    if (first == kNone) return false;  // Only stale bytes are gone.
    out_.bytes.resize(at);
    const Part& p = draft_.parts[first];
    const Field* field = p.field;
    std::string lacks = name(p);
    if (draft_.radio && at == kMacHeaderBytes && short_radio_) {
      for (int i = 0; i < short_radio_->field_count; ++i) {
        if (short_radio_->fields[i].fixed_offset != static_cast<std::int32_t>(at)) continue;
        field = &short_radio_->fields[i];
        lacks = std::string(short_radio_->name) + "." + field->name;
      }
    }
    return fault(Fault::kTruncated, at, *field,
                 "cut to " + to_string(at) + " of " + to_string(size_) + " bytes" + more + "; " +
                     lacks + " needs more");
  }

  const Draft& draft_;
  const std::uint32_t size_;
  const std::size_t max_bytes_;
  const Type* short_radio_;
  Random& random_;
  Broken& out_;
};

/// The number at a constant place in a structure that is the whole of an expression.
struct Load {
  bool lone = false;
  std::size_t offset = 0;  ///< From the start of the structure.
  Field number{};          ///< Width and byte order alone.
};

Load lone_load(const Expr& expr) {
  Load load;
  if (expr.count != 1 || expr.floats) return load;
  const Op op = expr.steps[0].op;
  if (!is_load(op)) return load;
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
      const auto bits = static_cast<std::uint64_t>(now);  // The greatest has one after it, too: 0.
      value = static_cast<std::int64_t>(random_.chance(0.5) ? bits + 1 : bits - 1);
    } else if (way == 6) {
      value = now ^ std::int64_t{1} << random_.below(8u * f.width_bytes);
    } else if (!refused_value(f, random_, value)) {
      value = static_cast<std::int64_t>(f.held().max);
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
    // A constant number of elements is always whole; one at a place that varies is left alone.
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

bool break_body(const Draft& draft, std::size_t max_bytes, Random& random, Broken& out) {
  return Breaker(draft, max_bytes, nullptr, random, out).body();
}

bool break_one(const Draft& draft, Breakage how, std::size_t max_bytes, const Type* short_radio,
               Random& random, Broken& out) {
  Breaker breaker(draft, max_bytes, short_radio, random, out);
  switch (how) {
    case Breakage::kValue: return breaker.value();
    case Breakage::kCut: return breaker.cut();
    case Breakage::kCutRepaired: return breaker.cut_repaired();
    case Breakage::kMore: return breaker.more();
    case Breakage::kLess: return breaker.less();
    case Breakage::kTrailing: return breaker.trailing();
  }
  return false;
}

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
