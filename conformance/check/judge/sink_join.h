// Joins as sinks answer them: for each pair of sink and mote a set of hypotheses about the sink's
// list, each one stepped by the very functions of the machine.
//
// mote_join.h explains the method. Here a hypothesis says whether the sink lists the mote, which
// request it stored, and what it owes: join_replies, a serial_joined, a moteJoined. Each pair of a
// sink and an AM address has a set of its own, as if the sink knew one mote only, so the sets stay
// small however many motes join at once (decision 106). Only the size of the list joins them: it is
// taken as full when `members_max` pairs list their mote in every hypothesis.
//
// Decides: whether each join_reply answers a request (J3, J2-LISTED, N9-SET). A missing reply that
// is surely owed is up to join_watch.h, serial_joined and moteJoined to announcements.h.
//
// How a set changes:
// - It starts as `unknown`, or, with `start_cold`, as that of a sink that never heard of the mote.
//   A new island id adds hypotheses that forget the mote (decision 123).
// - A request or an ack_join to the sink's address goes through machine::hear_request() or
//   machine::hear_ack_join(). A hypothesis splits into received and lost, unless the reception is
//   certain: by a log, or by a link ack where only one sink is known (decision 127).
// - A reply leaves the hypotheses that owe that number, an announcement those that owe it.
//   `unknown` allows both and is known afterwards. A descriptor that is announced must be the one
//   stored.
// - If none is left, the furthest hypothesis is blamed, and the set goes on from what was seen.
//
// Tolerance: the response time for what is owed (decision 125). cur_time may be a second off and
// may run in binary ms (decision 119). A sink with a full list may be silent (decision 107). Of
// replies owed to one mote only the newest four are remembered, and until these are sent any number
// may be that of an older one; beyond kSetMax hypotheses the pair is inconclusive.
//
// Cannot know: what a sink stored before the capture began; which of several sinks of one address
// sent a link ack; that a sink forgot a mote without a reboot, a new island or a mote_left that the
// run shows. Where gone_after is stated and no log tells, a sink may have forgotten a mote so long
// after its ack_join (decision 124).
//
// Why an inconclusive finding is never a failure here: a reply or an announcement without its cause
// has the severity of Context::without(), over the time in which the mote's request or ack_join may
// have escaped. Two replies fail at once, since no escaped frame would put them right: one with a
// number that only another mote asked with, and one to the last request of a mote that the furthest
// hypothesis lists. So does wrong content. A missing serial_joined fails only if the ack_join
// surely arrived, every hypothesis owes the report, the response time is over, the sink sent
// something up its line afterwards, its list has room, the run starts cold, and no bytes were
// damaged in between. A missing reply is inconclusive where nothing proves that the request
// arrived.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/machine/state.h"

namespace rubric::check {

/// A possible state of a sink's view of one mote, with what it owes.
struct SinkHypothesis {
  bool unknown = false;  ///< It may list the mote since before the capture.
  std::optional<machine::Admission> member;
  std::optional<machine::Admission> pending;
  std::array<std::uint16_t, 4> owed_seq{};  ///< Replies, oldest first.
  std::uint8_t owed = 0;
  bool owes_older = false;   ///< Perhaps also replies to requests before those.
  bool owes_report = false;  ///< serial_joined.
  bool owes_notice = false;  ///< moteJoined to its application.
  friend bool operator==(const SinkHypothesis&, const SinkHypothesis&) = default;
};

/// Converts between the machine's list and a hypothesis about one mote.
inline machine::JoinSink list_of(const SinkHypothesis& h) {
  machine::JoinSink list;
  if (h.member) list.members.push(*h.member);
  if (h.pending) list.pending.push(*h.pending);
  return list;
}
inline void take_list(const machine::JoinSink& list, SinkHypothesis& h) {
  h.member = list.members.empty() ? std::nullopt : std::optional(list.members[0]);
  h.pending = list.pending.empty() ? std::nullopt : std::optional(list.pending[0]);
}

/// A sink and a mote.
struct PairWatch {
  std::vector<SinkHypothesis> set;
  std::uint16_t answered_seq = 0;  ///< In the last reply.
  bool answered = false;
  std::int64_t answered_us = 0;
  Place request;  ///< The last.
  std::uint16_t request_seq = 0;
  bool asked = false;
  Place ack;       ///< The last ack_join to this sink.
  Place admitted;  ///< The last one that may have made it a member.
  /// When it was reported before its ack_join was seen, by the skew of the taps.
  std::int64_t ahead_us = INT64_MIN / 2;
  std::int64_t comes_us = -1;               ///< When a report that is late comes.
  std::int64_t admitted_us = -1;            ///< When the sink has that one whole.
  ReqId ignored_ack = ReqId::kNone;         ///< Why the last one must have been ignored.
  std::int64_t own_ack_us = INT64_MIN / 2;  ///< Of the last one for the sink's island.
  bool report_due = false;      ///< Surely owed since `admitted`, and not yet complained about.
  bool request_listed = false;  ///< The last request surely came while it was listed.
  bool cut_off = false;         ///< It was listed when the sink's island became another.

  /// Returns whether what was told of the mote ahead of its ack_join may be what that is due.
  bool is_ahead(std::int64_t skew_us) const { return admitted.time_us - ahead_us <= skew_us; }
  /// Takes the sink to list the mote, or not, and to owe nothing.
  void know_nothing() {
    set.assign(1, SinkHypothesis{});
    set.front().unknown = true;
    answered = report_due = request_listed = cut_off = false;
  }
};

struct SinkWatch {
  std::uint16_t device = kNobody;
  std::uint16_t island = kNoIsland;
  bool island_set = false;    ///< SET_ISLAND_ID was seen.
  bool island_sure = true;    ///< It surely arrived, if so.
  bool perhaps_told = false;  ///< A packet down its line, which came damaged, may have been one.
  std::uint16_t former_island = kNoIsland;
  std::uint16_t start_island = kNoIsland;  ///< With which a life begins, if that was seen.
  std::int32_t ignored = -1;  ///< The value of the last config message that changes nothing.
  std::int32_t unheard = -1;  ///< The last island that it was set to while its line was off.
  std::int64_t island_set_us = 0;
  std::int64_t first_set_us = -1;     ///< When it was told that, if nobody saw the one before.
  std::int64_t island_shown_us = -1;  ///< When it last acted for its island.
  std::unordered_map<std::uint16_t, PairWatch> motes;  ///< By AM address.
  bool has_clock = false;                              ///< From the last reply:
  std::uint32_t clock_ms = 0;
  std::int64_t clock_us = 0;
  std::int64_t still_us = 0;      ///< Of the first reply with that cur_time.
  std::int64_t behind_us = -1;    ///< Of the last reply whose clock fell behind: of a new life?
  std::uint32_t debts = 0;        ///< Pairs with something due.
  bool serial_off = false;        ///< Its serial line, by its application.
  std::int64_t serial_on_us = 0;  ///< When it was switched on again.
  std::int64_t serial_us = -1;    ///< Its last frame on its serial line.
  bool behind = false;            ///< That one had to wait for the one before.
  std::int64_t reported_us = -1;  ///< The latest ack_join that it reported.

  /// Notes that the report of this mote, one of `motes`, is due, or no longer.
  void set_due(PairWatch& mote, bool due) {
    if (mote.report_due == due) return;
    mote.report_due = due;
    debts = due ? debts + 1 : debts - 1;
  }
};

class SinkJoins {
 public:
  explicit SinkJoins(Context& context);

  void begin_life(std::uint16_t sink, std::int64_t since_us);
  void set_island(std::uint16_t sink, std::uint16_t island, const Place& at, bool sure);
  /// Notes SET_ISLAND_ID that its serial line, switched off, is not to hear.
  void missed_island(std::uint16_t sink, std::uint16_t island);
  /// Notes a config message that changes nothing.
  void configured(std::uint16_t sink, const machine::Frame& frame);
  /// Returns the rule that the sink breaks by being of island `other`.
  static ReqId wrong_island(const SinkWatch& sink, std::uint16_t other, ReqId otherwise);
  void request(std::uint16_t mote_device, const Observation& seen, const Request& request,
               std::uint16_t surely_received_by);
  /// Returns the AM address of the mote that it answers, be it sent there or not.
  std::uint16_t reply(std::uint16_t sink, const Observation& seen, const Reply& reply);
  void ack_join(std::uint16_t mote_device, const Observation& seen, const AckJoin& ack,
                std::uint16_t surely_received_by);
  /// Notes that the sink calls a mote gone, so that it lists it no more. (decision 124)
  void forgot(std::uint16_t sink, std::uint16_t mote_am);
  void finish();
  /// Notes that somebody else waits for the answer to the mote's last request.
  void settled(std::uint16_t mote_am) { unanswered_[mote_am].open = false; }

  /// Notes that the mote was given a reply to this request, though no sink was seen to send it.
  void answered(std::uint16_t mote_am, std::uint16_t seq_num);

  /// Takes a reply of an unknown sender: it may be the sink's, in a life of few frames.
  void may_have_replied(const Observation& seen, const Reply& reply);

  /// Returns whether a sink that was told another island may show this one: its former one, if what
  /// made it do so came before or it was never told, or, if it may have lost its power, the one
  /// with which it begins, or any where that was not seen. In the last cases it is the sink's
  /// island from now on, which is reported as inconclusive. `cause_us`: -1 if there is no cause.
  bool keeps_former(SinkWatch& sink, std::uint16_t shown, const Place& at, std::int64_t cause_us);

  /// Returns whether an address that is not the sink's is its own again, as keeps_former() has it.
  bool is_former(std::uint16_t sink, machine::Address address, const Place& at);
  /// Notes that something came down its line damaged, which may have told it another island.
  void perhaps_told(std::uint16_t sink);
  /// Notes that the sink acts for its island.
  void acts(std::uint16_t sink, std::int64_t now_us);
  /// Returns whether the sink has perhaps lost its power, and with it the island that it was told,
  /// since it last acted for that.
  bool may_have_lost_island(std::uint16_t sink, std::int64_t now_us) const;

  /// Returns the sink's island now; kNoIsland if unknown.
  std::uint16_t island(std::uint16_t sink) const;
  /// Returns whether `address` is the sink's, or was until so short a time ago that a message from
  /// before SET_ISLAND_ID may have waited.
  bool is_own(std::uint16_t sink, machine::Address address, std::int64_t now_us) const;
  SinkWatch* find(std::uint16_t sink);

  // For the announcements, which change the same hypotheses.
  std::vector<SinkWatch>& all() { return sinks_; }
  PairWatch& pair(SinkWatch& sink, std::uint16_t mote_am);
  void keep(SinkWatch& sink, PairWatch& watch, std::vector<SinkHypothesis>& next, const Place& at);
  /// Returns how many motes the sink surely lists, since that time at the latest.
  std::size_t listed(const SinkWatch& sink, std::int64_t since_us = INT64_MAX) const;
  static std::string sentence(const SinkHypothesis& h);

 private:
  static constexpr std::size_t kSetMax = 256;

  /// Adds that the sink may have forgotten the mote, if so much silence was possible.
  void doubt(std::uint16_t sink, PairWatch& watch, const Place& now) const;
  void may_forget(SinkWatch& sink, PairWatch& pair, const Place& at);
  bool may_be_told(const SinkWatch& sink) const;
  static std::size_t others(const SinkWatch& sink, const PairWatch& pair);
  static bool owes(SinkWatch& sink, std::uint16_t mote_am, std::uint16_t seq_num);
  void judge_clock(SinkWatch& sink, const Observation& seen, const Reply& reply);
  void refuse_reply(SinkWatch& sink, PairWatch& watch, const Observation& seen, const Reply& reply);
  bool answers_copy(std::uint16_t sink, const PairWatch& watch, const Observation& seen,
                    const Reply& reply);

  struct Unanswered {
    Place request;
    std::uint16_t seq_num = 0;
    bool open = false;
    bool overtaken = false;  ///< A later request of another mote was answered before.
    std::uint16_t sink = kNobody;
  };
  void close_unanswered(std::uint16_t mote_am, Unanswered& unanswered);
  bool missed(std::uint16_t sink, std::uint16_t mote_am, const Unanswered& unanswered) const;
  bool hears(const Device& device, const Observation& seen, bool sure) const;

  Context& context_;
  std::vector<SinkWatch> sinks_;
  std::unordered_map<std::uint16_t, Unanswered> unanswered_;
  std::vector<SinkHypothesis> next_;
  Place copied_;  ///< The last request of which a copy was taken to be missing.
};

}  // namespace rubric::check
