// joinIsland and joined, as a mote's log has them: what its application called and was told.
//
// MoteJoins knows the states that a mote may be in; here they are compared with the calls (J1) and
// the events (J5, J8), which in turn rule out states that do not fit what the application was told.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/check/judge/mote_join.h"

namespace rubric::check {

class JoinCalls {
 public:
  JoinCalls(Context& context, MoteJoins& motes, std::size_t devices);

  void begin_life(std::uint16_t mote);
  /// Judges a request by the calls. Called before MoteJoins::request(). Returns whether one of
  /// them, of a mote that was a member, asked for it.
  bool request(std::uint16_t mote, const Observation& seen, const Request& request);
  void called(std::uint16_t mote, const Observation& seen, const machine::JoinIsland& call);
  void told(std::uint16_t mote, const Observation& seen, const machine::Joined& joined);
  void radio_set(std::uint16_t mote, bool on, std::int64_t now_us);
  /// Judges what the application was never told when a life of the mote ends, or the log.
  void closes(std::uint16_t mote, std::int64_t end_us);
  void finish();

 private:
  struct Calls {
    bool logged = false;    ///< The log has join calls at all,
    bool recorded = false;  ///< or at least other calls.
    std::int64_t open = 0;  ///< That have not ended.
    std::optional<machine::JoinIsland> last;
    std::optional<machine::JoinIsland> earlier;  ///< Open when the last one came.
    bool refusable = true;                       ///< That one may fail at once.
    Place called;
    bool waits = false;                    ///< It came while another one ran.
    bool asks = false;                     ///< It owes a join_request.
    std::int64_t told_us = INT64_MIN / 2;  ///< When the last one ended.
    std::int64_t off_since_us = -1;  ///< Its application switched the radio off; -1: it is on.
    std::int64_t off_us = 0;         ///< How long it was off in the open call.
    std::optional<Request> asked;    ///< The last request,
    Place asked_at;                  ///< and where.
    bool fresh = false;              ///< The last call, of a mote with none open, sent none.
  };

  void ends(std::uint16_t mote, std::int64_t end_us);
  void judge_member(std::uint16_t mote, const MoteHypothesis& h, std::int64_t end_us);
  void judge_over(std::uint16_t mote, std::int64_t now_us);
  void judge_silent(std::uint16_t mote, std::int64_t end_us);
  bool judge_late(std::uint16_t mote, const Observation& seen,
                  const std::vector<MoteHypothesis>& set);
  std::string fails_by(std::uint16_t mote) const;
  std::int64_t joined_us(std::uint16_t mote, const MoteHypothesis& h, std::int64_t now_us) const;
  std::int64_t last_expiry_us(std::uint16_t mote, const MoteHypothesis& h) const;

  Context& context_;
  MoteJoins& motes_;
  std::vector<Calls> calls_;
};

}  // namespace rubric::check
