#include "conformance/check/align/align_order.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include "conformance/check/message.h"

namespace rubric::check {
namespace {

constexpr std::size_t kOrderFramesMin = 3;
constexpr std::int64_t kNeverUs = std::numeric_limits<std::int64_t>::max();

// A frame of the file that another file has as well, and the times at which it can have come.
struct Anchor {
  std::uint32_t index = 0;  // Into Run::seen.
  std::int64_t at_us = 0;   // The other one's stamp.
  std::int64_t from_us = 0;
  std::int64_t to_us = 0;
  bool effect = false;  // It is the other one's effect.
};

Anchor anchor_of(const Run& run, const Pair& pair, std::int64_t response_us) {
  Anchor out{pair.b, run.seen[pair.a].place.time_us, 0, 0, pair.lag_sign > 0};
  // An effect comes after its cause, within the time that a node may take.
  out.from_us = out.effect ? out.at_us + pair.lag_min_us : out.at_us - response_us;
  out.to_us = out.effect ? out.at_us + pair.lag_min_us + response_us : out.at_us - 1;
  return out;
}

// Returns the longest subsequence whose stamps never go back.
std::vector<Anchor> longest_in_order(const std::vector<Anchor>& all) {
  std::vector<std::size_t> tails;  // The last of the best sequence of each length.
  std::vector<std::size_t> before(all.size(), SIZE_MAX);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto longer = std::upper_bound(
        tails.begin(), tails.end(), all[i].at_us,
        [&](std::int64_t at_us, std::size_t tail) { return at_us < all[tail].at_us; });
    if (longer != tails.begin()) before[i] = *(longer - 1);
    if (longer == tails.end()) {
      tails.push_back(i);
    } else {
      *longer = i;
    }
  }
  std::vector<Anchor> out;
  for (std::size_t i = tails.empty() ? SIZE_MAX : tails.back(); i != SIZE_MAX; i = before[i]) {
    out.push_back(all[i]);
  }
  std::reverse(out.begin(), out.end());
  return out;
}

// Returns whether a message between islands may have gone either way: a host may send down the line
// what it got from it.
bool may_be_either(const Run& run, const Observation& seen) {
  Net net;
  return seen.kind == Observation::Kind::kSerial && !run.taps[seen.tap].shows_direction() &&
         seen.frame.type == am::kNet && parse_net(seen.frame.payload, net) &&
         net.src.devid != machine::kNullDevid && net.dest.pid != net.src.pid;
}

// Returns the line's island that this message shows, whichever way it went; kNoIsland if none.
std::uint16_t island_shown(const Observation& seen, const Net& net) {
  SerialJoined joined;
  if (!seen.to_mote && parse_serial_joined(net, joined)) return joined.address.pid;
  if (net.src.devid == machine::kNullDevid) return net.src.pid;
  return net.dest == machine::Address{net.src.pid, machine::kNullDevid} ? net.src.pid : kNoIsland;
}

class Ordering {
 public:
  Ordering(Run& run, std::uint32_t file, const AlignOptions& options)
      : run_(run), file_(file), options_(options) {}

  OrderFit fit(const OrderEvidence& evidence) {
    OrderFit out;
    std::vector<Anchor> all;
    for (const Pair& pair : evidence.pairs) {
      all.push_back(anchor_of(run_, pair, options_.response_us));
    }
    std::stable_sort(all.begin(), all.end(), [](const Anchor& a, const Anchor& b) {
      return std::tie(a.index, a.at_us) < std::tie(b.index, b.at_us);
    });
    anchors_ = longest_in_order(all);
    out.frames = anchors_.size();
    if (all.size() < kOrderFramesMin) {
      out.why = all.empty()       ? "no frame that comes but once is in both"
                : all.size() == 1 ? "only 1 frame is in both, and 3 are needed"
                                  : "only 2 frames are in both, and 3 are needed";
      return out;
    }
    if (anchors_.size() < kOrderFramesMin || 4 * anchors_.size() < 3 * all.size()) {
      out.why = "the " + std::to_string(all.size()) +
                " frames that are in both are in another "
                "order in each";
      return out;
    }
    if (anchors_.size() < std::min(lonely_a(evidence), lonely_b(evidence))) {
      out.why = "the " + std::to_string(anchors_.size()) +
                " frames that are in both are fewer "
                "than those between them that are not";
      return out;
    }
    place(out);
    out.good = true;
    return out;
  }

 private:
  std::size_t lonely_a(const OrderEvidence& evidence) const {
    return static_cast<std::size_t>(
        std::count_if(evidence.only_a.begin(), evidence.only_a.end(), [&](std::uint32_t i) {
          const std::int64_t at_us = run_.seen[i].place.time_us;
          return at_us >= anchors_.front().at_us && at_us <= anchors_.back().at_us;
        }));
  }
  std::size_t lonely_b(const OrderEvidence& evidence) const {
    return static_cast<std::size_t>(
        std::count_if(evidence.only_b.begin(), evidence.only_b.end(), [&](std::uint32_t i) {
          return i >= anchors_.front().index && i <= anchors_.back().index;
        }));
  }

  // Bounds each frame's time; frames keep their order. None is earlier than an anchor before it
  // allows, none later than one after it.
  void place(OrderFit& out) {
    std::vector<std::uint32_t> frames;
    std::int64_t first_us = kNeverUs;
    std::int64_t last_us = kNoStamp;
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) {
      const Place& place = run_.seen[i].place;
      if (!run_.seen[i].node.empty()) continue;
      if (place.file == file_) {
        frames.push_back(i);
      } else if (place.time_us != kNoStamp) {
        first_us = std::min(first_us, place.time_us);
        last_us = std::max(last_us, place.time_us);
      }
    }
    std::vector<LoosePlace> places(frames.size());
    std::size_t next = 0;
    std::int64_t early_us = first_us;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Place& place = run_.seen[frames[i]].place;
      if (next < anchors_.size() && anchors_[next].index == frames[i]) {
        early_us = std::max(early_us, anchors_[next++].from_us);
      }
      const bool between =
          frames[i] >= anchors_.front().index && frames[i] <= anchors_.back().index;
      out.between += between ? 1 : 0;
      places[i] = {place.file, place.frame, std::min(early_us, last_us), 0,
                   between && !may_be_either(run_, run_.seen[frames[i]])};
    }
    out.all = frames.size();
    std::int64_t late_us = last_us;
    for (std::size_t i = frames.size(); i-- > 0;) {
      if (next > 0 && anchors_[next - 1].index == frames[i]) {
        late_us = std::min(late_us, anchors_[--next].to_us);
      }
      places[i].late_us = std::max(late_us, places[i].early_us);
    }
    set_likely(frames, places);
    run_.loose.insert(run_.loose.end(), places.begin(), places.end());
  }

  // Puts an effect right after its cause, a cause right before its effect, others evenly between.
  void set_likely(const std::vector<std::uint32_t>& frames, const std::vector<LoosePlace>& places) {
    std::vector<std::pair<std::size_t, std::int64_t>> known;
    std::size_t next = 0;
    for (std::size_t i = 0; i < frames.size() && next < anchors_.size(); ++i) {
      if (anchors_[next].index != frames[i]) continue;
      known.emplace_back(i, anchors_[next].effect ? places[i].early_us : places[i].late_us);
      ++next;
    }
    std::size_t after = 0;
    std::int64_t before_us = kNoStamp;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      while (after < known.size() && known[after].first < i) ++after;
      std::int64_t at_us = 0;
      if (after == known.size()) {
        at_us = known.back().second;
      } else if (after == 0 || known[after].first == i) {
        at_us = known[after].second;
      } else {
        const auto& [from, from_us] = known[after - 1];
        const auto& [to, to_us] = known[after];
        const double part = static_cast<double>(i - from) / static_cast<double>(to - from);
        at_us = from_us + static_cast<std::int64_t>(part * static_cast<double>(to_us - from_us));
      }
      at_us = std::max(before_us, std::clamp(at_us, places[i].early_us, places[i].late_us));
      before_us = at_us;
      run_.seen[frames[i]].place.time_us = at_us;
      run_.seen[frames[i]].place.loose = true;
    }
  }

  Run& run_;
  std::uint32_t file_;
  const AlignOptions& options_;
  std::vector<Anchor> anchors_;
};

}  // namespace

std::optional<std::vector<std::uint32_t>> wrong_ways(const Run& run, std::uint32_t file) {
  std::vector<std::uint32_t> open;
  std::set<std::uint16_t> islands;
  for (std::uint32_t i = 0; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (seen.place.file != file || seen.kind != Observation::Kind::kSerial) continue;
    if (run.taps[seen.tap].shows_direction()) continue;
    if (const std::int32_t id = set_island_id(seen.frame); id >= 0) {
      islands.insert(static_cast<std::uint16_t>(id));
    }
    Net net;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) continue;
    if (const std::uint16_t island = island_shown(seen, net); island != kNoIsland)
      islands.insert(island);
    if (may_be_either(run, seen)) open.push_back(i);
    const bool within = net.src.devid != machine::kNullDevid &&
                        net.dest.devid != machine::kNullDevid && net.dest.pid == net.src.pid;
    if (within) return std::nullopt;  // A sink passes no such message on.
  }
  if (open.empty()) return open;
  if (islands.size() != 1) return std::nullopt;
  std::vector<std::uint32_t> out;
  for (const std::uint32_t i : open) {
    Net net;
    if (!parse_net(run.seen[i].frame.payload, net)) continue;
    const bool down = net.dest.pid == *islands.begin();
    if (!down && net.src.pid != *islands.begin()) return std::nullopt;
    if (down != run.seen[i].to_mote) out.push_back(i);
  }
  return out;
}

OrderFit fit_order(Run& run, std::uint32_t file, const OrderEvidence& evidence,
                   const AlignOptions& options) {
  return Ordering(run, file, options).fit(evidence);
}

}  // namespace rubric::check
