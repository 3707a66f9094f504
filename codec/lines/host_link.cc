#include "codec/lines/host_link.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubric::lines {
namespace {

// Numbers older than half a round have expired.
constexpr int kNumbersKept = 128;

}  // namespace

std::size_t host_answer(const Packet& packet, MutableBytes out) {
  if (packet.framing != Framing::kHdlc || packet.error.fault != Fault::kNone) return 0;
  const bool known = packet.kind == kSerialPacketNoAck || packet.kind == kSerialAck ||
                     packet.kind == kSerialUnknown;  // No answer to an answer.
  if (known || packet.kind == kAbsent) return 0;
  const std::uint8_t unknown[] = {kSerialUnknown, static_cast<std::uint8_t>(packet.kind)};
  const Result<std::size_t> size =
      packet.kind == kSerialPacketAck
          ? write_serial_ack(static_cast<std::uint8_t>(packet.serial_seq), out)
          : write_hdlc_frame(unknown, out);
  return size ? *size : 0;
}

bool brings_packet(const Packet& packet) {
  return packet.error.fault == Fault::kNone && !packet.bytes.empty() &&
         (packet.kind == kSerialPacketNoAck || packet.kind == kSerialPacketAck);
}

HostLink::HostLink(const HostLinkOptions& options, OnOutcome on_outcome,
                   const ReaderOptions& reader_options)
    : options_(options), on_outcome_(std::move(on_outcome)), reader_(reader_options) {}

HostLink::Submitted HostLink::submit(Bytes packet, SteadyTime now) {
  if (options_.listen_only) return Submitted::kListenOnly;
  if (packet.empty() || packet.size() > kPacketBytesMax) return Submitted::kBadSize;
  if (waiting_.size() > options_.waiting_max) return Submitted::kFull;
  waiting_.push_back({taken_++, {packet.begin(), packet.end()}});
  if (waiting_.size() == 1) {
    current_ = Outcome{};
    send(now);
  }
  return Submitted::kTaken;
}

// Sends the next try of the first packet.
void HostLink::send(SteadyTime now) {
  if (current_.tries == 0) {
    current_.packet = waiting_.front().number;
    current_.begun = now;
    turns_ = 0;
  }
  ++turns_;
  due_ = now + options_.ack_wait;
  // While the try before could not be written, a second one would not help the mote.
  if (current_.tries > 0 && !output_.empty()) return;
  const std::vector<std::uint8_t>& bytes = waiting_.front().bytes;
  std::uint8_t out[hdlc_frame_room(kSerialAfterHeaderMax + 2)];
  const auto size = write_serial_packet_ack(seq_++, Bytes(bytes.data(), bytes.size()),
                                            MutableBytes(out, sizeof out));
  assert(size);
  ++current_.tries;
  put(Bytes(out, *size));
}

void HostLink::put(Bytes frame) { output_.insert(output_.end(), frame.begin(), frame.end()); }

void HostLink::written(std::size_t count) {
  assert(count <= output_.size());
  output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(count));
}

void HostLink::take(Bytes bytes, SteadyTime now, PacketSink sink) {
  auto deliver = [&](const Packet& packet) {
    heard(packet, now);
    sink(packet);
  };
  reader_.feed(bytes, deliver);
}

void HostLink::heard(const Packet& packet, SteadyTime now) {
  if (packet.error.fault != Fault::kNone) return;
  if (packet.kind == kSerialAck) {
    if (waiting_.empty()) return;
    if (is_ours(static_cast<std::uint8_t>(packet.serial_seq))) return end(true, now);
    ++current_.strange_acks;
    return;
  }
  if (options_.listen_only) return;
  std::uint8_t out[kHostAnswerRoom];
  const std::size_t size = host_answer(packet, out);
  if (output_.size() + size <= kOutputMax) put(Bytes(out, size));
}

// Returns whether one of the present packet's tries has this number.
bool HostLink::is_ours(std::uint8_t seq) const {
  const int age = static_cast<std::uint8_t>(seq_ - seq);  // 1: the last try's.
  return age >= 1 && age <= std::min(current_.tries, kNumbersKept);
}

// Ends the first packet; the next one follows.
void HostLink::end(bool confirmed, SteadyTime now) {
  Outcome outcome = std::exchange(current_, Outcome{});
  outcome.confirmed = confirmed;
  outcome.ended = now;
  waiting_.pop_front();
  if (!waiting_.empty()) send(now);
  if (on_outcome_) on_outcome_(outcome);
}

void HostLink::tick(SteadyTime now) {
  if (waiting_.empty() || now < due_) return;
  if (turns_ < options_.tries) return send(now);
  end(false, now);
}

std::optional<SteadyTime> HostLink::next() const {
  if (waiting_.empty()) return std::nullopt;
  return due_;
}

void HostLink::reset(SteadyTime now, PacketSink sink) {
  reader_.finish(sink);
  output_.clear();
  Outcome first = std::exchange(current_, Outcome{});
  for (Waiting& one : std::exchange(waiting_, {})) {
    Outcome outcome = std::exchange(first, Outcome{});
    outcome.packet = one.number;
    outcome.ended = now;
    if (outcome.tries == 0) outcome.begun = now;
    if (on_outcome_) on_outcome_(outcome);
  }
}

void HostLink::reset(SteadyTime now) {
  auto nothing = [](const Packet&) {};
  reset(now, nothing);
}

}  // namespace rubric::lines
