// State shared by every part of the judgement: the run, who is who, and how to report.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "conformance/check/identify/identity.h"
#include "conformance/check/identify/line_losses.h"
#include "conformance/check/judge/findings.h"
#include "conformance/check/message.h"
#include "conformance/check/observation.h"
#include "conformance/check/terms.h"
#include "conformance/machine/actions.h"
#include "conformance/machine/join.h"
#include "conformance/machine/state.h"
#include "conformance/machine/ticks.h"

namespace rubric::check {

/// The text of a finding; see Finding.
struct Said {
  std::string text;
  std::string expected;
  std::vector<Hypothesis> hypotheses;
  /// A profile accepts some difference of the rule, but not this.
  bool beyond = false;
};

/// Returns by how much a clock of 32 bits has grown between two readings: of the growths that wrap
/// to the second one, the nearest to the time that passed.
inline std::int64_t grown_ms_of(std::uint32_t from_ms, std::uint32_t to_ms,
                                std::int64_t passed_ms) {
  const std::uint32_t expected_ms = from_ms + static_cast<std::uint32_t>(passed_ms);
  return passed_ms + static_cast<std::int32_t>(to_ms - expected_ms);
}

/// By how much a run shows that stamps of one tap are late beside those of another, at most the
/// skew that is allowed.
struct TapsCross {
  std::int64_t air_us = 0;   ///< A message was on a line before its mote sent it, or an
                             ///< acknowledgement of the link is late.
  std::int64_t line_us = 0;  ///< A sink radiated a message before it came down its line.
};

struct Context {
  static constexpr std::int64_t kRoundedUs = 2;
  /// For so long after its time a log's node may still do what a busy line or application holds up.
  static constexpr std::int64_t kHeldLongUs = 10'000'000;

  Context(const Run& r, const Options& o, const Identity& w, Findings& f);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Run& run;
  const Options& options;
  const Identity& who;
  Findings& findings;
  std::uint16_t sink_am = 1;  ///< AM address of sinks.
  machine::Actions actions;   ///< For the machine's functions; not read here.

  const Device& device(std::uint16_t i) const { return who.devices[i]; }
  /// The only sink on the air; kNobody if there are none or several.
  std::uint16_t only_sink = kNobody;

  std::vector<std::uint16_t> sinks;       ///< Known ones.
  std::vector<std::uint16_t> mote_of_am;  ///< The last known mote of each AM address.
  std::vector<std::uint16_t> next_of_am;  ///< By device: another mote of the same address.

  /// The order of files to each other is unknown, as of raw bytes beside a capture with stamps.
  bool unordered = false;
  std::vector<bool> untimed_taps;  ///< If unordered: taps with frames without a stamp,
                                   ///< or on a clock of their own.

  std::int64_t at_us = 0;  ///< When the observation was that is judged.

  std::vector<bool> down_taps;            ///< Taps with frames to a sink.
  std::vector<std::int64_t> tap_from_us;  ///< By tap: the first frame of its file.

  std::vector<LineLoss> line_losses;  ///< By tap: what the capture misses of a serial line.
  bool lossy_air = false;             ///< It misses many of the air; a link's repeat shows no gap.
  std::size_t copies_missed = 0;      ///< It may miss so many of the link's copies in joins.
  std::vector<std::int64_t> last_us;  ///< By device: when something of it was seen last.

  /// Fills in all of these. Called before anything else.
  void look_up();
  /// Calls `call` with each known mote of that address.
  template <class Call>
  void for_motes(std::uint16_t am, Call call) const {
    for (std::uint16_t mote = mote_of_am[am]; mote != kNobody; mote = next_of_am[mote]) call(mote);
  }

  /// Returns what the node is held to; of no log, or kNobody, by the user and the profile.
  const Terms& terms(std::uint16_t node) const {
    return node < logged_.size() ? logged_[node] : unlogged_;  // A log's are the first devices.
  }
  const machine::Profile& profile(std::uint16_t node) const { return terms(node).profile; }
  /// Returns whether a node may still have done then what it owed when the capture began.
  bool after_begin(std::int64_t time_us) const {
    return !options.start_cold && time_us <= run.start_us + response_us(kNobody);
  }
  /// Returns whether a sender that is none of the sinks has their address, and sends until a time
  /// after the first one and from before the second one on.
  bool stray_sink(std::int64_t from_us = 0, std::int64_t to_us = INT64_MAX) const {
    return std::ranges::any_of(who.devices, [&](const Device& d) {
      return !d.known && d.radio && d.am == sink_am && d.first_us <= to_us && d.last_us >= from_us;
    });
  }
  /// Returns how many messages a buffer for this line holds at least (decision 122).
  std::size_t room(std::uint16_t node, machine::Link line) const {
    return std::min(line == machine::Link::kRadio ? machine::kRadioRoom : machine::kSerialRoom,
                    terms(node).buffers);
  }
  /// Returns how early a timer may look (decision 128). Ticks of logs are rounded to microseconds,
  /// and stamps of a coarse clock by more.
  std::int64_t early_us(std::uint16_t node) const {
    return machine::us_of(profile(node).early_ticks) + kRoundedUs + run.grid_us;
  }
  std::int64_t join_period_us(std::uint16_t mote) const {
    return machine::us_of(profile(mote).join_period_ticks);
  }
  /// Returns how long a joinIsland call takes that sends all its requests.
  std::int64_t join_call_us(std::uint16_t mote) const {
    return profile(mote).join_requests_max * join_period_us(mote);
  }
  /// Returns the mote of that AM address whose calls take longest; kNobody if none is known.
  std::uint16_t slowest_mote(std::uint16_t am) const;
  std::int64_t response_us(std::uint16_t node) const {
    return terms(node).response_us + run.slack_us + run.grid_us;
  }
  std::int64_t ack_timeout_us(std::uint16_t node) const { return terms(node).ack_timeout_us; }
  bool ack_timeout_stated(std::uint16_t node) const {
    return device(node).whole || terms(node).ack_timeout_stated;
  }
  /// Returns until when the run shows what the node does: another node's log may go on for longer.
  std::int64_t end_us(std::uint16_t node) const {
    return node < run.nodes.size() ? std::min(run.end_us, run.nodes[node].to_us) : run.end_us;
  }
  /// Returns whether the node's log had begun by then.
  bool log_begun(std::uint16_t node, std::int64_t time_us) const {
    return node < logs_us_.size() && logs_us_[node].first <= time_us;
  }
  /// Returns until when the node's log goes on beside captures, which may be longer.
  std::int64_t log_end_us(std::uint16_t node) const {
    return logs_beside_captures(node) ? logs_us_[node].second : INT64_MAX;
  }
  /// Returns whether captures that show what the node sends, as its log does not, began later.
  bool before_captures(std::uint16_t node, std::int64_t time_us) const {
    return captured_ && !device(node).hearing && time_us < captured_->first;
  }
  /// Returns until when they do.
  std::int64_t captures_end_us(std::uint16_t node) const {
    return logs_beside_captures(node) ? captured_->second : INT64_MAX;
  }
  /// Returns whether an event at the application of the node that is due by then would be in its
  /// log: that has what the node was given, or events of this kind, and goes on.
  template <class Event>
  bool tells(std::uint16_t node, std::int64_t due_us) const {
    return tells_any(node, due_us) &&
           (device(node).hearing || told_[node].contains(machine::Notice(Event{}).index()));
  }
  /// Returns the same of events of any kind.
  bool tells_any(std::uint16_t node, std::int64_t due_us) const {
    if (device(node).hearing) return true;
    return node < told_.size() && !told_[node].empty() && due_us < logs_us_[node].second;
  }
  /// Returns whether what happened up to `before_us` before then may have come before the node's
  /// log began.
  bool begun_before(std::uint16_t node, std::int64_t time_us, std::int64_t before_us) const {
    return node < run.nodes.size() && !device(node).whole && !options.start_cold &&
           begun_us_[node] >= time_us &&
           time_us - std::max(run.start_us, run.nodes[node].from_us) <= before_us;
  }
  /// Returns whether the node's log begins later than the run, at most `before_us` before then:
  /// what came before it is not told, whether the run begins cold or not.
  bool log_late(std::uint16_t node, std::int64_t time_us, std::int64_t before_us) const {
    return node < logs_us_.size() && logs_us_[node].first > run.start_us &&
           time_us - logs_us_[node].first <= before_us && begun_us_[node] >= time_us;
  }
  /// Returns what was seen then, or later by at most the skew of the taps, and may be the cause;
  /// nullptr if nothing.
  template <class Cause>
  const Observation* soon(std::int64_t time_us, Cause is_cause) const {
    return next(time_us, options.skew_us, is_cause);
  }
  /// Returns whether a message with that source and number comes to `node` by another tap than that
  /// of what it sends, so soon that it may be the cause: the clocks of two taps may differ.
  bool comes(std::uint16_t node, const Observation& sent, machine::Address src,
             std::uint16_t seq_num) const;
  /// Returns by how much the frames of a run show that the clocks of its taps differ: then the
  /// order of one file's frames tells nothing of what another tap saw.
  const TapsCross& taps_cross() const;
  /// Returns the first such thing that was seen then, or later by at most `within_us`.
  template <class Wanted>
  const Observation* next(std::int64_t time_us, std::int64_t within_us, Wanted is_wanted) const {
    const auto from = std::ranges::lower_bound(
        run.seen, time_us, {}, [](const Observation& seen) { return seen.place.time_us; });
    for (auto at = from; at != run.seen.end(); ++at) {
      if (at->place.time_us > time_us + within_us) return nullptr;
      if (is_wanted(*at)) return &*at;
    }
    return nullptr;
  }
  /// Returns when an answer to what the node has whole at `whole_us` is overdue. What waited for a
  /// line or an application that was busy, by the node's log, may take as long again behind others.
  /// With `line` only that line and the application count.
  std::int64_t due_us(std::uint16_t node, std::int64_t whole_us,
                      std::optional<machine::Link> line = {}) const;
  /// Returns whether by its log a line or the application of the node was busy within that time;
  /// with `line` only that line or the application.
  bool busy(std::uint16_t node, std::int64_t from_us, std::int64_t to_us,
            std::optional<machine::Link> line = {}) const;
  /// Returns whether so many messages came to the node around that time that they may have found a
  /// buffer full (decision 122); by a whole log, whether so many waited for it to handle them.
  bool crowded(std::uint16_t node, std::int64_t time_us) const;
  /// Returns whether the node was seen to pass on, before then, what came: it waits no more.
  bool passed_on(std::uint16_t node, std::vector<Observation>::const_iterator came,
                 std::int64_t until_us) const;
  /// Returns whether by its log the application of the node took nothing then, and so many messages
  /// waited for it that they may have filled a buffer.
  bool full(std::uint16_t node, std::int64_t time_us) const;
  /// Returns since when what came until then waits for the application of the node, which by its
  /// log was busy; `time_us` if it was not.
  std::int64_t held_since_us(std::uint16_t node, std::int64_t time_us) const;
  /// Returns the times in which by its log a line or the application of the node was busy.
  const std::vector<BusyTime>& busy_times(std::uint16_t node) const;
  machine::JoinContext join_context(std::uint16_t node, std::uint16_t island,
                                    std::int64_t now_us) const {
    return {profile(node), device(node).am, island, 0, machine::ticks_of(now_us)};
  }

  /// Returns whether a sink may have started anew between two times: by later frames of the air it
  /// did between its last frame before and the first of a new life.
  bool may_have_restarted(std::uint16_t sink, std::int64_t from_us, std::int64_t to_us) const;

  /// Returns the severity of "X without an earlier Y of `cause`": kFail only if no Y can have
  /// escaped. What the log of `node` tells after all captures have ended may rest on a later frame.
  Severity without(std::uint16_t cause, std::int64_t from_us, std::int64_t to_us,
                   std::uint16_t node = kNobody) const;
  /// Returns the same where Y is the link's own copy of a frame that `sender` sent at `first`.
  Severity without_copy(std::uint16_t sender, const Place& first, std::int64_t now_us) const;
  /// Returns the same where any mote of that address may have sent Y.
  Severity without_mote(std::uint16_t am, std::int64_t from_us, std::int64_t to_us,
                        std::uint16_t node = kNobody) const;
  /// Returns the same where Y may lie any time before, even before the capture.
  Severity without_ever(std::uint16_t cause, std::int64_t to_us) const;

  /// Notes that by its log the node puts something on a line that it accepted for it between two
  /// times. Reports an order in which what was accepted later leaves first (N2-ORDER).
  void left(std::uint16_t node, machine::Link line, const Place& at, std::int64_t from_us,
            std::int64_t to_us, const std::string& what);
  /// Returns until when what a node had whole is accepted for the line by which it answers now: by
  /// a log that is not whole it may handle it late (decision 125).
  std::int64_t handled_us(std::uint16_t node, std::int64_t whole_us, std::int64_t now_us) const;
  /// Notes that a life of the node begins, with nothing waiting.
  void begin_life(std::uint16_t node);

  /// Reports a finding about device `node` at `at`: none about testers, at most kStray about
  /// unknown senders.
  void report(ReqId requirement, Severity severity, const Place& at, std::uint16_t node, Said said);
  /// Returns whether such a finding depends on an order that is unknown.
  bool rests_on_order(ReqId requirement, const Place& at, std::uint16_t node) const;
  /// Returns whether a sink's line has only the sink's own frames in the run, as if recorded from a
  /// line in use that others write to: whatever came down it is unknown.
  bool half_heard(std::uint16_t node) const;
  /// Returns whether the log has the messages from `node` to PEIS and back.
  bool logs_peis(std::uint16_t node) const {
    return node < run.nodes.size() && run.nodes[node].peis;  // A log's nodes are the first devices.
  }
  /// Returns whether messages of that island come to the node where no log and no tap is read.
  bool by_peis(std::uint16_t node, std::uint16_t island) const {
    const Device& d = device(node);
    return d.role == machine::Role::kBaseStation && island != d.island && !logs_peis(node);
  }
  /// Counts something that depends on what came down such a line; finish() reports all at once.
  void needs_host(std::uint16_t sink, const Place& at);
  /// Returns `severity`, or kInconclusive if frames are missing from the capture of the line of
  /// `node`, a sink or base station: for findings that rest on a line's frame that is not there.
  Severity on_line(std::uint16_t node, Severity severity) const;
  /// Returns the same where one frame that `node` owes on the line is not there: kInconclusive also
  /// for as many as the recorder may have missed of a line that shows no loss. Counts it as one.
  Severity absent_on_line(std::uint16_t node, Severity severity);
  /// Returns the same of a frame that `node` makes itself: kInconclusive also where the capture of
  /// the line misses much of what it passes on (misses_passed).
  Severity own_absent_on_line(std::uint16_t node, Severity severity);
  /// Returns whether the run has all lines of the node: a mote has the air alone, of a sink or a
  /// base station nothing that depends on its serial line is known without it.
  bool has_lines(std::uint16_t node) const;
  /// Returns whether the capture of the sink's line had begun by then.
  bool line_recorded(std::uint16_t sink, std::int64_t time_us) const;
  /// Returns the severity of something that a host may cause by what it hands down the sink's line
  /// after `since_us`: at most kInconclusive unless the run has all of that (decision 26).
  Severity unless_given(std::uint16_t sink, std::int64_t since_us,
                        Severity severity = Severity::kFail) const;
  /// Reports what was gathered about nodes that fell silent and hosts that are not in the run.
  void finish();
  /// Reports a frame of an unknown sender.
  void report_stranger(const Observation& seen, std::uint16_t node);

 private:
  std::map<std::uint16_t, bool> misses_passed_;  // By sink; found where it is asked.
  // Returns the taps of the node's serial line; a base station has its sink's.
  const std::vector<std::uint32_t>& lines_of(std::uint16_t node) const;

  std::vector<Terms> logged_;           // By device.
  std::vector<std::int64_t> begun_us_;  // Of these: when the log shows that it begins anew.
  std::vector<std::pair<std::int64_t, std::int64_t>> logs_us_;     // The log's first and last line.
  std::optional<std::pair<std::int64_t, std::int64_t>> captured_;  // The same of all captures.
  std::vector<std::set<std::size_t>> told_;  // Which kinds of events its application got.
  Terms unlogged_;
  // By sink: times between which a life of it may have begun.
  std::map<std::uint16_t, std::vector<std::pair<std::int64_t, std::int64_t>>> restarts_;

  // Returns whether the node has a log, and captures alone show what it sends.
  bool logs_beside_captures(std::uint16_t node) const {
    return node < logs_us_.size() && captured_ && !device(node).hearing;
  }
  void find_restarts();
  void doubt_lone_replies();
  TapsCross find_taps_cross() const;
  mutable std::optional<TapsCross> taps_cross_;  // Found when it is asked for.
  int backlog_of(std::uint16_t node, std::size_t index) const;
  int backlog(std::uint16_t node, std::int64_t time_us) const;
  /// Findings that are told as one.
  struct Gathered {
    Finding first;
    std::uint32_t count = 0;
  };
  bool gather(const Finding& finding, std::uint16_t node);

  struct Accepted {
    std::int64_t from_us = -1;
    std::string what;
  };
  std::map<std::pair<std::uint16_t, machine::Link>, Accepted> left_;  // The latest of each line.
  std::map<std::uint16_t, Gathered> silent_;  // By device, after its last frame.
  std::map<std::uint16_t, Gathered> unseen_;  // By sink, about what hosts send down its line.
};

// Texts for findings.
std::string text_of(machine::Address address);
std::string name_of(const Net& net);  ///< "the message <..> to <..> with number 7"
std::string ms_text(std::int64_t us);
std::string number(std::uint64_t n);

}  // namespace rubric::check
