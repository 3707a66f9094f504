#include "conformance/explore/network.h"

#include <algorithm>
#include <deque>

namespace rubric::explore {

// Runs the network after faults have stopped: frames arrive in the order in which they were sent,
// link acks come, timers fire only when nothing else happens.
class Healing {
 public:
  explicit Healing(Network& network) : network_(network) {}

  /// Returns, for a state in which no node has anything to do, whether a call of each mote that is
  /// no member, alone and after the others', makes it one that its sink lists. Sets `weak` if one
  /// could not because it has rebooted and a sink still lists it (spec/membership.md), which is
  /// known.
  bool succeeds(const World& world, bool& weak);

 private:
  bool joins(World& world, std::size_t mote);
  void happen(World& world, std::size_t node, std::uint32_t what);
  bool advance(World& world);

  Network& network_;
  std::deque<Copy> air_;
};

constexpr int kStepsMax = 10000;  // Far more than a call can take.

void Healing::happen(World& world, std::size_t node, std::uint32_t what) {
  world.copies = 0;
  network_.apply(world, node, what, nullptr);
  for (std::size_t i = 0; i < world.copies; ++i) air_.push_back(world.copy[i]);
  world.copies = 0;
}

// Makes one thing happen. Returns false if nothing is left.
bool Healing::advance(World& world) {
  if (!air_.empty()) {
    const Copy copy = air_.front();
    air_.pop_front();
    const NodeSet hearers = network_.addressed(copy);
    for (std::size_t i = 0; i < network_.count_; ++i) {
      if ((hearers >> i & 1) != 0) happen(world, i, event::kFrame + copy.frame());
    }
    const bool confirms = network_.nodes_.frame(copy.frame()).link_ack && hearers != 0;
    if (confirms && network_.facts(world, copy.sender()).on_air == copy.frame()) {
      happen(world, copy.sender(), event::kDoneAcked);
    }
    return true;
  }
  for (std::size_t i = 0; i < network_.count_; ++i) {
    const NodeFacts f = network_.facts(world, i);
    if (f.serial_sending) return happen(world, i, event::kDoneSerial), true;
    if (f.radio_sending) {
      const bool wanted = f.on_air != 0;
      return happen(world, i, wanted ? event::kDoneUnacked : event::kDoneAcked), true;
    }
  }
  for (std::size_t i = 0; i < network_.count_; ++i) {
    if (network_.facts(world, i).join_timer) return happen(world, i, event::kJoinTimer), true;
  }
  return false;
}

bool Healing::joins(World& world, std::size_t mote) {
  air_.clear();
  happen(world, mote, event::kCall);
  for (int i = 0; i < kStepsMax && advance(world); ++i) {
  }
  const std::uint8_t view = network_.facts(world, mote).view;
  for (std::size_t s = network_.nodes_.options().motes; s < network_.count_; ++s) {
    const auto island = static_cast<std::uint8_t>(1U << (s - network_.nodes_.options().motes));
    const bool lists = (network_.facts(world, s).listed >> mote & 1) != 0;
    if (view == island && lists) return true;
  }
  return false;
}

bool Healing::succeeds(const World& world, bool& weak) {
  const Options& options = network_.nodes_.options();
  World after = world;
  bool all = true;
  for (std::size_t m = 0; m < options.motes; ++m) {
    const NodeFacts mote = network_.facts(world, m);
    if (mote.view != 0) continue;
    if (mote.open) {  // The application waits for ever, and calls no more.
      all = false;
      continue;
    }
    bool listed = false;
    for (std::size_t s = options.motes; s < network_.count_; ++s) {
      listed |= (network_.facts(world, s).listed >> m & 1) != 0;
    }
    World alone = world;
    if (joins(alone, m) && joins(after, m)) continue;
    if (mote.reboots != 0 && listed && options.profile.listed_ignored) {
      weak = true;
    } else {
      all = false;
    }
  }
  return all;
}

Network::Network(Nodes& nodes) : nodes_(nodes), outcomes_(nodes), count_(nodes.count()) {
  for (std::size_t i = 0; i < count_; ++i) am_address_[i] = nodes.config_of(i).id;
}

World Network::initial() const {
  World world;
  for (std::size_t i = 0; i < count_; ++i) world.node[i] = nodes_.initial(i);
  return world;
}

// Returns whether two frames of one sender keep their order: some node can hear both.
bool Network::ordered(Copy a, Copy b) const {
  if (nodes_.options().reorder) return a == b;
  const std::uint16_t one = nodes_.frame(a.frame()).dest;
  const std::uint16_t other = nodes_.frame(b.frame()).dest;
  return one == other || one == machine::kAmBroadcast || other == machine::kAmBroadcast;
}

// Frames of one sender that no node can hear both of have no order, so that the air does not
// remember what nobody can tell. Of all orders that keep the rest in order the one with the lowest
// numbers first is kept: a new copy goes before the first with a higher number, behind all that it
// may not overtake.
void Network::put(World& world, Copy copy) const {
  std::size_t place = 0;
  bool placed = false;
  for (std::size_t i = 0; i < world.copies; ++i) {
    const Copy other = world.copy[i];
    const bool mine = other.sender() == copy.sender();
    if (other.sender() < copy.sender() || (mine && ordered(other, copy))) {
      place = i + 1;
      placed = false;
    } else if (mine && !placed && other.frame() < copy.frame()) {
      place = i + 1;
    } else {
      placed = true;
    }
  }
  std::memmove(&world.copy[place + 1], &world.copy[place], (world.copies - place) * sizeof(Copy));
  world.copy[place] = copy;
  ++world.copies;
}

void Network::fly(World& world, Copy copy) {
  std::size_t same = 0;
  std::size_t own = 0;
  for (std::size_t i = 0; i < world.copies; ++i) {
    same += world.copy[i] == copy ? 1 : 0;
    own += world.copy[i].sender() == copy.sender() ? 1 : 0;
  }
  if (same >= nodes_.options().in_flight) return;
  if (world.copies == World::kCopiesMax || own == World::kOwnCopiesMax) {
    overflowed_ = true;
  } else {
    put(world, copy);
  }
}

// Removes a copy. What it held back may now stand before others, so its sender's are put again.
void Network::take(World& world, std::size_t i) const {
  const Copy gone = world.copy[i];
  world.erase(i);
  bool passed = false;
  bool held_back = false;
  for (std::size_t k = i; k < world.copies && world.copy[k].sender() == gone.sender(); ++k) {
    held_back |= passed && ordered(gone, world.copy[k]);
    passed |= !ordered(gone, world.copy[k]);
  }
  if (!held_back) return;
  const World old = world;
  world.copies = 0;
  for (std::size_t k = 0; k < old.copies; ++k) put(world, old.copy[k]);
}

NodeSet Network::addressed(Copy copy) const {
  const std::uint16_t dest = nodes_.frame(copy.frame()).dest;
  unsigned set = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (am_address_[i] == dest || dest == machine::kAmBroadcast) set |= 1U << i;
  }
  return static_cast<NodeSet>(set & ~(1U << copy.sender()));
}

bool Network::in_flight(const World& world, Copy copy) const {
  const Copy* const end = world.copy.data() + world.copies;
  return std::find(world.copy.data(), end, copy) != end;
}

// Applies a node's step and sends its frames.
void Network::apply(World& world, std::size_t node, std::uint32_t what, Successor* successor) {
  const Outcome& outcome = outcomes_(world.node[node], what);
  if (successor != nullptr) {
    successor->violated |= outcome.violated;
    successor->goals |= outcome.goals;
  }
  if (outcome.overflow) overflowed_ = true;
  world.node[node] = outcome.next;
  for (std::uint8_t i = 0; i < outcome.frames; ++i) fly(world, Copy::of(outcome.frame[i], node));
}

void Network::hear(World& world, Copy copy, NodeSet hearers, Successor* successor) {
  for (std::size_t i = 0; i < count_; ++i) {
    if ((hearers >> i & 1) != 0) apply(world, i, event::kFrame + copy.frame(), successor);
  }
}

void Network::add_step(const World& world, std::size_t node, std::uint32_t what, Successors& out) {
  Successor& next = out.push(world);
  next.move.node = static_cast<std::uint8_t>(node);
  next.move.what = what;
  apply(next.world, node, what, &next);
}

void Network::node_moves(const World& world, std::size_t node, Successors& out) {
  const Options& options = nodes_.options();
  const NodeFacts f = facts(world, node);
  if (f.may_call) add_step(world, node, event::kCall, out);
  for (std::uint8_t i = 0; i < f.sends; ++i) add_step(world, node, event::kSend + i, out);
  if (!options.prompt || world.copies == 0) {
    if (f.join_timer) add_step(world, node, event::kJoinTimer, out);
    for (std::uint8_t i = 0; i < f.ack_timers; ++i) {
      add_step(world, node, event::kAckTimer + i, out);
    }
  }
  if (f.serial_sending) add_step(world, node, event::kDoneSerial, out);
  if (f.radio_sending && f.on_air == 0) add_step(world, node, event::kDoneAcked, out);
  if (f.radio_sending && f.on_air != 0) {
    // Without loss the link ack comes as long as the frame may yet be heard.
    const bool none = options.loss || !in_flight(world, Copy::of(f.on_air, node));
    if (none) add_step(world, node, event::kDoneUnacked, out);
  }
  if (f.may_reboot) add_step(world, node, event::kReboot, out);
}

// Returns whether no frame that it may not overtake is still in flight.
bool Network::is_first(const World& world, std::size_t i) const {
  for (std::size_t k = 0; k < i; ++k) {
    const bool mine = world.copy[k].sender() == world.copy[i].sender();
    if (mine && ordered(world.copy[k], world.copy[i])) return false;
  }
  return true;
}

// Returns whether a copy that is heard may be heard again.
bool Network::may_stay(const World& world) const {
  const Options& options = nodes_.options();
  return options.dup && (options.dups == 0 || world.doubled < options.dups);
}

// Delivers a copy. The radio answers at once whatever is addressed to it, before any node reads the
// frame; with loss, the answer may not arrive.
void Network::deliver(const World& world, std::size_t i, NodeSet hearers, bool stays,
                      Successors& out) {
  const Copy copy = world.copy[i];
  const bool wanted =
      nodes_.frame(copy.frame()).link_ack && facts(world, copy.sender()).on_air == copy.frame();
  for (const bool confirmed : {false, true}) {
    if (confirmed ? !wanted : wanted && !nodes_.options().loss) continue;
    Successor& next = out.push(world);
    next.move.kind = Move::Kind::kDeliver;
    next.move.copy = copy;
    next.move.hearers = hearers;
    next.move.stays = stays;
    next.move.confirmed = confirmed;
    if (!stays) take(next.world, i);
    if (stays && nodes_.options().dups != 0) ++next.world.doubled;
    hear(next.world, copy, hearers, &next);
    if (confirmed) apply(next.world, copy.sender(), event::kDoneAcked, &next);
  }
}

void Network::copy_moves(const World& world, std::size_t i, Successors& out) {
  const Copy copy = world.copy[i];
  const Options& options = nodes_.options();
  if (!is_first(world, i)) return;
  const NodeSet all = addressed(copy);
  for (unsigned hearers = all; hearers != 0; hearers = (hearers - 1) & all) {
    if (hearers != all && !options.loss) continue;  // Without loss all hear it.
    // Hearing by some that ends the copy equals a copy that stays and is then lost.
    const bool twice = options.loss && options.dup && options.dups == 0 && hearers != all;
    if (!twice) deliver(world, i, static_cast<NodeSet>(hearers), false, out);
    if (may_stay(world)) deliver(world, i, static_cast<NodeSet>(hearers), true, out);
  }
  if (options.loss || all == 0) {
    Successor& next = out.push(world);
    next.move.kind = Move::Kind::kLose;
    next.move.copy = copy;
    take(next.world, i);
  }
}

// Two frames overlap: nodes that both are addressed to hear neither.
void Network::collide(const World& world, std::size_t i, std::size_t k, Successors& out) {
  const Copy a = world.copy[i];
  const Copy b = world.copy[k];
  const auto common = static_cast<NodeSet>(addressed(a) & addressed(b));
  Successor& next = out.push(world);
  next.move.kind = Move::Kind::kCollide;
  next.move.copy = a;
  next.move.other = b;
  next.move.hearers = static_cast<NodeSet>(addressed(a) & ~common);
  next.move.other_hearers = static_cast<NodeSet>(addressed(b) & ~common);
  take(next.world, k);
  take(next.world, i);
  hear(next.world, a, next.move.hearers, &next);
  hear(next.world, b, next.move.other_hearers, &next);
}

void Network::collisions(const World& world, Successors& out) {
  for (std::size_t i = 0; i < world.copies; ++i) {
    for (std::size_t k = i + 1; k < world.copies; ++k) {
      const Copy a = world.copy[i];
      const Copy b = world.copy[k];
      const bool meet = a.sender() != b.sender() && (addressed(a) & addressed(b)) != 0;
      if (meet && is_first(world, i) && is_first(world, k)) collide(world, i, k, out);
    }
  }
}

void Network::successors(const World& world, Successors& out) {
  out.clear();
  for (std::size_t i = 0; i < count_; ++i) node_moves(world, i, out);
  for (std::size_t i = 0; i < world.copies; ++i) copy_moves(world, i, out);
  if (nodes_.options().collide) collisions(world, out);
}

bool Network::at_rest(const World& world) const {
  if (world.copies != 0) return false;
  for (std::size_t i = 0; i < count_; ++i) {
    const NodeFacts& f = facts(world, i);
    if (f.open || f.open_sends || f.radio_sending || f.serial_sending || f.waiting) return false;
  }
  return true;
}

Mask Network::violated(const World& world, const Successors& ways_on) {
  const Options& options = nodes_.options();
  Mask broken = 0;
  bool open = false;
  bool open_sends = false;
  for (std::size_t i = 0; i < count_; ++i) {
    const NodeFacts& f = facts(world, i);
    open |= f.open;
    open_sends |= f.open_sends;
    for (std::size_t m = 0; f.listed != 0 && m < options.motes; ++m) {
      const auto island = static_cast<std::uint8_t>(1U << (i - options.motes));
      const bool acked = (facts(world, m).acked_ever & island) != 0;
      if ((f.listed >> m & 1) != 0 && !acked) broken |= bit(Property::kListedAcked);
    }
  }
  if (rests(world, ways_on)) {
    const bool ack_times_out = options.profile.ack_timeout_ticks != 0;
    if (!at_rest(world)) {
      if (open) broken |= bit(Property::kOneTerminal);
      if (open_sends && ack_times_out) broken |= bit(Property::kReliableEnds);
      if (open || !open_sends || ack_times_out) broken |= bit(Property::kNoDeadlock);
    }
    broken |= broken_by_healing(world);
  }
  return broken & options.properties;
}

bool Network::rests(const World& world, const Successors& ways_on) const {
  return world.copies == 0 && std::none_of(ways_on.begin(), ways_on.end(), [](const Successor& s) {
           return s.move.what != event::kCall && s.move.what != event::kReboot &&
                  (s.move.what < event::kSend || s.move.what >= event::kFrame);
         });
}

Mask Network::broken_by_healing(const World& world) {
  const Mask asked = nodes_.options().properties & bit(Property::kJoinSucceeds);
  bool weak = false;
  const bool broken = asked != 0 && !Healing(*this).succeeds(world, weak);
  if (weak) ++known_weak_;
  return broken ? asked : 0;
}

Mask Network::goals(const World& world) const {
  const Options& options = nodes_.options();
  Mask reached = 0;
  std::uint8_t views = 0;
  int members = 0;
  for (std::size_t m = 0; m < options.motes; ++m) {
    const NodeFacts& mote = facts(world, m);
    views = static_cast<std::uint8_t>(views | mote.view);
    if (mote.view != 0) ++members;
    for (std::size_t s = 0; s < options.sinks; ++s) {
      const bool listed = (facts(world, options.motes + s).listed >> m & 1) != 0;
      const bool member = mote.view == 1U << s;
      if (listed && !member) reached |= bit(Goal::kGhost);
      if (member && !listed && world.copies == 0 && !mote.radio_sending) {
        reached |= bit(Goal::kOrphan);
      }
    }
  }
  if (members > 1) {
    const bool one = (views & (views - 1)) == 0;
    reached |= bit(one ? Goal::kSameIsland : Goal::kTwoIslands);
  }
  return reached;
}

}  // namespace rubric::explore
