#include "conformance/check/align/align_logs.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>

#include "conformance/check/message.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using Kind = Observation::Kind;

// What two sightings share, so that keys of different events differ.
enum class Event : std::uint8_t { kCall, kDelivery, kOffer, kMember, kAck, kRequest };

Hash about(Event event, Link link = Link::kRadio) {
  return Hash().add(static_cast<std::uint64_t>(event), 1).add(link == Link::kSerial ? 1 : 0, 1);
}

class LogSightings {
 public:
  LogSightings(const Run& run, std::vector<std::vector<Sighting>>& out) : run_(run), out_(out) {}

  void add() {
    for (index_ = 0; index_ < run_.seen.size(); ++index_) {
      const Observation& seen = run_.seen[index_];
      const bool frame = seen.kind == Kind::kRadio || seen.kind == Kind::kSerial;
      if (seen.node.empty() && frame) add_frame(seen);
      if (!seen.node.empty() && (frame || seen.kind == Kind::kPeis)) add_passed(seen);
      if (seen.kind == Kind::kCall) add_call(seen);
      if (seen.kind == Kind::kNotice) add_notice(seen);
    }
  }

 private:
  void put(const Hash& key, bool cause) { put(key, cause, index_); }
  void put(const Hash& key, bool cause, std::uint32_t index) {
    out_[run_.seen[index].place.file].push_back({key.value(), index, Common::kLogged, cause});
  }

  // What a node sent is the cause of what another one was given.
  void add_passed(const Observation& seen) {
    Hash key;
    key.add(static_cast<std::uint64_t>(seen.kind), 1).add(seen.frame.type, 1);
    key.add(seen.frame.dest, 2).add(seen.frame.src, 2).add(seen.frame.payload);
    out_[seen.place.file].push_back({key.value(), index_, Common::kPassed, !seen.received});
  }

  void add_frame(const Observation& seen) {
    Net net;
    Reply reply;
    Request request;
    AckJoin ack;
    if (seen.frame.type == am::kNet) {
      if (parse_net(seen.frame.payload, net) && net.sound) add_net(seen, net);
    } else if (seen.frame.type == am::kJoin && parse_request(seen.frame.payload, request)) {
      put(about(Event::kRequest).add(seen.frame.src, 2).add(request.descriptor), false);
    } else if (seen.frame.type == am::kJoinReply && parse_reply(seen.frame.payload, reply)) {
      put(about(Event::kOffer).add(machine::Address{reply.island, reply.mote}), true);
    } else if (seen.frame.type == am::kAckJoin && parse_ack_join(seen.frame.payload, ack)) {
      put(about(Event::kMember).add(ack.src).add(ack.descriptor), true);
    }
  }

  void add_net(const Observation& seen, const Net& net) {
    const Link link = seen.frame.link;
    const bool serial = link == Link::kSerial;
    const bool base = net.src.devid == machine::kNullDevid;
    const bool last = net.dest.devid == machine::kNullDevid || net.dest.devid == seen.frame.dest;
    const std::int32_t acked = net.is_ack() ? machine::acked_seq_num(net.body()) : -1;
    if (!net.is_ack() && (serial || base || net.src.devid == seen.frame.src)) {
      put(of_call(link, net.src.devid, net.dest.devid, net.seq_num, net.app_id), false);
    }
    if (net.broadcast() || !(serial || last)) return;
    if (acked >= 0) {
      put(of_ack(link, net.dest.devid, static_cast<std::uint16_t>(acked), net.app_id), true);
    } else {
      put(of_delivery(link, net.dest.devid, net.src, net.app_id, net.body()), true);
    }
  }

  static Hash of_call(Link link, std::uint16_t from, std::uint16_t to, std::uint16_t number,
                      std::uint8_t app_id) {
    return about(Event::kCall, link).add(from, 2).add(to, 2).add(number, 2).add(app_id, 1);
  }
  static Hash of_ack(Link link, std::uint16_t to, std::uint16_t number, std::uint8_t app_id) {
    return about(Event::kAck, link).add(to, 2).add(number, 2).add(app_id, 1);
  }
  static Hash of_delivery(Link link, std::uint16_t to, machine::Address from, std::uint8_t app_id,
                          Bytes data) {
    return about(Event::kDelivery, link).add(to, 2).add(from).add(app_id, 1).add(data);
  }

  std::uint16_t devid_of(std::string_view name) const {
    const auto node = std::ranges::find(run_.nodes, name, &LoggedNode::name);
    if (node == run_.nodes.end() || node->role == Role::kBaseStation) return machine::kNullDevid;
    return node->id;
  }

  void add_call(const Observation& seen) {
    if (std::holds_alternative<machine::Send>(*seen.call)) calls_[seen.node].push_back(index_);
    if (const auto* join = std::get_if<machine::JoinIsland>(seen.call)) {
      put(about(Event::kRequest).add(devid_of(seen.node), 2).add(join->descriptor), true);
    }
  }

  void add_notice(const Observation& seen) {
    const std::uint16_t own = devid_of(seen.node);
    if (const auto* joined = std::get_if<machine::Joined>(seen.notice)) {
      if (joined->success) put(about(Event::kOffer).add(joined->address), false);
    } else if (const auto* mote = std::get_if<machine::MoteJoined>(seen.notice)) {
      put(about(Event::kMember).add(mote->address).add(mote->descriptor), false);
    } else if (const auto* result = std::get_if<machine::SendResult>(seen.notice)) {
      add_result(seen.node, own, result->seq_num);
    }
    for (const Link link : {Link::kRadio, Link::kSerial}) {
      if (const auto* received = std::get_if<machine::Received>(seen.notice)) {
        put(of_delivery(link, own, received->src, received->app_id, received->data), false);
      } else if (const auto* ack = std::get_if<machine::AckReceived>(seen.notice)) {
        if (ack->success) put(of_ack(link, own, ack->seq_num, ack->app_id), false);
      }
    }
  }

  // Results come in the order of the calls.
  void add_result(std::string_view node, std::uint16_t own, std::uint16_t number) {
    std::vector<std::uint32_t>& calls = calls_[node];
    if (calls.empty()) return;
    const std::uint32_t call = calls.front();
    calls.erase(calls.begin());
    if (number == machine::kNoSeq) return;
    const auto& send = std::get<machine::Send>(*run_.seen[call].call);
    for (const Link link : {Link::kRadio, Link::kSerial}) {
      put(of_call(link, own, send.dest.devid, number, send.app_id), true, call);
    }
  }

  const Run& run_;
  std::vector<std::vector<Sighting>>& out_;
  std::map<std::string_view, std::vector<std::uint32_t>> calls_;  // Of send, without a result.
  std::uint32_t index_ = 0;
};

constexpr std::size_t kSideMin = 3;       // Events on either side of a step.
constexpr std::ptrdiff_t kFarShare = 10;  // Of all events so many may lie elsewhere.
constexpr int kJumpsMax = 16;

// An event: its stamp in a log, and how much later that is than its stamp in the other file.
struct LogEvent {
  std::int64_t at_us = 0;
  std::int64_t ahead_us = 0;
};
using LogEvents = std::vector<LogEvent>;

std::int64_t usual_ahead(LogEvents::const_iterator from, LogEvents::const_iterator to) {
  std::vector<std::int64_t> ahead;
  for (auto at = from; at != to; ++at) ahead.push_back(at->ahead_us);
  const auto middle = ahead.begin() + static_cast<std::ptrdiff_t>(ahead.size() / 2);
  std::nth_element(ahead.begin(), middle, ahead.end());
  return *middle;
}

// Returns the line after the longest gap between two stamps, if it is longer than `longest_us`.
std::uint64_t line_after_gap(const Run& run, std::uint32_t log, std::int64_t from_us,
                             std::int64_t to_us, std::int64_t longest_us) {
  const Place* last = nullptr;
  std::uint64_t line = 0;
  for (const Observation& seen : run.seen) {
    const std::int64_t time_us = seen.place.time_us;
    if (seen.place.file != log || time_us < from_us || time_us > to_us) continue;
    if (last != nullptr && time_us - last->time_us > longest_us) {
      longest_us = time_us - last->time_us;
      line = seen.place.frame;
    }
    last = &seen.place;
  }
  return line;
}

}  // namespace

void add_logged(const Run& run, std::vector<std::vector<Sighting>>& sightings) {
  LogSightings(run, sightings).add();
}

std::uint64_t step_of_log(const Run& run, std::uint32_t log, const std::vector<Pair>& pairs,
                          const AlignOptions& options) {
  LogEvents events;
  for (const Pair& pair : pairs) {
    const std::int64_t a_us = run.seen[pair.a].place.time_us;
    const std::int64_t b_us = run.seen[pair.b].place.time_us;
    if (a_us != kNoStamp && b_us != kNoStamp) events.push_back({b_us, b_us - a_us});
  }
  if (events.size() < 2 * kSideMin) return 0;
  std::ranges::stable_sort(events, {}, &LogEvent::at_us);
  const std::int64_t most_us = 2 * options.response_us;
  const auto end = events.end() - kSideMin;
  int jumps = 0;
  for (auto at = events.begin() + kSideMin; at <= end && jumps < kJumpsMax; ++at) {
    if (at->ahead_us - (at - 1)->ahead_us <= most_us) continue;
    ++jumps;
    const std::int64_t before_us = usual_ahead(events.begin(), at);
    const std::int64_t after_us = usual_ahead(at, events.end());
    std::ptrdiff_t far = 0;
    for (auto one = events.begin(); one != events.end(); ++one) {
      const std::int64_t usual_us = one < at ? before_us : after_us;
      far += std::abs(one->ahead_us - usual_us) > most_us ? 1 : 0;
    }
    const std::int64_t step_us = after_us - before_us;
    if (step_us <= most_us || kFarShare * far > std::ssize(events)) continue;
    return line_after_gap(run, log, (at - 1)->at_us, at->at_us, step_us - most_us);
  }
  return 0;
}

}  // namespace rubric::check
