// Property: whatever a mote's line brings and however late, each packet that the host's link takes
// ends once, in order, confirmed if and only if the line confirmed one of its tries; and what the
// link writes are whole frames: those tries, each with the next number, and answers.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <set>
#include <vector>

#include "codec/containers/hdlc_reader.h"
#include "codec/lines/host_link.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;
using lines::HostLink;

constexpr std::size_t kNumbersKept = 128;  // Older ones are another packet's by now.

class Host {
 public:
  explicit Host(fuzz::Input input)
      : input_(input),
        options_(options_of(input_)),
        link_(options_, [this](const HostLink::Outcome& one) { ended(one); }) {}

  void run() {
    while (!input_.at_end()) step();
    link_.reset(now_);
    require(submitted_.empty() && link_.pending() == 0, "every packet ends");
  }

 private:
  static lines::HostLinkOptions options_of(fuzz::Input& input) {
    return {.ack_wait = lines::Milliseconds(1 + input.u8()),
            .tries = 1 + static_cast<int>(input.below(200)),
            .waiting_max = input.below(4),
            .listen_only = input.below(16) == 0};
  }

  void step() {
    switch (input_.below(6)) {
      case 0: submit(); break;
      case 1: hear(input_.bytes(input_.u8())); break;
      case 2: confirm(); break;
      case 3: wait(); break;
      case 4: write(); break;
      default:
        if (input_.below(8) == 0) lose();
    }
    require(link_.pending() == submitted_.size(), "all that were taken and have not ended wait");
    require(!options_.listen_only || link_.output().empty(), "who only listens writes nothing");
  }

  void submit() {
    const Bytes packet = input_.bytes(input_.u8());
    const std::size_t waiting = link_.pending();
    const HostLink::Submitted is = link_.submit(packet, now_);
    const bool fits = !packet.empty() && packet.size() <= HostLink::kPacketBytesMax;
    const bool room = waiting <= options_.waiting_max;
    require((is == HostLink::Submitted::kTaken) == (!options_.listen_only && fits && room),
            "what fits is taken");
    if (is == HostLink::Submitted::kTaken) submitted_.emplace_back(packet.begin(), packet.end());
  }

  void hear(Bytes bytes) {
    acks_.clear();
    auto note = [this](const Packet& frame) {
      if (frame.error.fault != Fault::kNone || frame.kind != kSerialAck) return;
      acks_.insert(static_cast<std::uint8_t>(frame.serial_seq));
    };
    ear_.feed(bytes, note);
    auto nothing = [](const Packet&) {};
    link_.take(bytes, now_, nothing);
  }

  // The confirmation of the last try that was written, or of a number near it.
  void confirm() {
    const std::uint64_t number = written_ - 1 + input_.below(2) * input_.u8();
    std::uint8_t frame[hdlc_frame_room(8)];
    const auto size = write_serial_ack(seq_of(number), MutableBytes(frame, sizeof frame));
    const bool is_ours = number + 1 == written_ && written_ > tries_;
    const std::uint64_t ended = next_outcome_;
    hear(Bytes(frame, *size));
    require(!is_ours || next_outcome_ > ended, "who is confirmed ends");
  }

  static std::uint8_t seq_of(std::uint64_t number) {
    return static_cast<std::uint8_t>(HostLink::kSeqFirst + number);
  }

  void wait() {
    now_ += lines::Milliseconds(input_.u8());
    const auto due = link_.next();
    require(due.has_value() == (link_.pending() > 0), "while a packet waits there is a time");
    link_.tick(now_);
  }

  // Takes some of the output, cut anywhere.
  void write() {
    const Bytes all = link_.output();
    const Bytes part = all.first(std::min(all.size(), std::size_t{input_.u16()}));
    auto read = [this](const Packet& frame) { written(frame); };
    line_.feed(part, read);
    link_.written(part.size());
  }

  void written(const Packet& frame) {
    require(frame.error.fault == Fault::kNone, "frames are whole");
    if (frame.kind != kSerialPacketAck) {
      require(frame.kind == kSerialAck || frame.kind == kSerialUnknown, "all others are answers");
      return;
    }
    require(frame.serial_seq == seq_of(written_++), "each try has the next number");
    require(!frame.bytes.empty(), "and a packet");
  }

  void lose() {
    link_.reset(now_);
    line_ = ear_ = HdlcReader();
    written_ = tries_;  // Tries that were never written had numbers, too.
  }

  void ended(const HostLink::Outcome& one) {
    require(one.packet == next_outcome_++, "packets end in order, each once");
    require(one.tries <= options_.tries, "no more tries than were asked for");
    const std::uint64_t begin = tries_;
    tries_ += static_cast<std::uint64_t>(one.tries);
    bool acked = false;
    for (std::uint64_t i = begin; i < tries_; ++i) {
      acked = acked || (tries_ - i <= kNumbersKept && acks_.contains(seq_of(i)));
    }
    require(!one.confirmed || acked, "only the line confirms");
    require(one.begun <= one.ended && one.ended == now_, "times are those of the calls");
    require(!submitted_.empty(), "it was taken before");
    submitted_.pop_front();
  }

  fuzz::Input input_;
  lines::HostLinkOptions options_;
  lines::SteadyTime now_ = lines::SteadyTime(std::chrono::hours(1));
  HdlcReader line_;  // What is written.
  HdlcReader ear_;   // What comes.
  std::set<std::uint8_t> acks_;
  std::deque<std::vector<std::uint8_t>> submitted_;
  std::uint64_t next_outcome_ = 0;
  std::uint64_t tries_ = 0;    // Of packets that have ended.
  std::uint64_t written_ = 0;  // Tries, those of lost lines included.
  HostLink link_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Host(fuzz::Input(data, size)).run();
  return 0;
}
