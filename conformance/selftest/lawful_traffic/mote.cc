// A mote.
#include <fmt/format.h>

#include <utility>

#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::int64_t kUpdatesUs = 488'281;        // 500 binary milliseconds.
constexpr std::int64_t kAckJoinRepeatUs = 380'000;  // Within one join period of acceptance.
constexpr std::uint8_t kControlLayer = static_cast<std::uint8_t>(rubicon::Component::kControlLayer);
constexpr std::uint8_t kMockup = static_cast<std::uint8_t>(rubicon::Component::kMockup);

}  // namespace

Mote::Mote(World& world, int number, const MotePlan& plan, std::uint16_t preferred_island)
    : Node(world, number, plan.id, plan.any_sink ? -1 : plan.island, "mote"),
      plan_(plan),
      preferred_island_(preferred_island) {}

void Mote::boot() {
  power(true);
  reboot_clock();
  address_ = {};
  joined_ = waiting_ = accepted_ = false;
  calls_ = 0;
  ++timer_;
  event("booted", "");
  join_island();
}

void Mote::switch_off() {
  power(false);
  reboot_clock();
  forget_transport();
  address_ = {};
  joined_ = false;
}

void Mote::join_island() {
  ++calls_;
  requests_ = 0;
  accepted_ = confirmed_ = false;
  seq_ = fresh_seq();
  event("joinIsland", "");
  send_request();
}

void Mote::send_request() {
  const Traits& traits = world().traits();
  if (++requests_ > 1 && traits.new_seq_per_retry) seq_ = fresh_seq();
  waiting_ = true;
  accepted_ = false;
  RadioFrame frame{.dst = kSinkAm,
                   .type = static_cast<std::uint8_t>(rubicon::AmType::kJoin),
                   .payload = join_request(seq_, plan_.descriptor)};
  transmit(std::move(frame));
  start_join_timer();
}

void Mote::start_join_timer() {
  timer(world().traits().join_period_us, [this, mine = ++timer_] {
    if (mine == timer_) expired();
  });
}

void Mote::expired() {
  const Traits& traits = world().traits();
  if (requests_ >= traits.requests_max) return failed();
  // FAIL comes at the last expiry all the same; after acceptance no more requests are sent until
  // then.
  if (accepted_ && traits.unconfirmed == Unconfirmed::kFail) {
    ++requests_;
    return start_join_timer();
  }
  send_request();
}

void Mote::failed() {
  const Traits& traits = world().traits();
  waiting_ = accepted_ = false;
  address_ = {};
  event("joined", ",\"error\":1");
  if (calls_ >= traits.join_calls) return;
  timer(traits.join_pause_us, [this] { join_island(); });
}

void Mote::heard(const RadioFrame& frame) {
  if (frame.type == static_cast<std::uint8_t>(rubicon::AmType::kJoinReply)) {
    return work(false, [this, frame] { on_reply(frame); });
  }
  if (frame.type != static_cast<std::uint8_t>(rubicon::AmType::kNet)) return;
  if (!joined_) return;
  work(true, [this, frame] {
    Octets bytes = frame.payload;
    const bool odd = bytes.size() > 8 && bytes[8] > 1;
    if (odd && world().traits().odd_reliable == OddReliable::kUnreliable) bytes[8] = 0;
    const auto message = decode_net(view(bytes));
    if (!message || !joined_) return;
    const bool mine = message->dest.devid == am() || message->dest.devid == kAllNodes;
    const bool here = message->dest.pid == address_.pid || message->dest.pid == kAllNodes;
    if (mine && here) arrived(*message);
  });
}

void Mote::on_reply(const RadioFrame& frame) {
  const auto reply = rubicon::JoinReplyView::parse(view(frame.payload));
  if (!reply || joined_ || !waiting_ || reply->seq_num() != seq_) return;
  if (!plan_.any_sink && reply->island_addr() != preferred_island_) return;
  waiting_ = false;
  accepted_ = true;
  accepted_us_ = world().now_us();
  ack_joins_ = 0;
  address_ = {reply->island_addr(), reply->mote_addr()};
  if (world().traits().joined_when == JoinedWhen::kAcceptance) become_joined();
  send_ack_join();
}

void Mote::send_ack_join() {
  RadioFrame frame{.dst = kSinkAm,
                   .type = static_cast<std::uint8_t>(rubicon::AmType::kAckJoin),
                   .ack_request = true,
                   .payload = ack_join({address_.pid, kSinkAm}, address_, seq_, plan_.descriptor)};
  const bool again = ++ack_joins_ > 1;
  const bool same_dsn = again && world().traits().ack_join_same_dsn;
  frame.dsn = ack_join_dsn_;
  transmit(
      std::move(frame), [this](bool acked) { ack_join_sent(acked); }, same_dsn);
}

void Mote::ack_join_sent(bool acked) {
  const Traits& traits = world().traits();
  if (ack_joins_ == 1) ack_join_dsn_ = last_dsn();
  if (acked) confirmed_ = true;
  if (confirmed_ && accepted_ && !joined_) become_joined();
  if (confirmed_ && !traits.ack_join_always) return;
  if (ack_joins_ >= traits.ack_join_max) return;
  if (world().now_us() - accepted_us_ > kAckJoinRepeatUs) return;
  // The link layer repeats at once; software takes its time.
  const auto gap = traits.ack_join_same_dsn ? world().random().between(200, 1'000)
                                            : world().random().between(8'000, 50'000);
  timer(gap, [this, seq = seq_] {
    if (accepted_ && seq == seq_) send_ack_join();
  });
}

void Mote::become_joined() {
  joined_ = true;
  ++timer_;
  event("joined",
        fmt::format(",\"island\":{},\"mote\":{},\"error\":0", address_.pid, address_.devid));
  if (!plan_.updates) return;
  timer(kUpdatesUs, [this] { send_updates(); });
}

void Mote::send_updates() {
  if (!joined_) return;
  timer(kUpdatesUs, [this] { send_updates(); });
  reading_ = static_cast<std::uint16_t>(reading_ + world().random().below(3));
  const auto base = static_cast<std::uint16_t>(300 + am() + reading_);
  const auto pair = [&](std::uint16_t bit, int offset) {
    return std::pair(bit, static_cast<std::uint16_t>(base + offset));
  };
  send({address_.pid, kNull}, kControlLayer,
       updates_body({pair(0x0001, 0), pair(0x0002, 6100), pair(0x0040, 900)}), false);
}

bool Mote::route(const NetMessage& message) {
  if (!joined_) return false;
  if (radio_full()) return false;
  std::uint16_t am = kSinkAm;
  const bool wide = message.dest.pid == kAllNodes && world().traits().wide_pid_to_all;
  if (wide) {
    am = kAllNodes;
  } else if (message.dest.pid == address_.pid && message.dest.devid != kNull) {
    am = message.dest.devid;
  }
  transmit_net(message, am);
  return true;
}

void Mote::on_app(const NetMessage& message) {
  // The demo application answers a command with one reading.
  if (message.payload[1] != kMockup || message.payload.size() < 3) return;
  const std::uint8_t code = message.payload[2];
  if (code != 1 && code != static_cast<std::uint8_t>(rubicon::AmType::kReadUpdates)) return;
  send({address_.pid, kNull}, kMockup,
       demo_data_body(static_cast<std::uint16_t>(500 + world().random().below(100))), false);
}

}  // namespace rubric::lawful
