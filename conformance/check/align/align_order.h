// Orders a file without stamps among files with stamps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/check/align/align.h"
#include "conformance/check/align/align_frames.h"

namespace rubric::check {

/// The frames that a file without stamps has in common with files on one clock; `b` of a pair is in
/// the file without stamps and in no other pair.
struct OrderEvidence {
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> only_a;  ///< See CommonFrames.
  std::vector<std::uint32_t> only_b;
};

struct OrderFit {
  bool good = false;
  std::string why;          ///< Not good: the second half of a sentence.
  std::size_t frames = 0;   ///< Pairs that are in one order.
  std::size_t between = 0;  ///< Frames of the file from the first to the last of them.
  std::size_t all = 0;
};

/// Returns the frames of `file` that went the other way than it seems, where its bytes have no
/// direction: messages from another island on a line whose island the others show. Returns nothing
/// where some message may have gone either way.
std::optional<std::vector<std::uint32_t>> wrong_ways(const Run& run, std::uint32_t file);

/// Gives the frames of `file` likely stamps and Place::loose, and fills Run::loose with their
/// bounds, if the pairs allow it. Stamps are those of the files, as in align().
OrderFit fit_order(Run& run, std::uint32_t file, const OrderEvidence& evidence,
                   const AlignOptions& options);

}  // namespace rubric::check
