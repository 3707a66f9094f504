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
  board_.put(kChannelsRoom);
  put16(sizeof(Node));
}

void Bench::handle(Bytes record) {
  const Bytes body = record.from(1);
  switch (static_cast<ToBoard>(record[0])) {
    case ToBoard::kSetup: setup(body.data()); break;
    case ToBoard::kRadio: hear(body); break;
    case ToBoard::kRadioSent: node_.radio_sent(body[0] != 0); break;
    case ToBoard::kBusy: set_busy(body[0], body[1] != 0); break;
    case ToBoard::kCall: call(static_cast<CallCode>(body[0]), body.from(1)); break;
    case ToBoard::kRestart: board_.restart();
  }
  ++records_;
  reported_ = false;
}

void Bench::setup(const uint8_t* body) {
  Setup setup;
  setup.id = load_be16(body);
  setup.island = load_be16(body + 2);
  setup.channels = body[4];
  // Numbers continue after a reset: a late reply must not fit the next request. (decision 117)
  setup.last_seq_num = body[7] != 0 ? board_.kept_seq_num() : load_be16(body + 5);
  board_.start_clock();
  begin(FromBoard::kReady, 0);
  node_.start(setup);
  started_ = true;
}

void Bench::hear(Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!header) return;
  const Bytes payload = packet.from(kAmHeaderBytes);
  if (payload.size() < header->length()) return;
  node_.radio_received(header->dest(), header->src(), header->type(),
                       payload.first(header->length()));
}

void Bench::set_busy(uint8_t line, bool busy) {
  if (line == 2) return node_.set_application_busy(busy);
  if (line == 1) serial_.set_held(busy);
  node_.set_line_busy(line == 0 ? Line::kRadio : Line::kSerial, busy);
}

void Bench::run() {
  if (!started_) return;
  const uint8_t packets = serial_.poll(node_);
  if (packets != 0) {
    packets_ = static_cast<uint8_t>(packets_ + packets);
    reported_ = false;
  }
  node_.run_timers();
  board_.kept_seq_num() = node_.last_seq_num();
  report_idle();
}

void Bench::report_idle() {
  Ticks due = 0;
  uint8_t flags = 0;
  if (node_.next_due(due)) flags |= kIdleTimerRuns;
  if (serial_.is_sending()) flags |= kIdleSerialSends;
  if (reported_ && flags == told_flags_ && due == told_due_) return;
  reported_ = true;
  told_flags_ = flags;
  told_due_ = due;
  begin(FromBoard::kIdle, 7);
  board_.put(records_);
  board_.put(packets_);
  board_.put(flags);
  put32(due);
}

void Bench::send(uint16_t dest, uint8_t am_type, Bytes payload, bool link_ack) {
  begin(FromBoard::kRadio, 1 + kAmHeaderBytes + payload.size());
  board_.put(link_ack ? 1 : 0);
  tinyos::AmHeader header;
  header.dispatch = tinyos::Dispatch::kActiveMessage;
  header.dest = dest;
  header.src = node_.address().devid;
  header.length = static_cast<uint8_t>(payload.size());
  header.type = am_type;
  uint8_t bytes[kAmHeaderBytes];
  tinyos::AmHeaderLayout::store(header, bytes);
  for (const uint8_t byte : bytes) board_.put(byte);
  for (const uint8_t byte : payload) board_.put(byte);
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
