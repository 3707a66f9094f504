#include "conformance/explore/counterexample.h"

#include <algorithm>
#include <utility>

#include "conformance/trace/concrete.h"
#include "conformance/trace/events/lines.h"

namespace rubric::explore {
namespace {

using machine::Actions;
using machine::Event;
using machine::Link;
using machine::Ticks;
using machine::Transmit;
using trace::LinkKind;
using trace::Op;

constexpr std::string_view kRadio = "r";
constexpr Ticks kStepTicks = 2;       // From one thing to the next.
constexpr Ticks kSilencePeriods = 6;  // Join periods between the last event and the end.
constexpr std::uint8_t kRadioGroup = 0x22;

// A frame in the air, with who heard it.
struct Flying {
  Copy copy;
  Transmit transmit;
  NodeSet heard = 0;
};

struct Actor {
  events::NodeNames names;
  machine::State state;
  Monitor monitor;
  NodeId id = 0;  // The explorer's number of what should be the same state, but for the clock.
};

class Walk {
 public:
  Walk(Nodes& nodes, trace::Case& out) : nodes_(nodes), out_(out) {
    for (std::size_t i = 0; i < nodes.count(); ++i) {
      const bool mote = nodes.is_mote(i);
      const std::size_t number = mote ? kFirstMoteId + i : i - nodes.options().motes;
      const std::string letter(1, static_cast<char>('A' + number % 26));
      Actor actor;
      actor.names.node = mote ? "m" + std::to_string(number) : "s" + letter;
      actor.names.radio = kRadio;
      actor.names.serial = mote ? "" : "ser" + letter;
      actor.names.radio_group = kRadioGroup;
      actor.state = machine::start(nodes.config_of(i));
      actor.id = nodes.initial(i);
      actors_.push_back(std::move(actor));
    }
  }

  void headers(trace::File& file) const {
    trace::LinkHeader air{std::string(kRadio), LinkKind::kRadio, {}};
    for (std::size_t i = 0; i < actors_.size(); ++i) {
      air.nodes.push_back(actors_[i].names.node);
      file.node(events::header_of(nodes_.config_of(i), air.nodes.back()));
    }
    file.header({air, {}, {}});
    for (const Actor& actor : actors_) {
      const auto& [node, radio, serial, peis, group] = actor.names;
      if (!serial.empty())
        file.header({trace::LinkHeader{serial, LinkKind::kSerial, {node}}, {}, {}});
    }
  }

  void move(const Move& move) {
    now_ += kStepTicks;
    switch (move.kind) {
      case Move::Kind::kStep: return happens(move.node, move.what);
      case Move::Kind::kDeliver: return deliver(move);
      case Move::Kind::kLose: return lose(move.copy, "lost");
      case Move::Kind::kCollide: return collide(move);
    }
  }

  // Lets so much time pass that all that is due has come.
  void silence() {
    now_ += kSilencePeriods * nodes_.options().profile.join_period_ticks;
    const Event clock = machine::Called{machine::GetClock{}};
    Actor& actor = actors_.front();
    given(actor, clock);
    Actions actions;
    nodes_.options().step(actor.state, now_, clock, actions);
    did(actor, actions);
  }

  void comment(const std::string& text) {
    out_.items.emplace_back(trace::Comment{';', false, " " + text});
  }

 private:
  void given(const Actor& actor, const Event& event) {
    if (auto line = events::given_line(now_, actor.names, event)) out_.add(std::move(*line));
  }
  void did(const Actor& actor, const Actions& actions) {
    for (trace::Line& line : events::emitted_lines(now_, actor.names, actions)) {
      out_.add(std::move(line));
    }
  }

  // Makes one of the explorer's steps: the event, and the ends of transmissions that nobody waits
  // for.
  void happens(std::size_t node, std::uint32_t what, const Transmit* frame = nullptr) {
    Actor& actor = actors_[node];
    wait_for_timer(actor, what);
    const Event event = nodes_.event_of(actor.state, actor.monitor, what, frame);
    // Of other frames nobody is told how they ended.
    const bool done = std::holds_alternative<machine::SendDone>(event);
    if (!done || (what != event::kDoneSerial && actor.state.radio.sending_ack_join)) {
      given(actor, event);
    }
    std::vector<Transmit> sent;
    step(actor, event, sent);
    while (!nodes_.options().busy) {
      if (actor.state.radio.sending && !actor.state.radio.sending_ack_join) {
        step(actor, machine::SendDone{Link::kRadio, true}, sent);
      } else if (actor.state.serial.sending) {
        step(actor, machine::SendDone{Link::kSerial, true}, sent);
      } else {
        break;
      }
    }
    const Outcome& outcome = nodes_.outcome(actor.id, what);
    actor.id = outcome.next;
    actor.monitor = nodes_.state(actor.id).monitor;
    const std::size_t frames = std::min<std::size_t>(outcome.frames, sent.size());
    for (std::size_t i = 0; i < frames; ++i) fly(Copy::of(outcome.frame[i], node), sent[i]);
  }

  void step(Actor& actor, const Event& event, std::vector<Transmit>& sent) {
    Actions actions;
    nodes_.options().step(actor.state, now_, event, actions);
    did(actor, actions);
    for (const Transmit& t : actions.transmits()) {
      if (t.link == Link::kRadio) sent.push_back(t);
    }
  }

  void wait_for_timer(const Actor& actor, std::uint32_t what) {
    const bool ack = what >= event::kAckTimer && what < event::kSend;
    if (what != event::kJoinTimer && !ack) return;
    for (const machine::DueTimer& timer : machine::timers(actor.state)) {
      const bool is = ack ? timer.timer.kind == machine::TimerKind::kAck &&
                                timer.timer.index == what - event::kAckTimer
                          : timer.timer.kind == machine::TimerKind::kJoin;
      if (is) now_ = std::max(now_, timer.due);
    }
  }

  // Puts a copy in the air. Of the same frame only the newest copies are followed, as many as there
  // may be in flight.
  void fly(Copy copy, const Transmit& transmit) {
    std::size_t same = 0;
    for (const Flying& flying : air_) same += flying.copy == copy ? 1 : 0;
    if (same < nodes_.options().in_flight) return air_.push_back({copy, transmit, 0});
    for (Flying& flying : air_) {
      if (flying.copy == copy) flying = {copy, transmit, 0};
    }
  }

  std::size_t find(Copy copy) const {
    for (std::size_t i = 0; i < air_.size(); ++i) {
      if (air_[i].copy == copy) return i;
    }
    return air_.size();
  }

  void fault(const Transmit& transmit, Op op, std::size_t node, const std::string& why) {
    trace::Line line = trace::fault_line(now_, op, kRadio, LinkKind::kRadio,
                                         events::frame_of(actors_[node].names, transmit.frame()));
    line.comment = actors_[node].names.node + ": " + why;
    out_.add(std::move(line));
  }

  void hear(Flying& flying, NodeSet hearers) {
    for (std::size_t i = 0; i < actors_.size(); ++i) {
      if ((hearers >> i & 1) == 0) continue;
      if ((flying.heard >> i & 1) != 0) fault(flying.transmit, Op::kDup, i, "twice");
      flying.heard = static_cast<NodeSet>(flying.heard | 1U << i);
      const Transmit transmit = flying.transmit;
      happens(i, event::kFrame + flying.copy.frame(), &transmit);
    }
  }

  // Marks a frame as lost for all addressees that never heard it.
  void gone(const Flying& flying, const std::string& why) {
    for (std::size_t i = 0; i < actors_.size(); ++i) {
      const std::uint16_t dest = flying.transmit.dest;
      const bool addressed = nodes_.config_of(i).id == dest || dest == machine::kAmBroadcast;
      const bool missed = addressed && (flying.heard >> i & 1) == 0;
      if (missed && i != flying.copy.sender()) fault(flying.transmit, Op::kLost, i, why);
    }
  }

  void deliver(const Move& move) {
    const std::size_t at = find(move.copy);
    if (at == air_.size()) return;
    Flying flying = air_[at];
    air_.erase(air_.begin() + static_cast<std::ptrdiff_t>(at));
    const Copy copy = flying.copy;
    const NodeSet before = flying.heard;
    flying.heard = before;
    hear(flying, move.hearers);
    if (move.stays && find(copy) == air_.size()) {
      air_.push_back(flying);
    } else if (!move.stays) {
      gone(flying, "lost");
    }
    if (move.confirmed) happens(copy.sender(), event::kDoneAcked);
  }

  void lose(Copy copy, const std::string& why) {
    const std::size_t at = find(copy);
    if (at == air_.size()) return;
    gone(air_[at], why);
    air_.erase(air_.begin() + static_cast<std::ptrdiff_t>(at));
  }

  void collide(const Move& move) {
    for (const bool first : {true, false}) {
      const std::size_t at = find(first ? move.copy : move.other);
      if (at == air_.size()) continue;
      Flying flying = air_[at];
      air_.erase(air_.begin() + static_cast<std::ptrdiff_t>(at));
      hear(flying, first ? move.hearers : move.other_hearers);
      gone(flying, "collision");
    }
  }

  Nodes& nodes_;
  trace::Case& out_;
  std::vector<Actor> actors_;
  std::vector<Flying> air_;
  Ticks now_ = 0;
};

}  // namespace

trace::File counterexample(Nodes& nodes, const Path& path, const Title& title) {
  trace::File file = trace::File::begin(title.profile);
  if (!title.note.empty()) file.header({trace::NoteHeader{title.note}, {}, {}});
  trace::Case one(title.case_name);
  Walk walk(nodes, one);
  walk.headers(file);
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    if (path.loop == i)
      walk.comment("Loop: what follows, up to the end of the loop, repeats for ever.");
    walk.move(path.moves[i]);
  }
  if (path.loop) walk.comment("End of the loop: all nodes and frames are as at its beginning.");
  for (const PropertyInfo& p : properties()) {
    if ((path.violated & bit(p.property)) == 0) continue;
    std::string rules;
    for (const ReqId rule : p.requirements) {
      if (rule == ReqId::kNone) continue;
      rules += (rules.empty() ? "" : " ") + std::string(trace::requirement_text(rule));
    }
    walk.comment("Broken: " + std::string(p.name) + " (" + rules + "): " + p.sentence);
  }
  if (!path.loop) walk.silence();
  file.cases.push_back(std::move(one));
  return file;
}

}  // namespace rubric::explore
