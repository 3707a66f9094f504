// The reference machine at the other end of a real line, in real time, for tests.
#pragma once

#include <atomic>
#include <climits>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "codec/lines/packet_line.h"
#include "codec/lines/stream.h"
#include "codec/runtime/hdlc.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/clock.h"
#include "conformance/trace/events/lines.h"

namespace rubric::targets {

/// How a node behaves in time. Up to 300 ticks in all are lawful (decision 125).
struct Pace {
  runner::Ticks late = 0;        ///< Its outputs leave so much later,
  runner::Ticks burst = 0;       ///< and together at multiples of this; 0: each by itself.
  lines::Milliseconds start{0};  ///< From the opening of its line; it hears nothing before.
};

/// A subject in real time whose outputs leave at its pace.
class PacedNode {
 public:
  PacedNode(std::unique_ptr<runner::Subject> subject, const Pace& pace)
      : target_(std::move(subject)), pace_(pace) {}

  /// Starts it. A base station tells its sink the island.
  void start(const machine::Config& config) {
    config_ = config;
    target_.reset(config);
    target_.hold_link_acks(holds_link_acks);
    waiting_.clear();
    seen_ = 0;
    clock_.start();
    if (config.role == machine::Role::kBaseStation && tells_island) {
      give(machine::Called{machine::SetIslandId{config.island}});
    }
  }
  runner::Ticks now() const { return clock_.now(); }
  const machine::Config& config() const { return config_; }

  void give(const machine::Event& event) {
    const runner::Ticks now = clock_.now();
    pass(now);
    target_.give(now, event);
    collect();
  }
  /// Lets time pass until now, and takes the next output that has left; nothing: none has.
  std::optional<runner::Output> take() {
    const runner::Ticks now = clock_.now();
    pass(now);
    if (waiting_.empty() || waiting_.front().time > now) return std::nullopt;
    runner::Output out = std::move(waiting_.front());
    waiting_.pop_front();
    return out;
  }
  /// Returns when it may do something by itself, at most `latest`.
  lines::SteadyTime next(lines::SteadyTime latest) const {
    if (const auto due = target_.next()) latest = std::min(latest, clock_.begin_of(*due));
    if (!waiting_.empty()) latest = std::min(latest, clock_.begin_of(waiting_.front().time));
    return latest;
  }

  bool holds_link_acks = false;
  bool tells_island = true;

 private:
  void pass(runner::Ticks now) {
    while (target_.run_until(now) < now) collect();
    collect();
  }
  void collect() {
    for (; seen_ < target_.outputs().size(); ++seen_) {
      runner::Output output = target_.outputs()[seen_];
      output.time += pace_.late;
      if (pace_.burst > 0) output.time = (output.time / pace_.burst + 1) * pace_.burst;
      waiting_.push_back(std::move(output));
    }
  }

  runner::SubjectTarget target_;
  const Pace pace_;
  machine::Config config_;
  RealClock clock_;
  std::size_t seen_ = 0;
  std::deque<runner::Output> waiting_;  // Their times are those at which they leave.
};

/// Runs a subject in a thread until it is destroyed. Opens the line whenever it can, each time with
/// a node that starts anew; with `lives_max`, only so often.
class RealNode {
 public:
  RealNode(std::unique_ptr<lines::PacketLine> line, const machine::Config& config,
           std::unique_ptr<runner::Subject> subject = std::make_unique<runner::Machine>(),
           const Pace& pace = {}, int lives_max = INT_MAX)
      : line_(std::move(line)),
        config_(config),
        pace_(pace),
        lives_max_(lives_max),
        node_(std::move(subject), pace) {
    thread_ = std::thread([this] { live(); });
  }
  ~RealNode() {
    stop_ = true;
    thread_.join();
  }
  int lives() const { return lives_; }

  /// Gives it an event that does not come by its line. One that has not started is not there.
  void give(const machine::Event& event) {
    const std::lock_guard lock(mutex_);
    if (running_) node_.give(event);
  }
  /// Takes what has left it by another way than its line.
  std::vector<runner::Output> take_others() {
    const std::lock_guard lock(mutex_);
    return std::exchange(others_, {});
  }

 private:
  static constexpr lines::Milliseconds kNap{3};
  static constexpr lines::Milliseconds kHandshake{200};

  void live() {
    while (!stop_ && lives_ < lives_max_) {
      try {
        line_->open(std::chrono::steady_clock::now() + kHandshake);
        ++lives_;
        run();
      } catch (const runner::TargetBroken&) {
        running_ = false;
        std::this_thread::sleep_for(lines::Milliseconds(1));
      }
    }
  }

  void run() {
    const auto start = std::chrono::steady_clock::now() + pace_.start;
    while (!stop_ && std::chrono::steady_clock::now() < start) line_->receive(start);
    {
      const std::lock_guard lock(mutex_);
      node_.start(config_);
      running_ = true;
    }
    while (!stop_) {
      const auto packet = line_->receive(next());
      const std::lock_guard lock(mutex_);
      if (packet) hear(packet->bytes);
      while (const auto output = node_.take()) tell(*output);
    }
  }

  lines::SteadyTime next() {
    const std::lock_guard lock(mutex_);
    return node_.next(std::chrono::steady_clock::now() + kNap);
  }

  void hear(const std::vector<std::uint8_t>& bytes) {
    trace::AmFrame am;
    if (!trace::parse_packet({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, am)) {
      return;
    }
    const machine::Frame frame{machine::Link::kSerial, am.dest, am.src, am.type,
                               Bytes(am.payload.data(), am.payload.size())};
    node_.give(machine::Heard{frame});
  }

  void tell(const runner::Output& output) {
    if (!output.is_frame || output.frame.link != machine::Link::kSerial) {
      others_.push_back(output);
      return;
    }
    line_->send(events::packet_of(output.frame.frame()),
                std::chrono::steady_clock::now() + lines::Milliseconds(1000));
  }

  std::unique_ptr<lines::PacketLine> line_;
  const machine::Config config_;
  const Pace pace_;
  const int lives_max_;
  PacedNode node_;
  std::atomic<bool> stop_{false};
  std::atomic<int> lives_{0};
  std::atomic<bool> running_{false};
  std::mutex mutex_;  // Of the node and its other outputs.
  std::vector<runner::Output> others_;
  std::thread thread_;
};

/// The mote's end of a serial line: confirms what it gets, and asks for no confirmation.
class MoteEnd : public lines::PacketLine {
 public:
  explicit MoteEnd(std::function<lines::ByteStream(lines::SteadyTime)> connect)
      : connect_(std::move(connect)) {}

  bool open(lines::SteadyTime deadline) override {
    if (stream_.is_open()) return false;
    stream_ = connect_(deadline);
    return true;
  }
  void close() override { stream_.close(); }
  void send(const std::vector<std::uint8_t>& packet, lines::SteadyTime deadline) override {
    std::uint8_t out[600];
    const auto size = write_serial_packet(Bytes(packet.data(), packet.size()), out);
    if (frames_damaged > 0) {
      --frames_damaged;
      out[*size / 2] ^= 1;
    }
    stream_.write(Bytes(out, *size), deadline);
  }
  std::optional<lines::TimedPacket> receive(lines::SteadyTime deadline) override {
    std::uint8_t byte = 0;
    while (stream_.read(MutableBytes(&byte, 1), deadline) == 1) {
      if (deframer_.push(byte) != HdlcEvent::kFrame) continue;
      const Bytes content = deframer_.content();
      if (content[0] != kSerialPacketAck) continue;
      if (deaf_to > 0) {
        --deaf_to;
        continue;
      }
      std::uint8_t out[16];
      const auto size = write_serial_ack(content[1], out);
      const bool confirms = unconfirmed == 0 || --unconfirmed > 0;
      if (confirms) stream_.write(Bytes(out, *size), deadline + lines::Milliseconds(1000));
      return lines::TimedPacket{std::chrono::steady_clock::now(),
                                {content.data() + 2, content.data() + content.size()}};
    }
    return std::nullopt;
  }

  std::atomic<int> deaf_to{0};         ///< So many packets that come next.
  std::atomic<int> unconfirmed{0};     ///< The packet of this number from now on, from 1.
  std::atomic<int> frames_damaged{0};  ///< So many that it sends next.

 private:
  std::function<lines::ByteStream(lines::SteadyTime)> connect_;
  lines::ByteStream stream_;
  std::uint8_t room_[300] = {};
  HdlcDeframer deframer_{MutableBytes(room_)};
};

}  // namespace rubric::targets
