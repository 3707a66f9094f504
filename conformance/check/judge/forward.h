// Judges what sinks pass on: from the radio to their serial line and back.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/check/judge/sizes.h"
#include "conformance/check/ring.h"
#include "conformance/machine/route.h"

namespace rubric::check {

/// A message that a sink may have received, on its way through.
struct Passing {
  Net net;
  Place place;
  std::int64_t last_us = 0;    ///< When it came, or was repeated, for the last time.
  std::int64_t whole_us = -1;  ///< When the sink has it whole.
  std::uint64_t order = 0;     ///< Counts arrivals at the sink.
  std::uint16_t sender = kNobody;
  std::uint16_t am_dest = 0;       ///< The radio frame's destination.
  ReqId forbidden = ReqId::kNone;  ///< Passing it on breaks this rule.
  bool weak = false;               ///< And that rule is a SHOULD.
  bool owed = false;               ///< Received, and not yet passed on.
  bool owes = false;               ///< It is to be passed on, if it was received.
  bool sure = true;                ///< The reception is proven.
  bool came = true;         ///< By a whole log it was given to the sink, or the sink was off.
  bool cut = false;         ///< It came without the bytes after its payload.
  bool twin = false;        ///< Another one of the same content is around.
  bool told = false;        ///< One ahead of its cause: it is reported if that does not come.
  std::uint8_t copies = 1;  ///< Times that it may have been received.
  std::uint8_t passed = 0;
  std::uint8_t relayed = 0;  ///< Sent on by radio, where it came from.
};

class Forwarding {
 public:
  /// How a message came down a sink's serial line.
  struct Down {
    bool sure = false;                 ///< The sink surely received it, and is able to radiate it.
    bool given = false;                ///< It surely came to its end of the line.
    bool off = false;                  ///< Which is switched off.
    std::uint16_t island = kNoIsland;  ///< Of the base station.
  };

  Forwarding(Context& context);

  /// Takes a message on the air, from somebody else, to the address of sinks or to all.
  /// `off`: a sink that by its log was given it although its radio is switched off.
  void heard_on_radio(const Observation& seen, std::uint16_t sender, const Net& net,
                      std::uint16_t surely_received_by, std::uint16_t off);
  /// Notes that the link repeated the frame: on the air, or down the serial line of `sink`.
  void repeated(const Net& net, std::uint16_t sink, std::int64_t now_us);
  /// Takes a message down the serial line of `sink`.
  void heard_on_serial(std::uint16_t sink, std::uint16_t base, const Observation& seen,
                       const Net& net, Down down);
  /// Returns whether the same message came down the sink's serial line, or one that may be its, and
  /// was not yet radiated.
  bool came_down(std::uint16_t sink, const Net& net);
  /// Returns whether by a log of the sink one came down and waits that differs in its source alone.
  bool alters(std::uint16_t sink, const Net& net);
  /// Returns whether the same message was heard by the sink's radio, and was not yet passed on.
  bool came_up(std::uint16_t sink, const Net& net);
  /// Judges a message on its serial line that is not the sink's own.
  void sent_on_serial(std::uint16_t sink, const Observation& seen, const Net& net);
  /// Judges a message by radio that is not the sink's own.
  /// Returns false if its serial line is not known, so that nobody can say where it came from.
  bool sent_on_radio(std::uint16_t sink, const Observation& seen, const Net& net);
  /// Notes that the sink's serial line is switched on or off; while off, the sink owes nothing
  /// there.
  void serial_set(std::uint16_t sink, bool on);
  /// Notes that its radio is switched on or off; while off, it owes nothing of what it hears there,
  /// or should send.
  void radio_set(std::uint16_t sink, bool on);
  /// Notes that the sink sent something; by radio, what it should have radiated is overdue.
  void showed_life(std::uint16_t sink, const Observation& seen);
  /// Notes that one of the sinks, unknown which, sent this by radio.
  void somebody_sent(const Net& net);
  /// Notes that by a log the sink was given a message that its host sent before.
  void surely_down(std::uint16_t sink, const Net& net, std::int64_t now_us);
  /// Returns whether a message of the sink's own has all but the source of one that it heard and
  /// has not forwarded yet.
  bool alters_up(std::uint16_t sink, const Net& net);
  /// Notes that another message left on the sink's serial line.
  void went_up(std::uint16_t sink, std::int64_t now_us);
  /// Sets the island that the sink is told.
  void set_island(std::uint16_t sink, std::uint16_t island, std::int64_t now_us, bool sure);
  /// Notes that the sink acts for that island.
  void acts(std::uint16_t sink, std::uint16_t island, std::int64_t now_us);
  /// Notes that something came down its line damaged, which may have told it another island.
  void perhaps_told(std::uint16_t sink);
  void begin_life(std::uint16_t sink, std::int64_t since_us);
  /// Judges what the sink owes, by a log that has all that it does until then.
  void overdue(std::uint16_t sink, std::int64_t now_us);
  void finish();

 private:
  static constexpr std::size_t kRoom = 256;
  static constexpr std::size_t kEarlyRoom = 16;
  static constexpr std::size_t kTwinsLook = 64;

  /// What passes a sink in one direction.
  struct Way : Ring<Passing, kRoom> {
    std::uint32_t owed = 0;       ///< So many of these.
    std::uint32_t forgotten = 0;  ///< Owed ones that were pushed out, and may still be passed on.
  };

  struct Line {
    std::uint16_t sink = kNobody;
    std::uint16_t am = 0;
    std::uint16_t island = kNoIsland;
    std::uint16_t last_island = kNoIsland;  ///< Before SET_ISLAND_ID.
    std::int64_t island_changed_us = -1'000'000'000;
    std::int64_t island_shown_us = -1'000'000'000;  ///< When it last acted for its island.
    std::int64_t slack_us = 0;                      ///< For so long it may act for either island.
    bool island_sure = true;                        ///< That change surely arrived.
    bool told = false;  ///< It was told an island, perhaps before the capture.
    /// Returns whether its island changed about then.
    bool changing(std::int64_t time_us) const;
    bool off = false;                 // Its serial line, by its application.
    bool deaf = false;                // Its radio, by its application.
    bool serial = false;              ///< Its line is captured.
    Way up;                           ///< From the radio.
    Way down;                         ///< From serial.
    Ring<Passing, kEarlyRoom> early;  ///< On serial before the radio stamp, by skew of the taps.
    Ring<Passing, kEarlyRoom> ahead;  ///< By radio before the serial stamp.
    std::uint64_t order = 0;
    /// The latest that was passed on.
    struct Last {
      std::uint64_t order = 0;
      std::int64_t begun_us = INT64_MAX;
    };
    Last last_up;
    Last last_down;
    Place on_air;                 ///< The last frame that it sent there.
    Place on_line;                ///< And on its serial line.
    std::uint32_t heard = 0;      ///< Messages for its base station that it may have received.
    std::uint32_t forwarded = 0;  ///< Messages that it passed on to its base station.
    Stale stale;                  ///< On its serial line.
  };

  static void change_island(Line& line, std::uint16_t island, std::int64_t now_us, bool sure);
  void forwards_nothing(const Line& line);
  Line* find(std::uint16_t sink);
  static void store(Way& way, const Passing& passing);
  /// Returns whether the message is among these, `waiting`: not yet passed on.
  static bool holds(const Way& way, const Net& net, bool waiting);
  static void forget_owed(Way& way);
  void pass_up(Line& line, Passing& passing, const Observation& seen);
  void pass_down(Line& line, Passing& passing, const Observation& seen, const Net& net);
  void refuse_up(Line& line, const Observation& seen, const Net& net);
  bool resembles(const Line& line, const Passing& came, const Net& net) const;
  void refuse_down(Line& line, const Observation& seen, const Net& net);
  void expire_early(Line& line, std::int64_t now_us);
  void overdue_up(Line& line, std::int64_t now_us, Severity most = Severity::kFail);
  void overdue_down(Line& line, std::int64_t now_us, Severity most = Severity::kFail);
  bool crowded(const Line& line, const Passing& passing, machine::Link out) const;
  bool may_be_anothers(const Line& line, const Net& net);
  bool relayed(Line& line, const Observation& seen, const Net& net);
  void unheard(Line& line, const Passing& passing);
  void invented(Line& line, const Passing& passing);
  void judge_order(Line& line, const Passing& passing, const Observation& seen);

  Context& context_;
  std::vector<Line> lines_;
};

}  // namespace rubric::check
