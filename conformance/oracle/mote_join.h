// Joins as motes make them: for each life of a mote a set of hypotheses about its join, each one
// stepped by the very functions of the machine.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/machine/state.h"
#include "conformance/oracle/context.h"

namespace rubric::oracle {

/// What a mote may be in. A frame on the air makes two of one: it was received, or it was lost.
struct MoteHypothesis {
  machine::JoinMote join;
  bool unknown = false;           ///< Nothing is known: it ran before the capture began.
  std::int64_t first_request_us = 0;  ///< Of the present call.
  std::int64_t last_request_us = 0;
  std::int64_t accepted_us = 0;   ///< When the reply was heard.
  std::uint32_t reply = 0;        ///< Which observation that was.
  bool renumbered = false;        ///< Requests of this call had several numbers.
  std::uint8_t acks_seen = 0;     ///< ack_join on the air.
  bool confirmed = false;         ///< The link acknowledged its ack_join; it may have heard that.
  bool unaccepted = false;        ///< It acked what it could not accept.
  bool told = false;              ///< Its application was told SUCCESS.
  bool sent = false;              ///< It sent a net_msg, so in its own view it is a member.
};

/// A mote, through its lives.
struct MoteWatch {
  std::vector<MoteHypothesis> set;
  std::optional<Reply> wrong_reply;   ///< The last that its request had not asked for.
  Place wrong_place;
  std::int64_t joined_calls = 0;  ///< Calls that have not ended, by a log.
  bool calls_logged = false;
  std::optional<machine::JoinIsland> call;  ///< The last, by a log.
  std::int64_t called_us = 0;
};

class MoteJoins {
 public:
  MoteJoins(Context& context, std::size_t devices);

  void begin_life(std::uint16_t mote);
  void request(std::uint16_t mote, const Observation& seen, const Request& request);
  void reply(std::uint16_t mote, const Observation& seen, std::uint32_t index, const Reply& reply,
             bool surely_received);
  void ack_join(std::uint16_t mote, const Observation& seen, const AckJoin& ack, bool confirmed);
  void net_msg(std::uint16_t mote, const Observation& seen, const Net& net);
  void called(std::uint16_t mote, const Observation& seen, const machine::JoinIsland& call);
  void told(std::uint16_t mote, const Observation& seen, const machine::Joined& joined);
  void finish(std::int64_t end_us);

  const std::vector<MoteHypothesis>& set(std::uint16_t mote) const { return motes_[mote].set; }

  /// The own address where every hypothesis agrees on it.
  std::optional<machine::Address> address(std::uint16_t mote) const;

 private:
  static constexpr std::size_t kSetMax = 256;
  static constexpr std::uint8_t kAckJoinsMax = 20;
  static constexpr std::uint8_t kExpiriesMin = 4;  // Before a FAIL (decision 101).

  bool may_have_failed(const MoteHypothesis& h, std::int64_t now_us) const;
  bool next_request(const MoteHypothesis& h, std::uint16_t id, std::int64_t now_us,
                    const Request& request, std::vector<MoteHypothesis>& out);
  void refuse_request(std::uint16_t mote, const Observation& seen, const Request& request);
  ReqId why_not_ack(const MoteHypothesis& h, const Observation& seen, const AckJoin& ack) const;
  void refuse_ack(std::uint16_t mote, const Observation& seen, const AckJoin& ack);
  std::string sentence(const MoteHypothesis& h) const;
  std::string allows(const MoteHypothesis& h) const;
  void keep(MoteWatch& watch, std::vector<MoteHypothesis>& next, std::uint16_t mote,
            const Observation& seen);

  Context& context_;
  std::vector<MoteWatch> motes_;
  std::vector<MoteHypothesis> next_;  // Scratch.
};

}  // namespace rubric::oracle
