#include "conformance/check/align/steps.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "conformance/check/links.h"
#include "conformance/check/message.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kJitterUs = 10'000;          // Frames that a recorder's buffer turned round.
constexpr std::int64_t kAcrossUs = 50'000;          // The same between two taps of it.
constexpr std::int64_t kGoesOnUs = 1'000;           // How soon the first frame after a step comes.
constexpr std::int64_t kLateAckUs = kLinkRepeatUs;  // Else of a copy that escaped.
constexpr std::size_t kInterruptedMax = 4;          // More often it is the nodes that are slow;
constexpr std::size_t kFramesEach = 10;             // in a short file more often than this.
constexpr std::int64_t kSlowestUs = 1'000'000;      // Nobody waits for nodes that are slower.
constexpr std::int64_t kHiddenUs = 1'000'000;       // A step forth that nothing shows is no longer.
constexpr std::int64_t kLongUs = 5'000'000;         // No node takes so long.
constexpr std::int64_t kAckRepeatUs = 810'000;      // After its reply an ack_join comes no later.
constexpr std::int64_t kSilenceUs = 20'000'000;
constexpr std::int64_t kSilences = 10;     // Times the longest of the others.
constexpr std::size_t kManyFrames = 40;    // With fewer no silence is long by itself.
constexpr std::int64_t kAloneTimes = 100;  // So much closer are the neighbours of a wrong stamp.
constexpr std::size_t kTurnedMax = 8;
constexpr std::size_t kBlockFrames = 3;  // At least, where a file has its taps in blocks.
constexpr std::uint8_t kDsnGapMax = 8;   // Beyond it a DSN is another sender's.
constexpr std::size_t kFactsMax = 8;

std::string seconds(std::int64_t us) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(us) / 1e6);
  return text;
}

// An exchange of frames: what kind, between whom, with which number.
enum class Hop : std::uint8_t { kReply, kAckJoin, kRepeat, kReport, kUp, kDown, kAck };
using Exchange = std::tuple<Hop, std::uint64_t, std::uint16_t>;
struct HashOfExchange {
  std::size_t operator()(const Exchange& of) const {
    const auto& [hop, addresses, number] = of;
    return (addresses ^ (std::uint64_t{number} << 3 | static_cast<std::uint64_t>(hop)) << 24) *
           0x9e3779b97f4a7c15;
  }
};

std::uint64_t addresses_of(machine::Address src, machine::Address dest) {
  return std::uint64_t{dest.pid} << 48 | std::uint64_t{dest.devid} << 32 |
         std::uint64_t{src.pid} << 16 | src.devid;
}

void exchanges_of_net(const Observation& seen, std::vector<Exchange>& ends,
                      std::vector<Exchange>& begins) {
  Net net;
  if (!parse_net(seen.frame.payload, net) || !net.sound) return;
  const bool radio = seen.kind == Observation::Kind::kRadio;
  SerialJoined joined;
  if (!radio && !seen.to_mote && parse_serial_joined(net, joined)) {
    ends.emplace_back(Hop::kReport, joined.address.devid, joined.address.pid);
    return;
  }
  if (radio) ends.emplace_back(Hop::kDown, net.addresses(), net.seq_num);
  if (radio) begins.emplace_back(Hop::kUp, net.addresses(), net.seq_num);
  if (!radio && seen.to_mote) begins.emplace_back(Hop::kDown, net.addresses(), net.seq_num);
  if (!radio && !seen.to_mote) ends.emplace_back(Hop::kUp, net.addresses(), net.seq_num);
  const bool to_sink = seen.to_mote && net.dest.devid == machine::Profile{}.sink_id;
  const std::int32_t acked = net.is_ack() ? machine::acked_seq_num(net.body()) : -1;
  // A node answers where it hears the message; elsewhere a sink has to pass on one or both.
  const std::uint16_t by = acked >= 0 ? net.src.devid : net.dest.devid;
  const bool pc = by == machine::kNullDevid;
  if (radio ? pc : !pc && by != machine::Profile{}.sink_id) return;
  if (acked >= 0) {
    ends.emplace_back(Hop::kAck, addresses_of(net.dest, net.src),
                      static_cast<std::uint16_t>(acked));
  } else if (net.reliable == 1 && (net.src.pid == net.dest.pid || to_sink)) {
    begins.emplace_back(Hop::kAck, net.addresses(), net.seq_num);
  }
}

// Appends the exchanges that a frame ends, and those that it begins.
void exchanges(const Observation& seen, std::vector<Exchange>& ends,
               std::vector<Exchange>& begins) {
  const bool radio = seen.kind == Observation::Kind::kRadio;
  if (!radio && seen.kind != Observation::Kind::kSerial) return;
  const machine::Frame& frame = seen.frame;
  Request request;
  Reply reply;
  AckJoin ack;
  if (frame.type == am::kNet) {
    exchanges_of_net(seen, ends, begins);
  } else if (radio && frame.type == am::kJoin && parse_request(frame.payload, request)) {
    begins.emplace_back(Hop::kReply, frame.src, request.seq_num);
  } else if (radio && frame.type == am::kJoinReply && parse_reply(frame.payload, reply)) {
    ends.emplace_back(Hop::kReply, frame.dest, reply.seq_num);
    // Another sink's reply to the same request does not begin the mote's time anew.
    const std::uint64_t offered = addresses_of({reply.island, frame.dest}, {});
    begins.emplace_back(Hop::kAckJoin, offered, reply.seq_num);
    begins.emplace_back(Hop::kRepeat, offered, reply.seq_num);
  } else if (radio && frame.type == am::kAckJoin && parse_ack_join(frame.payload, ack)) {
    const std::uint64_t accepted = addresses_of({ack.src.pid, frame.src}, {});
    ends.emplace_back(Hop::kAckJoin, accepted, ack.seq_num);
    begins.emplace_back(Hop::kReport, ack.src.devid, ack.src.pid);
    ends.emplace_back(Hop::kRepeat, accepted, ack.seq_num);
    begins.push_back(ends.back());
  }
}

// One recorder's frames with stamps, in the order of the file.
class Recorded {
 public:
  Recorded(Run& run, std::vector<std::uint32_t> frames, std::int64_t response_us)
      : run_(run),
        frames_(std::move(frames)),
        response_us_(response_us),
        suspect_(frames_.size(), What::kGood) {
    for (const std::uint32_t i : frames_) stamps_.push_back(run.seen[i].place.time_us);
    std::size_t turned = 0;
    for (std::size_t i = 1; i < stamps_.size(); ++i) turned += stamps_[i] < stamps_[i - 1] ? 1 : 0;
    in_order_ = turned <= kTurnedMax;
    interrupted_max_ = std::clamp<std::size_t>(frames_.size() / kFramesEach, 1, kInterruptedMax);
  }

  void mend() {
    look_back();
    look_forth();
    go_on();
    keep_order();
  }
  bool stepped() const { return stepped_; }

 private:
  enum class What : std::uint8_t { kGood, kStep, kAlone };

  std::size_t tap(std::size_t i) const { return run_.seen[frames_[i]].tap; }

  void look_back() {
    std::vector<std::size_t> last(run_.taps.size(), SIZE_MAX);  // Of each tap.
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      const std::size_t own = last[tap(i)];
      last[tap(i)] = i;
      if (i == 0 || suspect_[i] != What::kGood) continue;
      const bool before_own =
          own != SIZE_MAX && good_between(own, i) && stamps_[i] < stamps_[own] - kJitterUs;
      const bool across = suspect_[i - 1] != What::kAlone &&
                          stamps_[i] < stamps_[i - 1] - (in_order_ ? kJitterUs : kAcrossUs);
      if (before_own || across) backwards(i, before_own ? own : i - 1);
    }
  }

  // Returns whether no step lies between two frames.
  bool good_between(std::size_t from, std::size_t to) const {
    if (suspect_[from] == What::kAlone) return false;
    for (std::size_t i = from + 1; i < to; ++i) {
      if (suspect_[i] == What::kStep) return false;
    }
    return true;
  }

  // Takes frame `i`, whose stamp is before that of frame `high`.
  void backwards(std::size_t i, std::size_t high) {
    const std::int64_t off_us = stamps_[high] - stamps_[i];
    // The stamp of `high` alone: it is after all that follow.
    const bool high_wrong = high == 0 || stamps_[i] >= stamps_[high - 1] - kJitterUs;
    // The stamp of `i` alone: it is before all that came.
    const bool low_wrong = i + 1 == stamps_.size() || stamps_[i + 1] >= stamps_[high] - kJitterUs;
    const auto near = [&](std::size_t from, std::size_t to) {
      return stamps_[to] - stamps_[from] < off_us / kAloneTimes;
    };
    if (high_wrong && !low_wrong && high > 0 && near(high - 1, i)) {
      suspect_[high] = What::kAlone;
      return;
    }
    if (low_wrong && !high_wrong && i + 1 < stamps_.size() && near(high, i + 1)) {
      suspect_[i] = What::kAlone;
      return;
    }
    suspect_[i] = What::kStep;
    if (high_wrong && high > 0) suspect_[high] = What::kStep;
    if (low_wrong && i + 1 < stamps_.size()) suspect_[i + 1] = What::kStep;
  }

  // Marks steps forth. Where there are some, shorter ones may hide in silences.
  void look_forth() {
    const auto steps = [&] { return std::ranges::count(suspect_, What::kStep); };
    const auto back = steps();
    mark_forth();
    if (steps() > back) run_.slack_us = std::max(run_.slack_us, kHiddenUs);
  }

  void mark_forth() {
    interrupted();
    // Among few frames the one that this acknowledges, with the same number, may not be captured.
    const bool many = stamps_.size() >= kManyFrames;
    const std::int64_t late_us = many ? kLateAckUs : kLongUs;
    std::int64_t longest = 0;
    std::int64_t second = 0;
    std::size_t at = 0;
    for (std::size_t i = 1; i < stamps_.size(); ++i) {
      if (suspect_[i] != What::kGood || suspect_[i - 1] == What::kAlone) continue;
      const std::int64_t gap = stamps_[i] - stamps_[i - 1];
      if (gap > late_us && late_ack(i) && nothing_lost(i, UINT8_MAX)) suspect_[i] = What::kStep;
      if (gap > longest) {
        second = longest;
        longest = gap;
        at = i;
      } else {
        second = std::max(second, gap);
      }
    }
    if (many && longest > kSilenceUs && longest > kSilences * second) suspect_[at] = What::kStep;
  }

  // Marks silences without which effects came in time after their causes. Where there are more
  // than a clock has steps the nodes are slow, so that their usual time is more.
  void interrupted() {
    const std::int64_t slowest_us = std::max(kSlowestUs, response_us_);
    for (std::int64_t usual_us = response_us_; usual_us <= slowest_us; usual_us += usual_us / 8) {
      const std::set<std::size_t> silences = silences_beyond(usual_us);
      if (silences.size() > interrupted_max_) continue;
      for (const std::size_t at : silences) suspect_[at] = What::kStep;
      return;
    }
  }

  // Returns these silences, by the frame after each, where nodes take `usual_us` to react.
  std::set<std::size_t> silences_beyond(std::int64_t usual_us) const {
    std::unordered_map<Exchange, std::size_t, HashOfExchange> causes;
    std::set<std::size_t> silences;
    std::vector<Exchange> ends;
    std::vector<Exchange> begins;
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      ends.clear();
      begins.clear();
      exchanges(run_.seen[frames_[i]], ends, begins);
      for (const Exchange& end : ends) {
        const auto cause = causes.find(end);
        if (cause == causes.end()) continue;
        const bool repeats = std::get<Hop>(end) == Hop::kRepeat;
        const std::vector<std::size_t> found =
            late_by_silence(cause->second, i, repeats ? kAckRepeatUs : usual_us, repeats);
        // A node may repeat too late by itself, so that these silences must be rare ones.
        const auto rare = [this](std::size_t at) { return stands_out(at); };
        if (repeats && !std::ranges::all_of(found, rare)) continue;
        for (const std::size_t at : found) {
          const bool long_silence = stamps_[at] - stamps_[at - 1] > kSilenceUs;
          if (repeats || long_silence || nothing_lost(at)) silences.insert(at);
        }
        if (!repeats) causes.erase(cause);
      }
      for (const Exchange& begin : begins) {
        const bool repeated = std::find(ends.begin(), ends.end(), begin) != ends.end();
        if (!repeated || !causes.contains(begin)) causes[begin] = i;  // The first counts.
      }
    }
    return silences;
  }

  // Returns whether no sender's DSNs show that frames before `at` are missing, more than those that
  // came damaged: then the cause may be one of these.
  bool nothing_lost(std::size_t at, std::uint8_t gap_max = kDsnGapMax) const {
    std::map<std::uint16_t, std::pair<std::uint8_t, std::size_t>> before;  // By address: the last
    std::size_t damaged = 0;                                               // DSN, and these so far.
    for (std::size_t i = 0; i < stamps_.size() && !(i >= at && before.empty()); ++i) {
      const Observation& seen = run_.seen[frames_[i]];
      damaged += seen.kind == Observation::Kind::kDamaged ? 1 : 0;
      if (seen.kind != Observation::Kind::kRadio || !seen.has_dsn) continue;
      const auto known = before.find(seen.frame.src);
      if (i < at) {
        before[seen.frame.src] = {seen.dsn, damaged};
      } else if (known != before.end()) {
        const auto ahead = static_cast<std::uint8_t>(seen.dsn - known->second.first);
        const bool gap = ahead > 1 + damaged - known->second.second;
        if (gap && ahead <= gap_max) return false;
        before.erase(known);
      }
    }
    return true;
  }

  // Returns the frames after the longest silences between two frames, if the time from one to the
  // other is more than `limit_us` and without these silences it is not. After the first one only
  // `several` count, or such as no node takes.
  std::vector<std::size_t> late_by_silence(std::size_t from, std::size_t to, std::int64_t limit_us,
                                           bool several) const {
    std::int64_t all_us = 0;
    std::vector<std::pair<std::int64_t, std::size_t>> gaps;
    for (std::size_t i = from + 1; i <= to; ++i) {
      if (suspect_[i] != What::kGood || suspect_[i - 1] == What::kAlone) continue;
      gaps.emplace_back(stamps_[i] - stamps_[i - 1], i);
      all_us += gaps.back().first;
    }
    std::sort(gaps.rbegin(), gaps.rend());
    std::vector<std::size_t> out;
    for (const auto& [gap_us, at] : gaps) {
      if (all_us <= limit_us) return out;
      if (out.size() == interrupted_max_) break;
      if (!out.empty() && !several && gap_us < kLongUs) break;
      all_us -= gap_us;
      out.push_back(at);
    }
    return all_us <= limit_us ? out : std::vector<std::size_t>{};
  }

  // Returns whether few silences of the file are as long as that before frame `at`.
  bool stands_out(std::size_t at) const {
    std::size_t as_long = 0;
    for (std::size_t i = 1; i < stamps_.size() && as_long <= interrupted_max_; ++i) {
      as_long += stamps_[i] - stamps_[i - 1] >= stamps_[at] - stamps_[at - 1] ? 1 : 0;
    }
    return as_long <= interrupted_max_;
  }

  // Returns whether frame `i` acknowledges the one directly before it in its tap.
  bool late_ack(std::size_t i) const {
    const Observation& ack = run_.seen[frames_[i]];
    std::size_t before = i - 1;
    while (before > 0 && tap(before) != tap(i)) --before;
    const Observation& sent = run_.seen[frames_[before]];
    return ack.kind == Observation::Kind::kLinkAck && sent.kind == Observation::Kind::kRadio &&
           sent.ack_request && sent.has_dsn && sent.dsn == ack.dsn && sent.tap == ack.tap;
  }

  // Lets times go on after each step.
  void go_on() {
    std::int64_t shift_us = 0;
    std::int64_t last_us = 0;
    std::size_t said = 0;
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      Place& place = run_.seen[frames_[i]].place;
      std::int64_t time_us = stamps_[i] + shift_us;
      if (suspect_[i] == What::kStep) {
        const std::int64_t later_us = time_us - last_us - kGoesOnUs;
        shift_us -= later_us;
        time_us = last_us + kGoesOnUs;
        // Where a clock was set forth less time passed than it says.
        step(place, later_us < 0 ? ClockStep::kUnknown : later_us, true);
        const std::int64_t by_us = stamps_[i] - stamps_[i - 1];
        say(said, "the clock of " + name(i) + " steps " + (by_us < 0 ? "back" : "forth") + " by " +
                      seconds(std::abs(by_us)) + " at frame " + std::to_string(place.frame) +
                      "; what spans this moment is inconclusive");
        stepped_ = true;
      } else if (suspect_[i] == What::kAlone) {
        const bool ends = i + 1 == stamps_.size();
        const std::int64_t next_us = ends ? last_us : stamps_[i + 1] + shift_us;
        const std::int64_t off_us = time_us < last_us ? time_us - last_us : time_us - next_us;
        time_us = last_us;
        step(place, std::max<std::int64_t>(0, next_us - last_us), false);
        say(said, "the stamp of frame " + std::to_string(place.frame) + " of " + name(i) +
                      " is wrong by about " + seconds(std::abs(off_us)) +
                      "; it came between its neighbours");
      }
      place.time_us = time_us;
      last_us = std::max(last_us, time_us);
      if (i == 0) last_us = time_us;
    }
    if (said > kFactsMax) {
      run_.facts.push_back(name(0) + ": " + std::to_string(said - kFactsMax) +
                           " more steps or wrong stamps");
    }
  }

  // Keeps each tap, or all of them, in the order of the file, where stamps are off by less than a
  // step.
  void keep_order() {
    std::vector<std::int64_t> last(run_.taps.size(), kNoStamp);
    for (const std::uint32_t i : frames_) {
      std::int64_t& latest = last[in_order_ ? 0 : run_.seen[i].tap];
      Place& place = run_.seen[i].place;
      if (place.time_us < latest) run_.turned[{place.file, place.frame}] = latest - place.time_us;
      place.time_us = latest = std::max(latest, place.time_us);
    }
  }

  void step(const Place& place, std::int64_t later_us, bool with_rest) {
    run_.steps.push_back({place.file, place.frame, 0, later_us, with_rest});
  }
  void say(std::size_t& said, std::string fact) {
    if (++said <= kFactsMax) run_.facts.push_back(std::move(fact));
  }
  const std::string& name(std::size_t i) const {
    return run_.files[run_.seen[frames_[i]].place.file];
  }

  Run& run_;
  std::vector<std::uint32_t> frames_;  // Indices into Run::seen.
  std::int64_t response_us_;
  std::vector<std::int64_t> stamps_;
  std::vector<What> suspect_;
  std::size_t interrupted_max_ = 0;  // So many silences at most show steps by what they interrupt.
  bool in_order_ = true;             // The file has its taps' frames in the order of time.
  bool stepped_ = false;
};

// How often a file changes from one tap to another, and how often it goes back in time then.
struct Changes {
  std::size_t all = 0;
  std::size_t back = 0;
};

Changes changes_of(const Run& run, const std::vector<std::uint32_t>& frames) {
  Changes out;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Observation& before = run.seen[frames[i - 1]];
    const Observation& seen = run.seen[frames[i]];
    if (before.tap == seen.tap) continue;
    ++out.all;
    out.back += seen.place.time_us < before.place.time_us - kAcrossUs ? 1 : 0;
  }
  return out;
}

void mend_file(Run& run, const std::vector<std::uint32_t>& frames, std::int64_t response_us) {
  if (frames.empty()) return;
  // A recorder of several taps writes them in order of time; or it writes a block of one, and then
  // a block of another.
  const Changes changes = changes_of(run, frames);
  if (4 * changes.back <= changes.all) return Recorded(run, frames, response_us).mend();
  const bool blocks = changes.all * kBlockFrames <= frames.size();
  std::vector<std::vector<std::uint32_t>> of_tap(run.taps.size());
  for (const std::uint32_t i : frames) of_tap[run.seen[i].tap].push_back(i);
  bool stepped = false;
  for (std::vector<std::uint32_t>& tap : of_tap) {
    if (tap.empty()) continue;
    Recorded recorded(run, std::move(tap), response_us);
    recorded.mend();
    stepped = stepped || recorded.stepped();
  }
  if (!stepped && blocks) return;
  if (!stepped) {
    run.facts.push_back(run.files[run.seen[frames.front()].place.file] +
                        ": the clocks of its taps differ; what depends on the order between them "
                        "is inconclusive");
  }
  run.unordered_taps.resize(run.taps.size());  // Nothing ties the taps together any more.
  for (const std::uint32_t i : frames) {
    const std::uint32_t tap = run.seen[i].tap;
    if (run.taps[tap].link == machine::Link::kSerial) run.unordered_taps[tap] = true;
  }
}

}  // namespace

void mend_steps(Run& run, std::int64_t response_us) {
  response_us = std::max(response_us, AlignOptions{}.response_us);
  std::vector<std::uint32_t> frames;
  for (std::uint32_t i = 0; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (!frames.empty() && run.seen[frames.front()].place.file != seen.place.file) {
      mend_file(run, frames, response_us);
      frames.clear();
    }
    if (seen.node.empty() && seen.place.time_us != kNoStamp) frames.push_back(i);
  }
  mend_file(run, frames, response_us);
}

void place_steps(Run& run) {
  if (run.steps.empty()) return;
  const auto by_frame = [](const ClockStep& a, const ClockStep& b) {
    return std::tie(a.file, a.frame) < std::tie(b.file, b.frame);
  };
  std::sort(run.steps.begin(), run.steps.end(), by_frame);
  for (const Observation& seen : run.seen) {
    const ClockStep of_frame{seen.place.file, seen.place.frame};
    const auto step = std::lower_bound(run.steps.begin(), run.steps.end(), of_frame, by_frame);
    if (step == run.steps.end() || by_frame(of_frame, *step)) continue;
    step->time_us = seen.place.time_us;
  }
  std::sort(run.steps.begin(), run.steps.end(),
            [](const ClockStep& a, const ClockStep& b) { return a.time_us < b.time_us; });
}

}  // namespace rubric::check
