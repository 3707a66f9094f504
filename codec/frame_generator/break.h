// Breaks one thing of a valid frame, and reports the effect: which rule it breaks, and where a
// decoder that reads front to back first sees it. This follows from the layout of the frame and
// from the change alone, without asking any decoder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/frame_generator/draft.h"
#include "codec/frame_generator/random.h"
#include "codec/runtime/result.h"

namespace rubric::generate {

enum class Breakage : std::uint8_t {
  kValue,        ///< A number that its rule refuses.
  kCut,          ///< Bytes missing at the end.
  kCutRepaired,  ///< The same, and some of the lengths around the cut agree with it.
  kMore,         ///< A size or count that is larger than what there is.
  kLess,         ///< A size that is smaller than what is in it, or than what there is.
  kTrailing,     ///< Bytes after the end.
};
inline constexpr std::size_t kBreakages = 6;

struct Broken {
  std::vector<std::uint8_t> bytes;
  Error error{Fault::kNone, 0, ReqId::kNone};
  std::string what;
};

/// Breaks the body of `draft`, so that the frame stays valid, but its body bytes are no longer the
/// meant message, nor another. `error`, whose offset counts from the frame's start, is why they do
/// not fit. Returns false as below.
bool break_body(const Draft& draft, std::size_t max_bytes, Random& random, Broken& out);

/// Breaks `draft` in that way; returns false if it cannot be, or chance found nothing. `max_bytes`:
/// of the frame. `short_radio`: the structure of a radio frame that ends with its MAC header; null
/// if none.
bool break_one(const Draft& draft, Breakage how, std::size_t max_bytes,
               const reflect::Type* short_radio, Random& random, Broken& out);

}  // namespace rubric::generate
