#include "codec/reflect/decode.h"

#include <algorithm>
#include <utility>

#include "codec/reflect/text_field.h"

namespace rubric::reflect {
namespace {

__attribute__((noinline)) std::uint64_t load_bytes(const Field& field, const std::uint8_t* at) {
  std::uint64_t raw = 0;
  for (int i = 0; i < field.width_bytes; ++i) {
    raw = raw << 8 | at[field.little_endian ? field.width_bytes - 1 - i : i];
  }
  return raw;
}

std::int64_t load_bits(const Field& field, const std::uint8_t* at) {
  const std::uint64_t raw = load_bytes(field, at) >> field.bit_shift;
  return static_cast<std::int64_t>(raw & ((std::uint64_t{1} << field.bit_width) - 1));
}

// Declared here and not in a header: the decoder wants it inlined, others call load_number.
RUBRIC_INLINE std::int64_t load(const Field& field, const std::uint8_t* at) {
  std::uint32_t raw = 0;
  if (field.width_bytes == 1) {
    raw = load_u8(at);
  } else if (field.width_bytes == 2) {
    raw = field.little_endian ? load_le16(at) : load_be16(at);
  } else if (__builtin_expect(field.width_bytes == 8, 0)) {
    return static_cast<std::int64_t>(load_bytes(field, at));
  } else {
    raw = field.little_endian ? load_le32(at) : load_be32(at);
  }
  if (field.kind != Kind::kSint) return raw;
  const int unused_bits = 32 - 8 * field.width_bytes;
  return static_cast<std::int32_t>(raw << unused_bits) >> unused_bits;
}

}  // namespace

std::int64_t load_number(const Field& field, const std::uint8_t* at) {
  return field.kind == Kind::kBits ? load_bits(field, at) : load(field, at);
}

Chosen choose_with(const Switch& choice, std::int64_t key) {
  const SwitchCase* end = choice.cases + choice.count;
  const SwitchCase* found = std::lower_bound(
      choice.cases, end, key, [](const SwitchCase& c, std::int64_t k) { return c.key < k; });
  if (found != end && found->key == key) return {found->type, found->arguments};
  return {choice.otherwise, choice.otherwise_arguments};
}

const Type* choose(const Switch& choice, std::int64_t key) { return choose_with(choice, key).type; }

void Decoded::clear(Bytes frame) {
  bytes = frame;
  error = Error{Fault::kNone, 0, ReqId::kNone};
  node_count_ = note_count_ = path_count_ = stale_count_ = 0;
}

void Decoded::add_note(const Note& note) {
  if (note_count_ < kMaxNotes) notes_[note_count_++] = note;
}

std::size_t Decoded::child(std::size_t parent, std::string_view name) const {
  if (parent >= node_count_) return 0;
  for (std::size_t i = parent + 1; i < nodes_[parent].end; i = nodes_[i].end) {
    if (nodes_[i].field && name == nodes_[i].field->name) return i;
  }
  return 0;
}

constexpr std::int64_t kMostEmpty = 256;  // Elements of a list that take no byte.

/// One decoding: a cursor over the tables that appends nodes.
class Decoder {
 public:
  Decoder(Decoded& out, const Switch* more) : out_(out), more_(more) {}

  void run(const Type& type, Tail tail, bool is_message) {
    outermost(type, tail, is_message);
    out_.node_count_ = count_;
  }

 private:
  void outermost(const Type& type, Tail tail, bool is_message) {
    // A node is a structure or takes at least a byte, and structures nest less than kMaxPath deep.
    const std::size_t need = 2 * out_.bytes.size() + 64 * Decoded::kMaxPath;
    if (out_.capacity_ < need) {
      out_.nodes_ = std::make_unique_for_overwrite<Node[]>(need);
      out_.capacity_ = need;
    }
    nodes_ = out_.nodes_.get();
    if (is_message) push_path(type);
    const auto size = static_cast<std::uint32_t>(out_.bytes.size());
    if (!structure(type, nullptr, 0, size)) return;
    const std::uint32_t used = nodes_[0].size;
    if (used == size) return;
    if (tail == Tail::kStale) return push_stale(used, size);
    const Field* last = type.field_count ? &type.fields[type.field_count - 1] : nullptr;
    out_.error = Error{Fault::kTrailing, used, last ? last->requirement : type.requirement};
    out_.error_field = nullptr;
    out_.error_value = size - used;
  }

  bool set_error(Fault fault, std::uint32_t offset, const Field& field, std::int64_t value) {
    out_.error = Error{fault, offset, field.requirement};
    out_.error_field = &field;
    out_.error_value = value;
    return false;
  }
  void push_path(const Type& type) {
    if (out_.path_count_ < Decoded::kMaxPath) out_.path_[out_.path_count_++] = &type;
  }
  void push_note(const Note& note) { out_.add_note(note); }
  void push_stale(std::uint32_t from, std::uint32_t to) {
    if (out_.stale_count_ < Decoded::kMaxStale) {
      out_.stale_[out_.stale_count_++] = Range{from, to - from};
    }
  }
  RUBRIC_INLINE Node& push(NodeKind kind, const Field* field, std::uint32_t offset,
                           std::uint32_t size) {
    if (count_ == out_.capacity_) grow();
    Node& node = nodes_[count_++];
    node.field = field;
    node.type = nullptr;
    node.value = 0;
    node.offset = offset;
    node.size = size;
    node.end = static_cast<std::uint32_t>(count_);
    node.count = 0;
    node.kind = kind;
    return node;
  }
  __attribute__((noinline)) void grow() {
    auto larger = std::make_unique_for_overwrite<Node[]>(2 * out_.capacity_);
    std::copy_n(nodes_, count_, larger.get());
    out_.nodes_ = std::move(larger);
    out_.capacity_ *= 2;
    nodes_ = out_.nodes_.get();
  }
  Bytes from(std::uint32_t base, std::uint32_t end) const {
    return out_.bytes.sub(base, end - base);
  }

  /// Returns the value of an expression of the open structure, which begins at `base`.
  RUBRIC_INLINE std::int64_t value_of(const Expr& expr, std::uint32_t base,
                                      std::uint32_t limit) const {
    if (__builtin_expect(expr.floats, 0)) return floating(expr, base, limit, open_);
    return evaluate(expr, from(base, limit), params_);
  }
  __attribute__((noinline)) std::int64_t floating(const Expr& expr, std::uint32_t base,
                                                  std::uint32_t limit, std::size_t node) const {
    const Field* const fields = nodes_[node].type->fields;
    const auto start_of = [&](int index) -> std::size_t {
      for (std::size_t i = node + 1; i < count_; i = nodes_[i].end) {
        if (nodes_[i].field == &fields[index]) return nodes_[i].offset - base;
      }
      return kNowhere;
    };
    return evaluate_floating(expr, from(base, limit), start_of, params_);
  }

  /// Decodes the fields of `type` in [base, limit) and closes the node.
  bool structure(const Type& type, const Field* field, std::uint32_t base, std::uint32_t limit) {
    const std::size_t index = count_;
    push(NodeKind::kStruct, field, base, 0).type = &type;
    const std::size_t around = std::exchange(open_, index);
    // A structure never takes more than its greatest size, whatever is left around it.
    if (limit - base > type.max_size) limit = base + type.max_size;
    std::uint32_t at = base;
    bool good = true;
    const Field* const fields_end = type.fields + type.field_count;
    for (const Field* f = type.fields; good && f != fields_end; ++f) {
      if (f->condition.count && !value_of(f->condition, base, limit)) continue;
      if (f->width_bytes != 0 && f->repeat == Repeat::kOnce) {
        good = __builtin_expect(f->kind == Kind::kBits, 0) ? bits(*f, at, limit)
                                                           : number(*f, at, limit);
      } else if (type.interpretation_count && f->kind == Kind::kBytes &&
                 interpret(type, static_cast<std::uint16_t>(f - type.fields), base, at, limit)) {
        at = limit;
      } else {
        good = other(*f, base, at, limit);
      }
    }
    Node& node = nodes_[index];
    node.size = at - base;
    node.end = static_cast<std::uint32_t>(count_);
    open_ = around;
    return good;
  }

  RUBRIC_INLINE bool number(const Field& f, std::uint32_t& at, std::uint32_t limit) {
    if (limit - at < f.width_bytes) return set_error(Fault::kTruncated, limit, f, f.width_bytes);
    return number(f, load(f, out_.bytes.data() + at), at);
  }

  RUBRIC_INLINE bool number(const Field& f, std::int64_t value, std::uint32_t& at) {
    if (f.valid.kind != ValidKind::kAny && !valid(f, value, at)) return false;
    push(NodeKind::kNumber, &f, at, f.width_bytes).value = value;
    if (f.expect >= 0 && value != f.expect) {
      push_note({NoteKind::kUnexpectedValue, at, &f, nullptr, value});
    }
    at += f.width_bytes;
    return true;
  }

  __attribute__((noinline)) bool bits(const Field& f, std::uint32_t& at, std::uint32_t limit) {
    std::uint32_t begin = at - f.shared_bytes();
    if (limit - begin < f.width_bytes) return set_error(Fault::kTruncated, limit, f, f.width_bytes);
    if (!number(f, load_bits(f, out_.bytes.data() + begin), begin)) return false;
    at = begin;
    return true;
  }

  bool valid(const Field& f, std::int64_t value, std::uint32_t at) {
    if (f.valid.kind == ValidKind::kRange) {
      if (Valid::within(value, f.valid.min, f.valid.max)) return true;
      return set_error(Fault::kOutOfRange, at, f, value);
    }
    for (int i = 0; i < f.valid.one_of_count; ++i) {
      if (f.valid.one_of[i] == value) return true;
    }
    return set_error(Fault::kUnexpected, at, f, value);
  }

  bool other(const Field& f, std::uint32_t base, std::uint32_t& at, std::uint32_t limit) {
    std::uint32_t end = limit;
    if (f.extent == Extent::kSize) {
      const std::int64_t size = value_of(f.size, base, limit);
      if (size < 0 || size > limit - at) return truncated(f, at, limit, size);
      end = at + static_cast<std::uint32_t>(size);
    }
    if (__builtin_expect(f.text != nullptr, 0)) return text(f, at, end);
    if (f.repeat != Repeat::kOnce) return array(f, base, at, end);
    if (f.kind == Kind::kBytes) {
      push(NodeKind::kBytes, &f, at, end - at);
      at = end;
      return true;
    }
    return nested(f, base, at, end, limit);
  }

  /// Decodes bytes with characters or a terminator, which lie before `end`.
  __attribute__((noinline)) bool text(const Field& f, std::uint32_t& at, std::uint32_t end) {
    if (f.extent == Extent::kTerminated) {
      const std::size_t found = terminator_at(*f.text, from(at, end));
      if (found == end - at && !f.text->may_lack_its_end) {
        return truncated(f, at, end, std::int64_t{end - at} + f.text->unit);
      }
      if (found != end - at) end = at + static_cast<std::uint32_t>(found) + f.text->unit;
    }
    push(NodeKind::kBytes, &f, at, end - at);
    const Bytes content = text_content(f, from(at, end));
    const std::size_t sound = sound_text(f, content);
    if (sound != content.size()) {
      push_note({NoteKind::kNotText, at + static_cast<std::uint32_t>(sound), &f, nullptr,
                 content[sound]});
    }
    at = end;
    return true;
  }

  // The available part of a field that is cut off stays visible.
  bool truncated(const Field& f, std::uint32_t at, std::uint32_t limit, std::int64_t needed) {
    if (at < limit) push(NodeKind::kBytes, &f, at, limit - at);
    return set_error(Fault::kTruncated, limit, f, needed);
  }

  bool nested(const Field& f, std::uint32_t base, std::uint32_t& at, std::uint32_t end,
              std::uint32_t limit) {
    Chosen inner{f.type, f.arguments};
    if (f.choice) {
      const std::int64_t key = value_of(f.choice->key, base, limit);
      inner = choose_with(*f.choice, key);
      if (!inner.type && f.extent == Extent::kOwn) {
        if (end > at) push_note({NoteKind::kUnknownMessage, at, &f, nullptr, key});
        return true;
      }
      if (!inner.type) {
        if (more_ && base == 0 && radio_only(f, key, at, end)) return true;
        if (end > at) push_note({NoteKind::kUnknownMessage, at, &f, nullptr, key});
        push(NodeKind::kBytes, &f, at, end - at);
        at = end;
        return true;
      }
      push_path(*inner.type);
    }
    const std::size_t index = count_;
    if (!call(*inner.type, inner.arguments, f, {base, limit}, at, end)) return false;
    const std::uint32_t used = at + nodes_[index].size;
    if (f.extent == Extent::kOwn) {
      at = used;
    } else {
      if (used < end) push_stale(used, end);
      at = end;
    }
    return true;
  }

  /// The bytes of the open structure.
  struct Around {
    std::uint32_t base;
    std::uint32_t limit;
  };

  /// Decodes a structure in [at, end) within the open one, which says what its parameters are.
  RUBRIC_INLINE bool call(const Type& type, const Argument* arguments, const Field& f,
                          Around around, std::uint32_t at, std::uint32_t end) {
    if (__builtin_expect(arguments == nullptr, 1)) return structure(type, &f, at, end);
    return call_with(type, arguments, f, around, at, end);
  }
  __attribute__((noinline)) bool call_with(const Type& type, const Argument* arguments,
                                           const Field& f, Around around, std::uint32_t at,
                                           std::uint32_t end) {
    std::int64_t values[kMaxParams];
    for (int i = 0; i < type.param_count; ++i) {
      values[i] = value_of(arguments[i].value, around.base, around.limit);
      if (values[i] >= arguments[i].min && values[i] <= arguments[i].max) continue;
      push(NodeKind::kStruct, &f, at, 0).type = &type;
      return set_error(Fault::kTruncated, end, f, values[i]);
    }
    const std::int64_t* const outer = std::exchange(params_, values);
    const bool good = structure(type, &f, at, end);
    params_ = outer;
    return good;
  }

  /// Decodes a message of another carrier; returns true if there is one for the key, opaque if it
  /// does not fit.
  bool radio_only(const Field& f, std::int64_t key, std::uint32_t& at, std::uint32_t end) {
    const Type* type = choose(*more_, key);
    if (!type) return false;
    if (fits(f, {type, nullptr}, {}, at, end)) {
      push_note({NoteKind::kRadioOnly, at, &f, type, key});
    } else {
      push_note({NoteKind::kDoesNotFit, at, &f, type, key});
      push(NodeKind::kBytes, &f, at, end - at);
    }
    at = end;
    return true;
  }

  bool array(const Field& f, std::uint32_t base, std::uint32_t& at, std::uint32_t limit) {
    if (__builtin_expect(f.repeat == Repeat::kUntil, 0)) return until(f, base, at, limit);
    const std::uint32_t width = f.kind == Kind::kStruct ? f.type->max_size : f.width_bytes;
    if (f.kind == Kind::kStruct && (f.type->min_size != width || width == 0)) {
      return varying(f, base, at, limit);
    }
    std::int64_t count = 0;
    if (f.repeat == Repeat::kCount) {
      count = value_of(f.count, base, limit);
      if (count < 0 || count * width > limit - at) return truncated(f, at, limit, count * width);
    } else {
      count = (limit - at) / width;
      if (count * width != limit - at) return truncated(f, at, limit, (count + 1) * width);
    }
    const auto size = static_cast<std::uint32_t>(count * width);
    if (f.kind != Kind::kStruct) {
      Node& node = push(NodeKind::kNumberArray, &f, at, size);
      node.count = static_cast<std::uint32_t>(count);
      at += size;
      return true;
    }
    const std::size_t index = count_;
    push(NodeKind::kStructArray, &f, at, size).count = static_cast<std::uint32_t>(count);
    bool good = true;
    for (std::int64_t i = 0; good && i < count; ++i, at += width) {
      good = call(*f.type, f.arguments, f, {base, limit}, at, at + width);
    }
    nodes_[index].end = static_cast<std::uint32_t>(count_);
    return good;
  }

  /// Decodes elements of varying size, one after the other.
  bool varying(const Field& f, std::uint32_t base, std::uint32_t& at, std::uint32_t limit) {
    const bool to_end = f.repeat == Repeat::kToEnd;
    const std::int64_t count = to_end ? limit - at : value_of(f.count, base, limit);
    if (count < 0 || (!to_end && count * f.type->min_size > limit - at)) {
      return truncated(f, at, limit, count * f.type->min_size);
    }
    const std::size_t index = count_;
    push(NodeKind::kStructArray, &f, at, 0);
    const std::uint32_t begin = at;
    bool good = true;
    std::uint32_t elements = 0;
    while (good && elements < count && !(to_end && at == limit)) {
      const std::size_t element = count_;
      good = call(*f.type, f.arguments, f, {base, limit}, at, limit);
      at += nodes_[element].size;
      ++elements;
      // Elements without a byte would never come to the end.
      if (nodes_[element].size == 0 && (to_end || elements > kMostEmpty)) break;
    }
    Node& node = nodes_[index];
    node.size = at - begin;
    node.count = elements;
    node.end = static_cast<std::uint32_t>(count_);
    return good;
  }

  /// Decodes elements up to the first for which the condition holds.
  __attribute__((noinline)) bool until(const Field& f, std::uint32_t base, std::uint32_t& at,
                                       std::uint32_t limit) {
    const bool numbers = f.kind != Kind::kStruct;
    const std::size_t index = count_;
    const std::uint32_t begin = at;
    push(numbers ? NodeKind::kNumberArray : NodeKind::kStructArray, &f, at, 0);
    std::uint32_t elements = 0;
    bool good = true;
    for (bool done = false; good && !done; ++elements) {
      const std::size_t element = count_;
      const std::uint32_t start = at;
      if (!numbers) {
        good = call(*f.type, f.arguments, f, {base, limit}, at, limit);
        at += nodes_[element].size;
      } else if (limit - at < f.width_bytes) {
        good = set_error(Fault::kTruncated, limit, f, f.width_bytes);
        break;
      } else {
        at += f.width_bytes;
      }
      done = good && (f.until.floats ? floating(f.until, start, at, element)
                                     : evaluate(f.until, from(start, at), params_));
      // Elements without a byte would never come to their end.
      if (good && !done && at == start) good = set_error(Fault::kTruncated, at, f, 1);
    }
    Node& node = nodes_[index];
    node.size = at - begin;
    node.count = elements;
    node.end = static_cast<std::uint32_t>(count_);
    return good;
  }

  /// Tries the interpretations of field `i`; returns true if one fits. Leaves notes if none does.
  bool interpret(const Type& type, std::uint16_t i, std::uint32_t base, std::uint32_t at,
                 std::uint32_t limit) {
    const Type* unfit = nullptr;
    const Field* about = nullptr;
    for (std::uint16_t k = 0; k < type.interpretation_count; ++k) {
      const Interpretation& candidate = type.interpretations[k];
      if (candidate.overlays != i) continue;
      const Field& f = candidate.field;
      if (f.condition.count && !value_of(f.condition, base, limit)) continue;
      about = &f;
      Chosen chosen{f.type, f.arguments};
      if (f.choice) {
        if (at == limit) continue;  // The key is the first byte, and there is none.
        chosen = choose_with(*f.choice, value_of(f.choice->key, base, limit));
      }
      if (!chosen.type) continue;
      if (fits(f, chosen, {base, limit}, at, limit)) return true;
      unfit = chosen.type;
    }
    if (at == limit) return false;  // Nothing there, nothing to remark.
    const NoteKind kind = unfit ? NoteKind::kDoesNotFit : NoteKind::kUnknownMessage;
    push_note({kind, at, about ? about : &type.fields[i], unfit, out_.bytes[at]});
    return false;
  }

  bool fits(const Field& f, Chosen chosen, Around around, std::uint32_t at, std::uint32_t limit) {
    const std::size_t nodes = count_;
    const std::size_t notes = out_.note_count_;
    const std::size_t path = out_.path_count_;
    const std::size_t stale = out_.stale_count_;
    push_path(*chosen.type);
    if (call(*chosen.type, chosen.arguments, f, around, at, limit)) {
      const std::uint32_t used = at + nodes_[nodes].size;
      if (used < limit) push_stale(used, limit);
      return true;
    }
    out_.error = Error{Fault::kNone, 0, ReqId::kNone};
    count_ = nodes;
    out_.note_count_ = notes;
    out_.path_count_ = path;
    out_.stale_count_ = stale;
    return false;
  }

  Decoded& out_;
  const Switch* more_;
  Node* nodes_ = nullptr;
  std::size_t count_ = 0;  // Number of nodes; set in `out_` at the end.
  std::size_t open_ = 0;   // The node of the innermost structure that is not closed yet.
  const std::int64_t* params_ = nullptr;  // Of that structure, if its type has some.
};

void decode(const Type& type, Bytes bytes, Tail tail, bool is_message, Decoded& out,
            const Switch* more) {
  out.clear(bytes);
  Decoder(out, more).run(type, tail, is_message);
}

const Type* find_type(const Protocol& protocol, std::string_view name) {
  for (int i = 0; i < protocol.type_count; ++i) {
    if (name == protocol.types[i]->id) return protocol.types[i];
  }
  for (int i = 0; i < protocol.type_count; ++i) {
    if (name == protocol.types[i]->name) return protocol.types[i];
  }
  return nullptr;
}

const Type* find_carrier(const Protocol& protocol, std::string_view carrier) {
  for (int i = 0; i < protocol.carrier_count; ++i) {
    if (carrier == protocol.carriers[i].name) return protocol.carriers[i].type;
  }
  return nullptr;
}

const char* enum_name(const EnumTable& table, std::int64_t value) {
  const EnumEntry* end = table.entries + table.count;
  // Most enums count up from their first value without gaps.
  const std::int64_t guess = table.count ? value - table.entries[0].value : -1;
  if (guess >= 0 && guess < table.count && table.entries[guess].value == value) {
    return table.entries[guess].name;
  }
  const EnumEntry* found = std::lower_bound(
      table.entries, end, value,
      [](const EnumEntry& e, std::int64_t v) { return static_cast<std::int64_t>(e.value) < v; });
  return found != end && static_cast<std::int64_t>(found->value) == value ? found->name : nullptr;
}

}  // namespace rubric::reflect
