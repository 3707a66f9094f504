// The air between radios: 802.15.4 at 250 kbit/s as a CC2420 under TinyOS uses it. A station waits
// a random time, listens, and sends; frames that overlap at a receiver destroy each other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "conformance/machine/actions.h"
#include "conformance/simulate/event_queue.h"
#include "conformance/simulate/network.h"
#include "conformance/simulate/recorder.h"

namespace rubric::simulate {

inline constexpr Micros kRadioByteUs = 32;
inline constexpr std::uint16_t kPanId = 0x0022;
/// Preamble, start of frame and length.
inline constexpr std::size_t kPhyBytes = 6;
inline constexpr std::size_t kFcsBytes = 2;
/// Returns how long a frame of so many bytes, FCS excluded, is in the air.
constexpr Micros air_us(std::size_t frame_bytes) {
  return static_cast<Micros>(kPhyBytes + frame_bytes + kFcsBytes) * kRadioByteUs;
}

/// The owner of radios.
class RadioUser {
 public:
  virtual ~RadioUser() = default;
  /// Returns whether power and radio are on.
  virtual bool listens(NodeId node) const = 0;
  virtual void heard(NodeId node, const machine::Frame& frame) = 0;
  /// Called when the frame given to send() has left; `acked` is true if no ack was asked for.
  virtual void radio_sent(NodeId node, bool acked) = 0;
};

class Radio {
 public:
  Radio(std::size_t index, const RadioPlan& plan, EventQueue& queue, Random& random,
        Recorder& recorder, RadioUser& user)
      : index_(index),
        plan_(plan),
        queue_(queue),
        random_(random),
        recorder_(recorder),
        user_(user) {}

  /// Adds a node's station, or, without a node, one that only sends.
  std::size_t add_station(std::optional<NodeId> node, std::uint16_t am_address);
  /// Takes a frame; the user waits for radio_sent() before the next.
  void send(std::size_t station, const machine::Frame& frame, bool link_ack);
  /// Restarts the station: it forgets pending frames, and counts frames from 0.
  void reset(std::size_t station) {
    ++stations_[station].life;
    stations_[station].dsn = 0;
    stations_[station].awaited.reset();
  }

 private:
  struct Station {
    std::optional<NodeId> node;
    std::uint16_t am_address = 0;
    std::uint8_t dsn = 0;
    bool sending = false;
    std::uint64_t life = 0;               ///< Work of a former life is not done.
    std::optional<std::uint8_t> awaited;  ///< DSN of the frame whose link ack is awaited.
  };
  struct Reception {
    std::size_t station = 0;
    bool destroyed = false;
  };
  /// A frame in the air. A link ack has no AM part.
  struct OnAir {
    std::size_t sender = 0;
    std::vector<std::uint8_t> bytes;  ///< Without FCS.
    machine::Frame am;                ///< Its payload lies in `bytes`.
    std::uint8_t dsn = 0;
    bool is_ack = false;
    bool asks_ack = false;
    std::uint64_t life = 0;           ///< The sender's.
    bool again = false;               ///< The link's own repetition: the same bytes, the same DSN.
    std::vector<std::size_t> had_it;  ///< Stations that got it before it was repeated.
    std::vector<Reception> receptions;
  };
  using Shared = std::shared_ptr<OnAir>;

  bool hears(std::size_t station, std::size_t sender) const;
  const Faults& faults(const Station& from, const Station& to) const;
  bool is_busy(std::size_t station) const;
  void try_channel(const Shared& frame, Micros backoff_us);
  void begin(const Shared& frame);
  void end(const Shared& frame);
  bool may_double() const;
  void repeat(const Shared& frame, std::vector<std::size_t> had_it);
  /// Returns whether the receiver got the frame and is to get it twice.
  bool receive(const OnAir& frame, const Reception& reception);
  void deliver(const Shared& frame, std::size_t station);
  void answer(const OnAir& frame, std::size_t station);
  void sent(const Shared& frame);
  void finish(std::size_t station, bool acked);

  std::size_t index_;
  const RadioPlan& plan_;
  EventQueue& queue_;
  Random& random_;
  Recorder& recorder_;
  RadioUser& user_;
  std::vector<Station> stations_;
  std::vector<Shared> air_;
};

}  // namespace rubric::simulate
