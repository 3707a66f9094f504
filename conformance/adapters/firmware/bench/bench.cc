#include "conformance/adapters/firmware/bench/bench.h"

namespace rubric {
namespace firmware {

void Bench::put16(uint16_t value) {
  board_.put(static_cast<uint8_t>(value >> 8));
  board_.put(static_cast<uint8_t>(value));
}

void Bench::put32(uint32_t value) {
  put16(static_cast<uint16_t>(value >> 16));
  put16(static_cast<uint16_t>(value));
}

void Bench::put_address(Address address) {
  put16(address.pid);
  put16(address.devid);
}

void Bench::begin(FromBoard tag, size_t body_bytes) {
  board_.put(static_cast<uint8_t>(1 + body_bytes));
  board_.put(static_cast<uint8_t>(tag));
}

void Bench::begin(EventCode event, size_t argument_bytes) {
  begin(FromBoard::kEvent, 1 + argument_bytes);
  board_.put(static_cast<uint8_t>(event));
}

void Bench::hello() {
  begin(FromBoard::kHello, 4);
  board_.put(kIsSink ? 1 : 0);
  board_.put(FirmwareSizes::kChannels);
  put16(sizeof(FirmwareNode));
}

void Bench::byte_received(uint8_t byte) {
  if (record_size_ != 0) return;  // The bench does not wait for its answer.
  if (record_awaited_ == 0) {
    record_awaited_ = byte <= kRecordMax ? byte : uint8_t{0};
    record_filled_ = 0;
    return;
  }
  record_[record_filled_++] = byte;
  if (record_filled_ < record_awaited_) return;
  record_size_ = record_awaited_;
  record_awaited_ = 0;
}

// Handles a record, from its tag on.
void Bench::handle(Bytes record) {
  const Bytes body = record.from(1);
  Ticks due;
  if (started_) node_.run(now(), due);
  switch (static_cast<ToBoard>(record[0])) {
    case ToBoard::kSetup: setup(body.data()); break;
    case ToBoard::kRadio: hear(body); break;
    case ToBoard::kRadioSent: node_.sent(Line::kRadio, body[0] != 0); break;
    case ToBoard::kBusy: set_busy(body[0], body[1] != 0); break;
    case ToBoard::kCall: call(static_cast<CallCode>(body[0]), body.from(1)); break;
    case ToBoard::kRestart: board_.restart(); break;
    case ToBoard::kTime: time_ = load_be32(body.data());
  }
  ++records_;
  reported_ = false;
}

void Bench::setup(const uint8_t* body) {
  Setup setup;
  setup.role = kIsSink ? Role::kSink : Role::kMote;
  setup.id = load_be16(body);
  setup.island = load_be16(body + 2);
  setup.channels = body[4];
  // Numbers continue after a reset: a late reply must not fit the next request. (decision 117)
  setup.last_seq_num = body[7] != 0 ? board_.kept_seq_num() : load_be16(body + 5);
  setup.members = body[8];
  takes_time_ = body[13] != 0;
  time_ = 0;
  if (!takes_time_) board_.start_clock();
  setup.now = now();
  setup.slack = 1;
  begin(FromBoard::kReady, 0);
  node_.start(setup);
  silence_.start(load_be32(body + 9));
  started_ = true;
}

void Bench::hear(Bytes packet) {
  node_.received(Line::kRadio, packet);
  if (kIsSink) silence_.received(node_, Role::kSink, Line::kRadio, packet, now());
}

void Bench::set_busy(uint8_t line, bool busy) {
  if (line == 2) return node_.set_application_busy(busy);
  if (line == 1) serial_.set_held(busy);
  node_.set_busy(line == 0 ? Line::kRadio : Line::kSerial, busy);
}

void Bench::run() {
  if (record_size_ != 0) {
    handle(Bytes(record_, record_size_));
    record_size_ = 0;
  }
  if (!started_) return;
  Ticks due = 0;
  if (serial_.has_news()) node_.run(now(), due);
  if (serial_.poll(node_) != 0) reported_ = false;
  bool timer_runs = node_.run(now(), due);
  Ticks silence_due = 0;
  if (kIsSink && silence_.run(node_, *this, now(), silence_due)) {
    if (!timer_runs || is_reached(silence_due, due)) due = silence_due;
    timer_runs = true;
  }
  board_.kept_seq_num() = node_.last_seq_num();
  report_idle(timer_runs, due);
}

void Bench::report_idle(bool timer_runs, Ticks due) {
  // Read first: what they have brought shows in the flags.
  const uint16_t serial_bytes = board_.serial_bytes();
  uint8_t flags = 0;
  if (timer_runs) flags |= kIdleTimerRuns;
  if (serial_.is_sending()) flags |= kIdleSerialSends;
  // A packet that has just left may be followed by what had no room beside it.
  if (serial_.has_news()) flags |= kIdleSerialHasNews;
  if (reported_ && flags == told_flags_ && due == told_due_) return;
  reported_ = true;
  told_flags_ = flags;
  told_due_ = due;
  begin(FromBoard::kIdle, 8);
  board_.put(records_);
  put16(serial_bytes);
  board_.put(flags);
  put32(due);
}

void Bench::transmit(Line line, Bytes packet, bool link_ack) {
  if (line == Line::kSerial) return serial_.send(packet);
  begin(FromBoard::kRadio, 1 + packet.size());
  board_.put(link_ack ? 1 : 0);
  for (const uint8_t byte : packet) board_.put(byte);
}

void Bench::joined(Address address, bool success) {
  begin(EventCode::kJoined, 5);
  put_address(address);
  board_.put(success);
}

void Bench::mote_joined(Address address, const Descriptor& descriptor) {
  begin(EventCode::kMoteJoined, 8);
  put_address(address);
  board_.put(static_cast<uint8_t>(descriptor.mote_type));
  put16(descriptor.transducers.raw());
  board_.put(descriptor.actuators.raw());
}

void Bench::mote_left(Address address) {
  begin(EventCode::kMoteLeft, 4);
  put_address(address);
}

void Bench::received(Address src, uint8_t app_id, Bytes data) {
  begin(EventCode::kReceived, 5 + data.size());
  put_address(src);
  board_.put(app_id);
  for (const uint8_t byte : data) board_.put(byte);
}

void Bench::ack_received(uint8_t app_id, uint16_t seq_num, bool success) {
  begin(EventCode::kAckReceived, 4);
  board_.put(app_id);
  put16(seq_num);
  board_.put(success);
}

void Bench::syn_data_received(ChannelId channel, DataStatus status) {
  begin(EventCode::kSynData, 5);
  put32(channel);
  board_.put(static_cast<uint8_t>(status));
}

}  // namespace firmware
}  // namespace rubric
