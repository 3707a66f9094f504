// The order of a file without stamps among files with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/oracle/align.h"
#include "conformance/oracle/align_frames.h"

namespace rubric::oracle {

/// What the frames of one file, which has no stamps, have in common with those of files on one
/// clock; of each pair `b` is in that one, and in no other pair.
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

/// Frames of `file`, bytes that do not say which way they went, that went the other way than they
/// seem to: messages from another island on a line whose island the others show. Nothing where
/// some message may have gone either way.
std::optional<std::vector<std::uint32_t>> wrong_ways(const Run& run, std::uint32_t file);

/// Gives the frames of `file` likely stamps, Place::loose and their bounds in Run::loose, where the
/// pairs say so. Stamps are those of the files, as in align().
OrderFit fit_order(Run& run, std::uint32_t file, const OrderEvidence& evidence,
                   const AlignOptions& options);

}  // namespace rubric::oracle
