#include "conformance/oracle/align.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "conformance/oracle/align_clock.h"
#include "conformance/oracle/align_frames.h"

namespace rubric::oracle {
namespace {

std::string decimal(double value, int places, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f %s", places, value, unit);
  return text;
}

struct File {
  bool frames = false;       // Of captures.
  bool timed = false;        // Some have stamps.
  bool radio = false;
  bool serial = false;
  bool settled = false;      // On the common clock, or left as it is.
};

class Alignment {
 public:
  Alignment(Run& run, const AlignOptions& options)
      : run_(run), options_(options), files_(run.files.size()) {}

  void align() {
    look();
    const auto captures =
        std::count_if(files_.begin(), files_.end(), [](const File& f) { return f.frames; });
    if (captures < 2) return;
    sightings_ = sightings_of(run_);
    while (const std::optional<std::uint32_t> next = first_unsettled()) {
      files_[*next].settled = true;  // The first, or one that nothing puts beside those before.
      while (settle_one()) continue;
    }
  }

 private:
  void look() {
    for (const Observation& seen : run_.seen) {
      const bool radio = seen.kind == Observation::Kind::kRadio;
      if (!seen.node.empty() || !(radio || seen.kind == Observation::Kind::kSerial)) continue;
      File& file = files_[seen.place.file];
      file.frames = true;
      file.timed = file.timed || seen.place.time_us != kNoStamp;
      (radio ? file.radio : file.serial) = true;
    }
  }

  std::optional<std::uint32_t> first_unsettled() {
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (!files_[i].timed || files_[i].settled) continue;
      say_why_not(i);
      return i;
    }
    return std::nullopt;
  }

  // Takes the file that has most in common with one of those that are settled.
  bool settle_one() {
    std::optional<ClockFit> best;
    std::uint32_t best_a = 0;
    std::uint32_t best_b = 0;
    for (std::uint32_t b = 0; b < files_.size(); ++b) {
      if (!files_[b].timed || files_[b].settled) continue;
      for (std::uint32_t a = 0; a < files_.size(); ++a) {
        if (!files_[a].timed || !files_[a].settled) continue;
        const ClockFit fit = fitted(a, b);
        if (fit.clocks == Clocks::kUnsure || (best && best->frames >= fit.frames)) continue;
        best = fit;
        best_a = a;
        best_b = b;
      }
    }
    if (!best) return false;
    files_[best_b].settled = true;
    if (best->clocks == Clocks::kDiffer) move(best_a, best_b, *best);
    return true;
  }

  ClockFit fitted(std::uint32_t a, std::uint32_t b) {
    return fit_clock(run_, common_frames(run_, sightings_[a], sightings_[b]), options_);
  }

  void move(std::uint32_t a, std::uint32_t b, const ClockFit& fit) {
    for (Observation& seen : run_.seen) {
      if (seen.place.file != b || !seen.node.empty() || seen.place.time_us == kNoStamp) continue;
      seen.place.time_us = fit.moved(seen.place.time_us);
    }
    std::string text = run_.files[b] + " is aligned with " + run_.files[a] + " by " +
                       std::to_string(fit.frames) + " common frames: its clock is " +
                       decimal(std::abs(static_cast<double>(fit.offset_us)) / 1e6, 6, "s") +
                       (fit.offset_us < 0 ? " behind" : " ahead") + " (spread " +
                       decimal(fit.spread_us / 1000, 1, "ms");
    if (fit.drift != 0) text += ", drift " + decimal(fit.drift * 1e6, 1, "ppm");
    run_.facts.push_back(text + ")");
  }

  // Of a file that has frames in common with one before, or the other kind of link.
  void say_why_not(std::uint32_t b) {
    for (std::uint32_t a = 0; a < files_.size(); ++a) {
      if (!files_[a].settled) continue;
      const bool other = files_[a].radio != files_[b].radio || files_[a].serial != files_[b].serial;
      const CommonFrames common = common_frames(run_, sightings_[a], sightings_[b]);
      if (common.pairs.empty() && !other) continue;
      const ClockFit fit = fit_clock(run_, common, options_);
      run_.facts.push_back(run_.files[b] + " is not aligned with " + run_.files[a] + ": " +
                           fit.why);
      return;
    }
  }

  Run& run_;
  const AlignOptions& options_;
  std::vector<File> files_;
  std::vector<std::vector<Sighting>> sightings_;
};

}  // namespace

void align(Run& run, const AlignOptions& options) {
  if (options.enabled && run.files.size() > 1) Alignment(run, options).align();
}

}  // namespace rubric::oracle
