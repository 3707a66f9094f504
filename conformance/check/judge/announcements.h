// serial_joined and moteJoined: how a sink announces its new members, to its base station and to
// its application.
//
// Decides: whether each of them follows an ack_join that the sink had to accept (J6), by the
// hypotheses of sink_join.h, and whether one is missing. A serial_joined is due within the response
// time after the ack_join, or after the serial line was switched on again (by a whole log).
// Where the ack_join may have found the incoming buffer full (decision 122), one that is missing is
// inconclusive, and where the capture of the line misses other things that passed the sink; where
// the list may have been full when it came, nothing is owed.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/judge/sink_join.h"

namespace rubric::check {

class Announcements {
 public:
  Announcements(Context& context, SinkJoins& joins) : context_(context), joins_(joins) {}

  void report(std::uint16_t sink, const Observation& seen, const Net& net,
              const SerialJoined& joined);
  void told(std::uint16_t sink, const Observation& seen, const machine::MoteJoined& joined);
  /// Notes that the sink sent something at this time, so whatever it still owes is overdue.
  void showed_life(std::uint16_t sink, std::int64_t now_us);
  /// Notes that the sink's serial line is switched on or off; while off, no report is due.
  void serial_set(std::uint16_t sink, bool on, std::int64_t now_us);
  /// Judges what the sink owes its host, by a log that has all that it does until then.
  void overdue(std::uint16_t sink, std::int64_t now_us);
  /// Judges what its application was never told when the sink loses its power, or is told its
  /// island, or forgets a mote.
  void ends(std::uint16_t sink, std::int64_t now_us);
  void forgets(std::uint16_t sink, std::uint16_t mote_am, std::int64_t now_us);
  void finish();

 private:
  static constexpr std::int64_t kNotEnded = -1;

  void announce(SinkWatch& sink, const Place& at, machine::Address address,
                const machine::Descriptor& descriptor, bool notice);
  static bool owes(const SinkWatch& sink, std::uint16_t mote_am);
  void refuse_report(SinkWatch& sink, PairWatch& watch, const Place& at,
                     const machine::Admission& announced, bool notice, bool astray);
  /// Reports each serial_joined that is overdue; `end`: no frame of the sink comes any more.
  void overdue_reports(SinkWatch& sink, std::int64_t end_us);
  bool may_be_lost(const SinkWatch& sink, const PairWatch& watch) const;
  void unannounced(const SinkWatch& sink, std::uint16_t mote_am, const PairWatch& watch,
                   std::int64_t end_us);

  Context& context_;
  SinkJoins& joins_;
  std::vector<SinkHypothesis> next_;
};

}  // namespace rubric::check
