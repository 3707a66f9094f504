// Joins as motes make them: for each life of a mote a set of hypotheses about its join, each one
// stepped by the very functions of the machine.
//
// A sniffer hears what is on the air, not what a mote received. The same frames can leave a mote
// asking, joined, or outside. So each mote is followed as the set of all states that it may be in,
// and it is blamed only when no state is left in which it could have done what it did.
//
// Decides: whether the join_requests, ack_joins and net_msgs of a mote are those of a mote that
// keeps the rules (J1, J4, J5, J7, J8, J11-SEND, N1-SRC). A request or ack_join that is owed and
// never sent is up to join_watch.h, what its application calls and is told to join_calls.h.
//
// How the set changes:
// - It starts with one hypothesis: `unknown`, or, where nothing happened before the capture
//   (`start_cold`) or the mote has rebooted, outside.
// - A reply to the mote's address goes through machine::hear_reply(). A hypothesis that accepts it
//   becomes two: it was received, or it was lost. It stays one only where reception is certain: a
//   log gave the mote that frame, or the link acknowledged it and one known mote has the address
//   (decision 127). A mote with a log of what its radio was given hears that and nothing else.
// - A frame that the mote sends leaves only the hypotheses that allow it, stepped by
//   machine::call_join() and machine::join_timer(). A request may repeat, start a new call after
//   one that may have failed, or come from a mote that accepted but never learned that its ack_join
//   arrived (decision 102). `unknown` allows everything, and the frame tells what it becomes.
// - If none is left, the furthest one, the last of the set, is blamed, and the finding lists them
//   all. The set then goes on from what was seen, or from `unknown`.
//
// Tolerance: requests may come early_us() before the join period is over (decision 128), and as
// late as they like. FAIL is right from expiries_min() periods on, less early_us(). An ack_join may
// be repeated, kAckJoinsMax times, for a join period after the last request or after the acceptance
// and the response time; more than kFewAcks, or than are stated, are weak. Without stamps a request
// is always in time. Hypotheses that differ only in age are merged into the younger one, which
// allows more. Beyond kSetMax of them the mote is inconclusive, and unknown until it joins again.
//
// Cannot know: whether a request with a new number is a new call or the same one (decision 104);
// how a call ended that no log shows; whether the mote heard a link ack that the sniffer heard;
// that a mote rebooted without a break in its DSNs.
//
// Why an inconclusive finding is never a failure here: the machine's own functions decide what a
// state allows, so the set of a lawful mote stays filled as long as nothing escapes
// (align_lawful_test.cc and lawful_test.cc try this with lawful traffic). It can become empty
// because a frame escaped. Where one would explain what was seen, the severity is that of
// Context::without(): a failure only if none can have escaped. So it is with a net_msg before the
// join and with an ack_join that fits the mote's own request. A request with a number that changed
// is inconclusive, and so is one of a mote that only a link ack shows to have joined; one that goes
// on as the member that it was before it asked did not start anew, and is blamed for it. What no
// escaped frame would put right fails at once: a request to another address, one too early or one
// too many with the same number, an ack_join that fits no request of the mote.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/machine/state.h"

namespace rubric::check {

/// A state that a mote may be in. A frame on the air splits it: it was received, or it was lost.
struct MoteHypothesis {
  machine::JoinMote join;
  bool unknown = false;               ///< Nothing is known: it ran before the capture began.
  std::int64_t first_request_us = 0;  ///< In the present call.
  std::int64_t last_request_us = 0;
  std::int64_t accepted_us = 0;  ///< Time of the accepted reply.
  std::uint32_t reply = 0;       ///< Index of the accepted reply.
  bool renumbered = false;       ///< Requests of this call had several numbers.
  std::uint8_t acks_seen = 0;    ///< ack_join on the air.
  bool confirmed = false;        ///< The link acknowledged its ack_join; it may have heard that.
  bool linked = false;           ///< By its log the mote surely heard that.
  std::int64_t acked_us = 0;     ///< The last ack_join.
  bool unaccepted = false;       ///< It acked what it could not accept.
  bool void_offer = false;       ///< It accepted what was not offered to it (J4-ADDRESS).
  bool told = false;             ///< Its application got joined(SUCCESS).
  bool sent = false;             ///< It sent a net_msg, so in its own view it is a member.
  std::int64_t sent_us = 0;      ///< The last one with its address.
  bool wrong = false;            ///< It surely has another address than it shows.
};

/// A request of a member with another number, as that of a new call: it may have lost its power.
struct MemberAsked {
  machine::Address address;  ///< That it had.
  std::uint16_t seq_num = 0;
  std::int64_t time_us = 0;
};

/// A mote, through its lives.
struct MoteWatch {
  std::vector<MoteHypothesis> set;
  std::optional<Reply> wrong_reply;  ///< The last that its request had not asked for.
  Place wrong_place;
  std::optional<MemberAsked> asked;  ///< It has not joined since.
  std::int64_t booted_us = -1;       ///< By its log; -1: it shows no start.
  std::int64_t called_us = -1;  ///< Its last call of joinIsland began, by its log; -1: none did.
};

/// Returns whether the mote of that address is to ignore such an offer (J4-ADDRESS).
bool is_void(const Reply& reply, std::uint16_t am);

class MoteJoins {
 public:
  MoteJoins(Context& context, std::size_t devices);

  void begin_life(std::uint16_t mote);
  /// Notes that by its log the mote starts anew, with nothing before.
  void booted(std::uint16_t mote, std::int64_t now_us) { motes_[mote].booted_us = now_us; }
  /// Judges a request; a member's if a call of joinIsland asked for it `as_member`.
  void request(std::uint16_t mote, const Observation& seen, const Request& request,
               bool as_member = false);
  void reply(std::uint16_t mote, const Observation& seen, std::uint32_t index, const Reply& reply,
             bool surely_received);
  void ack_join(std::uint16_t mote, const Observation& seen, const AckJoin& ack, bool confirmed);
  void net_msg(std::uint16_t mote, const Observation& seen, const Net& net);

  const std::vector<MoteHypothesis>& set(std::uint16_t mote) const { return motes_[mote].set; }
  std::vector<MoteHypothesis>& set(std::uint16_t mote) { return motes_[mote].set; }
  /// Notes what the link told the mote until `now_us`, by its log.
  void link_told(std::uint16_t mote, std::int64_t now_us);
  /// Reports that the mote took an offer that was void, if by all that is possible it did, and lets
  /// it be a member there.
  void judge_offer(std::uint16_t mote, const Place& at, std::vector<MoteHypothesis>& set);
  /// Returns whether the mote was offered what its request had not asked for.
  bool stray_offer(std::uint16_t mote) const { return motes_[mote].wrong_reply.has_value(); }
  /// Returns at which expiry of its timer a call may fail first (decision 101).
  std::uint8_t expiries_min(std::uint16_t mote) const;
  /// Notes a call of joinIsland that begins now.
  void called(std::uint16_t mote, std::int64_t now_us) { motes_[mote].called_us = now_us; }
  /// Returns when the timer of a call may have begun to run: with its first request, or with the
  /// call itself where that request had to wait for a busy channel.
  std::int64_t began_us(std::uint16_t mote, const MoteHypothesis& h) const;
  /// Returns whether such a call may have failed by now.
  bool may_have_failed(std::uint16_t mote, const MoteHypothesis& h, std::int64_t now_us) const;
  /// Returns the hypotheses for a finding, the furthest first, each with what it misses.
  std::vector<Hypothesis> explanations(std::uint16_t mote, const std::vector<MoteHypothesis>& set,
                                       const std::string& miss) const;

  /// Returns whether every hypothesis has it outside: what it hears is not for it (J11-HEAR).
  bool is_outside(std::uint16_t mote) const;
  /// Returns whether it surely takes itself for a member (decisions 102, 118).
  bool surely_member(std::uint16_t mote) const;

  /// Returns the own address if every hypothesis agrees on it.
  std::optional<machine::Address> address(std::uint16_t mote) const;

 private:
  static constexpr std::size_t kSetMax = 256;
  static constexpr std::uint8_t kAckJoinsMax = 20;

  bool next_request(std::uint16_t mote, const MoteHypothesis& h, std::int64_t now_us,
                    const Request& request, std::vector<MoteHypothesis>& out);
  void refuse_request(std::uint16_t mote, const Observation& seen, const Request& request,
                      bool as_member);
  bool asked_as_member(std::uint16_t mote, const Place& at, machine::Address src, bool only);
  std::uint16_t sink_of(std::uint16_t island) const;
  bool may_take_copy(std::uint16_t mote, const MoteHypothesis& h, const AckJoin& ack,
                     std::int64_t now_us);
  ReqId why_not_ack(std::uint16_t mote, const MoteHypothesis& h, const Observation& seen,
                    const AckJoin& ack) const;
  void refuse_ack(std::uint16_t mote, const Observation& seen, const AckJoin& ack);
  std::string sentence(const MoteHypothesis& h) const;
  std::string allows(std::uint16_t mote, const MoteHypothesis& h) const;
  void keep(MoteWatch& watch, std::vector<MoteHypothesis>& next, std::uint16_t mote,
            const Observation& seen);

  Context& context_;
  std::vector<MoteWatch> motes_;
  std::vector<MoteHypothesis> next_;  // Scratch.
};

}  // namespace rubric::check
