// A variant's decisions about a network before it runs.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "conformance/selftest/lawful_traffic/message.h"

namespace rubric::lawful {

class World;
class Device;
struct RadioFrame;

enum class JoinedWhen : std::uint8_t { kAcceptance, kLinkAck };
/// The act of a mote that has acked a reply but saw no link ack for it, when its timer expires.
enum class Unconfirmed : std::uint8_t { kFail, kRequestAgain };
enum class SeqMode : std::uint8_t { kRandom, kCounting, kNearTheEnd };
enum class AckForm : std::uint8_t { kDeployed, kPaper, kPerNode };
/// A sink's treatment of pid 0xFFFF from its own island. kRefuse: sends none of its own either.
enum class WidePid : std::uint8_t { kIgnore, kForward, kRefuse };
/// A receiver's treatment of `reliable` other than 0 or 1.
enum class OddReliable : std::uint8_t { kDrop, kUnreliable };

/// Every freedom that the rules leave. The defaults are those of a common network.
struct Traits {
  // Join.
  int requests_max = 5;
  bool new_seq_per_retry = false;
  std::int64_t join_period_us = 488'281;  ///< 500 binary milliseconds.
  JoinedWhen joined_when = JoinedWhen::kAcceptance;
  Unconfirmed unconfirmed = Unconfirmed::kFail;
  int ack_join_max = 1;            ///< Transmissions of one ack_join.
  bool ack_join_always = false;    ///< All of them, confirmed or not.
  bool ack_join_same_dsn = false;  ///< Repeated by the link layer.
  int join_calls = 1;              ///< joinIsland again after FAIL, that many calls in all.
  std::int64_t join_pause_us = 1'500'000;
  // Timing.
  std::int64_t delay_min_us = 300;  ///< From hearing to acting.
  std::int64_t delay_max_us = 3'000;
  std::int64_t access_min_us = 300;  ///< Channel access.
  std::int64_t access_max_us = 9'000;
  int clock_ppm_min = -50;
  int clock_ppm_max = 50;
  // Sequence numbers.
  SeqMode seq_mode = SeqMode::kRandom;
  bool uses_ffff = false;  ///< 0xFFFF as a sequence number.
  // Transport.
  AckForm ack_form = AckForm::kDeployed;
  bool ack_unknown_app = true;
  bool ack_broadcasts = false;
  bool answer_before_ack = false;
  std::int64_t ack_timeout_us = 1'000'000;
  int app_resends = 0;  ///< Times an application sends a failed message again.
  bool resend_same_seq = false;
  OddReliable odd_reliable = OddReliable::kDrop;
  // Buffers, in messages.
  std::size_t in_buffer = 64;
  std::size_t out_buffer = 64;
  // Sinks.
  bool serial_true_nbytes = false;
  bool serial_cut = false;         ///< On the serial line a net_msg ends after its nbytes.
  bool relays_for_others = false;  ///< Sends a message for another mote on by radio.
  bool forwards_foreign_source = true;
  bool forgets_members = true;    ///< When its island id changes.
  bool radiates_foreign = false;  ///< Messages from serial for another island.
  WidePid wide_pid = WidePid::kIgnore;
  std::size_t members_max = 20;
  bool answers_when_full = false;
  bool binary_time = false;  ///< cur_time in 1024ths of a second.
  std::uint32_t time_offset_ms = 0;
  // Motes.
  bool wide_pid_to_all = true;  ///< pid 0xFFFF goes out as AM broadcast, not to the sink.
  // Synaptic channels.
  std::uint8_t synaptic_app = 11;  ///< ESN_DATA, or 6 for LEARNING.
  bool phase_shift = true;
  bool restart_shifts_clock = false;
  std::int64_t synaptic_period_us = 488'281;
  // Base stations.
  bool hands_foreign_to_sink = false;
  std::int64_t peis_min_us = 2'000;
  std::int64_t peis_max_us = 60'000;
  std::uint16_t serial_am_dest = 1;
};

struct MotePlan {
  std::uint16_t id = 0;
  int island = 0;  ///< Index; whose sink it prefers.
  std::int64_t boot_us = 0;
  bool updates = true;         ///< Sends a reading every 500 binary ms once joined.
  std::int64_t leave_us = -1;  ///< Falls silent then; -1 for never.
  bool any_sink = false;       ///< Takes the reply that comes first.
  Descriptor descriptor;
};

using Script = std::function<void(World&)>;
/// Returns whether `to` misses `frame`.
using Loss = std::function<bool(World&, const RadioFrame& frame, const Device& to)>;
/// Returns whether the sender of `frame` misses its link ack.
using AckLoss = std::function<bool(World&, const RadioFrame& frame)>;

struct Plan {
  Traits traits;
  std::vector<std::uint16_t> islands{11};
  bool islands_apart = true;  ///< Nodes of different islands do not hear each other.
  std::vector<MotePlan> motes;
  std::int64_t end_us = 10'000'000;
  int chats = 12;  ///< Messages of applications in random directions.
  bool foreign_chats = true;
  int net_loss_percent = 1;  ///< Receptions of net_msg.
  std::vector<Loss> losses;
  std::vector<AckLoss> ack_losses;
  std::vector<std::pair<std::int64_t, Script>> script;
  int corrupt_percent = 0;         ///< Radio frames; nobody takes them.
  int serial_corrupt_percent = 0;  ///< Frames from host to mote.
  int serial_ack_corrupt_percent = 0;
  // The capture.
  int sniffer_misses_percent = 0;
  std::int64_t capture_from_us = 0;
  bool capture_radio = true;
  bool capture_serial = true;
  bool all_well_formed = true;

  void at(std::int64_t time_us, Script what) { script.emplace_back(time_us, std::move(what)); }
};

}  // namespace rubric::lawful
