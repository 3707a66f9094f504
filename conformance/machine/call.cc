// Handles the application's calls.
#include <variant>

#include "codec/generated/rubicon/config.h"
#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/synaptic.h"
#include "conformance/machine/transport.h"

namespace rubric::machine {
namespace {

// Returns a number for a new call that differs from that of the call before.
std::uint16_t join_seq_num(State& state) {
  const std::uint16_t seq_num = next_seq_num(state.sequence, state.awaited);
  //= J1-SEQ: A new joinIsland call uses a sequence number other than the one of the call before it.
  const bool again = state.join.requests != 0 && seq_num == state.join.seq_num;
  return again ? next_seq_num(state.sequence, state.awaited) : seq_num;
}

struct NodeCall {
  Node& node;

  void result(bool success, ReqId requirement) {
    node.actions.notify(OperationResult{success}, requirement);
  }

  void operator()(const JoinIsland& call) {
    State& state = node.state;
    if (node.config().role != Role::kMote) {  // It is where it belongs, for good.
      return node.actions.notify(Joined{own_address(state), false}, "J8-JOINED"_rule);
    }
    const bool starts = state.join.phase == JoinMote::Phase::kOutside;
    const std::uint16_t seq_num = starts ? join_seq_num(state) : state.join.seq_num;
    const JoinSend send =
        call_join(state.join, join_context(node), call.descriptor, seq_num, node.actions);
    if (send == JoinSend::kRequest) send_join_request(node, "J1-REQUEST"_rule);
  }

  void operator()(const Send& call) {
    //= N1-SIZE: send refuses more than 100 bytes of application data.
    ReqId refused = "N1-SIZE"_rule;
    std::uint16_t seq_num = kNoSeq;
    if (call.data.size() <= kAppDataMax) {
      const OwnMessage message{call.dest, component::kConnless, call.app_id, call.reliable,
                               call.data, ReqId::kNone};
      seq_num = send_own(node, message, refused);
    }
    //= N1-SEQ: send returns the sequence number that the message carries.
    node.actions.notify(SendResult{seq_num}, refused == ReqId::kNone ? "N1-SEQ"_rule : refused);
  }

  void operator()(const SetInterface& call) {
    const bool known = has_line(node.config().role, call.link) && call.link != Link::kPeis;
    if (!known) return result(false, "N10-STATE"_rule);
    (call.link == Link::kRadio ? node.state.radio.on : node.state.serial.on) = call.on;
    result(true, call.on ? "N10-ON"_rule : "N10-OFF"_rule);
    //= N10-ON: An interface that is switched on again sends and receives.
    flush(node, call.link);
  }

  void operator()(const GetInterface& call) {
    const bool has = has_line(node.config().role, call.link);
    bool on = has;
    if (has && call.link == Link::kRadio) on = node.state.radio.on;
    if (has && call.link == Link::kSerial) on = node.state.serial.on;
    //= N10-STATE: The state of the radio and of the serial interface is told when asked for.
    node.actions.notify(InterfaceState{call.link, on}, "N10-STATE"_rule);
  }

  void operator()(const SetIslandId& call) {
    if (node.config().role != Role::kBaseStation) return result(false, "N9-SET"_rule);
    if (is_reserved(call.island)) return result(false, "N9-OTHER"_rule);
    const Header header{Link::kSerial, am::kConfig, node.profile().sink_id, "N9-SET"_rule, false};
    const ReqId refusal = line_refusal(node.state, Link::kSerial);
    if (refusal != ReqId::kNone) return result(false, refusal);
    const Place place = put(node, header);
    rubicon::Config config;
    config.type = rubicon::CommandCode::kSetIslandId;
    config.value = call.island;
    rubicon::ConfigLayout::store(config, place.payload);
    *place.size_bytes = rubicon::ConfigView::kMaxSizeBytes;
    set_island(node, call.island);
    result(true, "N9-SET"_rule);
  }

  void operator()(const GetClock&) { node.actions.notify(Clock{clock_ms(node)}, "J4-CLOCK"_rule); }

  // The other calls are about synaptic channels, which a base station does not have.
  void operator()(const CreateChannel&) { synaptic(ChannelResult{0, false}); }
  void operator()(const ReadInput&) { synaptic(InputValue{0, false}); }
  template <class Other>
  void operator()(const Other&) {
    synaptic(OperationResult{false});
  }

  void synaptic(const Notice& refusal) {
    if (node.config().role == Role::kBaseStation) {
      return node.actions.notify(refusal, ReqId::kNone);
    }
    call_synaptic(node.state.synaptic, node.config(), own_address(node.state), node.now, whole,
                  node.actions);
  }

  const Call& whole;
};

}  // namespace

void call(Node& node, const Call& call) { std::visit(NodeCall{node, call}, call); }

}  // namespace rubric::machine
