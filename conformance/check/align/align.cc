#include "conformance/check/align/align.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "conformance/check/align/align_clock.h"
#include "conformance/check/align/align_frames.h"
#include "conformance/check/align/align_logs.h"
#include "conformance/check/align/align_order.h"
#include "conformance/check/message.h"

namespace rubric::check {
namespace {

constexpr std::size_t kPassedMin = 3;  // Fewer frames between two logs may be a chance.

std::string decimal(double value, int places, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f %s", places, value, unit);
  return text;
}

struct File {
  bool frames = false;  // It is a capture.
  bool log = false;
  bool timed = false;  // Some have stamps.
  bool radio = false;
  bool serial = false;
  bool moved = false;       // It was shifted by frames it shares with another.
  bool settled = false;     // On a clock, or left as it is.
  bool stepped = false;     // Its clock stepped: no one shift fits.
  std::uint32_t clock = 0;  // The first file on the same one.
  std::int64_t first_us = 0;
  std::int64_t last_us = 0;
};

class Alignment {
 public:
  Alignment(Run& run, const AlignOptions& options, bool own_zero)
      : run_(run), options_(options), own_zero_(own_zero), files_(run.files.size()) {}

  void align() {
    look();
    const auto captures =
        std::count_if(files_.begin(), files_.end(), [](const File& f) { return f.frames; });
    const auto logs = std::ranges::count_if(files_, &File::log);
    if (captures + logs < 2) return;
    sightings_ = sightings_of(run_);
    if (logs > 0) add_logged(run_, sightings_);
    if (captures > 0) return place_files();
    place_logs();
    bound_nodes();
  }

 private:
  void place_files() {
    while (const std::optional<std::uint32_t> next = first_unsettled()) {
      while (settle_one()) continue;
    }
    mark_lines();
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (files_[i].frames && !files_[i].timed) order(i);
    }
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (files_[i].log) place_log(i);
    }
  }

  // Says of each node when its log shows what it does.
  void bound_nodes() {
    std::vector<std::int64_t> from_us(files_.size(), INT64_MAX);
    std::vector<std::int64_t> to_us(files_.size(), INT64_MIN);
    for (const Observation& seen : run_.seen) {
      const std::int64_t time_us = seen.place.time_us;
      if (time_us == kNoStamp) continue;
      from_us[seen.place.file] = std::min(from_us[seen.place.file], time_us);
      to_us[seen.place.file] = std::max(to_us[seen.place.file], time_us);
    }
    for (LoggedNode& node : run_.nodes) {
      if (node.whole) continue;
      node.from_us = from_us[node.file];
      node.to_us = to_us[node.file];
    }
  }

  void look() {
    for (const Observation& seen : run_.seen) {
      const bool radio = seen.kind == Observation::Kind::kRadio;
      files_[seen.place.file].log = !seen.node.empty();
      if (!seen.node.empty() || !(radio || seen.kind == Observation::Kind::kSerial)) continue;
      File& file = files_[seen.place.file];
      file.frames = true;
      (radio ? file.radio : file.serial) = true;
      const std::int64_t time_us = seen.place.time_us;
      if (time_us == kNoStamp) continue;
      file.first_us = file.timed ? std::min(file.first_us, time_us) : time_us;
      file.last_us = file.timed ? std::max(file.last_us, time_us) : time_us;
      file.timed = true;
    }
    for (const ClockStep& step : run_.steps) {
      if (!step.alone()) files_[step.file].stepped = true;
    }
  }

  // Returns the first file that is not settled, which begins a clock of its own.
  std::optional<std::uint32_t> first_unsettled() {
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (!files_[i].timed || files_[i].settled) continue;
      files_[i].clock = i;
      stay(i);
      files_[i].settled = true;
      return i;
    }
    return std::nullopt;
  }

  // Settles the file that has most in common with a settled one. What two sniffers of one air heard
  // says more than what waited for a line.
  bool settle_one() {
    std::optional<ClockFit> best;
    std::uint32_t best_a = 0;
    std::uint32_t best_b = 0;
    for (std::uint32_t b = 0; b < files_.size(); ++b) {
      if (!files_[b].timed || files_[b].settled || files_[b].stepped) continue;
      for (std::uint32_t a = 0; a < files_.size(); ++a) {
        if (!files_[a].timed || !files_[a].settled || files_[a].stepped) continue;
        const ClockFit fit = fitted(a, b);
        if (fit.clocks == Clocks::kUnsure) continue;
        if (best && std::pair(best->same, best->frames) >= std::pair(fit.same, fit.frames))
          continue;
        best = fit;
        best_a = a;
        best_b = b;
      }
    }
    if (!best) return false;
    if (best->clocks == Clocks::kDiffer) {
      move(best_a, best_b, *best);
    } else if (best->same) {
      bring_together(best_a, best_b, *best);
    }
    files_[best_b].settled = true;
    files_[best_b].clock = files_[best_a].clock;
    return true;
  }

  // Puts clocks that agree on that of the file with more frames, as each_once() takes it: what one
  // file missed of an exchange is then in its place.
  void bring_together(std::uint32_t a, std::uint32_t b, const ClockFit& fit) {
    const auto on_clock = [&](std::uint32_t file) {
      return files_[file].settled && files_[file].clock == files_[a].clock;
    };
    bool most = true;
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      most = most && !(on_clock(i) && sightings_[i].size() >= sightings_[b].size());
    }
    for (Observation& seen : run_.seen) {
      std::int64_t& time_us = seen.place.time_us;
      if (!seen.node.empty() || time_us == kNoStamp) continue;
      if (most ? !on_clock(seen.place.file) : seen.place.file != b) continue;
      time_us = most ? fit.moved_back(time_us) : fit.moved(time_us);
    }
  }

  ClockFit fitted(std::uint32_t a, std::uint32_t b) {
    const CommonFrames common = common_of(a, b);
    if (!goes_on(a, b, common)) return fit_clock(run_, common, options_);
    return {.clocks = Clocks::kAgree, .frames = common.pairs.size()};
  }

  // Returns whether one file begins where the other ends, as when a recorder begins another, and
  // what they have in common was under way then: that it waited says nothing about their clocks.
  bool goes_on(std::uint32_t a, std::uint32_t b, const CommonFrames& common) const {
    const auto all = [](const File& file) { return file.radio && file.serial; };
    const auto after = [&](std::uint32_t first, std::uint32_t next) {
      return files_[next].first_us >= files_[first].last_us;
    };
    if (!all(files_[a]) || !all(files_[b]) || !(after(a, b) || after(b, a))) return false;
    return !common.pairs.empty() && std::ranges::all_of(common.pairs, [&](const Pair& pair) {
      const std::int64_t ahead_us =
          run_.seen[pair.b].place.time_us - run_.seen[pair.a].place.time_us;
      return pair.lag_sign != 0 && pair.lag_sign * ahead_us >= pair.lag_min_us &&
             pair.lag_sign * ahead_us <= options_.response_us;
    });
  }

  // Returns the frames that two files with stamps have in common. A line is compared with all
  // sniffers on the clock of `a`, since one of them may have missed frames or heard them late.
  CommonFrames common_of(std::uint32_t a, std::uint32_t b) {
    const auto sniffer = [](const File& file) { return file.timed && file.radio && !file.serial; };
    if (!sniffer(files_[a]) || files_[b].radio) {
      return common_frames(run_, sightings_[a], sightings_[b]);
    }
    std::vector<const std::vector<Sighting>*> sniffers;
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      const bool one_clock = files_[i].settled && files_[i].clock == files_[a].clock;
      if (sniffer(files_[i]) && one_clock) sniffers.push_back(&sightings_[i]);
    }
    std::vector<Sighting> air = each_once(run_, sniffers, options_.skew_us);
    return common_frames(run_, air, sightings_[b]);
  }

  void move(std::uint32_t a, std::uint32_t b, const ClockFit& fit) {
    for (Observation& seen : run_.seen) {
      if (seen.place.file != b || !seen.node.empty() || seen.place.time_us == kNoStamp) continue;
      seen.place.time_us = fit.moved(seen.place.time_us);
    }
    files_[b].moved = true;
    run_.slack_us = std::max(run_.slack_us, std::min(fit.slack_us, options_.response_us));
    say_moved(a, b, fit);
  }

  void say_moved(std::uint32_t a, std::uint32_t b, const ClockFit& fit) {
    std::string text = run_.files[b] + " is aligned with " + run_.files[a] + " by " +
                       std::to_string(fit.frames) + " common frames: its clock is " +
                       decimal(std::abs(static_cast<double>(fit.offset_us)) / 1e6, 6, "s") +
                       (fit.offset_us < 0 ? " behind" : " ahead") + " (spread " +
                       decimal(fit.spread_us / 1000, 1, "ms");
    if (fit.drift != 0) text += ", drift " + decimal(fit.drift * 1e6, 1, "ppm");
    run_.facts.push_back(text + ")");
  }

  // Says why file `b` shares no clock with those before. It is taken to share one only where
  // nothing suggests otherwise.
  void stay(std::uint32_t b) {
    bool said = false;
    for (std::uint32_t a = 0; a < files_.size(); ++a) {
      if (!files_[a].settled) continue;
      const bool other = files_[a].radio != files_[b].radio || files_[a].serial != files_[b].serial;
      const CommonFrames common = common_of(a, b);
      const bool some = !common.pairs.empty() || !common.guesses.empty();
      const bool steps = files_[a].stepped || files_[b].stepped;
      if (!some && !other) continue;
      if (!said) {
        run_.facts.push_back(run_.files[b] + " is not aligned with " + run_.files[a] + ": " +
                             (steps ? "a clock steps" : fit_clock(run_, common, options_).why));
      }
      said = true;
      const bool apart = files_[b].first_us > files_[a].last_us + options_.response_us ||
                         files_[a].first_us > files_[b].last_us + options_.response_us;
      const bool could = !common.only_a.empty() && !common.only_b.empty();
      if (!some && !could && !apart && !steps) files_[b].clock = files_[a].clock;
    }
  }

  // Puts a log on the clock of the air's first capture, or of the first one with stamps.
  void place_log(std::uint32_t b) {
    const auto timed = std::ranges::find_if(files_, &File::timed);
    const std::uint32_t a = air_file().value_or(static_cast<std::uint32_t>(timed - files_.begin()));
    CommonFrames common;
    bool steps = false;
    for (std::uint32_t i = 0; timed != files_.end() && i < files_.size(); ++i) {
      if (!files_[i].timed || files_[i].clock != files_[a].clock) continue;
      steps = steps || files_[i].stepped;
      CommonFrames its = common_frames(run_, sightings_[i], sightings_[b]);
      // Clocks of captures are one within the skew, and a line may be later than it was put.
      const std::int64_t apart_us = i == a ? 0 : options_.skew_us + run_.slack_us;
      for (Pair& pair : its.pairs) pair.lag_min_us -= apart_us;
      common.pairs.insert(common.pairs.end(), its.pairs.begin(), its.pairs.end());
    }
    std::vector<Pair> passed;  // Between it and other logs.
    for (const LogClock& log : run_.logs) {
      if (!log.known) continue;
      const std::vector<Pair> its = common_of_logs(log.file, b);
      passed.insert(passed.end(), its.begin(), its.end());
    }
    // What passed between nodes is exact; other events may have waited.
    if (passed.size() >= kPassedMin) common.pairs = passed;
    ClockFit fit;
    if (steps) {
      fit.why = "a clock steps";
    } else if (timed != files_.end()) {
      fit = fit_log(run_, common, options_, own_zero_);
    } else {
      fit.why = "no capture has time stamps";
    }
    put_log(timed == files_.end() ? 0 : a, b, fit, common.pairs);
    if (fit.clocks != Clocks::kUnsure) join_lines(passed);
  }

  // Returns what one log's node sent, and the other log's was given.
  std::vector<Pair> common_of_logs(std::uint32_t a, std::uint32_t b) {
    CommonFrames its = common_frames(run_, sightings_[a], sightings_[b]);
    std::erase_if(its.pairs, [](const Pair& pair) { return pair.how != Common::kPassed; });
    return std::move(its.pairs);
  }

  // Puts logs without captures on the clock of the first one, those first that have most in common
  // with what is there.
  void place_logs() {
    std::vector<std::uint32_t> rest;
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (files_[i].log) rest.push_back(i);
    }
    const std::uint32_t first = rest.front();
    run_.logs.push_back({first});
    std::vector<std::uint32_t> placed{first};
    std::vector<CommonFrames> common(files_.size());
    for (rest.erase(rest.begin()); !rest.empty();) {
      for (const std::uint32_t b : rest) {
        const std::vector<Pair> its = common_of_logs(placed.back(), b);
        common[b].pairs.insert(common[b].pairs.end(), its.begin(), its.end());
      }
      const auto next = std::ranges::max_element(
          rest, {}, [&](std::uint32_t b) { return common[b].pairs.size(); });
      const std::uint32_t b = *next;
      rest.erase(next);
      put_log(first, b, fit_log(run_, common[b], options_, own_zero_), common[b].pairs);
      join_lines(common[b].pairs);
      placed.push_back(b);
    }
  }

  // Gives the lines that pass such a frame one tap: both ends kept a log of one line. Frames for
  // all islands tell nothing, as they pass on the lines of many.
  void join_lines(const std::vector<Pair>& passed) {
    std::vector<std::uint32_t> tap(run_.taps.size());
    std::iota(tap.begin(), tap.end(), 0);
    for (const Pair& pair : passed) {
      const Observation& seen = run_.seen[pair.b];
      Net net;
      const bool message = seen.frame.type == am::kNet && parse_net(seen.frame.payload, net);
      const bool all = message && net.dest.pid == machine::kBroadcastPid;
      if (!all) tap[seen.tap] = run_.seen[pair.a].tap;
    }
    for (Observation& seen : run_.seen) seen.tap = tap[seen.tap];
  }

  void put_log(std::uint32_t a, std::uint32_t b, const ClockFit& fit,
               const std::vector<Pair>& pairs) {
    if (fit.clocks == Clocks::kDiffer) {
      move_log(run_, b, [&](std::int64_t time_us) { return fit.moved(time_us); });
      say_moved(a, b, fit);
    } else if (fit.clocks == Clocks::kUnsure) {
      run_.facts.push_back(run_.files[b] + " is not aligned with " + run_.files[a] + ": " +
                           fit.why);
    }
    const bool known = fit.clocks != Clocks::kUnsure;
    const std::uint64_t step = known ? 0 : step_of_log(run_, b, pairs, options_);
    run_.logs.push_back({b, known, fit.earlier_us, fit.slack_us, step});
  }

  // Orders a file without stamps among those on the air's clock.
  void order(std::uint32_t b) {
    const std::optional<std::uint32_t> air = air_file();
    if (!air) return;
    const std::optional<std::vector<std::uint32_t>> turned = wrong_ways(run_, b);
    if (turned) turn(*turned, b);
    const OrderEvidence evidence = evidence_of(b, *air);
    if (shared_with_timed(b, *air) > evidence.pairs.size()) {  // See duplicates.h.
      if (turned) turn(*turned, b);
      return;
    }
    OrderFit fit{.why = "frames between islands may go either way on its line"};
    if (turned) fit = fit_order(run_, b, evidence, options_);
    const std::string other = run_.files[*air];
    if (!fit.good) {
      if (turned) turn(*turned, b);
      run_.facts.push_back(run_.files[b] + ", which has no time stamps, is not aligned with " +
                           other + ": " + fit.why);
      return;
    }
    run_.facts.push_back(run_.files[b] + ", which has no time stamps, is in order with " + other +
                         " by " + std::to_string(fit.frames) + " common frames, between which " +
                         std::to_string(fit.between) + " of its " + std::to_string(fit.all) +
                         " frames lie");
  }

  // Returns what `b` has in common with the air. A frame that several sniffers heard counts once.
  OrderEvidence evidence_of(std::uint32_t b, std::uint32_t air) {
    std::vector<const std::vector<Sighting>*> timed;
    for (std::uint32_t a = 0; a < files_.size(); ++a) {
      if (files_[a].timed && files_[a].clock == files_[air].clock) timed.push_back(&sightings_[a]);
    }
    std::vector<Sighting> others = each_once(run_, timed, options_.skew_us);
    if (!files_[b].radio) {  // Frames of another line pass to no other.
      std::erase_if(others, [&](const Sighting& one) {
        return run_.seen[one.index].kind != Observation::Kind::kRadio;
      });
    }
    CommonFrames common = common_frames(run_, others, sightings_[b]);
    std::erase_if(common.pairs,
                  [&](const Pair& pair) { return run_.seen[pair.a].place.time_us == kNoStamp; });
    return {std::move(common.pairs), std::move(common.only_a), std::move(common.only_b)};
  }

  // Counts the frames of `b` that a line with stamps has as well.
  std::size_t shared_with_timed(std::uint32_t b, std::uint32_t air) {
    std::set<std::uint32_t> same;
    for (std::uint32_t a = 0; a < files_.size(); ++a) {
      if (!files_[a].timed || files_[a].clock != files_[air].clock) continue;
      for (const Pair& pair : common_frames(run_, sightings_[a], sightings_[b]).pairs) {
        if (pair.how == Common::kSame) same.insert(pair.b);
      }
    }
    return same.size();
  }

  // Reverses the direction of these frames of `b`.
  void turn(const std::vector<std::uint32_t>& frames, std::uint32_t b) {
    if (frames.empty()) return;
    for (const std::uint32_t i : frames) run_.seen[i].to_mote = !run_.seen[i].to_mote;
    sightings_[b] = std::move(sightings_of(run_)[b]);
  }

  std::optional<std::uint32_t> air_file() const {
    const auto air = std::find_if(files_.begin(), files_.end(),
                                  [](const File& f) { return f.timed && f.radio; });
    if (air == files_.end()) return std::nullopt;
    return static_cast<std::uint32_t>(air - files_.begin());
  }

  // Marks lines on another clock than the air's first capture, and those that were put on it.
  void mark_lines() {
    const std::optional<std::uint32_t> air = air_file();
    if (!air) return;
    for (const Observation& seen : run_.seen) {
      const File& file = files_[seen.place.file];
      if (!seen.node.empty() || seen.kind != Observation::Kind::kSerial || !file.timed) continue;
      const bool own = file.clock != files_[*air].clock;
      if (!own && (seen.place.file == *air || !(file.moved || files_[*air].moved))) continue;
      std::vector<bool>& taps = own ? run_.unordered_taps : run_.slack_taps;
      taps.resize(run_.taps.size());
      taps[seen.tap] = true;
    }
  }

  Run& run_;
  const AlignOptions& options_;
  const bool own_zero_;
  std::vector<File> files_;
  std::vector<std::vector<Sighting>> sightings_;
};

}  // namespace

void align(Run& run, const AlignOptions& options, bool own_zero) {
  if (options.enabled && run.files.size() > 1) Alignment(run, options, own_zero).align();
}

}  // namespace rubric::check
