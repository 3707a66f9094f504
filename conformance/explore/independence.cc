#include "conformance/explore/independence.h"

#include <algorithm>
#include <memory>
#include <unordered_set>
#include <vector>

namespace rubric::explore {
namespace {

constexpr std::size_t kOutcomesMax = 2'000'000;

/// All states of each node, whatever frames it hears whenever.
class Closure {
 public:
  explicit Closure(const Options& options) : nodes_(std::make_unique<Nodes>(options)) {
    for (std::size_t i = 0; i < nodes_->count(); ++i) {
      am_address_[i] = nodes_->config_of(i).id;
      add(i, nodes_->initial(i));
    }
  }

  /// Returns whether the motes' steps are independent.
  bool separates_motes() {
    return grow() && frames_stay_with_their_mote() && sinks_answer_the_sender() && orders_agree();
  }

 private:
  struct OfNode {
    std::vector<NodeId> states;
    std::unordered_set<NodeId> known;
  };

  void add(std::size_t node, NodeId id) {
    if (of_[node].known.insert(id).second) of_[node].states.push_back(id);
  }
  bool is_mote(std::size_t node) const { return nodes_->is_mote(node); }
  std::size_t sender(std::size_t frame) const {
    return nodes_->facts(nodes_->frame_origin(static_cast<FrameId>(frame)).before).node;
  }
  bool hears(std::size_t node, std::size_t frame) const {
    const std::uint16_t dest = nodes_->frame(static_cast<FrameId>(frame)).dest;
    const bool addressed = dest == am_address_[node] || dest == machine::kAmBroadcast;
    return addressed && sender(frame) != node;
  }
  const Outcome& hear(NodeId id, std::size_t frame) {
    return outcomes_(id, event::kFrame + static_cast<std::uint32_t>(frame));
  }

  // Events that need no frame.
  static std::vector<std::uint32_t> own_events(const NodeFacts& f) {
    std::vector<std::uint32_t> out;
    if (f.may_call) out.push_back(event::kCall);
    if (f.may_reboot) out.push_back(event::kReboot);
    if (f.join_timer) out.push_back(event::kJoinTimer);
    if (f.serial_sending) out.push_back(event::kDoneSerial);
    if (f.radio_sending) out.push_back(event::kDoneAcked);
    if (f.radio_sending && f.on_air != 0) out.push_back(event::kDoneUnacked);
    for (std::uint32_t i = 0; i < f.ack_timers; ++i) out.push_back(event::kAckTimer + i);
    for (std::uint32_t i = 0; i < f.sends; ++i) out.push_back(event::kSend + i);
    return out;
  }

  // Returns false if that becomes too much.
  bool grow() {
    std::size_t before = 0;
    do {
      before = nodes_->outcomes();
      for (std::size_t node = 0; node < nodes_->count(); ++node) {
        for (std::size_t i = 0; i < of_[node].states.size(); ++i) {
          const NodeId id = of_[node].states[i];
          for (const std::uint32_t what : own_events(nodes_->facts(id))) {
            add(node, nodes_->outcome(id, what).next);
          }
          for (std::size_t f = 1; f <= nodes_->frames(); ++f) {
            if (hears(node, f)) add(node, hear(id, f).next);
          }
          if (nodes_->full() || nodes_->outcomes() > kOutcomesMax) return false;
        }
      }
    } while (before != nodes_->outcomes());
    return true;
  }

  // What a mote sends no mote hears.
  bool frames_stay_with_their_mote() const {
    for (std::size_t f = 1; f <= nodes_->frames(); ++f) {
      for (std::size_t node = 0; is_mote(node) && is_mote(sender(f)); ++node) {
        if (hears(node, f)) return false;
      }
    }
    return true;
  }

  bool sinks_answer_the_sender() {
    for (std::size_t node = nodes_->options().motes; node < nodes_->count(); ++node) {
      for (const NodeId id : of_[node].states) {
        if (!own_events(nodes_->facts(id)).empty()) return false;
        for (std::size_t f = 1; f <= nodes_->frames(); ++f) {
          if (!hears(node, f)) continue;
          const Outcome& outcome = hear(id, f);
          const unsigned changed =
              nodes_->facts(outcome.next).listed ^ unsigned { nodes_->facts(id).listed };
          if ((changed & ~(1U << sender(f))) != 0) return false;
          for (std::size_t i = 0; i < outcome.frames; ++i) {
            if (nodes_->frame(outcome.frame[i]).dest != am_address_[sender(f)]) return false;
          }
        }
      }
    }
    return true;
  }

  static bool same(const Outcome& a, const Outcome& b) {
    return a.violated == b.violated && a.overflow == b.overflow && a.frames == b.frames &&
           a.frame == b.frame;
  }

  bool orders_agree() {
    for (std::size_t node = nodes_->options().motes; node < nodes_->count(); ++node) {
      for (const NodeId id : of_[node].states) {
        for (std::size_t f = 1; f <= nodes_->frames(); ++f) {
          for (std::size_t g = 1; g < f; ++g) {
            if (sender(f) == sender(g) || !hears(node, f) || !hears(node, g)) continue;
            const Outcome& first_f = hear(id, f);
            const Outcome& then_g = hear(first_f.next, g);
            const Outcome& first_g = hear(id, g);
            const Outcome& then_f = hear(first_g.next, f);
            const bool agree =
                then_g.next == then_f.next && same(first_f, then_f) && same(first_g, then_g);
            if (!agree) return false;
          }
        }
      }
    }
    return true;
  }

  std::unique_ptr<Nodes> nodes_;
  OutcomeCache outcomes_{*nodes_};
  std::array<std::uint16_t, kNodesMax> am_address_{};
  std::array<OfNode, kNodesMax> of_;
};

// Returns the mote whose step a move is; that of a sink's answer is the one that it is for.
std::size_t mote_of(const Nodes& nodes, const Move& move) {
  if (move.kind == Move::Kind::kStep) return move.node;
  if (nodes.is_mote(move.copy.sender())) return move.copy.sender();
  return std::size_t{nodes.frame(move.copy.frame()).dest} - kFirstMoteId;
}

}  // namespace

bool motes_are_independent(const Options& options) {
  if (!options.partial_order || options.motes < 2 || options.scope != Scope::kJoin) return false;
  if (options.collide || options.prompt || options.dups != 0) return false;
  Options one_call_more = options;
  ++one_call_more.calls;
  return Closure(one_call_more).separates_motes();
}

void keep_one_mote(const Nodes& nodes, const World& world, Successors& ways_on) {
  std::size_t best = 2 * kNodesMax;
  const auto rank = [&](const Successor& s) {
    const std::size_t mote = mote_of(nodes, s.move);
    const bool begun = world.node[mote] != nodes.initial(mote);
    return mote + (begun ? 0 : kNodesMax);
  };
  for (const Successor& s : ways_on) best = std::min(best, rank(s));
  ways_on.keep([&](const Successor& s) { return rank(s) == best; });
}

}  // namespace rubric::explore
