// The host's end of a TinyOS serial line, without I/O and without a clock: the caller passes bytes
// and times in, writes the output, and calls again when it is time.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "codec/containers/hdlc_reader.h"
#include "codec/lines/time.h"
#include "codec/runtime/hdlc.h"

namespace rubric::lines {

/// Room for any frame that host_answer() writes.
inline constexpr std::size_t kHostAnswerRoom = hdlc_frame_room(8);

/// Writes the frame with which a host answers this one: the confirmation of a sound PACKET_ACK, or
/// the report of an unknown kind. Returns its size in bytes; 0 if there is nothing to answer.
/// Source: TEP 113, section 3.1; TinyOS's hosts answer unknown kinds so.
std::size_t host_answer(const Packet& packet, MutableBytes out);

/// Returns whether the frame is sound and carries a packet (PACKET_ACK or PACKET_NOACK and at least
/// a dispatch byte), so that it is for listeners and not for the link alone.
bool brings_packet(const Packet& packet);

struct HostLinkOptions {
  Milliseconds ack_wait{1000};   ///< Until a packet is sent again. TinyOS's Java host has 1000 ms,
  int tries = 25;                ///< and sends up to 25 times. A turn counts, too, when the line
                                 ///< had not taken the try before.
  std::size_t waiting_max = 64;  ///< Packets that wait after the current one.
  bool listen_only = false;      ///< Nothing is ever to be written; packets are refused.
};

/// Sends one packet at a time, as PACKET_ACK, and again with the next sequence number until the
/// mote confirms it. The confirmation of any try counts, for the packet has arrived then.
class HostLink {
 public:
  /// TinyOS's Java host begins with it too.
  static constexpr std::uint8_t kSeqFirst = 14;
  /// Packets of 1 to 252 bytes from the dispatch byte on go through a mote's serial line.
  static constexpr std::size_t kPacketBytesMax = kSerialAfterHeaderMax - kSerialCrcBytes;
  /// The most output that may wait; answers beyond it are left out, as by a mute host.
  static constexpr std::size_t kOutputMax = 4096;

  enum class Submitted : std::uint8_t {
    kTaken,
    kFull,     ///< `waiting_max` packets wait already.
    kBadSize,  ///< Not of 1 to kPacketBytesMax bytes.
    kListenOnly,
  };
  /// The result of a packet that was taken.
  struct Outcome {
    std::uint64_t packet = 0;  ///< Counts the packets that were taken, from 0.
    bool confirmed = false;
    int tries = 0;         ///< How often it was sent, or queued to be written; 0:
                           ///< the line was gone before its turn.
    int strange_acks = 0;  ///< Confirmations of other numbers that came meanwhile.
    SteadyTime begun;      ///< Time of the first try; as `ended` without one.
    SteadyTime ended;
  };
  /// May submit, but call nothing else of the link.
  using OnOutcome = std::function<void(const Outcome&)>;

  explicit HostLink(const HostLinkOptions& options = {}, OnOutcome on_outcome = {},
                    const ReaderOptions& reader_options = {});

  /// Takes a packet, from its dispatch byte on, and sends it when those before it are done.
  Submitted submit(Bytes packet, SteadyTime now);
  /// Returns the number of unfinished packets, including the one that is being sent.
  std::size_t pending() const { return waiting_.size(); }
  /// Returns how many packets were taken: the number of the next one.
  std::uint64_t taken() const { return taken_; }

  /// Takes bytes from the line. `sink` gets every frame as HdlcReader delivers it: packets,
  /// malformed frames, and confirmations, too (see brings_packet). It must not call the link.
  void take(Bytes bytes, SteadyTime now, PacketSink sink);
  /// Sends again or gives up, if it is time. Harmless at any time.
  void tick(SteadyTime now);
  /// Returns when tick() is due; nothing: not before something else happens.
  std::optional<SteadyTime> next() const;

  /// Returns the bytes to be written. Valid until the next call that is not const.
  Bytes output() const { return {output_.data(), output_.size()}; }
  /// Notes that the first `count` of them were written.
  void written(std::size_t count);

  /// Handles the loss of the line: `sink` gets the part of a frame that has arrived, all unfinished
  /// packets end unconfirmed, and no output is left. The sequence number continues, lest the mote's
  /// late answer be taken for one to a new packet.
  void reset(SteadyTime now, PacketSink sink);
  void reset(SteadyTime now);

 private:
  struct Waiting {
    std::uint64_t number;
    std::vector<std::uint8_t> bytes;
  };

  void send(SteadyTime now);
  void heard(const Packet& packet, SteadyTime now);
  bool is_ours(std::uint8_t seq) const;
  void end(bool confirmed, SteadyTime now);
  void put(Bytes frame);

  HostLinkOptions options_;
  OnOutcome on_outcome_;
  HdlcReader reader_;
  std::deque<Waiting> waiting_;  // The first one is being sent.
  std::uint64_t taken_ = 0;
  std::vector<std::uint8_t> output_;
  Outcome current_;  // The packet being sent, so far.
  int turns_ = 0;    // How often it was its turn.
  SteadyTime due_;
  std::uint8_t seq_ = kSeqFirst;  // The next try's.
};

}  // namespace rubric::lines
