// Streams of DSNs: frames of one AM address that follow each other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/check/identify/given.h"
#include "conformance/check/identify/identity.h"
#include "conformance/check/message.h"

namespace rubric::check {

/// A frame's hints about its sender's island, and their weight.
struct IslandHint {
  std::uint16_t strong = kNoIsland;  ///< A reply's island, or the pid of the sink's own address.
  std::uint16_t src = kNoIsland;     ///< pid of a message from a base station.
  std::uint16_t dest = kNoIsland;    ///< Destination of a message that is passed on.
  std::uint16_t mote = kNoIsland;    ///< Were it a mote's: its island.
  std::uint16_t line = kNoIsland;    ///< The serial line down which the same message came lately.
  std::int32_t join = -1;            ///< The number in a join_request or an ack_join; -1: neither.
};

struct Stream {
  std::uint16_t am = 0;
  std::uint8_t dsn = 0;  ///< In the last frame.
  bool sink = false;
  bool joins = false;       ///< Its first frame was a join_request.
  bool asked = false;       ///< It sent a join_request.
  bool asks = false;        ///< Its last frame is one.
  std::int32_t join = -1;   ///< The number in its join_request, until it sends a message.
  bool given = false;       ///< Its island is what the user says, so far.
  std::uint32_t plain = 0;  ///< The first observation that shows its island, + 1; 0: none.
  std::uint16_t plain_island = kNoIsland;  ///< There.
  std::uint16_t island = kNoIsland;        ///< Now; may change by SET_ISLAND_ID.
  std::uint16_t first_island = kNoIsland;
  std::uint16_t last_island = kNoIsland;  ///< Before SET_ISLAND_ID.
  std::uint32_t first = 0;                ///< Observations.
  std::uint32_t last = 0;
  std::int64_t first_us = 0;
  std::int64_t last_us = 0;
  std::uint64_t frames = 0;
  std::uint8_t loose = 0;        ///< How far its last frame is ahead, if it may be another's; or 0.
  std::uint32_t last_of_am = 0;  ///< Frames of its address before its last one.
  /// Frames that were missed between two times.
  struct Hole {
    std::int64_t from_us = 0;
    std::int64_t to_us = 0;
    std::optional<std::uint8_t> dsn;  ///< Of the one frame, if it is only one.
  };
  std::vector<Hole> holes;
  /// Returns whether this one frame of another stream is the one that is missing in this stream.
  bool lacks(const Stream& other) const;
  /// Returns whether this is a new life of the sender of `other`, which was not heard since it
  /// began: then a frame that could be of both is of this one. `even`: it fits both as well;
  /// `request`: it is a join_request, which shows no island.
  bool renews(const Stream& other, bool even, bool request) const;
  /// Returns whether the frame is an ack_join with the number that the stream asked with.
  bool asked_for(const Observation& seen, const IslandHint& hint) const;
};

/// Assigns frames to streams, one after the other.
class Streams {
 public:
  Streams(const Run& run, const Options& options);
  /// Returns the stream of observation `index`, a radio frame with DSN; kNobody if it could be of
  /// two. Sets in its mark `repeat` if it is a copy of the frame before, and `late` if that did not
  /// come within the time in which the link repeats. An earlier frame that is shown to be of
  /// another sender is nobody's from then on.
  std::uint16_t assign(std::uint32_t index, std::vector<Mark>& marks);
  const std::vector<Stream>& all() const { return streams_; }
  /// Returns how many frames belong to none since there are as many streams as are kept.
  std::uint64_t left_out() const { return left_out_; }
  /// Notes that a base station sends the sink of `island` a message, which it may radiate.
  void heard_on_serial(const Net& net, std::uint16_t island);
  std::uint16_t sink_am() const { return sink_am_; }
  bool has_sink() const;
  /// Returns whether a sink of that island was heard.
  bool has_sink(std::uint16_t island) const;
  /// Notes that a base station changed the island of the sink with frames of island `from` to `to`.
  void rename_island(std::uint16_t from, std::uint16_t to);

 private:
  IslandHint hint_of(const machine::Frame& frame) const;
  void guess_island(Stream& stream, std::uint32_t index, const IslandHint& hint) const;
  int score(const Stream& stream, const Observation& seen, const IslandHint& hint) const;
  // Returns whether a sink's plain frame has the number of the stream's last one, which could have
  // been another sink's: then that frame is taken from the stream.
  bool takes_back(Stream& stream, const Observation& seen, const IslandHint& hint) const;
  std::uint16_t open(std::uint32_t index, const IslandHint& hint);
  void go_on(Stream& stream, std::uint32_t index, const IslandHint& hint);
  // Assigns a frame of Run::past, whose sender is known.
  std::uint16_t assign_past(std::uint32_t index, const IslandHint& hint);

  struct Down {
    std::uint64_t addresses = 0;
    std::uint16_t seq_num = 0;
    std::uint16_t island = kNoIsland;
  };
  std::array<Down, 16> downs_{};
  std::size_t down_next_ = 0;

  static constexpr std::uint16_t kLast = 0xFFFF;
  const Run& run_;
  const Given given_;
  std::uint16_t sink_am_;
  std::vector<Stream> streams_;
  std::uint64_t left_out_ = 0;
  std::vector<std::uint16_t> next_;       // Links streams of the same address.
  std::vector<std::uint16_t> first_of_;   // By AM address,
  std::vector<std::uint32_t> frames_of_;  // and the frames of it.
  std::vector<std::uint16_t> of_sender_;  // By number in Run::past.
};

}  // namespace rubric::check
