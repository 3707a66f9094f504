#include "conformance/machine/synaptic.h"

#include <algorithm>
#include <variant>

#include "codec/generated/rubicon/synaptic_data.h"

namespace rubric::machine {
namespace {

using ChannelList = BoundedList<Channel, kChannelsRoom>;

using Values = rubicon::SynapticDataLayout::ValuesAt;

Channel* find(ChannelList& list, ChannelId id) {
  auto* const found =
      std::find_if(list.begin(), list.end(), [id](const Channel& c) { return c.id == id; });
  return found == list.end() ? nullptr : found;
}

bool erase(ChannelList& list, ChannelId id) {
  Channel* const channel = find(list, id);
  if (channel == nullptr) return false;
  list.erase(static_cast<std::size_t>(channel - list.begin()));
  return true;
}

bool any_started(const Synaptic& synaptic) {
  const auto started = [](const Channel& channel) { return channel.started; };
  return std::any_of(synaptic.out.begin(), synaptic.out.end(), started) ||
         std::any_of(synaptic.in.begin(), synaptic.in.end(), started);
}

// Ids hold no island, but peers do. (decision 130)
bool is_in_island(const Channel& channel, Address own, std::uint16_t pid) {
  const auto island = [own](std::uint16_t p) { return p == kLocalPid ? own.pid : p; };
  return island(channel.peer.pid) == island(pid);
}

// Returns whether a channel leads from a node to itself. Every sink is mote 1 of its island, so the
// devid alone is not enough.
bool is_local(const Channel& channel, Address own) {
  return channel.peer.devid == own.devid && is_in_island(channel, own, own.pid);
}

// One call on the channels of one node.
struct SynapticCall {
  Synaptic& synaptic;
  const Config& config;
  Address own;
  Ticks now;
  Actions& actions;

  void result(bool success, ReqId requirement) {
    actions.notify(OperationResult{success}, requirement);
  }

  void begin_clock() {
    //= S6-CLOCK: Starting a channel again does not shift the clock of the others.
    if (synaptic.due != 0) return actions.followed("S6-CLOCK"_rule);
    synaptic.phase_ticks = 0;
    //= S2-PHASE: A mote's clock starts shifted by (devid - 1) * 30 ms.
    if (config.role == Role::kMote && own.devid > 1) {
      synaptic.phase_ticks =
          static_cast<Ticks>(own.devid - 1) * config.profile.synaptic_phase_ticks;
      actions.followed("S2-PHASE"_rule);
    }
    synaptic.due = now + synaptic.phase_ticks + synaptic.period_ticks;
  }
  void end_clock() {
    if (!any_started(synaptic)) synaptic.due = synaptic.phase_ticks = 0;
  }

  // Starts a channel. An input has nothing new yet.
  //= S3-FIRST: The first tick after start sends the values in either mode.
  static void start(Channel& channel, bool out) {
    if (channel.started) return;
    channel.started = true;
    channel.fresh = out;
  }
  static void stop(Channel& channel) { channel.started = channel.fresh = false; }

  void operator()(const CreateChannel& call) {
    const bool out = call.direction == Direction::kOut;
    const ChannelId id =
        out ? channel_id(own.devid, call.peer.devid) : channel_id(call.peer.devid, own.devid);
    ChannelList& list = out ? synaptic.out : synaptic.in;
    Channel* const existing = find(list, id);
    const std::size_t before = existing == nullptr ? 0 : existing->size;
    const std::size_t room_for = std::min<std::size_t>(config.profile.channels_max, kChannelsRoom);
    const bool room = existing != nullptr || list.size() < room_for;
    //= S1-LIMIT: Creation beyond the stated number of channels of a direction (four unless the node
    //= says otherwise), or ten connections of a channel, is refused and changes nothing.
    if (!room || call.size == 0 || before + call.size > kConnectionsMax) {
      return actions.notify(ChannelResult{id, false}, "S1-LIMIT"_rule);
    }
    //= S1-ID: Creating a channel returns its id: source devid in the upper, destination devid in
    //= the lower 16 bits.
    // A channel to the same devid in another island would be taken for this one.
    if (existing != nullptr && !is_in_island(*existing, own, call.peer.pid)) {
      return actions.notify(ChannelResult{id, false}, "S1-ID"_rule);
    }
    if (existing != nullptr) {  // Peer and mode stay those of its creation.
      existing->size = static_cast<std::uint8_t>(before + call.size);
      return actions.notify(ChannelResult{id, true}, "S1-ENLARGE"_rule);
    }
    Channel channel;
    channel.id = id;
    channel.peer = call.peer;
    //= S1-MODE: The mode given at creation, reliable or power-save, is the one in which the channel
    //= sends.
    channel.mode = call.mode;
    channel.size = call.size;
    list.push(channel);
    actions.notify(ChannelResult{id, true}, "S1-ID"_rule);
  }

  void operator()(const DisposeChannel& call) {
    const bool out = erase(synaptic.out, call.id);  // A local channel has both ends here.
    const bool in = erase(synaptic.in, call.id);
    end_clock();
    result(out || in, "S6-DISPOSED"_rule);
  }

  void operator()(const StartChannel& call) {
    Channel* const out = find(synaptic.out, call.id);
    Channel* const in = find(synaptic.in, call.id);
    if (out == nullptr && in == nullptr) return result(false, "S6-DISPOSED"_rule);
    //= S1-START: start_syn_channel starts that channel: its values are sent, or its data signalled,
    //= from the next tick on.
    if (out != nullptr) start(*out, true);
    if (in != nullptr) start(*in, false);
    begin_clock();
    result(true, "S1-START"_rule);
  }

  void operator()(const StopChannel& call) {
    Channel* const out = find(synaptic.out, call.id);
    Channel* const in = find(synaptic.in, call.id);
    if (out == nullptr && in == nullptr) return result(false, "S6-DISPOSED"_rule);
    //= S6-OTHERS: stop_syn_channel stops that channel only.
    if (out != nullptr) stop(*out);
    if (in != nullptr) stop(*in);
    end_clock();
    result(true, "S6-OTHERS"_rule);
  }

  void operator()(const StartAllChannels&) {
    //= S1-ALL: start_all_syn_channels and stop_all_syn_channels start and stop every channel of the
    //= node.
    for (Channel& channel : synaptic.out) start(channel, true);
    for (Channel& channel : synaptic.in) start(channel, false);
    if (any_started(synaptic)) begin_clock();
    result(true, "S1-ALL"_rule);
  }

  void operator()(const StopAllChannels&) {
    for (Channel& channel : synaptic.out) stop(channel);
    for (Channel& channel : synaptic.in) stop(channel);
    end_clock();
    result(true, "S1-ALL"_rule);
  }

  void operator()(const WriteOutput& call) {
    Channel* const out = find(synaptic.out, call.id);
    //= S1-WRITE: write_output_value sets the value at pos, which the next tick sends; a pos outside
    //= the channel is refused.
    if (out == nullptr || call.pos >= out->size) return result(false, "S1-WRITE"_rule);
    std::uint32_t& bits = out->value_bits[call.pos];
    // Bits, not numbers: a NaN written twice is unchanged, and 0 is not -0. A value that changes
    // there and back between two ticks has changed.
    if (bits != bits_of_float(call.value)) out->fresh = true;
    bits = bits_of_float(call.value);
    result(true, "S1-WRITE"_rule);
  }

  void operator()(const ReadInput& call) {
    const Channel* const in = find(synaptic.in, call.id);
    //= S1-READ: read_input_value tells the value at pos that was received last; a pos outside the
    //= channel is refused.
    const bool good = in != nullptr && call.pos < in->size;
    const float value = good ? float_of_bits(in->value_bits[call.pos]) : 0;
    actions.notify(InputValue{value, good}, "S1-READ"_rule);
  }

  void operator()(const SetTimeStep& call) {
    if (call.ticks == 0) return result(false, "S1-CLOCK"_rule);
    //= S1-CLOCK: set_time_step sets the period of the clock, 500 ms by default.
    synaptic.period_ticks = call.ticks;
    if (synaptic.due != 0) synaptic.due = now + synaptic.phase_ticks + call.ticks;
    result(true, "S1-CLOCK"_rule);
  }

  template <class Other>
  void operator()(const Other&) {
    assert(false && "not a call of the synaptic interface");
  }
};

// Passes values on to the other end of a channel from a node to itself.
void hand_over(const Channel& out, ChannelList& inputs, Address own, Actions& actions) {
  //= S4-LOCAL: A channel from a node to itself hands its values over at the tick without sending
  //= anything.
  Channel* const in = find(inputs, out.id);
  const bool takes = in != nullptr && in->started && is_local(*in, own);
  if (!takes) return actions.ignored("S4-LOCAL"_rule);
  std::copy_n(out.value_bits.begin(), std::min(in->size, out.size), in->value_bits.begin());
  in->fresh = true;
  actions.followed("S4-LOCAL"_rule);
}

}  // namespace

ChannelId channel_id(std::uint16_t source_devid, std::uint16_t destination_devid) {
  return static_cast<ChannelId>(source_devid) << 16 | destination_devid;
}

void call_synaptic(Synaptic& synaptic, const Config& config, Address own, Ticks now,
                   const Call& call, Actions& actions) {
  if (synaptic.period_ticks == 0) synaptic.period_ticks = config.profile.synaptic_period_ticks;
  std::visit(SynapticCall{synaptic, config, own, now, actions}, call);
}

void hear_synaptic(Synaptic& synaptic, Address own, Address src, Bytes floats, Actions& actions) {
  const ChannelId id = channel_id(src.devid, own.devid);
  Channel* const in = find(synaptic.in, id);
  if (in == nullptr || !is_in_island(*in, own, src.pid)) {
    //= S5-UNKNOWN: Data for an unknown channel is reported by its status and not stored.
    return actions.notify(SynDataReceived{id, DataStatus::kUnknownChannel}, "S5-UNKNOWN"_rule);
  }
  if (!in->started) return actions.ignored("S6-STOPPED"_rule);
  // The data do not show how many connections the sender meant (decision 8); takes what both sides
  // have.
  const std::size_t count = std::min<std::size_t>(in->size, floats.size() / Values::kUnitBytes);
  if (count == 0) return actions.ignored("S2-CONTENT"_rule);
  for (std::size_t i = 0; i < count; ++i) {
    in->value_bits[i] = bits_of_float(Values::load(floats.data(), i));
  }
  in->fresh = true;
  actions.followed("S1-READ"_rule);
}

void tick_synaptic(Synaptic& synaptic, Address own, Ticks now, SynapticSends& sends,
                   Actions& actions) {
  if (synaptic.due == 0) return actions.ignored("S6-STOPPED"_rule);
  for (Channel& out : synaptic.out) {
    if (!out.started) continue;
    const bool power_save = out.mode == Mode::kPowerSave;
    const bool changed = out.fresh;
    out.fresh = false;
    if (power_save && !changed) {
      //= S3-UNCHANGED: In power-save mode a tick, but for the first after start, sends nothing when
      //= no value changed since the last tick.
      actions.followed("S3-UNCHANGED"_rule);
    } else if (is_local(out, own)) {
      hand_over(out, synaptic.in, own, actions);
    } else {
      //= S2-SEND: At each tick every started output channel in reliable mode, but for a channel to
      //= itself, sends its values to its destination.
      const ReqId requirement = power_save ? "S3-CHANGED"_rule : "S2-SEND"_rule;
      sends.push({out.id, out.peer, out.size, out.value_bits, requirement});
    }
  }
  for (Channel& in : synaptic.in) {
    if (!in.started) continue;
    //= S2-SIGNAL: At each tick every started input channel signals synData_received with status new
    //= or old.
    const DataStatus status = in.fresh ? DataStatus::kNew : DataStatus::kOld;
    actions.notify(SynDataReceived{in.id, status}, in.fresh ? "S2-SIGNAL"_rule : "S3-OLD"_rule);
    in.fresh = false;
  }
  //= S2-TICK: A channel sends at most once a tick, and ticks are no closer than the clock's period.
  synaptic.due = now + synaptic.period_ticks;
  synaptic.phase_ticks = 0;
}

void keep_change(Synaptic& synaptic, ChannelId id) {
  //= S3-CHANGED: In power-save mode a tick sends all values when any of them changed since the last
  //= tick.
  // The receiver would not know of the change before the next one.
  Channel* const out = find(synaptic.out, id);
  if (out != nullptr) out->fresh = true;
}

}  // namespace rubric::machine
