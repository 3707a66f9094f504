// Property: a value of any fields is written as bytes that parse and tables accept and that give it
// back, whatever the room, or refused by a rule of its structure; bytes after the room stay.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "fuzz/support/input.h"
#include "fuzz/support/require.h"
#include "fuzz/support/structures.h"

namespace {

using namespace rubric;
using fuzz::Input;
using fuzz::require;

constexpr std::size_t kRoom = 512;
constexpr std::size_t kGuard = 16;
constexpr std::uint8_t kUntouched = 0xA5;

/// Fills each field with the next part of the input.
class Fill {
 public:
  explicit Fill(Input& input) : input_(input) {}

  template <class T>
  void operator()(const char*, T& field) {
    fill(field);
  }

 private:
  template <class T>
  void fill(T& field) {
    if constexpr (std::is_same_v<T, float>) {
      field = float_of_bits(input_.u32());
    } else if constexpr (requires { field.raw(); }) {
      field = T(static_cast<decltype(field.raw())>(input_.u16()));
    } else if constexpr (std::is_enum_v<T> || std::is_integral_v<T>) {
      if (sizeof(T) == 1) {
        field = static_cast<T>(input_.u8());
      } else {
        field = static_cast<T>(sizeof(T) == 2 ? input_.u16() : input_.u32());
      }
    } else {
      visit_fields(field, *this);
    }
  }
  void fill(Bytes& field) { field = input_.bytes(input_.u8()); }
  template <class T, std::size_t kCount>
  void fill(T (&field)[kCount]) {
    for (T& item : field) fill(item);
  }
  template <class T, std::size_t kCapacity>
  void fill(Array<T, kCapacity>& field) {
    field.count = static_cast<std::uint16_t>(input_.u16() % (kCapacity + 1));
    for (std::size_t i = 0; i < field.count; ++i) fill(field.items[i]);
  }

  Input& input_;
};

/// Room followed by bytes that must stay as they are.
class Guarded {
 public:
  explicit Guarded(std::size_t size) : size_(size) { all_.fill(kUntouched); }
  MutableBytes room() { return MutableBytes(all_.data(), size_); }
  void check() const {
    require(std::all_of(all_.begin() + size_, all_.begin() + size_ + kGuard,
                        [](std::uint8_t byte) { return byte == kUntouched; }),
            "nothing after the room is written");
  }

 private:
  std::array<std::uint8_t, kRoom + kGuard> all_;
  std::size_t size_;
};

// Returns whether a rule is of a structure or of any in it.
bool is_rule_of(const reflect::Type& type, ReqId rule) {
  if (type.requirement == rule) return true;
  for (int i = 0; i < type.field_count; ++i) {
    const reflect::Field& field = type.fields[i];
    if (field.requirement == rule || (field.type && is_rule_of(*field.type, rule))) return true;
    for (int k = 0; field.choice && k < field.choice->count; ++k) {
      if (is_rule_of(*field.choice->cases[k].type, rule)) return true;
    }
  }
  return false;
}

template <class View>
void taken(const typename View::Value& value, Bytes bytes, const reflect::Type& type) {
  const Result<View> view = View::parse(bytes);
  require(view && view->stale().empty(), "parse takes what write made");
  if (std::string_view(type.id) != "serial_frame") {  // A value may have a number that kinds lack.
    require(view->to_value() == value, "parse gives the value back");
  }
  reflect::Decoded decoded;
  reflect::decode(type, bytes, reflect::Tail::kFault, true, decoded);
  require(!is_error(decoded.error), "the tables take what write made");
  Guarded exact(bytes.size());
  const auto again = write(value, exact.room());
  require(again && equal(*again, bytes), "write needs no more room than it uses");
  exact.check();
  if (bytes.empty()) return;
  Guarded small(bytes.size() - 1);
  const auto refused = write(value, small.room());
  require(!refused && refused.error().fault == Fault::kNoRoom &&
              refused.error().offset_bytes == bytes.size() - 1,
          "less room is too little, and ends where it ends");
  small.check();
}

template <class View>
void check(Input input, const reflect::Type& type) {
  const std::size_t room = input.u8();
  typename View::Value value;
  Fill fill(input);
  visit_fields(value, fill);
  Guarded out(kRoom);
  const auto written = write(value, out.room());
  out.check();
  if (written) {
    taken<View>(value, *written, type);
  } else {
    require(written.error().fault != Fault::kNoRoom, "there is room enough");
    require(is_rule_of(type, written.error().requirement), "the rule is one of the structure's");
  }
  Guarded any(room);
  const auto tried = write(value, any.room());
  any.check();
  require(tried.has_value() == (written && written->size() <= room), "room alone does not help");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto structures =
      fuzz::all_structures<Input>([]<class View>(ViewTag<View>) { return &check<View>; });
  for (const auto& one : structures) one.check(Input(data, size), *one.type);
  return 0;
}
