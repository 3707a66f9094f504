// A structure as functions with a name, for tests and tools that choose messages at run time.
#pragma once

#include "codec/runtime/view.h"

namespace rubric {

struct MessageCodec {
  const char* name;
  size_t min_size_bytes;
  size_t max_size_bytes;  ///< SIZE_MAX where it is as large as its surroundings.
  /// Returns the meant bytes.
  Result<Bytes> (*parse)(Bytes bytes);
  /// Parses, and writes the parsed value.
  Result<MutableBytes> (*rewrite)(Bytes bytes, MutableBytes out);
};

/// A view's type as an argument.
template <class View>
struct ViewTag {
  using Type = View;
};

namespace detail {

template <class View>
Result<Bytes> parse_meant(Bytes bytes) {
  const Result<View> view = View::parse(bytes);
  if (!view) return Failure{view.error()};
  return view->bytes();
}
template <class View>
Result<MutableBytes> rewrite(Bytes bytes, MutableBytes out) {
  const Result<View> view = View::parse(bytes);
  if (!view) return Failure{view.error()};
  return write(view->to_value(), out);
}

}  // namespace detail

template <class View>
constexpr MessageCodec message_codec(const char* name) {
  return {name, View::kMinSizeBytes, View::kMaxSizeBytes, &detail::parse_meant<View>,
          &detail::rewrite<View>};
}

}  // namespace rubric
