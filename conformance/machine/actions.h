// The results of a step: frames to put on a line, news for the application, and the rule for each.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <span>

#include "conformance/machine/event.h"

namespace rubric::machine {

/// A frame that the node puts on a line now.
struct Transmit {
  Link link = Link::kRadio;
  bool link_ack = false;  ///< Asks for the radio's own acknowledgement.
  std::uint8_t type = 0;
  std::uint8_t size_bytes = 0;
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::array<std::uint8_t, kAmPayloadMax> payload;

  Bytes bytes() const { return {payload.data(), size_bytes}; }
  Frame frame() const { return {link, dest, src, type, bytes()}; }
};

/// One labelled consequence. kFollowed changed the state or kept a rule without any output;
/// kIgnored had no effect because of the rule.
struct Action {
  enum class What : std::uint8_t { kTransmit, kNotify, kFollowed, kIgnored };
  What what = What::kFollowed;
  ReqId requirement = ReqId::kNone;
  std::uint8_t index = 0;  ///< Among the transmissions, or among the notices.
};

/// The consequences of one step, in order. Bounded, no heap; cleared by step().
class Actions {
 public:
  static constexpr std::size_t kTransmitsMax = 8;
  static constexpr std::size_t kNoticesMax = 24;
  static constexpr std::size_t kActionsMax = 64;

  void clear() { count_ = transmits_ = notices_ = 0; }
  /// Returns room for one more frame, to be filled at once.
  Transmit& transmit(ReqId requirement) {
    assert(transmits_ < kTransmitsMax);
    add(Action::What::kTransmit, requirement, transmits_);
    return transmit_[transmits_++];
  }
  void notify(const Notice& notice, ReqId requirement) {
    assert(notices_ < kNoticesMax);
    add(Action::What::kNotify, requirement, notices_);
    notice_[notices_++] = notice;
  }
  void followed(ReqId requirement) { add(Action::What::kFollowed, requirement, 0); }
  void ignored(ReqId requirement) { add(Action::What::kIgnored, requirement, 0); }

  std::span<const Action> all() const { return {action_.data(), count_}; }
  std::span<const Transmit> transmits() const { return {transmit_.data(), transmits_}; }
  std::span<const Notice> notices() const { return {notice_.data(), notices_}; }
  const Transmit& transmit_of(const Action& action) const { return transmit_[action.index]; }
  const Notice& notice_of(const Action& action) const { return notice_[action.index]; }

 private:
  void add(Action::What what, ReqId requirement, std::uint8_t index) {
    assert(count_ < kActionsMax);
    action_[count_++] = {what, requirement, index};
  }

  std::uint8_t count_ = 0;
  std::uint8_t transmits_ = 0;
  std::uint8_t notices_ = 0;
  std::array<Action, kActionsMax> action_;
  std::array<Transmit, kTransmitsMax> transmit_;
  std::array<Notice, kNoticesMax> notice_;
};

}  // namespace rubric::machine
