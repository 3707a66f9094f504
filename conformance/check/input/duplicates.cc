#include "conformance/check/input/duplicates.h"

#include <algorithm>
#include <map>
#include <vector>

#include "conformance/check/message.h"

namespace rubric::check {
namespace {

using machine::Link;

// What a capture has of the air, or of one serial line, in order.
struct Source {
  std::uint32_t file = 0;
  std::uint32_t tap = 0;  // Of the air, which may have several in a file, the first.
  Link link = Link::kRadio;
  bool timed = true;
  std::int64_t first_us = 0;
  std::int64_t last_us = 0;
  std::vector<std::uint32_t> frames;  // Indices into Run::seen.
};

bool is_frame(const Observation& seen) {
  return seen.kind == Observation::Kind::kRadio || seen.kind == Observation::Kind::kSerial;
}

bool same_frame(const Observation& a, const Observation& b) {
  return a.kind == b.kind && (!a.has_dsn || !b.has_dsn || a.dsn == b.dsn) &&
         a.frame.dest == b.frame.dest && a.frame.src == b.frame.src &&
         a.frame.type == b.frame.type && equal(a.frame.payload, b.frame.payload);
}

// Two sinks that hear a mote may both hand up what it sends from one island to another.
bool between_islands(const Observation& seen) {
  Net net;
  return seen.frame.type == am::kNet && parse_net(seen.frame.payload, net) &&
         net.src.pid != net.dest.pid;
}

// How two sources overlap.
struct Shared {
  std::size_t of_a = 0;  // Frames of each that could be in the other.
  std::size_t of_b = 0;
  std::vector<std::uint32_t> matched;  // Of b.
  bool upward = false;                 // A sink's frame among them: only its own line has that.
  std::uint32_t alone = 0;             // A frame of b that a has not.
};

class Duplicates {
 public:
  Duplicates(Run& run, const Options& options) : run_(run), options_(options) {}

  bool drop(std::string& error) {
    collect();
    if (!logs_fit(error)) return false;
    dropped_.assign(run_.seen.size(), false);
    drop_logged();
    for (std::size_t b = 1; b < sources_.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        if (sources_[a].file == sources_[b].file || sources_[a].link != sources_[b].link) continue;
        if (!compare(sources_[a], sources_[b], error)) return false;
      }
    }
    if (std::find(dropped_.begin(), dropped_.end(), true) == dropped_.end()) return true;
    std::size_t i = 0;
    std::erase_if(run_.seen, [&](const Observation&) { return dropped_[i++]; });
    run_.has_time = std::all_of(run_.seen.begin(), run_.seen.end(),
                                [](const Observation& seen) { return seen.place.timed(); });
    return true;
  }

 private:
  bool has(const Source& source, const Observation& seen) const {
    if (!seen.node.empty() || seen.place.file != source.file) return false;
    const bool radio = source.link == Link::kRadio && run_.taps[seen.tap].link == Link::kRadio;
    return seen.tap == source.tap || radio;
  }

  void collect() {
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) {
      const Observation& seen = run_.seen[i];
      const Link link = run_.taps[seen.tap].link;
      const bool radio = link == Link::kRadio && seen.kind == Observation::Kind::kLinkAck;
      if (!(is_frame(seen) || radio) || !seen.node.empty()) continue;
      auto source = std::ranges::find_if(sources_, [&](const Source& s) { return has(s, seen); });
      if (source == sources_.end()) {
        const std::int64_t time_us = seen.place.time_us;
        source =
            sources_.insert(source, {seen.place.file, seen.tap, link, true, time_us, time_us, {}});
      }
      source->timed = source->timed && seen.place.timed();
      source->last_us = seen.place.time_us;
      source->frames.push_back(i);
    }
    std::ranges::sort(sources_, {}, &Source::tap);
  }

  std::string file(std::uint32_t index) const { return run_.files[index]; }

  // Checks that each node has one log.
  bool logs_fit(std::string& error) const {
    std::map<std::string_view, std::uint32_t> log_of;
    for (const Observation& seen : run_.seen) {
      if (seen.node.empty()) continue;
      const auto [known, added] = log_of.emplace(seen.node, seen.place.file);
      if (added || known->second == seen.place.file) continue;
      error = file(seen.place.file) + ": what node " + std::string(seen.node) + " did is in " +
              file(known->second) +
              " as well; give one log of each node, or leave one out with --frames N:none";
      return false;
    }
    return true;
  }

  // Leaves frames that logs have at the time of a capture of that link to the capture: which of
  // them are the same cannot be told. What a node was given is then no longer known.
  void drop_logged() {
    using Links = std::pair<std::uint32_t, Link>;
    std::map<Links, std::uint32_t> captured;  // Files of captures, by logs and links.
    for (const Observation& seen : run_.seen) {
      if (seen.node.empty() || !is_frame(seen)) continue;
      const Link link = run_.taps[seen.tap].link;
      for (const Source& source : sources_) {
        if (source.link != link) continue;
        if (seen.place.time_us < source.first_us || seen.place.time_us > source.last_us) continue;
        captured.emplace(Links(seen.place.file, link), source.file);
        break;
      }
    }
    for (const auto& [log, capture] : captured) {
      const auto& [log_file, link] = log;
      run_.facts.push_back(file(log_file) + ": its frames " +
                           (link == Link::kRadio ? "on the air" : "of serial lines") +
                           " are left out, as " + file(capture) + " has them");
      for (LoggedNode& node : run_.nodes) {
        if (node.file != log_file) continue;
        const bool base_station = node.role == machine::Role::kBaseStation;
        if (node.hearing && node.role == machine::Role::kSink && link == Link::kRadio) {
          node.requests = requests_given(node);
        }
        node.hearing = node.hearing && (link == Link::kRadio) == base_station;
        node.whole = false;
      }
    }
    for (std::size_t i = 0; i < run_.seen.size(); ++i) {
      const Observation& seen = run_.seen[i];
      dropped_[i] = !seen.node.empty() && is_frame(seen) &&
                    captured.contains({seen.place.file, run_.taps[seen.tap].link});
    }
  }

  GivenRequests requests_given(const LoggedNode& sink) const {
    GivenRequests out;
    Request request;
    for (const Observation& seen : run_.seen) {
      if (seen.node.empty() || seen.place.file != sink.file) continue;
      out.from_us = std::min(out.from_us, seen.place.time_us);
      out.to_us = std::max(out.to_us, seen.place.time_us);
      if (seen.node == sink.name && seen.received && seen.frame.type == am::kJoin &&
          parse_request(seen.frame.payload, request)) {
        out.all.push_back({seen.place.time_us, seen.frame.src, request.seq_num});
      }
    }
    return out;
  }

  // Counts frames that both have between `lo` and `hi`, one for one.
  Shared shared(const Source& a, const Source& b, std::int64_t lo, std::int64_t hi) const {
    Shared out;
    const bool timed = a.timed && b.timed;
    const auto within = [&](std::uint32_t i) {
      const std::int64_t at = run_.seen[i].place.time_us;
      return !timed || (at >= lo && at <= hi);
    };
    for (const std::uint32_t i : a.frames) out.of_a += within(i) ? 1 : 0;
    std::vector<bool> used(timed ? a.frames.size() : 0);
    out.matched.reserve(b.frames.size());
    std::size_t from = 0;
    bool alone = false;
    for (const std::uint32_t i : b.frames) {
      if (!within(i)) continue;
      ++out.of_b;
      const Observation& seen = run_.seen[i];
      const auto early = [&](const Observation& other) {
        return timed && other.place.time_us < seen.place.time_us - options_.skew_us;
      };
      while (from < a.frames.size() && early(run_.seen[a.frames[from]])) ++from;
      std::size_t k = from;
      for (; k < a.frames.size(); ++k) {
        const Observation& other = run_.seen[a.frames[k]];
        if (timed && other.place.time_us > seen.place.time_us + options_.skew_us) {
          k = a.frames.size();
          break;
        }
        if (!(timed && used[k]) && same_frame(other, seen)) break;
      }
      if (k >= a.frames.size()) {
        if (!alone) out.alone = i;
        alone = true;
        continue;
      }
      out.matched.push_back(i);
      out.upward = out.upward || (!seen.to_mote && !between_islands(seen));
      if (timed) used[k] = true;
      if (!timed) from = k + 1;
    }
    return out;
  }

  bool compare(const Source& a, const Source& b, std::string& error) {
    const bool timed = a.timed && b.timed;
    const std::int64_t lo = std::max(a.first_us, b.first_us) - (timed ? options_.skew_us : 0);
    const std::int64_t hi = std::min(a.last_us, b.last_us) + (timed ? options_.skew_us : 0);
    if (timed && std::max(a.first_us, b.first_us) > std::min(a.last_us, b.last_us)) return true;
    const Shared b_in_a = shared(a, b, lo, hi);
    if (b_in_a.of_a == 0 || b_in_a.of_b == 0) return true;
    if (b_in_a.matched.size() == b_in_a.of_b && (a.timed || !b.timed))
      return drop(b, a, b_in_a, lo, hi);
    const Shared a_in_b = shared(b, a, lo, hi);
    if (a_in_b.matched.size() == a_in_b.of_b) return drop(a, b, a_in_b, lo, hi);
    if (b_in_a.matched.size() == b_in_a.of_b) return drop(b, a, b_in_a, lo, hi);
    const bool radio = a.link == Link::kRadio;
    // Two sniffers of one air each miss frames.
    if (radio && timed && 2 * b_in_a.matched.size() >= std::min(b_in_a.of_a, b_in_a.of_b)) {
      for (const std::uint32_t i : b_in_a.matched) dropped_[i] = true;
      return judged_once(b, a, b_in_a.matched.size());
    }
    if (radio ? !a.timed && !b.timed : !b_in_a.upward) return true;  // Other times, other lines.
    error = file(b.file) + ": frame " + std::to_string(run_.seen[b_in_a.alone].place.frame) +
            " is not in " + file(a.file) + ", which is of the same " +
            (radio ? "air" : "serial line") +
            (timed ? " at the same time" : "; without time stamps they cannot be put in order") +
            ". Give one of the two, or parts that do not overlap, as with --frames " +
            std::to_string(b.file + 1) + ":none";
    return false;
  }

  // Drops all of `which` that `other` has too.
  bool drop(const Source& which, const Source& other, const Shared& what, std::int64_t lo,
            std::int64_t hi) {
    for (std::size_t i = 0; i < run_.seen.size(); ++i) {
      const Observation& seen = run_.seen[i];
      if (!has(which, seen)) continue;
      const std::int64_t at = seen.place.time_us;
      if (!which.timed || !other.timed || (at >= lo && at <= hi)) dropped_[i] = true;
    }
    return judged_once(which, other, what.matched.size());
  }

  bool judged_once(const Source& which, const Source& other, std::size_t frames) {
    run_.facts.push_back(file(which.file) + ": " + std::to_string(frames) +
                         (frames == 1 ? " frame is" : " frames are") + " in " + file(other.file) +
                         " as well and judged once");
    return true;
  }

  Run& run_;
  const Options& options_;
  std::vector<Source> sources_;
  std::vector<bool> dropped_;
};

}  // namespace

bool drop_duplicates(Run& run, const Options& options, std::string& error) {
  if (run.files.size() < 2) return true;
  return Duplicates(run, options).drop(error);
}

}  // namespace rubric::check
