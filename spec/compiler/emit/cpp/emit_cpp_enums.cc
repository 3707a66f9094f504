// Emits enums.h and the headers of masks.
#include <fmt/core.h>

#include <algorithm>

#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kEnum[] = R"(enum class <<class>> : <<type>> {
  <<entries>>
};
)";

const char kMask[] = R"(<<doc>>
class <<class>> {
 public:
  enum Bit : <<raw>> {
    <<bits?>>
  };

  constexpr <<class>>() = default;
  constexpr <<class>>(Bit bit) : raw_(bit) {}
  constexpr explicit <<class>>(<<raw>> raw) : raw_(raw) {}

  /// All bits, unnamed ones too.
  constexpr <<raw>> raw() const { return raw_; }
  constexpr explicit operator <<raw>>() const { return raw_; }
  constexpr bool has(Bit bit) const { return (raw_ & bit) != 0; }
  constexpr <<class>> with(<<class>> other) const {
    return <<class>>(static_cast<<raw_in_angles>>(raw_ | other.raw_));
  }
  constexpr <<class>> without(<<class>> other) const {
    return <<class>>(static_cast<<raw_in_angles>>(raw_ & ~other.raw_));
  }

  friend constexpr <<class>> operator|(<<class>> a, <<class>> b) { return a.with(b); }
  friend constexpr bool operator==(<<class>> a, <<class>> b) { return a.raw_ == b.raw_; }
  friend constexpr bool operator!=(<<class>> a, <<class>> b) { return a.raw_ != b.raw_; }

 private:
  <<raw>> raw_ = 0;
};
// Two bits are a mask, not an int.
constexpr <<class>> operator|(<<class>>::Bit a, <<class>>::Bit b) {
  return <<class>>(a) | <<class>>(b);
}
)";

// Returns the width of the widest field that holds it.
int width_of(const Enum& e, const Spec& spec) {
  const std::int64_t most = e.entries.empty() ? 0 : e.entries.back().value;
  int width = most <= 0xff ? 1 : most <= 0xffff ? 2 : 4;
  for (const auto& type : spec.types) {
    for (const auto* list : {&type->fields, &type->instances}) {
      for (const auto& f : *list) {
        if (f->enumeration == &e) width = std::max(width, f->width_bytes);
      }
    }
  }
  return width;
}

std::string hex(std::uint32_t value, int width_bytes) {
  return fmt::format("0x{:0{}x}", value, 2 * width_bytes);
}

}  // namespace

std::string emit_enums(const Spec& spec) {
  std::string out;
  for (const auto& e : spec.enums) {
    const int width = width_of(*e, spec);
    std::string entries;
    for (const EnumEntry& entry : e->entries) {
      const auto value = static_cast<std::uint32_t>(entry.value);
      entries += cpp_constant(entry.name) + " = " +
                 (value > 0xff ? hex(value, width) : std::to_string(value)) + "," +
                 (entry.doc.empty() ? "" : "  ///< " + entry.doc) + "\n";
    }
    if (!out.empty()) out += "\n";
    out += fill(kEnum, {{"class", pascal(e->id)},
                        {"type", "uint" + std::to_string(8 * width) + "_t"},
                        {"entries", entries}});
  }
  return out;
}

std::string emit_mask(const Type& type) {
  const auto count = type.bits.size();
  const int width = static_cast<int>(count / 8);
  std::string bits;
  for (std::size_t i = count; i-- > 0;) {
    const MaskBit& bit = type.bits[i];
    if (bit.unnamed) continue;
    bits +=
        cpp_constant(bit.name) + " = " + hex(std::uint32_t{1} << (count - 1 - i), width) + ",\n";
  }
  const std::string raw = "uint" + std::to_string(8 * width) + "_t";
  return fill(kMask, {{"doc", comment(type.doc + " Unnamed bits are kept.")},
                      {"class", pascal(type.id)},
                      {"raw", raw},
                      {"raw_in_angles", "<" + raw + ">"},
                      {"bits", bits}});
}

}  // namespace rubricc::cpp
