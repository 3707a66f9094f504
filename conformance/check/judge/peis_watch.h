// Judges what base stations pass on between their sinks and PEIS, and that they tell their sinks
// the island that an application sets, where a log has these lines.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/check/ring.h"

namespace rubric::check {

class PeisWatch {
 public:
  PeisWatch(Context& context, std::size_t devices);

  void begin_life(std::uint16_t base) { bases_[base] = Base{}; }
  /// Notes that the island of `base` is another one now.
  void moved(std::uint16_t base) { bases_[base].moved = true; }
  /// Takes a message from the sink of `base`, in `island`; unless it is on, nothing is owed.
  void came_up(std::uint16_t base, std::uint16_t island, const Observation& seen, const Net& net,
               bool on);
  /// Notes that the message came up while the serial interface of `base` was switched off, and
  /// whether for so long (`off`) that it is not to be received.
  void came_while_off(std::uint16_t base, const Net& net, bool off);
  /// Notes that the serial interface of `base` is switched: while it is off what waits stays.
  void switched(std::uint16_t base, bool on, std::int64_t now_us);
  /// Notes that the log gives `base` a message that came up before.
  void surely_up(std::uint16_t base, const Net& net, std::int64_t now_us);
  /// Judges a message that `base` gives to PEIS; `own` is its address. Returns whether it is one of
  /// its own, to be judged as such; not if no message of this kind goes there, as all else that is
  /// odd about it has that one cause. `first`: its own message of this number did not leave yet.
  bool sent(std::uint16_t base, const Observation& seen, const Net& net, machine::Address own,
            bool first);
  /// Takes a message from PEIS to `base`, whose serial interface may be off.
  void given(std::uint16_t base, const Observation& seen, const Net& net, machine::Address own,
             bool serial_off);
  /// Returns whether a message that came to `base`, from its sink or from PEIS, waits to be passed
  /// on.
  bool came(std::uint16_t base, const Net& net) {
    return match(bases_[base].up, net) != nullptr || match(bases_[base].down, net) != nullptr;
  }
  /// Judges a message that `base` sends down to its sink and that is not its own.
  void went_down(std::uint16_t base, const Observation& seen, const Net& net);
  /// Notes a call that sets the island, which `base` must tell its sink if it `owes` that.
  void asked_island(std::uint16_t base, const Observation& call, std::uint16_t island, bool owes);
  /// Notes that the last call, which set `island`, failed.
  void refused_island(std::uint16_t base, std::uint16_t island);
  /// Judges a config message of `base` that sets `island`; -1 if it sets none.
  void told_island(std::uint16_t base, const Observation& seen, std::int32_t island);
  /// Judges what the base station owes, by a log that has all that it does until then.
  void overdue(std::uint16_t base, std::int64_t now_us);
  void finish();

 private:
  static constexpr std::size_t kRoom = 64;

  struct Message {
    Net net;
    Place place;
    bool owed = false;  ///< Surely received, to be passed on, and not yet seen to be.
    bool passed = false;
    bool came = true;   ///< The base station may have it: a whole log says what it was given.
    bool off = false;   ///< It came while its interface was switched off.
    bool held = false;  ///< It is owed once its interface is on.
    std::int64_t given_us = -1;  ///< When the base station had it, by its log.
  };
  using Messages = Ring<Message, kRoom>;
  struct Asked {  ///< A call that sets the island.
    Place place;
    std::uint16_t island = 0;
  };
  struct Base {
    Messages up;               ///< From the sink.
    Messages down;             ///< From PEIS.
    bool moved = false;        ///< Its application set another island.
    bool called = false;       ///< It was called to set one.
    std::vector<Asked> asked;  ///< Calls that the sink was not told of, oldest first.
  };

  static Message* match(Messages& messages, const Net& net);
  void refuse(std::uint16_t base, const Observation& seen, const Net& net, Messages& messages,
              bool up);
  void overdue_island(std::uint16_t base, std::int64_t now_us);
  void overdue(std::uint16_t base, Messages& messages, bool up, std::int64_t now_us, bool end);

  Context& context_;
  std::vector<Base> bases_;
};

}  // namespace rubric::check
