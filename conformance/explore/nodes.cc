#include "conformance/explore/nodes.h"

#include <algorithm>

#include "conformance/machine/join.h"
#include "conformance/machine/messages.h"

namespace rubric::explore {
namespace {

using machine::Link;
using machine::Role;

constexpr std::uint8_t kAppId = static_cast<std::uint8_t>(rubicon::Component::kMockup);
constexpr std::uint8_t kAppData[] = {0x2A};
constexpr machine::Descriptor kDescriptor{3, 1, 3};  // A micaz with light, temperature, a led.

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  return hash ^ (hash >> 29);
}

// The bit of an island; 0 for one that no sink can have.
std::uint8_t island_bit(std::uint16_t pid) {
  const unsigned number = static_cast<unsigned>(pid) - kFirstIsland;
  return number < kSinksMax ? static_cast<std::uint8_t>(1U << number) : std::uint8_t{0};
}
std::uint8_t bits_of(const std::set<std::uint16_t>& islands) {
  std::uint8_t bits = 0;
  for (const std::uint16_t pid : islands) bits |= island_bit(pid);
  return bits;
}
std::uint8_t view_of(const History& history) {
  return history.view ? island_bit(history.view->pid) : std::uint8_t{0};
}

std::uint64_t hash_of(const NodeState& node) {
  const Monitor& m = node.monitor;
  std::uint64_t hash = machine::hash_value(node.state);
  const auto pack = [](std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
    return a << 32 | b << 16 | c << 8 | d;
  };
  const History& h = m.history;
  const auto requests = static_cast<std::uint64_t>(h.requests);
  hash = mix(hash, pack(m.calls, m.reboots, m.sends, requests));
  hash = mix(hash, pack(h.present_seq, bits_of(h.offers), bits_of(h.chosen), view_of(h)));
  return mix(hash, std::uint64_t{m.on_air} << 8 | bits_of(h.acked));
}

std::string key_of(const machine::Transmit& t) {
  const char head[] = {static_cast<char>(t.link), static_cast<char>(t.link_ack),
                       static_cast<char>(t.type), static_cast<char>(t.dest >> 8),
                       static_cast<char>(t.dest), static_cast<char>(t.src >> 8),
                       static_cast<char>(t.src)};
  std::string key(head, sizeof head);
  return key.append(reinterpret_cast<const char*>(t.payload.data()), t.size_bytes);
}

// Clears what a node never reads again, so that states that differ in nothing else are one: how
// many requests a finished call took, how often a confirmed ack_join was sent, and the order of a
// sink's lists (never full here). A test explores without this, too.
void forget_the_past(machine::State& state) {
  machine::JoinMote& join = state.join;
  if (join.phase != machine::JoinMote::Phase::kJoining) join.requests = 0;
  if (join.phase != machine::JoinMote::Phase::kMember) join.acks = 0;
  if (join.acked) join.acks = 0;
  const auto by_mote = [](const machine::Admission& a, const machine::Admission& b) {
    return a.devid < b.devid;
  };
  std::sort(state.sink.members.begin(), state.sink.members.end(), by_mote);
  std::sort(state.sink.pending.begin(), state.sink.pending.end(), by_mote);
}

}  // namespace

Nodes::Nodes(const Options& options) : options_(options) {
  frames_.push({});  // Number 0 is no frame.
  for (std::size_t i = 0; i < count(); ++i) {
    initial_[i] = intern(NodeState{machine::start(config_of(i)), {}}, {});
  }
}

machine::Config Nodes::config_of(std::size_t node) const {
  machine::Config config{.profile = options_.profile};
  if (is_mote(node)) {
    config.id = static_cast<std::uint16_t>(kFirstMoteId + node);
  } else {
    config.role = Role::kSink;
    config.id = options_.profile.sink_id;
    config.island = static_cast<std::uint16_t>(kFirstIsland + node - options_.motes);
  }
  // Numbers of different nodes are different, so that a mix-up cannot hide.
  config.first_seq = static_cast<std::uint16_t>(100 * (node + 1));
  return config;
}

std::vector<SendChoice> Nodes::choices(const machine::State& state, const Monitor& monitor) const {
  std::vector<SendChoice> out;
  const std::uint16_t local = machine::kLocalPid;
  if (state.config.role == Role::kSink) {
    for (std::uint16_t m = 0; m < options_.motes; ++m) {
      const auto devid = static_cast<std::uint16_t>(kFirstMoteId + m);
      if (machine::find_member(state.sink, devid) != nullptr) out.push_back({{local, devid}, true});
    }
    return out;
  }
  const std::uint8_t view = view_of(monitor.history);
  if (view == 0) return out;
  out.push_back({{local, options_.profile.sink_id}, true});
  for (std::uint16_t m = 0; m < options_.motes; ++m) {
    const auto devid = static_cast<std::uint16_t>(kFirstMoteId + m);
    if (devid != state.config.id) out.push_back({{local, devid}, true});
  }
  for (std::uint16_t s = 0; s < options_.sinks; ++s) {
    const auto pid = static_cast<std::uint16_t>(kFirstIsland + s);
    if (island_bit(pid) == view) continue;
    out.push_back({{pid, options_.profile.sink_id}, true});
  }
  out.push_back({{local, machine::kBroadcastDevid}, false});
  return out;
}

machine::Event Nodes::event_of(const machine::State& state, const Monitor& monitor,
                               std::uint32_t what, const machine::Transmit* frame) const {
  if (what >= event::kFrame) return machine::Heard{frame->frame()};
  if (what >= event::kSend) {
    const SendChoice choice = choices(state, monitor)[what - event::kSend];
    return machine::Called{machine::Send{choice.dest, kAppId, choice.reliable, Bytes(kAppData)}};
  }
  if (what >= event::kAckTimer) {
    const auto index = static_cast<std::uint8_t>(what - event::kAckTimer);
    return machine::TimerDue{{machine::TimerKind::kAck, index}};
  }
  switch (what) {
    case event::kCall: return machine::Called{machine::JoinIsland{kDescriptor}};
    case event::kJoinTimer: return machine::TimerDue{{machine::TimerKind::kJoin, 0}};
    case event::kDoneAcked:
    case event::kDoneUnacked: return machine::SendDone{Link::kRadio, what == event::kDoneAcked};
    case event::kDoneSerial: return machine::SendDone{Link::kSerial, true};
    default: return machine::Reboot{};
  }
}

// Lists are never full here, so they are bounded by the motes that there are.
Noted Nodes::observe(History& history, const machine::State& before, const machine::Event& event,
                     const machine::Actions& actions, const machine::State& after) const {
  Noted noted;
  machine::Config config = before.config;
  config.profile = options_.profile;
  explore::observe(history, {config, before, event, actions, after}, handled_frames(before, event),
                   noted);
  if (after.sink.members.size() > options_.motes || after.sink.pending.size() > options_.motes) {
    noted.violated |= bit(Property::kQueuesBounded);
  }
  return noted;
}

// Compares states, frames, and the history of application events.
bool Nodes::same_as_machine(const NodeState& before, const machine::Event& event,
                            const NodeState& after, const machine::Actions& actions) const {
  NodeState honest = before;
  machine::Actions right;
  machine::step(honest.state, 0, event, right);
  const auto same_frame = [](const machine::Transmit& a, const machine::Transmit& b) {
    return key_of(a) == key_of(b);
  };
  if (honest.state != after.state ||
      !std::equal(right.transmits().begin(), right.transmits().end(), actions.transmits().begin(),
                  actions.transmits().end(), same_frame)) {
    return false;
  }
  History given = before.monitor.history;
  return observe(honest.monitor.history, before.state, event, right, honest.state) ==
             observe(given, before.state, event, actions, after.state) &&
         honest.monitor.history == given;
}

void Nodes::step(NodeState& node, const machine::Event& event, Outcome& outcome) {
  const NodeState old = node;
  const machine::State& before = old.state;
  machine::Actions actions;
  options_.step(node.state, 0, event, actions);
  if (options_.step != machine::step && !step_acted_) {
    step_acted_ = !same_as_machine(old, event, node, actions);
  }
  const auto* done = std::get_if<machine::SendDone>(&event);
  Monitor& m = node.monitor;
  if (done != nullptr && done->link == Link::kRadio) m.on_air = 0;
  if (const auto* called = std::get_if<machine::Called>(&event)) {
    m.calls += std::holds_alternative<machine::JoinIsland>(called->call);
    m.sends += std::holds_alternative<machine::Send>(called->call);
  } else if (std::holds_alternative<machine::Reboot>(event)) {
    ++m.reboots;
    m.on_air = 0;
  }
  const Noted noted = observe(m.history, before, event, actions, node.state);
  outcome.violated |= noted.violated;
  outcome.goals |= noted.goals;
  for (const machine::Transmit& transmit : actions.transmits()) {
    if (transmit.link != Link::kRadio) continue;
    Origin origin = outcome.of;
    origin.frame = outcome.frames;
    const FrameId id = intern(transmit, origin);
    if (transmit.link_ack) m.on_air = id;
    if (outcome.frames == Outcome::kFramesMax) {
      outcome.overflow = true;
    } else {
      outcome.frame[outcome.frames++] = id;
    }
  }
}

Outcome Nodes::compute(NodeId id, std::uint32_t what) {
  NodeState node = states_[id].node;
  Outcome outcome{.of = {id, what, 0}};
  const machine::Transmit* frame =
      what >= event::kFrame ? &this->frame(static_cast<FrameId>(what - event::kFrame)) : nullptr;
  step(node, event_of(node.state, node.monitor, what, frame), outcome);
  // A line is free again at once, unless a link ack may still come.
  for (int i = 0; !options_.busy && i < 64; ++i) {
    if (node.state.radio.sending && node.monitor.on_air == 0) {
      step(node, machine::SendDone{Link::kRadio, true}, outcome);
    } else if (node.state.serial.sending) {
      step(node, machine::SendDone{Link::kSerial, true}, outcome);
    } else {
      break;
    }
  }
  if (!options_.exact) forget_the_past(node.state);
  outcome.next = intern(node, outcome.of);
  outcome.violated &= options_.properties;
  return outcome;
}

const Outcome& Nodes::outcome(NodeId node, std::uint32_t what) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t key = std::uint64_t{node} << 32 | what;
  const auto found = memo_.find(key);
  if (found != memo_.end()) return outcomes_[found->second];
  const Outcome computed = compute(node, what);
  if (outcomes_.full()) {
    full_ = true;
    return outcomes_[0];
  }
  memo_.emplace(key, outcomes_.size());
  return outcomes_.push(computed);
}

NodeId Nodes::intern(const NodeState& node, const Origin& origin) {
  const std::uint64_t hash = hash_of(node);
  const auto [begin, end] = state_ids_.equal_range(hash);
  for (auto it = begin; it != end; ++it) {
    if (states_[it->second].node == node) return it->second;
  }
  if (states_.full()) {
    full_ = true;
    return 0;
  }
  const auto id = static_cast<NodeId>(states_.size());
  states_.push({node, facts_of(node), origin});
  state_ids_.emplace(hash, id);
  return id;
}

FrameId Nodes::intern(const machine::Transmit& frame, const Origin& origin) {
  const std::string key = key_of(frame);
  const auto found = frame_ids_.find(key);
  if (found != frame_ids_.end()) return found->second;
  if (frames_.full()) {
    full_ = true;
    return 1;
  }
  const auto id = static_cast<FrameId>(frames_.size());
  frames_.push({frame, origin});
  frame_ids_.emplace(key, id);
  return id;
}

NodeFacts Nodes::facts_of(const NodeState& node) const {
  const machine::State& s = node.state;
  const Monitor& m = node.monitor;
  const bool mote = s.config.role == Role::kMote;
  NodeFacts facts;
  facts.node = static_cast<std::uint8_t>(mote ? s.config.id - kFirstMoteId
                                              : options_.motes + s.config.island - kFirstIsland);
  for (const machine::DueTimer& timer : machine::timers(s)) {
    if (timer.timer.kind == machine::TimerKind::kJoin) facts.join_timer = true;
    if (timer.timer.kind == machine::TimerKind::kAck) ++facts.ack_timers;
  }
  const bool open = m.history.open_calls > 0;
  facts.may_call = mote && !open && m.calls < options_.calls;
  facts.may_reboot = mote && m.reboots < options_.reboots;
  facts.open = open;
  facts.open_sends = !m.history.sends.empty();
  facts.radio_sending = s.radio.sending;
  facts.serial_sending = s.serial.sending;
  facts.waiting =
      !s.radio.out.empty() || !s.radio.in.empty() || !s.serial.out.empty() || !s.serial.in.empty();
  const bool sends = options_.scope == Scope::kFull && m.sends < options_.sends;
  facts.sends = sends ? static_cast<std::uint8_t>(choices(s, m).size()) : std::uint8_t{0};
  facts.view = view_of(m.history);
  facts.acked_ever = bits_of(m.history.acked);
  for (const machine::Admission& member : s.sink.members) {
    const int number = static_cast<int>(member.devid) - kFirstMoteId;
    const bool known = number >= 0 && number < options_.motes;
    if (known) facts.listed = static_cast<std::uint8_t>(facts.listed | 1U << number);
  }
  facts.reboots = m.reboots;
  facts.on_air = m.on_air;
  return facts;
}

std::size_t Nodes::memory_bytes() const {
  return states_.size() * (sizeof(Entry) + 48) + frames_.size() * (sizeof(Frame) + 96) +
         outcomes_.size() * (sizeof(Outcome) + 32);
}

const Outcome& OutcomeCache::insert(std::uint64_t key, NodeId node, std::uint32_t what) {
  const Outcome& outcome = nodes_.outcome(node, what);
  if (2 * ++used_ > slots_.size()) {
    std::vector<Slot> larger(2 * slots_.size());
    for (const Slot& slot : slots_) {
      if (slot.key != 0) put(larger, slot);
    }
    slots_.swap(larger);
  }
  put(slots_, {key, &outcome});
  return outcome;
}

void OutcomeCache::put(std::vector<Slot>& slots, Slot slot) const {
  std::size_t i = (slot.key * 0x9E3779B97F4A7C15U) >> 32 & (slots.size() - 1);
  while (slots[i].key != 0) i = (i + 1) & (slots.size() - 1);
  slots[i] = slot;
}

}  // namespace rubric::explore
