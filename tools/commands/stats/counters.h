// The counters of `rubric stats`. Memory grows with the kinds of things met, never with their
// number.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

#include "codec/reflect/frame.h"
#include "codec/reflect/requirements.h"
#include "tools/commands/stats/distribution.h"

namespace rubric::stats {

/// A frame's place, to find it again with `rubric decode`.
struct Place {
  std::string file;
  std::uint64_t index = 0;   ///< Among all frames, from 0, as in `rubric decode --format jsonl`.
  std::uint64_t number = 0;  ///< In the file, from 1, as in the text of `rubric decode`.
  std::uint64_t offset = 0;  ///< In the file, in bytes.
  std::int64_t time_ns = kNoTime;
};

/// Frames that belong together, in their order.
struct Flow {
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;
  std::uint64_t malformed = 0;
  std::uint64_t repeated = 0;       ///< Frames with the sequence number of the one before.
  std::uint64_t backward = 0;       ///< Frames that are older than the one before.
  std::uint64_t timed = 0;          ///< Frames with a time.
  double seconds_before = 0;        ///< The lengths of the files before the present one.
  std::int64_t first_ns = kNoTime;  ///< The earliest in the present file,
  std::int64_t last_ns = kNoTime;   ///< and the latest, in whatever order they are.
  std::int64_t gap_ns = -1;         ///< The longest of them; -1 if there is none.
  Place gap_from;
  Place gap_to;
  Place last;

  /// Returns the time from the earliest to the latest frame, summed over the files.
  double seconds() const;
  /// Returns frames in a second, as capinfos does: all of them by that time; 0 if times are
  /// unknown.
  double rate() const;
};

/// What sniffers state about the frames of a link.
struct Signal {
  struct Range {
    std::uint64_t count = 0;
    double min = 0;
    double max = 0;
    double sum = 0;
    void take(double value);
    double mean() const { return count ? sum / static_cast<double>(count) : 0; }
  };
  std::uint64_t frames = 0;
  Range rssi;
  Range lqi;
};

struct FaultCount {
  std::uint64_t frames = 0;
  Place first;
};

/// The source of a frame.
struct Origin {
  std::string_view file;
  std::string_view interface_name;
  std::uint64_t index = 0;   ///< Among all frames, from 0.
  std::uint64_t number = 0;  ///< In the file, from 1.
};

/// Orders faults by kind, then by rule as the catalogue lists them.
struct FaultOrder {
  bool operator()(const std::pair<Fault, ReqId>& a, const std::pair<Fault, ReqId>& b) const {
    if (a.first != b.first) return a.first < b.first;
    return reflect::CatalogueOrder()(a.second, b.second);
  }
};
using FaultCounts = std::map<std::pair<Fault, ReqId>, FaultCount, FaultOrder>;

class Counters {
 public:
  using Flows = std::unordered_map<std::string, Flow>;
  /// Beyond this many pairs of addresses, new ones are counted together.
  static constexpr std::size_t kMaxPairs = 20'000;
  static constexpr std::string_view kOtherPairs = "(others)";

  void take(const reflect::Frame& frame, const Origin& origin);

  const Flow& all() const { return all_; }
  /// Between neighbouring frames of a file.
  const Gaps& gaps() const { return gaps_; }
  const TimeLine& time_line() const { return time_line_; }
  const Flows& messages() const { return messages_; }
  /// By the source of the pairs.
  const Flows& sources() const { return sources_; }
  /// By the addresses of the radio frame, "2>1".
  const std::map<std::string, Signal>& links() const { return links_; }
  const std::map<std::int32_t, std::uint64_t>& channels() const { return channels_; }
  const Flows& pairs() const { return pairs_; }
  /// By fault and rule.
  const FaultCounts& faults() const { return faults_; }
  const std::map<reflect::NoteKind, std::uint64_t>& notes() const { return notes_; }
  const std::map<std::string, std::uint64_t, std::less<>>& interfaces() const {
    return interfaces_;
  }

 private:
  bool is_repeated(const reflect::Frame& frame, const Origin& origin);

  void take_signal(const reflect::Frame& frame);

  Flow all_;
  Gaps gaps_;
  TimeLine time_line_;
  Flows sources_;
  std::map<std::string, Signal> links_;
  std::map<std::int32_t, std::uint64_t> channels_;
  Flows messages_;
  Flows pairs_;
  FaultCounts faults_;
  std::map<reflect::NoteKind, std::uint64_t> notes_;
  std::map<std::string, std::uint64_t, std::less<>> interfaces_;
  std::unordered_map<std::string, std::int64_t> last_sequence_;  // By pair, message, interface.
  std::string message_;
  std::string pair_;
  std::string key_;
};

/// Returns the name under which a frame is counted: its innermost message, or its framing.
std::string message_label(const reflect::Frame& frame);

/// Returns "src>dest": the addresses of the outermost message if it has fields of these names, else
/// those of the active-message header; empty if there are none.
std::string pair_label(const reflect::Frame& frame);

}  // namespace rubric::stats
