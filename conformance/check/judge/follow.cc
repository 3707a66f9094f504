#include "conformance/check/judge/follow.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/identify/identity.h"
#include "conformance/check/input/duplicates.h"
#include "conformance/check/judge/context.h"
#include "conformance/check/judge/findings.h"
#include "conformance/check/message.h"
#include "conformance/check/storage.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kHorizonMinUs = 60'000'000;
constexpr std::int64_t kTimesLongest = 4;
constexpr std::int64_t kJoinPeriods = 4;        // Until a join has failed (decision 101).
constexpr std::int64_t kBuffersUs = 5'000'000;  // How long a buffer may hold frames.
constexpr std::size_t kJoinFramesMax = 12;      // For each mote.
constexpr std::size_t kLastFramesMax = 2;       // For each sender, each line and way.
constexpr std::size_t kPastMax = 8192;

// Chooses what is kept of frames that go: looks at them from the last to the first.
class Keeper {
 public:
  Keeper(const Run& run, const Identity& who) : run_(run), who_(who), closed_(who.devices.size()) {}

  // Returns whether the observation is one of the last of its kind.
  bool wants(std::size_t i) {
    const Observation& seen = run_.seen[i];
    const Mark& mark = who_.marks[i];
    if (mark.repeat) return false;
    if (seen.kind == Observation::Kind::kSerial) return wants_serial(seen);
    if (seen.kind != Observation::Kind::kRadio || mark.device == kNobody) return false;
    if (!who_.devices[mark.device].known || closed_[mark.device]) return false;
    closed_[mark.device] = mark.new_life;  // The node forgot all before, too.
    const machine::Frame& frame = seen.frame;
    const bool last = first_ones({Kind::kSender, mark.device, 0}, kLastFramesMax);
    if (frame.type == am::kJoin || frame.type == am::kAckJoin) {
      return first_ones({Kind::kJoin, frame.src, 0}, kJoinFramesMax) || last;
    }
    if (frame.type == am::kJoinReply) {
      const bool shows = first_ones({Kind::kReplier, mark.device, 0}, 1);
      return first_ones({Kind::kJoin, frame.dest, 0}, kJoinFramesMax) || shows || last;
    }
    return last ||
           (frame.type == am::kNet && first_ones({Kind::kMessage, mark.device, 0}, kLastFramesMax));
  }

 private:
  enum class Kind : std::uint8_t { kSender, kJoin, kReplier, kMessage, kLine, kIsland, kReport };
  using Key = std::tuple<Kind, std::uint32_t, std::uint32_t>;

  bool first_ones(const Key& key, std::size_t most) { return counts_[key]++ < most; }

  bool wants_serial(const Observation& seen) {
    if (set_island_id(seen.frame) >= 0) {
      return first_ones({Kind::kIsland, seen.tap, seen.to_mote}, kLastFramesMax);
    }
    Net net;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return false;
    const bool last = first_ones({Kind::kLine, seen.tap, seen.to_mote}, kLastFramesMax);
    SerialJoined joined;
    if (seen.to_mote || !parse_serial_joined(net, joined)) return last;
    const auto its = std::uint32_t{joined.address.pid} << 16 | joined.address.devid;
    return first_ones({Kind::kReport, seen.tap, its}, kLastFramesMax) || last;
  }

  const Run& run_;
  const Identity& who_;
  std::vector<bool> closed_;
  std::map<Key, std::size_t> counts_;
};

bool is_judged(const Observation& seen) {
  return seen.kind == Observation::Kind::kRadio || seen.kind == Observation::Kind::kSerial;
}

// Returns whether the finding goes on with the episode, which a settled time divided.
bool goes_on(const Finding& episode, const Finding& finding) {
  const std::int64_t after_us = finding.place.time_us - episode.last.time_us;
  return episode.requirement == finding.requirement && episode.severity == finding.severity &&
         episode.node == finding.node && episode.place.file == finding.place.file &&
         after_us >= 0 && after_us <= Findings::kEpisodeUs;
}

// Adds a finding that comes after the others; returns false if there are too many.
bool append(std::vector<Finding>& all, Listed& listed, Finding finding, std::int64_t settled_us) {
  for (std::size_t i = all.size(); i > 0; --i) {
    Finding& before = all[i - 1];
    if (before.last.time_us >= settled_us || !goes_on(before, finding)) {
      if (before.place.time_us + kBuffersUs < settled_us) break;
      continue;
    }
    before.count += finding.count;
    before.last = finding.last;
    return true;
  }
  if (!listed.takes(finding)) return false;
  all.push_back(std::move(finding));
  return true;
}

}  // namespace

std::int64_t horizon_us(const Options& options) {
  const Terms terms = terms_of(options);
  const std::int64_t longest_us = terms.ack_timeout_us + terms.response_us + options.skew_us +
                                  kBuffersUs +
                                  kJoinPeriods * machine::us_of(terms.profile.join_period_ticks);
  return std::max(kHorizonMinUs, kTimesLongest * longest_us);
}

Follow::Follow(const AlignOptions& align, const Options& options, std::int64_t horizon_us)
    : options_(options), options_later_(options), horizon_us_(horizon_us), reader_(align) {
  options_later_.start_cold = false;
}

void Follow::take(std::uint32_t file, const Packet& packet, std::string_view interface_name,
                  std::uint64_t number) {
  reader_.take(file, packet, interface_name, number);
  // Two horizons are held when all is settled that can be.
  if (reader_.held() < judge_at_ || reader_.span_us() < 6 * horizon_us_) return;
  judge();
  judge_at_ = reader_.held() + reader_.held() / 2;
}

// Returns whether all that is held has its place in time. See the page above.
bool Follow::may_settle(std::int64_t until_us) const {
  const bool placed =
      run_.has_time && run_.loose.empty() && run_.slack_taps.empty() && run_.unordered_taps.empty();
  const bool steady = run_.steps.empty() || run_.steps.back().time_us < until_us - horizon_us_;
  return placed && steady;
}

bool Follow::judge() {
  Run run = reader_.snapshot();
  if (!drop_duplicates(run, options_, why_)) {
    return false;
  }
  why_.clear();
  run_ = std::move(run);
  run_bytes_ = past_bytes_;
  run_.past = gone_;
  if (gone_.until_us >= 0) {
    run_.seen.insert(run_.seen.begin(), past_.begin(), past_.end());
    run_.start_us = 0;
  }
  const std::int64_t until_us = run_.end_us - horizon_us_;
  const bool settles = until_us - settled_us_ >= horizon_us_ && may_settle(until_us);
  run_.past.settled_us = {settled_us_};
  if (settles) run_.past.settled_us.push_back(until_us);
  add_report(check::judge(run_, gone_.until_us >= 0 ? options_later_ : options_),
             settles ? until_us : settled_us_);
  if (settles) settle(until_us);
  return true;
}

// Makes the report of all: what is settled, and what is found of the rest, of which what is before
// `settles_us` will be settled.
void Follow::add_report(Report now, std::int64_t settles_us) {
  report_ = std::move(now);
  std::vector<Finding> fresh = std::exchange(report_.findings, settled_);
  Listed listed(settled_);
  std::vector<Place> more;
  for (Finding& finding : fresh) {
    const Place place = finding.place;
    const bool known = place.in_order() && place.time_us < settled_us_;
    if (!known && !append(report_.findings, listed, std::move(finding), settled_us_)) {
      more.push_back(place);
    }
  }
  report_.verdict = verdict_of(report_.findings);
  std::map<std::size_t, std::uint64_t> exercised = exercised_;
  for (const auto& [rule, count] : report_.exercised) {
    std::uint64_t& most = exercised[reflect::requirement_index(rule)];
    most = std::max(most, count);
  }
  report_.exercised.clear();
  for (const auto& [rule, count] : exercised) {
    report_.exercised.emplace_back(reflect::requirements()[rule].number(), count);
  }
  if (gone_.until_us >= 0) {
    report_.facts.push_back("Frames before " + ms_text(gone_.until_us) +
                            " are no longer held: what is found there is settled, and what would "
                            "need them to be decided is inconclusive or not found (--keep). A "
                            "rule's count is the most that was held at a time.");
  }
  if (more_ + more.size() > 0) {
    report_.facts.push_back(number(more_ + more.size()) + " more findings are not listed.");
  }
  more_ +=
      static_cast<std::uint64_t>(std::count_if(more.begin(), more.end(), [&](const Place& place) {
        return place.in_order() && place.time_us < settles_us;
      }));
}

// Settles what was found before `until_us`.
void Follow::settle(std::int64_t until_us) {
  settled_.clear();
  std::vector<Finding> others;
  for (Finding& finding : report_.findings) {
    const bool its = finding.place.in_order() && finding.place.time_us < until_us;
    (its ? settled_ : others).push_back(std::move(finding));
  }
  settled_us_ = until_us;
  report_.findings = settled_;
  Listed listed(settled_);
  for (Finding& finding : others) {
    append(report_.findings, listed, std::move(finding), settled_us_);
  }
  for (const auto& [rule, count] : report_.exercised) {
    exercised_[reflect::requirement_index(rule)] = count;
  }
  let_go();
}

// Lets frames go that are a horizon before what is settled.
void Follow::let_go() {
  const std::int64_t before_us = settled_us_ - horizon_us_;
  const auto place = std::find_if(
      run_.seen.begin() + static_cast<std::ptrdiff_t>(run_.past.senders.size()), run_.seen.end(),
      [&](const Observation& seen) { return seen.place.time_us >= before_us; });
  const auto end = static_cast<std::size_t>(place - run_.seen.begin());
  if (end <= run_.past.senders.size() || end == run_.seen.size()) return;
  const Options& options = gone_.until_us >= 0 ? options_later_ : options_;
  const Identity who = identify(run_, options);
  Past gone;
  gone.until_us = run_.seen[end].place.time_us;
  for (const LineLoss& line : find_losses(run_, who, options).lines) {
    gone.lossy_taps.push_back(line.any);
  }
  Keeper keeper(run_, who);
  std::vector<std::size_t> chosen;
  for (std::size_t i = end; i > 0 && chosen.size() < kPastMax; --i) {
    if (keeper.wants(i - 1)) chosen.push_back(i - 1);
  }
  auto bytes = std::make_shared<RunStorage>();
  past_.clear();
  for (auto i = chosen.rbegin(); i != chosen.rend(); ++i) {
    Observation& seen = past_.emplace_back(run_.seen[*i]);
    seen.frame.payload = bytes->keep(seen.frame.payload);
    seen.frame.packet = bytes->keep(seen.frame.packet);
    const bool radio = seen.kind == Observation::Kind::kRadio;
    gone.senders.push_back(radio ? who.marks[*i].device : kNobody);
  }
  past_bytes_ = std::move(bytes);
  gone.frames_of.resize(who.devices.size());
  for (std::size_t i = 0; i < who.devices.size(); ++i) gone.frames_of[i] = who.devices[i].frames;
  std::uint64_t held = past_.size();
  for (std::size_t i = end; i < run_.seen.size(); ++i) {
    const bool radio = run_.seen[i].kind == Observation::Kind::kRadio;
    const Mark& mark = who.marks[i];
    if (radio && mark.device != kNobody && !mark.repeat) --gone.frames_of[mark.device];
    if (is_judged(run_.seen[i])) ++held;
  }
  gone.frames = report_.frames - held;
  reader_.forget(run_, end);
  gone_ = std::move(gone);
}

}  // namespace rubric::check
