#include "tools/commands/space/gateway.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/text/text.h"
#include "conformance/machine/messages.h"
#include "tools/commands/run/json_application.h"
#include "tools/commands/run/names.h"
#include "tools/commands/run/wall_clock.h"

namespace rubric::space {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kSayOtherEvery{10};
constexpr std::size_t kMembersMax = 1024;  // A broker may offer any number.
constexpr std::size_t kArrivedMax = 1024;
constexpr std::size_t kWishesMax = 1024;
// A sink sends 100 to 200 messages in a second and has room for four. It drops what comes faster.
constexpr lines::Milliseconds kWishTime{10};
constexpr lines::Milliseconds kWishesAhead{10};

// Text of others, fit for a terminal.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 200)) out += c >= ' ' && c < 0x7F ? c : '?';
  return out;
}

// Says which of these transducers a mote has not; empty if it has all, or is not described.
std::string lacks(const Mote& mote, std::uint16_t transducers) {
  const auto lacking = static_cast<std::uint16_t>(transducers & ~mote.descriptor.transducers);
  if (mote.joined_ms == 0 || lacking == 0) return {};
  return fmt::format("the mote has no {}", fmt::join(run::transducer_names(lacking), ", "));
}

}  // namespace

void Gateway::start(run::Caller&) {
  say_online();
  space_->subscribe(island_availability_key(settings_.island));
  // Its own motes of an earlier run: a mote reports its joining once.
  space_->subscribe(fmt::format("{}/motes/+", settings_.island));
  space_->subscribe(fmt::format("{}/motes/+/set", settings_.island));
  space_->subscribe(net_key(settings_.island));
  space_->subscribe(net_key(machine::kBroadcastPid));
}

void Gateway::stop(run::Caller&) {
  space_->put(island_availability_key(settings_.island), availability_data(false),
              Space::Stay::kTuple);
}

void Gateway::say_online() {
  wrote_online_.insert(space_->put(island_availability_key(settings_.island),
                                   availability_data(true), Space::Stay::kTuple));
}

// All base stations of an island have one key, so its tuple tells whether there are two.
void Gateway::take_availability(const Tuple& tuple) {
  if (wrote_online_.contains(tuple.written_ms)) return;
  if (tuple.data != availability_data(true)) {
    // The last will of a session of its own that broke off, or the goodbye of another. What stayed
    // is replaced already.
    if (!tuple.stays) say_online();
    return;
  }
  const auto now = steady_clock::now();
  if (now - said_other_ < kSayOtherEvery) return;
  said_other_ = now;
  text::print(stderr,
              "rubric: space: another base station of island {} is there since {}{}; both take "
              "its messages and wishes\n",
              settings_.island, time_text(tuple.written_ms),
              tuple.stays ? ", or was and is not missed yet" : "");
}

void Gateway::happened(const machine::Notice& notice, run::Caller&) {
  if (const auto* message = std::get_if<machine::Received>(&notice)) heard(*message);
  if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) {
    const auto found = awaited_.find(ack->seq_num);
    if (found != awaited_.end()) {
      const Awaited awaited = found->second;
      awaited_.erase(found);
      return put_event(wish_event(ack->success ? "done" : "failed", awaited.mote, awaited.id,
                                  ack->success ? "" : "no acknowledgement came"));
    }
  }
  put_event(run::json_line(notice, ""));
  const auto* left = std::get_if<machine::MoteLeft>(&notice);
  const auto gone = left ? members_.find(left->address.devid) : members_.end();
  if (gone != members_.end()) set_online(gone->first, gone->second, false);
}

void Gateway::heard(const machine::Received& message) {
  if (message.src.pid != settings_.island) return;
  joined(message);
  if (members_.size() >= kMembersMax && !members_.contains(message.src.devid)) return;
  // One that joined before this base station began has no description, but takes wishes.
  Member& member = members_[message.src.devid];
  member.awaited.reset();
  set_online(message.src.devid, member, true);
  const std::string state = state_data(member.mote, message.app_id, message.data);
  if (state.empty()) return;
  space_->put(state_key(settings_.island, message.src.devid), state, Space::Stay::kTuple);
}

void Gateway::joined(const machine::Received& message) {
  if (message.app_id != machine::component::kControlLayer) return;
  const auto view = rubicon::SerialJoinedView::parse(message.data);
  if (!view || view->msg_type() != rubicon::AmType::kSerialJoined) return;
  const auto id = static_cast<std::uint16_t>(view->mote_addr());
  if (id != message.src.devid || view->island_addr() != settings_.island) return;
  Member& member = members_[id];
  const std::uint16_t before = member.mote.descriptor.transducers;
  member.mote.descriptor = {static_cast<std::uint8_t>(view->mote_type()), view->actuators().raw(),
                            view->transducers().raw()};
  member.mote.joined_ms = run::wall_ms();
  space_->put(mote_key(settings_.island, id), mote_data(member.mote), Space::Stay::kTuple);
  announce(id, member.mote);
  if (settings_.home_assistant.empty()) return;
  const auto lost = static_cast<std::uint16_t>(before & ~view->transducers().raw());
  for (const std::string& sensor : run::transducer_names(lost)) {
    space_->announce(sensor_topic(settings_.island, id, sensor), "");
  }
}

void Gateway::announce(std::uint16_t id, const Mote& mote) {
  if (settings_.home_assistant.empty()) return;
  for (const Announcement& one :
       home_assistant(settings_.home_assistant, settings_.island, id, mote)) {
    space_->announce(one.topic, one.payload);
  }
}

void Gateway::set_online(std::uint16_t id, Member& member, bool online) {
  if (member.online == online) return;
  member.online = online;
  space_->put(availability_key(settings_.island, id), availability_data(online),
              Space::Stay::kTuple);
}

lines::SteadyTime Gateway::run(run::Caller& caller) {
  for (const Tuple& tuple : space_->take()) take(tuple);
  give_wishes(caller);
  refusals_.say_rest();
  const auto now = steady_clock::now();
  const auto next = wishes_.empty() ? lines::SteadyTime::max() : now + kWishTime;
  if (settings_.gone_after.count() == 0) return next;
  for (auto& [id, member] : members_) {
    if (member.awaited && now - *member.awaited >= settings_.gone_after) {
      member.awaited.reset();
      set_online(id, member, false);
    }
  }
  return std::min(next, now + std::min(settings_.gone_after, lines::Milliseconds(1000)));
}

void Gateway::take(const Tuple& tuple) {
  const std::optional<Key> key = parse_key(tuple.key);
  if (!key) return refuse(tuple.key, "no key of the layout");
  if (!tuple.wrong.empty()) return refuse(tuple.key, tuple.wrong);
  if (key->kind == Key::Kind::kSet) return take_wish(tuple, key->mote);
  if (key->kind == Key::Kind::kMote) {
    // What it has just written comes back, too.
    if (!tuple.stays || members_.contains(key->mote) || members_.size() >= kMembersMax) return;
    Member member;
    const std::string wrong = parse_mote(tuple.data, member.mote);
    if (!wrong.empty()) return refuse(tuple.key, wrong);
    member.awaited = steady_clock::now();
    members_[key->mote] = member;
    return announce(key->mote, member.mote);
  }
  if (key->kind == Key::Kind::kIslandAvailability) return take_availability(tuple);
  if (key->kind != Key::Kind::kNet) return;
  if (tuple.stays) return refuse(tuple.key, "a net_msg that stays would arrive again and again");
  std::vector<std::uint8_t> packet;
  const std::string wrong = parse_net(tuple, packet);
  if (!wrong.empty()) return refuse(tuple.key, wrong);
  const auto header = tinyos::AmHeaderView::parse(Bytes(packet.data(), packet.size()));
  if (header->src() == settings_.island) return;  // Its own, to all.
  if (arrived_.size() >= kArrivedMax) return refuse(tuple.key, "too many at once");
  arrived_.push_back(std::move(packet));
}

void Gateway::take_wish(const Tuple& tuple, std::uint16_t mote) {
  Wish wish;
  std::string wrong = parse_wish(tuple.data, wish);
  if (wrong.empty() && tuple.stays) wrong = "a wish that stays would be fulfilled again and again";
  if (wrong.empty() && !members_.contains(mote)) {
    wrong = fmt::format("mote {} has not joined island {}", mote, settings_.island);
  }
  if (wrong.empty()) wrong = lacks(members_.at(mote).mote, wish.transducers);
  if (wrong.empty() && wishes_.size() >= kWishesMax) wrong = "too many at once";
  if (wrong.empty()) return wishes_.push_back({mote, tuple.key, std::move(wish)});
  put_event(wish_event("refused", mote, wish.id, wrong));
  refuse(tuple.key, wrong);
}

// Gives the serial line no more wishes than the sink's radio can send. They wait, too, while as
// many acknowledgements are awaited as can be.
void Gateway::give_wishes(run::Caller& caller) {
  const auto now = steady_clock::now();
  for (; !wishes_.empty() && all_sent_ <= now + kWishesAhead; wishes_.pop_front()) {
    const auto& [mote, key, wish] = wishes_.front();
    machine::Send send;
    send.dest = {settings_.island, mote};
    send.app_id = wish.app_id;
    send.reliable = wish.reliable;
    send.data = Bytes(wish.data.data(), wish.data.size());
    const node::Refusal refusal = caller.refusal(send);
    if (refusal == node::Refusal::kAwaiting || refusal == node::Refusal::kFull) return;
    const auto result = caller.call(send);
    const std::uint16_t number = std::get<machine::SendResult>(*result).seq_num;
    if (number == machine::kNoSeq) {
      const std::string wrong = run::refusal_text(refusal);
      put_event(wish_event("refused", mote, wish.id, wrong));
      refuse(key, wrong);
      continue;
    }
    all_sent_ = std::max(all_sent_, now) + kWishTime;
    put_event(wish_event("sent", mote, wish.id, ""));
    if (wish.reliable) awaited_[number] = {mote, wish.id};
  }
}

void Gateway::refuse(const std::string& key, const std::string& why) {
  refusals_.say(fmt::format("{}: {}", printable(key), printable(why)));
}

void Gateway::send(Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  space_->put(net_key(header->dest()), net_data(packet), Space::Stay::kEvent);
}

void Gateway::receive(const std::function<void(Bytes packet)>& take) {
  while (!arrived_.empty()) {
    const std::vector<std::uint8_t> packet = std::move(arrived_.front());
    arrived_.pop_front();
    take(Bytes(packet.data(), packet.size()));
  }
}

}  // namespace rubric::space
