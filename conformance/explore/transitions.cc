#include "conformance/explore/transitions.h"

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <unordered_set>

#include "conformance/explore/network.h"
#include "conformance/explore/parts.h"
#include "conformance/explore/sites.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"

namespace rubric::explore {
namespace {

using machine::Action;
using machine::Actions;

constexpr std::size_t kWorldsMax = 400'000;
constexpr std::uint32_t kNoState = ~std::uint32_t{0};

template <class T>
void add_once(std::vector<T>& all, const T& one) {
  if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
}

std::string name_of(const machine::Transmit& frame) {
  const trace::Message message = message_of(frame);
  const trace::Value* kind = message.find("payload.trans_id");
  return kind != nullptr && kind->text == "rubicon_ack" ? "ack" : message.name;
}

// Returns "joined(success)", "mote_joined".
std::string name_of(const machine::Notice& notice) {
  const auto* sent = std::get_if<machine::SendResult>(&notice);
  if (sent != nullptr && sent->seq_num == machine::kNoSeq) return "send_result(error)";
  const trace::Message message = events::from_notice(notice);
  const trace::Value* result = message.find("result");
  if (result == nullptr) result = message.find("status");
  return result == nullptr ? message.name : message.name + "(" + result->text + ")";
}

// Computes the effect of one event on a node, with the ends of transmissions that nobody waits for.
class Step {
 public:
  Step(const PartInfo& part, StepFunction step) : part_(part), step_(step) {}

  /// Changes the state. Returns nothing if the event does not concern the part.
  std::optional<Transition> take(machine::State& state, const Given& given) {
    const std::optional<Trigger> trigger = part_.trigger_of(state, given);
    Transition out{.from = part_.state_of(state)};
    one(state, given.event(), out);
    for (int i = 0; i < 64; ++i) {
      if (state.radio.sending && !state.radio.sending_ack_join) {
        one(state, machine::SendDone{machine::Link::kRadio, true}, out);
      } else if (state.serial.sending) {
        one(state, machine::SendDone{machine::Link::kSerial, true}, out);
      } else {
        break;
      }
    }
    if (!trigger) return std::nullopt;
    out.to = part_.state_of(state);
    out.trigger = trigger->name;
    out.guards = {trigger->guard};
    out.ignored = ignored_ && out.outputs.empty() && out.from == out.to;
    if (out.from == out.to && out.outputs.empty() && out.rules.empty()) return std::nullopt;
    return out;
  }

 private:
  void one(machine::State& state, const machine::Event& event, Transition& out) {
    Actions actions;
    step_(state, 0, event, actions);
    for (const Action& action : actions.all()) {
      if (action.what == Action::What::kTransmit) {
        out.outputs.push_back(name_of(actions.transmit_of(action)));
      } else if (action.what == Action::What::kNotify) {
        out.outputs.push_back(name_of(actions.notice_of(action)));
      } else if (action.what == Action::What::kIgnored) {
        ignored_ = true;
      }
      if (action.requirement == ReqId::kNone) continue;
      add_once(out.rules, std::string(trace::requirement_text(action.requirement)));
    }
  }

  const PartInfo& part_;
  StepFunction step_;
  bool ignored_ = false;
};

// The event of one node in a move of the network.
struct Happening {
  std::size_t node;
  std::uint32_t what;
};

std::vector<Happening> happenings(const Move& move) {
  std::vector<Happening> out;
  if (move.kind == Move::Kind::kStep) out.push_back({move.node, move.what});
  if (move.kind != Move::Kind::kDeliver) return out;
  for (std::size_t i = 0; i < kNodesMax; ++i) {
    if ((move.hearers >> i & 1) != 0) out.push_back({i, event::kFrame + move.copy.frame()});
  }
  if (move.confirmed) out.push_back({move.copy.sender(), event::kDoneAcked});
  return out;
}

using Key = std::tuple<std::size_t, std::size_t, std::string, std::vector<std::string>,
                       std::vector<std::string>, bool>;
Key key_of(const Transition& t) { return {t.from, t.to, t.trigger, t.outputs, t.rules, t.ignored}; }

/// Everything found of one part.
class Found {
 public:
  /// Returns whether a transition is known.
  bool holds(const Transition& t) const {
    const auto found = all_.find(key_of(t));
    return found != all_.end() && contains(found->second.guards, t.guards.front());
  }

  void add(Transition t) {
    add_once(guards_[{t.from, t.trigger}], t.guards.front());
    const Key key = key_of(t);
    const auto found = all_.find(key);
    if (found == all_.end()) {
      all_.emplace(key, std::move(t));
    } else {
      found->second.guards.push_back(t.guards.front());
    }
  }

  // Returns the transitions; drops guards where several cases have the same result.
  std::vector<Transition> take() {
    std::vector<Transition> out;
    for (auto& [key, t] : all_) {
      const std::size_t seen = guards_[{t.from, t.trigger}].size();
      if (seen > 1 && t.guards.size() == seen) t.guards.clear();
      std::erase(t.guards, "");
      std::sort(t.guards.begin(), t.guards.end());
      out.push_back(std::move(t));
    }
    return out;
  }

 private:
  static bool contains(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
  }

  std::map<Key, Transition> all_;
  std::map<std::pair<std::size_t, std::string>, std::vector<std::string>> guards_;
};

/// Breadth-first over one network.
class Tour {
 public:
  Tour(const PartInfo& part, const Options& options, Found& found)
      : part_(part),
        nodes_(std::make_unique<Nodes>(options)),
        network_(*nodes_),
        sites_(*nodes_),
        packer_(*nodes_, sites_, network_),
        found_(found) {}

  /// Visits the states of the network. Returns false if there are too many.
  bool run(std::uint64_t& worlds) {
    visit(network_.initial(), kNoState, {});
    Successors ways_on;
    for (std::uint32_t i = 0; i < all_.size() && all_.size() <= kWorldsMax; ++i) {
      const World world = all_[i].world;
      try_all(world, i);
      network_.successors(world, ways_on);
      for (const Successor& way : ways_on) {
        for (const Happening& one : happenings(way.move)) look(world, i, one);
        visit(way.world, i, way.move);
      }
    }
    worlds += all_.size();
    return all_.size() <= kWorldsMax && !network_.overflowed() && !nodes_->full();
  }

 private:
  struct Entry {
    World world;
    std::uint32_t parent;
    Move move;
  };

  void visit(const World& world, std::uint32_t parent, const Move& move) {
    if (seen_.insert(packer_.key(packer_.pack(world)).bits).second)
      all_.push_back({world, parent, move});
  }

  Given given(const NodeState& before, std::uint32_t what) const {
    Given out;
    if (what >= event::kFrame) {
      out.heard = nodes_->frame(static_cast<FrameId>(what - event::kFrame));
    } else {
      out.what = nodes_->event_of(before.state, before.monitor, what, nullptr);
    }
    return out;
  }

  // Tries events that the network does not have by itself, or has had as often as it may.
  void try_all(const World& world, std::uint32_t index) {
    for (std::size_t node = 0; node < nodes_->count(); ++node) {
      if (nodes_->is_mote(node)) look(world, index, {node, event::kCall});
      look(world, index, {node, event::kReboot});
    }
  }

  void look(const World& world, std::uint32_t index, const Happening& one) {
    const NodeId id = world.node[one.node];
    if (!part_.concerns(nodes_->config_of(one.node))) return;
    if (!looked_.insert(std::uint64_t{id} << 32 | one.what).second) return;
    const NodeState before = nodes_->state(id);
    machine::State state = before.state;
    const Given event = given(before, one.what);
    auto found = Step(part_, nodes_->options().step).take(state, event);
    if (!found || found_.holds(*found)) return;
    found->witness = witness(index, one.node);
    found->witness.events.push_back(event);
    found_.add(std::move(*found));
  }

  // Returns the events of the node on the path to that state.
  Witness witness(std::uint32_t index, std::size_t node) const {
    std::vector<std::uint32_t> way;
    for (; all_[index].parent != kNoState; index = all_[index].parent) way.push_back(index);
    Witness out{nodes_->config_of(node), {}};
    for (auto it = way.rbegin(); it != way.rend(); ++it) {
      const NodeState& before = nodes_->state(all_[all_[*it].parent].world.node[node]);
      for (const Happening& one : happenings(all_[*it].move)) {
        if (one.node == node) out.events.push_back(given(before, one.what));
      }
    }
    return out;
  }

  const PartInfo& part_;
  std::unique_ptr<Nodes> nodes_;
  Network network_;
  Sites sites_;
  Packer packer_;
  Found& found_;
  std::vector<Entry> all_;
  std::unordered_set<std::uint64_t> seen_;
  std::unordered_set<std::uint64_t> looked_;
};

/// Breadth-first over one sink, which is given anything at any time.
class Alone {
 public:
  Alone(const PartInfo& part, const machine::Profile& profile, StepFunction step, Found& found)
      : part_(part), step_(step), found_(found) {
    config_.role = machine::Role::kSink;
    config_.id = profile.sink_id;
    config_.island = kFirstIsland;
    config_.profile = profile;
    alphabet_ = part.alphabet(profile);
  }

  /// Returns false if there are too many states.
  bool run(std::uint64_t& worlds) {
    visit(machine::start(config_), kNoState, 0);
    for (std::uint32_t i = 0; i < all_.size() && all_.size() <= kWorldsMax; ++i) {
      for (std::size_t k = 0; k < alphabet_.size(); ++k) look(i, k);
    }
    worlds += all_.size();
    return all_.size() <= kWorldsMax;
  }

 private:
  struct Entry {
    machine::State state;
    std::uint32_t parent;
    std::size_t letter;
  };

  void look(std::uint32_t index, std::size_t letter) {
    machine::State state = all_[index].state;
    const Given& given = alphabet_[letter];
    const bool ticks = std::holds_alternative<machine::TimerDue>(given.what) && !given.heard;
    if (ticks && state.synaptic.due == 0) return;  // No such timer is set.
    auto found = Step(part_, step_).take(state, given);
    if (found && !found_.holds(*found)) {
      found->witness = {config_, {given}};
      for (std::uint32_t i = index; all_[i].parent != kNoState; i = all_[i].parent) {
        found->witness.events.insert(found->witness.events.begin(), alphabet_[all_[i].letter]);
      }
      found_.add(std::move(*found));
    }
    visit(std::move(state), index, letter);
  }

  void visit(machine::State state, std::uint32_t parent, std::size_t letter) {
    state.sequence = machine::start(config_).sequence;  // Else no two states would be the same.
    if (seen_.insert(machine::hash_value(state)).second) {
      all_.push_back({std::move(state), parent, letter});
    }
  }

  const PartInfo& part_;
  StepFunction step_;
  Found& found_;
  machine::Config config_;
  std::vector<Given> alphabet_;
  std::vector<Entry> all_;
  std::unordered_set<std::uint64_t> seen_;
};

const PartInfo& part_named(std::string_view name) {
  const PartInfo* part = find_part(name);
  if (part == nullptr) throw std::invalid_argument("no part is called " + std::string(name));
  return *part;
}

}  // namespace

std::string Given::text() const {
  if (heard) return "heard " + trace::print(message_of(*heard));
  if (const auto* called = std::get_if<machine::Called>(&what)) {
    return "called " + trace::print(events::from_call(called->call));
  }
  if (const auto* due = std::get_if<machine::TimerDue>(&what)) {
    if (due->timer.kind == machine::TimerKind::kSynaptic) return "tick";
    return due->timer.kind == machine::TimerKind::kJoin ? "join timer" : "ack timer";
  }
  if (const auto* done = std::get_if<machine::SendDone>(&what)) {
    return done->acked ? "link ack" : "no link ack";
  }
  return "reboot";
}

std::span<const PartName> part_names() {
  static const std::vector<PartName> kNames = [] {
    std::vector<PartName> names;
    for (const PartInfo& part : parts()) names.push_back({part.name, part.title});
    return names;
  }();
  return kNames;
}

Diagram transitions_of(std::string_view name, const machine::Profile& profile, StepFunction step) {
  const PartInfo& part = part_named(name);
  Diagram out{.name = part.name, .title = part.title, .states = part.states};
  Found found;
  if (part.networks == nullptr) out.complete = Alone(part, profile, step, found).run(out.worlds);
  std::vector<Options> networks;
  if (part.networks != nullptr) networks = part.networks(profile);
  for (Options& options : networks) {
    options.step = step;
    out.complete = Tour(part, options, found).run(out.worlds) && out.complete;
  }
  out.transitions = found.take();
  return out;
}

std::optional<Transition> replay(std::string_view name, const Witness& witness, StepFunction step) {
  const PartInfo& part = part_named(name);
  machine::State state = machine::start(witness.config);
  std::optional<Transition> last;
  for (const Given& given : witness.events) last = Step(part, step).take(state, given);
  if (last) std::erase(last->guards, "");
  return last;
}

}  // namespace rubric::explore
