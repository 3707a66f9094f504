// Property: a builder that gets every field of a parsed structure makes its bytes again, whatever
// its room held before; the parts that a view returns are those that parse finds in it.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/tests/every_view.h"
#include "fuzz/support/every_builder.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;

template <class Part>
void check_part(const Part& part, Bytes bytes) {
  const Result<Part> parsed = Part::parse(bytes);
  require(parsed && !(*parsed != part), "a part is what parse makes of its bytes");
}

template <class View>
void check(Bytes bytes, std::uint8_t before) {
  using Builder = typename View::Builder;
  const Result<View> view = View::parse(bytes);
  if (!view) return;
  const auto part = [](Bytes of, const auto& inner) { check_part(inner, of); };
  visit_parts(*view, part);
  std::vector<std::uint8_t> room(view->bytes().size(), before);
  const MutableBytes whole(room.data(), room.size());
  for (std::size_t n = 0; n < View::kMinSizeBytes; ++n) {
    require(!Builder::create(whole.first(n)), "less than the least has no room");
  }
  const auto created = Builder::create(whole);
  require(created.has_value(), "what parse took has room for its builder");
  Builder builder = *created;
  const typename View::Value value = view->to_value();
  fuzz::set_every_field(builder, value);
  fuzz::set_too_much(builder, value);
  const Result<View> made = builder.finish();
  require(made && equal(made->bytes(), view->bytes()), "the builder makes the bytes again");
  require(!(*made != *view) && !(made->to_value() != value), "what is the same is not different");
}

template <class Mask>
void check_mask(std::uint16_t one, std::uint16_t other) {
  using Raw = decltype(Mask().raw());
  const Raw a = static_cast<Raw>(one), b = static_cast<Raw>(other);
  const Mask first(a), second(b);
  require((first | second).raw() == (a | b), "a mask has the bits of both");
  require(first.without(second).raw() == static_cast<Raw>(a & ~b), "less the bits of the other");
  require(first.with(second).without(second) == first.without(second), "once in, then out");
  require(static_cast<Raw>(first) == a && (first != second) == (a != b), "a mask is its bits");
  for (int bit = 0; bit < int{sizeof(Raw)} * 8; ++bit) {
    const auto named = static_cast<typename Mask::Bit>(1u << bit);
    require(first.has(named) == ((a >> bit & 1) != 0), "a mask has the bits that it has");
    require((named | named) == Mask(named), "two bits are a mask");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(data, size);
  for_each_view_of_all(
      [&]<class View>(const std::string&, ViewTag<View>) { check<View>(bytes, data[size - 1]); });
  if (size < 4) return 0;
  check_mask<rubicon::ActuatorMask>(data[0], data[1]);
  check_mask<rubicon::TransducerMask>(load_be16(data), load_be16(data + 2));
  return 0;
}
