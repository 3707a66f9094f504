// The reference machine at the other end of a real line, in real time, for tests.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "codec/lines/packet_line.h"
#include "codec/lines/stream.h"
#include "codec/runtime/hdlc.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/clock.h"
#include "conformance/trace/trace.h"

namespace rubric::targets {

/// Runs a subject in a thread until it is destroyed or its line ends. Opens the line whenever it
/// can, each time with a new subject.
class RealNode {
 public:
  RealNode(std::unique_ptr<lines::PacketLine> line, const machine::Config& config,
           std::unique_ptr<runner::Subject> subject = std::make_unique<runner::Machine>())
      : line_(std::move(line)), config_(config), target_(std::move(subject)) {
    thread_ = std::thread([this] { live(); });
  }
  ~RealNode() {
    stop_ = true;
    thread_.join();
  }
  int lives() const { return lives_; }

 private:
  static constexpr lines::Milliseconds kNap{10};

  void live() {
    while (!stop_) {
      try {
        line_->open(std::chrono::steady_clock::now() + kNap);
        ++lives_;
        run();
      } catch (const runner::TargetBroken&) {
        std::this_thread::sleep_for(lines::Milliseconds(1));
      }
    }
  }

  void run() {
    RealClock clock;
    std::size_t told = 0;
    target_.reset(config_);
    while (!stop_) {
      const lines::SteadyTime nap_end = std::chrono::steady_clock::now() + kNap;
      const auto due = target_.next();
      const auto packet = line_->receive(due ? std::min(nap_end, clock.begin_of(*due)) : nap_end);
      const runner::Ticks now = clock.now();
      while (target_.run_until(now) < now) {
      }
      if (packet) hear(packet->bytes, now);
      for (; told < target_.outputs().size(); ++told) tell(target_.outputs()[told]);
    }
  }

  void hear(const std::vector<std::uint8_t>& bytes, runner::Ticks now) {
    trace::AmFrame am;
    if (!trace::parse_packet({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, am)) {
      return;
    }
    const machine::Frame frame{machine::Link::kSerial, am.dest, am.src, am.type,
                               Bytes(am.payload.data(), am.payload.size())};
    target_.give(now, machine::Heard{frame});
  }

  void tell(const runner::Output& output) {
    if (!output.is_frame || output.frame.link != machine::Link::kSerial) return;
    const machine::Frame frame = output.frame.frame();
    line_->send(
        trace::packet_of(
            {frame.dest, frame.src, 0, frame.type, {frame.payload.begin(), frame.payload.end()}}),
        std::chrono::steady_clock::now() + lines::Milliseconds(1000));
  }

  std::unique_ptr<lines::PacketLine> line_;
  const machine::Config config_;
  runner::SubjectTarget target_;
  std::atomic<bool> stop_{false};
  std::atomic<int> lives_{0};
  std::thread thread_;
};

/// The mote's end of a serial line: confirms what it gets, and asks for no confirmation.
class MoteEnd : public lines::PacketLine {
 public:
  explicit MoteEnd(std::function<lines::ByteStream(lines::SteadyTime)> connect)
      : connect_(std::move(connect)) {}

  void open(lines::SteadyTime deadline) override {
    if (!stream_.is_open()) stream_ = connect_(deadline);
  }
  void close() override { stream_.close(); }
  void send(const std::vector<std::uint8_t>& packet, lines::SteadyTime deadline) override {
    std::uint8_t out[600];
    const auto size = write_serial_packet(Bytes(packet.data(), packet.size()), out);
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
      stream_.write(Bytes(out, *size), deadline + lines::Milliseconds(1000));
      return lines::TimedPacket{std::chrono::steady_clock::now(),
                                {content.data() + 2, content.data() + content.size()}};
    }
    return std::nullopt;
  }

  std::atomic<int> deaf_to{0};  ///< So many packets that come next.

 private:
  std::function<lines::ByteStream(lines::SteadyTime)> connect_;
  lines::ByteStream stream_;
  std::uint8_t room_[300] = {};
  HdlcDeframer deframer_{MutableBytes(room_)};
};

}  // namespace rubric::targets
