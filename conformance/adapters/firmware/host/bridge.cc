#include "conformance/adapters/firmware/host/bridge.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "codec/generated/tinyos/am_header.h"

namespace rubric::firmware {
namespace {

constexpr Instant kBootMax = 2 * kInstantsPerSecond;
// How long a board may leave a serial packet without a sign before the bench gives it up: it was
// switched off, or had no room.
constexpr Instant kSerialPatience = 40 * kInstantsPerTick;
// The node's ticks begin that much later than the bench's, so that the node's work at the begin of
// its tick falls into the same tick of the bench.
constexpr Instant kNodeIsLate = kInstantsPerTick / 8;
constexpr std::size_t kPacketMax = kRecordMax - 1;
constexpr std::size_t kPacketHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;

// Returns the air time with preamble, header and FCS besides the payload, at 250 kbit/s.
Instant air_time(std::size_t packet_bytes) {
  const std::size_t us = (packet_bytes - kPacketHeaderBytes + 19) * 32;
  return us * kInstantsPerSecond / 1'000'000;
}

}  // namespace

Tick Bridge::tick_of(Instant instant) const { return (instant - zero_) / kInstantsPerTick; }

Instant Bridge::last_instant_of(Tick tick) const {
  return zero_ + (tick + 1) * kInstantsPerTick - 1;
}

Tick Bridge::tick() const { return tick_of(board_.now()); }

Firmware Bridge::greet() {
  board_.power_on();
  greeted_ = ready_ = off_ = in_flight_ = serial_busy_ = false;
  incoming_.clear();
  queue_.clear();
  held_.clear();
  chip_ = Chip();
  reported_ = Reported();
  sent_records_ = 0;
  sent_serial_bytes_ = 0;
  deframer_ = HdlcDeframer(content_);
  const Instant end = board_.now() + kBootMax;
  while (!greeted_ && board_.now() < end) board_.run(end, *this);
  if (!greeted_) throw BoardBroken("the firmware does not say hello");
  return firmware_;
}

void Bridge::start(const NodeSetup& setup) {
  setup_ = setup;
  this->setup(false);
  const Instant end = board_.now() + kBootMax;
  while (!ready_ && board_.now() < end) board_.run(end, *this);
  if (!ready_) throw BoardBroken("the firmware does not start its node");
  zero_ = clock_zero_ - kNodeIsLate;
  last_tick_ = 0;
  lines_.clear();
}

void Bridge::setup(bool keep_seq_num) {
  ByteVector body(14);
  store_be16(body.data(), setup_.id);
  store_be16(body.data() + 2, setup_.island);
  body[4] = setup_.channels;
  store_be16(body.data() + 5, setup_.last_seq_num);
  body[7] = keep_seq_num ? 1 : 0;
  body[8] = setup_.members;
  store_be32(body.data() + 9, setup_.gone_after);
  body[13] = board_.has_clock() ? 0 : 1;
  record(ToBoard::kSetup, Bytes(body.data(), body.size()));
}

void Bridge::record(ToBoard tag, Bytes body) {
  ByteVector bytes{static_cast<std::uint8_t>(1 + body.size()), static_cast<std::uint8_t>(tag)};
  bytes.insert(bytes.end(), body.begin(), body.end());
  queue_.push_back(std::move(bytes));
  send_next();
}

void Bridge::send_next() {
  if (in_flight_ || queue_.empty() || !greeted_) return;
  board_.put_link(Bytes(queue_.front().data(), queue_.front().size()));
  queue_.pop_front();
  in_flight_ = true;
  ++sent_records_;
}

void Bridge::hear_radio(Bytes packet) {
  if (off_ || packet.size() < kPacketHeaderBytes || packet.size() > kPacketMax) return;
  record(ToBoard::kRadio, packet);
}

void Bridge::hear_serial(Bytes packet) {
  if (off_) return;
  ByteVector frame(hdlc_frame_room(kSerialAfterHeaderMax + 2));
  const auto size =
      write_serial_packet_ack(serial_seq_++, packet, MutableBytes(frame.data(), frame.size()));
  if (!size) return;  // Longer than a frame may be.
  board_.put_serial(Bytes(frame.data(), *size));
  fed_serial_ = board_.now();
  sent_serial_bytes_ = static_cast<std::uint16_t>(sent_serial_bytes_ + *size);
  // Without time that its bytes take, it is there before whatever comes next.
  if (!board_.has_clock()) settle();
}

void Bridge::call(Bytes call_record) {
  if (!off_) record(ToBoard::kCall, call_record);
}

void Bridge::link_ack(bool acked) {
  if (chip_.has_frame && chip_.on_air && chip_.wants_ack) end_transmission(acked);
}

void Bridge::busy(std::uint8_t line, bool busy) {
  if (!off_) {
    const std::uint8_t body[] = {line, static_cast<std::uint8_t>(busy)};
    record(ToBoard::kBusy, body);
  }
  if (line == 0) {
    chip_.channel_busy = busy;
    if (!busy && chip_.has_frame && !chip_.on_air) transmit();
  } else if (line == 1) {
    serial_busy_ = busy;
    while (!busy && !held_.empty()) {
      const ByteVector& packet = held_.front();
      emit("serial " + hex_of_bytes(Bytes(packet.data(), packet.size())));
      held_.pop_front();
    }
  }
}

void Bridge::power_off() {
  if (!off_ && !board_.has_clock()) settle();
  off_ = true;
  ready_ = greeted_ = in_flight_ = false;
  chip_.has_frame = false;
  held_.clear();
  queue_.clear();
}

// Reboots the node; other users of the lines continue.
void Bridge::reboot() {
  power_off();
  off_ = false;
  board_.restart();
  incoming_.clear();
  reported_ = Reported();
  sent_records_ = 0;
  sent_serial_bytes_ = 0;
  setup(true);
  if (chip_.channel_busy) busy(0, true);
  if (serial_busy_) busy(1, true);
}

// Runs, and also stops when a line comes.
void Bridge::run_until(Instant end) {
  const bool transmission_ends = chip_.has_frame && chip_.on_air && !chip_.wants_ack;
  if (transmission_ends) end = std::min(end, chip_.end);
  if (board_.has_clock()) {
    board_.run(end, *this);
  } else {
    turn_clock(end);
  }
  if (transmission_ends && chip_.has_frame && board_.now() >= chip_.end) end_transmission(true);
}

// Passes the time to `end`, or to what comes before it: a line, or the node's next timer.
void Bridge::turn_clock(Instant end) {
  const std::size_t lines = lines_.size();
  settle();
  if (lines_.size() > lines) return;
  if ((reported_.flags & kIdleTimerRuns) != 0) {
    end = std::min(end, clock_zero_ + reported_.due * kInstantsPerTick);
  }
  board_.wait(end);
  tell_time();
  settle();
}

// Waits until the board has done all that there is to do at this time.
void Bridge::settle() {
  while (true) {
    while (in_flight_ || !queue_.empty()) board_.run(board_.now(), *this);
    const bool sends = (reported_.flags & kIdleSerialSends) != 0 && !serial_busy_;
    const bool has_news = (reported_.flags & kIdleSerialHasNews) != 0;
    if (has_all_bytes() && !sends && !has_news) return;
    tell_time();  // It answers with its news.
  }
}

void Bridge::tell_time() {
  const Instant passed = std::max(board_.now(), clock_zero_) - clock_zero_;
  std::uint8_t body[4];
  store_be32(body, static_cast<std::uint32_t>(passed / kInstantsPerTick));
  record(ToBoard::kTime, body);
}

void Bridge::advance(Tick now) {
  const Instant end = zero_ + now * kInstantsPerTick;
  last_tick_ = std::max(last_tick_, now);
  if (off_) board_.wait(end);
  while (!off_ && board_.now() < end) run_until(end);
}

Tick Bridge::run(Tick end) {
  const Instant until = last_instant_of(end);
  if (off_) {
    board_.wait(until);
    return end;
  }
  if (!board_.has_clock()) settle();  // Perhaps there is no time left in this tick.
  while (lines_.empty() && board_.now() < until) run_until(until);
  // The instruction that brought the line may have ended in the next tick.
  const Tick reached = lines_.empty() ? end : std::min(end, last_tick_);
  const Instant behind = last_instant_of(reached);
  while (board_.now() < behind) run_until(behind);  // All of that tick.
  last_tick_ = std::max(last_tick_, reached);
  return last_tick_;
}

bool Bridge::serial_is_quiet() const {
  if ((reported_.flags & (kIdleSerialSends | kIdleSerialHasNews)) != 0) return false;
  if (!board_.serial_is_idle()) return false;
  return has_all_bytes() || board_.now() > fed_serial_ + kSerialPatience;
}

std::optional<Tick> Bridge::next() const {
  if (off_) return std::nullopt;
  const Tick soon = std::max(tick(), last_tick_);
  if (!ready_ || in_flight_ || !queue_.empty() || !serial_is_quiet()) return soon;
  std::optional<Tick> next;
  if ((reported_.flags & kIdleTimerRuns) != 0) {
    next = tick_of(clock_zero_ + reported_.due * kInstantsPerTick);
  }
  if (chip_.has_frame && chip_.on_air && !chip_.wants_ack) {
    next = std::min(tick_of(chip_.end), next.value_or(tick_of(chip_.end)));
  }
  return next ? std::max(*next, soon) : next;
}

std::vector<std::string> Bridge::take_lines() { return std::exchange(lines_, {}); }

void Bridge::emit(std::string line) {
  const Tick now = std::max(last_tick_, tick());
  last_tick_ = now;
  lines_.push_back(fmt::format("{} {} {}", line.starts_with("up") ? "up" : "tx", now,
                               line.starts_with("up ") ? line.substr(3) : line));
  board_.stop();
}

void Bridge::transmit() {
  chip_.on_air = true;
  chip_.end = board_.now() + air_time(chip_.packet.size());
  emit(fmt::format("radio {}{}", hex_of_bytes(Bytes(chip_.packet.data(), chip_.packet.size())),
                   chip_.wants_ack ? " linkack" : ""));
}

void Bridge::end_transmission(bool acked) {
  chip_.has_frame = chip_.on_air = false;
  const std::uint8_t body[] = {static_cast<std::uint8_t>(acked)};
  record(ToBoard::kRadioSent, body);
}

void Bridge::link_byte(std::uint8_t byte) {
  incoming_.push_back(byte);
  if (!greeted_ && !is_greeting()) incoming_.clear();  // The rest of what a reset cut off.
  if (incoming_.empty()) return;
  if (incoming_.size() < std::size_t{1} + incoming_[0]) return;
  const ByteVector record = std::exchange(incoming_, {});
  handle(Bytes(record.data() + 1, record.size() - 1));
}

bool Bridge::is_greeting() const {
  constexpr std::uint8_t kStart[] = {5, static_cast<std::uint8_t>(FromBoard::kHello)};
  return incoming_[0] == kStart[0] && (incoming_.size() < 2 || incoming_[1] == kStart[1]);
}

void Bridge::handle(Bytes record) {
  if (record.empty()) throw BoardBroken("the firmware sends an empty record");
  const Bytes body = record.from(1);
  switch (static_cast<FromBoard>(record[0])) {
    case FromBoard::kHello:
      firmware_ = {body[0] != 0, body[1], load_be16(body.data() + 2)};
      greeted_ = true;
      sent_records_ = 0;
      board_.stop();
      return send_next();
    case FromBoard::kReady:
      ready_ = true;
      clock_zero_ = board_.now() + (board_.has_clock() ? 0 : kNodeIsLate);
      return board_.stop();
    case FromBoard::kRadio:
      chip_.packet.assign(body.begin() + 1, body.end());
      chip_.wants_ack = body[0] != 0;
      chip_.has_frame = true;
      chip_.on_air = false;
      if (!chip_.channel_busy) transmit();
      return;
    case FromBoard::kEvent: return emit("up " + event_text(body));
    case FromBoard::kIdle:
      reported_ = {body[0], load_be16(body.data() + 1), body[3], load_be32(body.data() + 4)};
      if (reported_.records == sent_records_) in_flight_ = false;
      return send_next();
  }
  throw BoardBroken(fmt::format("the firmware sends a record of kind {}", record[0]));
}

void Bridge::serial_byte(std::uint8_t byte) {
  if (serial_tap_) serial_tap_(byte);
  if (deframer_.push(byte) != HdlcEvent::kFrame) return;
  const Bytes content = deframer_.content();
  if (content[0] != kSerialPacketNoAck) return;  // A confirmation.
  const Bytes packet = content.from(1);
  if (serial_busy_) return held_.emplace_back(packet.begin(), packet.end()), void();
  emit("serial " + hex_of_bytes(packet));
}

}  // namespace rubric::firmware
