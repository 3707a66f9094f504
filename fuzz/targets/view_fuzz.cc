// Property: for any bytes and every structure `write(parse(x)) == x` for the meant bytes, no later
// byte heals a fault, and the reflection tables find the same fault at the same place by the same
// rule, or the same values.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/reflect/compare_view.h"
#include "fuzz/support/require.h"
#include "fuzz/support/structures.h"

namespace {

using namespace rubric;
using fuzz::require;

template <class View>
void written_again(const View& view) {
  const typename View::Value value = view.to_value();
  std::vector<std::uint8_t> out(view.bytes().size());
  const auto written = write(value, MutableBytes(out.data(), out.size()));
  require(written.has_value(), "write takes what parse took, and needs no more room");
  require(equal(*written, view.bytes()), "write makes the same bytes");
  const Result<View> again = View::parse(*written);
  require(again && *again == view && again->stale().empty(), "parse takes what write made");
  require(again->to_value() == value, "parse gives the value back");
  if (out.empty()) return;
  const auto small = write(value, MutableBytes(out.data(), out.size() - 1));
  require(!small && small.error().fault == Fault::kNoRoom, "write does with no less room");
}

// Only bytes up to the fault decide about it, unless some are missing.
template <class View>
void stays(Bytes bytes, const Error& error) {
  require(error.offset_bytes <= bytes.size(), "a fault lies within the bytes");
  if (error.fault == Fault::kTruncated) return;
  require(error.fault == Fault::kUnexpected || error.fault == Fault::kOutOfRange,
          "a fault is one of a structure");
  for (std::size_t n = error.offset_bytes + 1; n < bytes.size(); n += 1 + n / 16) {
    require(!View::parse(bytes.first(n)), "later bytes do not heal a fault");
  }
}

template <class View>
void check(Bytes bytes, const reflect::Type& type) {
  static reflect::Decoded decoded;
  const Result<View> view = View::parse(bytes);
  reflect::decode(type, bytes, reflect::Tail::kStale, true, decoded);
  require(decoded.error == view.error(), "the tables find the same fault");
  if (!view) return stays<View>(bytes, view.error());
  reflect::ViewComparer comparer(decoded);
  comparer.structure(*view, 0);
  require(comparer.difference().empty(), comparer.difference().c_str());
  written_again(*view);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto structures =
      fuzz::all_structures<Bytes>([]<class View>(ViewTag<View>) { return &check<View>; });
  for (const auto& one : structures) one.check(Bytes(data, size), *one.type);
  return 0;
}
