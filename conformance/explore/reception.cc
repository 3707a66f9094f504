#include "conformance/explore/reception.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "conformance/machine/messages.h"
#include "conformance/trace/trace.h"

namespace rubric::explore {
namespace reception {  // Its names differ from those of other files by this.
namespace {

using machine::Actions;
using machine::Address;
using machine::Event;
using machine::Transmit;

constexpr std::uint16_t kIsland = 11;
constexpr std::uint16_t kOtherIsland = 12;
constexpr std::uint16_t kMote = 5;   // The mote itself; at a sink one that has asked to join.
constexpr std::uint16_t kPeer = 6;   // Who sends; at a sink a member.
constexpr std::uint16_t kOther = 7;  // Another mote.
constexpr std::uint16_t kNewcomer = 8;
constexpr std::uint16_t kNumber = 9;  // Of a request to join.

constexpr std::array<PartName, 2> kNames{
    {{"mote_reception", "What a mote does about a message from its radio"},
     {"sink_reception", "What a sink does about a message from its radio"}}};

// Questions in the order in which a node may ask them, each with its answers.
enum Question : std::size_t {
  kMessage,
  kStage,
  kOffer,
  kListed,
  kJoinIsland,
  kJoinNumber,
  kWhole,
  kIslandOf,
  kSender,
  kDevice,
  kContent,
  kReliable,
  kQuestions
};
struct Asked {
  const char* text;
  std::vector<const char*> answers;
};
const std::array<Asked, kQuestions>& questions() {
  static const std::array<Asked, kQuestions> all{
      {{"which message?", {"join_request", "join_reply", "ack_join", "net_msg"}},
       {"is it a member?", {"it has not asked", "it is asking", "yes"}},
       {"for its request?", {"yes", "another number", "another mote's address"}},
       {"is the mote\non its list?", {"no", "yes"}},
       {"dest.pid?", {"its island", "another island"}},
       {"the number\nof its reply?", {"yes", "no"}},
       {"is nbytes right?", {"yes", "no"}},
       {"dest.pid?", {"its island", "another island", "all"}},
       {"src.pid?", {"its island", "another island"}},
       {"dest.devid?", {"its own", "another mote", "NULL: the PC", "all"}},
       {"TRANSID?", {"CONNLESS", "RUBICON_ACK", "SYN_CHANNEL"}},
       {"reliable?", {"0", "1"}}}};
  return all;
}

// The answers that a frame gives; kNone where a question makes no sense.
constexpr std::size_t kNone = 99;
struct Answers : std::array<std::size_t, kQuestions> {
  Answers() { fill(kNone); }
};

// A node that was brought to a stage.
class Tried {
 public:
  Tried(const machine::Config& config, StepFunction step) : step_(step) {
    state_ = machine::start(config);
    witness_.config = config;
  }

  // Gives an event and ends all transmissions that follow. Returns what followed.
  const Actions& give(const Given& given) {
    witness_.events.push_back(given);
    step_(state_, ++now_, given.event(), actions_);
    const Actions first = actions_;
    end(first);
    return last_ = first;
  }
  void call(const machine::Call& call) { give({machine::Called{call}, {}}); }
  void hear(const Transmit& frame) { give({{}, frame}); }

  const machine::State& state() const { return state_; }
  const Witness& witness() const { return witness_; }

 private:
  void end(const Actions& actions) {
    for (const Transmit& one : actions.transmits()) {
      const Event done = machine::SendDone{one.link, true};
      if (one.link_ack) witness_.events.push_back({done, {}});
      Actions more;
      step_(state_, now_, done, more);
      end(more);
    }
  }

  StepFunction step_;
  machine::State state_;
  machine::Ticks now_ = 0;
  Actions actions_;
  Actions last_;
  Witness witness_;
};

template <class Message>
Transmit frame_of(std::uint8_t type, std::uint16_t src, std::uint16_t dest,
                  const Message& message) {
  Transmit frame{.type = type, .dest = dest, .src = src};
  const auto bytes =
      rubicon::write(message, MutableBytes(frame.payload.data(), frame.payload.size()));
  frame.size_bytes = static_cast<std::uint8_t>(bytes->size());
  return frame;
}

Transmit join_request(std::uint16_t src) {
  rubicon::JoinRequest message;
  message.seq_num = kNumber;
  return frame_of(machine::am::kJoin, src, machine::kAmBroadcast, message);
}

Transmit join_reply(std::uint16_t number, std::uint16_t address, std::uint16_t to = kMote) {
  rubicon::JoinReply message;
  message.island_addr = kIsland;
  message.mote_addr = address;
  message.seq_num = number;
  return frame_of(machine::am::kJoinReply, 1, to, message);
}

Transmit ack_join(std::uint16_t src, std::uint16_t island, std::uint16_t number,
                  std::uint16_t to = 1) {
  rubicon::AckJoin message;
  message.dest = machine::wire_of(Address{island, 1});
  message.src = machine::wire_of(Address{island, src});
  message.seq_num = number;
  return frame_of(machine::am::kAckJoin, src, to, message);
}

Transmit net_msg(const Answers& answers, std::uint16_t own, std::uint16_t awaited) {
  const std::size_t sender = answers[kSender] == kNone ? 0 : answers[kSender];
  const std::uint16_t pids[] = {kIsland, kOtherIsland, machine::kBroadcastPid};
  const std::uint16_t devids[] = {own, kOther, machine::kNullDevid, machine::kBroadcastDevid};
  rubicon::NetMsg message;
  message.dest = machine::wire_of(Address{pids[answers[kIslandOf]], devids[answers[kDevice]]});
  message.src = machine::wire_of(Address{pids[sender], kPeer});
  message.reliable = answers[kReliable] == 1 ? 1 : 0;
  message.seq_num = 300;
  rubicon::AppMsg app;
  app.app_id = rubicon::Component::kControlLayer;
  app.trans_id = rubicon::Component::kConnless;
  std::uint8_t content[rubicon::AppMsgLayout::PayloadAt::kAt + 8];
  std::uint8_t inner[8] = {};
  app.payload = Bytes(inner, 4);
  if (answers[kContent] == 1) {
    app.trans_id = rubicon::Component::kRubiconAck;
    rubicon::RubiconAckSeqOnly ack;
    ack.seq_num = awaited;
    const auto written = rubicon::write(ack, MutableBytes(inner, sizeof inner));
    app.payload = Bytes(written->data(), written->size());
  } else if (answers[kContent] == 2) {
    app.trans_id = rubicon::Component::kSynChannel;
    app.app_id = rubicon::Component::kEsnData;
  }
  const auto written = rubicon::write(app, MutableBytes(content, sizeof content));
  message.payload = Bytes(written->data(), written->size());
  Transmit frame = frame_of(machine::am::kNet, kPeer, own, message);
  if (answers[kWhole] == 1) frame.size_bytes -= 1;
  return frame;
}

// ---- What comes of a frame.

struct Outcome {
  std::string end;
  std::vector<std::string> rules;
};

void add(std::vector<std::string>& list, const std::string& word) {
  if (std::find(list.begin(), list.end(), word) == list.end()) list.push_back(word);
}

// Names an output, by overloading.
struct NameOf {
  const char* operator()(const machine::Joined&) const { return "joined(success)"; }
  const char* operator()(const machine::MoteJoined&) const { return "mote_joined"; }
  const char* operator()(const machine::Received&) const { return "deliver it"; }
  const char* operator()(const machine::AckReceived&) const { return "receive_ack(success)"; }
  const char* operator()(const machine::SynDataReceived&) const { return "synData_received"; }
  template <class Other>
  const char* operator()(const Other&) const {
    return "";
  }
};

std::string text_of(const Transmit& sent, const Transmit& heard) {
  switch (sent.type) {
    case machine::am::kJoinReply: return "send join_reply";
    case machine::am::kAckJoin: return "send ack_join";
    default: break;
  }
  const bool same = equal(sent.bytes().first(rubicon::NetMsgLayout::PayloadAt::kAt),
                          heard.bytes().first(rubicon::NetMsgLayout::PayloadAt::kAt));
  const bool serial = sent.link == machine::Link::kSerial;
  if (heard.type != machine::am::kNet) return "send serial_joined";
  if (same) return serial ? "forward it by serial" : "forward it by radio";
  return serial ? "send an ack by serial" : "send an ack";
}

Outcome outcome_of(const Actions& actions, const Transmit& heard) {
  Outcome out;
  std::vector<std::string> ends;
  for (const machine::Action& action : actions.all()) {
    if (action.requirement != ReqId::kNone) {
      add(out.rules, std::string(trace::requirement_text(action.requirement)));
    }
    if (action.what == machine::Action::What::kTransmit) {
      add(ends, text_of(actions.transmit_of(action), heard));
    }
    if (action.what == machine::Action::What::kNotify) {
      add(ends, std::visit(NameOf(), actions.notice_of(action)));
    }
  }
  const bool keeps = std::find(out.rules.begin(), out.rules.end(), "S1-READ") != out.rules.end();
  if (ends.empty() && keeps) ends.emplace_back("keep its values");
  out.end = ends.empty() ? "nothing" : fmt::format("{}", fmt::join(ends, "\n"));
  return out;
}

struct Sample {
  Answers answers;
  Outcome outcome;
  Witness witness;
};

Sample sample_of(Tried node, const Answers& answers, const Transmit& frame) {
  Witness witness = node.witness();
  witness.events.push_back({{}, frame});
  return {answers, outcome_of(node.give({{}, frame}), frame), witness};
}

// Calls `make` with all answers to these questions.
template <class Make>
void each(std::vector<Question> asked, Answers answers, const Make& make) {
  if (asked.empty()) return make(answers);
  const Question question = asked.back();
  asked.pop_back();
  for (std::size_t i = 0; i < questions()[question].answers.size(); ++i) {
    answers[question] = i;
    each(asked, answers, make);
  }
}

// Calls `make` with all answers that a net_msg gives. Whose it is is asked of one for another
// island, whether it is reliable of one that CONNLESS takes.
template <class Make>
void each_net_msg(Answers answers, const Make& make) {
  answers[kMessage] = 3;
  each({kWhole, kIslandOf, kSender, kDevice, kContent, kReliable}, answers,
       [&](const Answers& given) {
         Answers all = given;
         if (all[kIslandOf] != 1 && std::exchange(all[kSender], kNone) != 0) return;
         if (all[kContent] != 0 && std::exchange(all[kReliable], kNone) != 0) return;
         make(all);
       });
}

// Makes a node that has a channel from a peer, and a message to it whose ack it awaits.
std::uint16_t busy(Tried& node) {
  node.call(machine::CreateChannel{
      machine::Direction::kIn, {kIsland, kPeer}, 1, machine::Mode::kReliable});
  node.call(machine::StartChannel{machine::ChannelId{kPeer} << 16 | node.state().config.id});
  node.call(machine::Send{{kIsland, kPeer}, machine::component::kControlLayer, true, {}});
  return node.state().awaited[0].seq_num;
}

std::vector<Sample> mote_samples(const machine::Profile& profile, StepFunction step) {
  machine::Config config{.id = kMote, .profile = profile};
  const Tried outside(config, step);
  Tried asking = outside;
  asking.call(machine::JoinIsland{{}});
  const std::uint16_t number = asking.state().join.seq_num;
  Tried member = asking;
  member.hear(join_reply(number, kMote));
  const std::uint16_t awaited = busy(member);
  const Tried* const stages[] = {&outside, &asking, &member};
  std::vector<Sample> out;
  for (std::size_t stage = 0; stage < 3; ++stage) {
    Answers answers;
    answers[kStage] = stage;
    answers[kMessage] = 0;
    out.push_back(sample_of(*stages[stage], answers, join_request(kPeer)));
    answers[kMessage] = 2;
    out.push_back(sample_of(*stages[stage], answers, ack_join(kPeer, kIsland, kNumber, kMote)));
    answers[kMessage] = 1;
    each({kOffer}, answers, [&](const Answers& all) {
      const std::uint16_t other = number + 1;
      const Transmit reply =
          join_reply(all[kOffer] == 1 ? other : number, all[kOffer] == 2 ? kOther : kMote);
      out.push_back(sample_of(*stages[stage], all, reply));
    });
    each_net_msg(answers, [&](const Answers& all) {
      out.push_back(sample_of(*stages[stage], all, net_msg(all, kMote, awaited)));
    });
  }
  return out;
}

std::vector<Sample> sink_samples(const machine::Profile& profile, StepFunction step) {
  machine::Config config{
      .role = machine::Role::kSink, .id = profile.sink_id, .island = kIsland, .profile = profile};
  Tried sink(config, step);
  sink.hear(join_request(kPeer));
  sink.hear(ack_join(kPeer, kIsland, kNumber));
  sink.hear(join_request(kMote));
  const std::uint16_t awaited = busy(sink);
  std::vector<Sample> out;
  Answers answers;
  answers[kMessage] = 0;
  each({kListed}, answers, [&](const Answers& all) {
    out.push_back(sample_of(sink, all, join_request(all[kListed] == 1 ? kPeer : kNewcomer)));
  });
  answers[kMessage] = 1;
  out.push_back(sample_of(sink, answers, join_reply(kNumber, kMote, config.id)));
  answers[kMessage] = 2;
  each({kJoinIsland, kJoinNumber}, answers, [&](const Answers& all) {
    const std::uint16_t island = all[kJoinIsland] == 0 ? kIsland : kOtherIsland;
    const std::uint16_t number = all[kJoinNumber] == 0 ? kNumber : kNumber + 1;
    out.push_back(sample_of(sink, all, ack_join(kMote, island, number)));
  });
  each_net_msg(answers, [&](const Answers& all) {
    out.push_back(sample_of(sink, all, net_msg(all, config.id, awaited)));
  });
  return out;
}

// ---- The flowchart.

class Flowchart {
 public:
  explicit Flowchart(Diagram& out) : out_(out) {}

  void draw(const std::vector<Sample>& samples) {
    std::vector<const Sample*> all;
    for (const Sample& sample : samples) all.push_back(&sample);
    place(build(all, 0));
  }

 private:
  struct Edge {
    std::vector<std::string> answers;
    std::size_t to = 0;
    const Sample* witness = nullptr;
  };
  // A question with its answers, or an end with the rules that lead to it.
  struct Step {
    std::string text;
    std::vector<std::string> rules;
    std::vector<Edge> edges;
  };

  std::size_t known(Step step) {
    std::string key = step.text + '|' + fmt::format("{}", fmt::join(step.rules, " "));
    for (const Edge& edge : step.edges) {
      key += fmt::format("|{}>{}", fmt::join(edge.answers, ","), edge.to);
    }
    const auto [found, fresh] = keys_.emplace(key, steps_.size());
    if (fresh) steps_.push_back(std::move(step));
    return found->second;
  }

  // Returns the step that asks these samples what is left to ask.
  std::size_t build(const std::vector<const Sample*>& samples, std::size_t question) {
    if (question == kQuestions) {
      Step end{samples.front()->outcome.end, {}, {}};
      for (const Sample* sample : samples) {
        for (const std::string& rule : sample->outcome.rules) add(end.rules, rule);
      }
      return known(std::move(end));
    }
    std::map<std::size_t, std::vector<const Sample*>> groups;
    for (const Sample* sample : samples) groups[sample->answers[question]].push_back(sample);
    Step step{questions()[question].text, {}, {}};
    for (const auto& [answer, group] : groups) {
      const std::size_t to = build(group, question + 1);
      const char* const word = answer == kNone ? "" : questions()[question].answers[answer];
      const auto same = std::find_if(step.edges.begin(), step.edges.end(),
                                     [to](const Edge& edge) { return edge.to == to; });
      if (same != step.edges.end()) {
        same->answers.emplace_back(word);
      } else {
        step.edges.push_back({{word}, to, group.front()});
      }
    }
    return step.edges.size() == 1 ? step.edges.front().to : known(std::move(step));
  }

  // Places a step and all below it. Returns its state.
  std::size_t place(std::size_t id) {
    const Step& step = steps_[id];
    const bool is_end = step.edges.empty();
    const auto placed = placed_.find(id);
    if (!is_end && placed != placed_.end()) return placed->second;
    const std::size_t state = out_.states.size();
    out_.states.push_back(step.text);
    placed_[id] = state;
    for (const Edge& edge : step.edges) {
      Transition answer{.from = state,
                        .to = place(edge.to),
                        .trigger = fmt::format("{}", fmt::join(edge.answers, " or ")),
                        .rules = steps_[edge.to].rules,
                        .witness = edge.witness->witness};
      out_.transitions.push_back(std::move(answer));
    }
    return state;
  }

  Diagram& out_;
  std::vector<Step> steps_;
  std::map<std::string, std::size_t> keys_;
  std::map<std::size_t, std::size_t> placed_;
};

}  // namespace
}  // namespace reception

std::span<const PartName> reception_names() { return reception::kNames; }

Diagram reception_of(std::string_view name, const machine::Profile& profile, StepFunction step) {
  using namespace reception;
  const PartName& part = *std::find_if(kNames.begin(), kNames.end(),
                                       [&](const PartName& one) { return name == one.name; });
  Diagram out{.name = part.name, .title = part.title};
  const bool mote = &part == &kNames.front();
  const std::vector<Sample> samples =
      mote ? mote_samples(profile, step) : sink_samples(profile, step);
  out.worlds = samples.size();
  Flowchart(out).draw(samples);
  return out;
}

}  // namespace rubric::explore
