// The transport level.
#include "conformance/selftest/lawful_traffic/endpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::size_t kRecentNumbers = 64;

bool known_app(std::uint8_t app) { return app >= 1 && app <= 11; }

}  // namespace

std::string address_fields(const char* prefix, Address address) {
  return fmt::format(",\"{0}_pid\":{1},\"{0}_devid\":{2}", prefix, address.pid, address.devid);
}

Endpoint::Endpoint(World& world, int number, std::uint16_t tos_id, std::string role)
    : world_(world), number_(number), tos_id_(tos_id), role_(std::move(role)) {
  const Traits& traits = world.traits();
  next_seq_ = traits.seq_mode == SeqMode::kNearTheEnd
                  ? static_cast<std::uint16_t>(world.random().between(0xFFF0, 0xFFF8))
                  : static_cast<std::uint16_t>(world.random().below(1000));
  paper_acks_ = traits.ack_form == AckForm::kPaper ||
                (traits.ack_form == AckForm::kPerNode && number % 2 == 0);
}

void Endpoint::event(const std::string& name, const std::string& fields) const {
  world_.record_event({world_.now_us(), number_, tos_id_, role_, name, fields});
}

void Endpoint::forget_transport() {
  pending_.clear();
  // A counter may begin anywhere after a reboot, but not where acks from before can still come.
  next_seq_ = static_cast<std::uint16_t>(next_seq_ + 200);
}

std::uint16_t Endpoint::fresh_seq() {
  const bool random = world_.traits().seq_mode == SeqMode::kRandom;
  std::uint16_t seq = 0;
  do {
    seq = random ? world_.random().number16() : next_seq_++;
    // 0xFFFF is the error value of send; recent numbers are not used again.
  } while ((seq == kNoSeq && !world_.traits().uses_ffff) || pending_.count(seq) != 0 ||
           std::find(recent_.begin(), recent_.end(), seq) != recent_.end());
  recent_.push_back(seq);
  if (recent_.size() > kRecentNumbers) recent_.pop_front();
  return seq;
}

std::uint16_t Endpoint::send(Address dest, std::uint8_t app, const Octets& body, bool reliable) {
  return send_message(dest, app, body, reliable, 0, -1);
}

std::uint16_t Endpoint::send_message(Address dest, std::uint8_t app, const Octets& body,
                                     bool reliable, int tries, int old_seq) {
  NetMessage message{.dest = dest,
                     .src = address_,
                     .reliable = reliable,
                     .seq = old_seq >= 0 ? static_cast<std::uint16_t>(old_seq) : fresh_seq(),
                     .payload = app_msg(rubicon::Component::kConnless, app, body)};
  const bool taken = route(message);
  event("send", fmt::format("{},\"reliable\":{},\"comp\":{},\"nbytes\":{},\"seq_num\":{}",
                            address_fields("dest", dest), reliable ? 1 : 0, app, body.size(),
                            taken ? message.seq : kNoSeq));
  if (!taken) return kNoSeq;
  // The sender of a reliable broadcast is notified of failure at the timeout, so it waits, too.
  if (reliable) {
    const std::uint64_t token = next_token_++;
    pending_[message.seq] = {dest, app, body, tries, token};
    world_.scheduler().after(world_.traits().ack_timeout_us,
                             [this, seq = message.seq, token] { timed_out(seq, token); });
  }
  return message.seq;
}

bool Endpoint::send_unreliable(Address dest, const Octets& payload) {
  return route(NetMessage{.dest = dest, .src = address_, .seq = fresh_seq(), .payload = payload});
}

void Endpoint::timed_out(std::uint16_t seq, std::uint64_t token) {
  const auto found = pending_.find(seq);
  if (found == pending_.end() || found->second.token != token) return;
  const Pending failed = found->second;
  pending_.erase(found);
  event("receive_ack", fmt::format("{},\"comp\":{},\"seq_num\":{},\"success\":0",
                                   address_fields("src", failed.dest), failed.app, seq));
  if (failed.tries >= world_.traits().app_resends) return;
  // The application sends it again, a moment later.
  const auto pause = world_.random().between(40'000, 120'000);
  world_.scheduler().after(pause, [this, failed, seq] {
    if (world_.now_us() > world_.last_send_us() || address_.pid == 0) return;
    send_message(failed.dest, failed.app, failed.body, true, failed.tries + 1,
                 world_.traits().resend_same_seq ? seq : -1);
  });
}

void Endpoint::arrived(const NetMessage& message) {
  const auto trans = static_cast<rubicon::Component>(message.payload[0]);
  if (trans == rubicon::Component::kRubiconAck) return ack_arrived(message);
  if (trans == rubicon::Component::kSynChannel) {
    return event("synData_received", address_fields("src", message.src));
  }
  if (trans != rubicon::Component::kConnless) return;
  const std::uint8_t app = message.payload[1];
  const bool broadcast = message.dest.pid == kAllNodes || message.dest.devid == kAllNodes;
  const bool acks = message.reliable && (!broadcast || world_.traits().ack_broadcasts) &&
                    (known_app(app) || world_.traits().ack_unknown_app);
  const bool answer_first = world_.traits().answer_before_ack;
  if (acks && !answer_first) send_ack(message);
  if (known_app(app)) {
    event("receive", fmt::format("{},\"comp\":{},\"nbytes\":{}", address_fields("src", message.src),
                                 app, message.payload.size() - 2));
    on_app(message);
  }
  if (acks && answer_first) send_ack(message);
}

void Endpoint::on_app(const NetMessage&) {}

void Endpoint::send_ack(const NetMessage& message) {
  const Octets body = paper_acks_ ? ack_body_paper(message.seq) : ack_body_deployed(message.seq);
  send_unreliable(message.src, app_msg(rubicon::Component::kRubiconAck, message.payload[1], body));
}

void Endpoint::ack_arrived(const NetMessage& message) {
  const std::uint8_t* body = message.payload.data() + 2;
  const std::size_t size = message.payload.size() - 2;
  if (size < 2) return;
  const std::uint16_t seq = size >= 4 ? load_be16(body + 1) : load_be16(body);
  const auto found = pending_.find(seq);
  if (found == pending_.end() || !(found->second.dest == message.src)) return;
  event("receive_ack", fmt::format("{},\"comp\":{},\"seq_num\":{},\"success\":1",
                                   address_fields("src", message.src), found->second.app, seq));
  pending_.erase(found);
}

}  // namespace rubric::lawful
