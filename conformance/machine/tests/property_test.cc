// Whatever happens to a node, in any order and with any content: it stays within its bounds, keeps
// the promises of the join protocol, and repeats itself when the same happens again.
#include <random>

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

using Phase = JoinMote::Phase;

struct Random {
  std::mt19937 engine;
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine()); }
};

std::uint32_t below(Random& random, std::uint32_t bound) { return random() % bound; }
bool one_in(Random& random, std::uint32_t n) { return below(random, n) == 0; }

// Small worlds meet more often.
std::uint16_t some_devid(Random& random) {
  constexpr std::uint16_t kSome[] = {1, 2, 5, 5, 6, kNullDevid, kBroadcastDevid};
  return one_in(random, 20) ? static_cast<std::uint16_t>(random()) : kSome[below(random, 7)];
}
std::uint16_t some_pid(Random& random) {
  constexpr std::uint16_t kSome[] = {kIsland, kIsland, kIsland, kOther, kLocalPid, kBroadcastPid};
  return one_in(random, 20) ? static_cast<std::uint16_t>(random()) : kSome[below(random, 6)];
}
Address some_address(Random& random) { return {some_pid(random), some_devid(random)}; }
Link some_link(Random& random) { return static_cast<Link>(below(random, 3)); }
std::uint16_t some_seq(Random& random, const State& state) {
  if (one_in(random, 2)) return state.join.seq_num;
  return static_cast<std::uint16_t>(below(random, 6) + state.sequence.last - 3u);
}
ChannelId some_channel(Random& random) {
  return ChannelId{some_devid(random)} << 16 | some_devid(random);
}

std::vector<std::uint8_t> some_net_msg(Random& random, const State& state) {
  constexpr std::uint8_t kTrans[] = {1, 3, 3, 3, 9, 77};
  constexpr std::uint8_t kApps[] = {5, 6, 10, 11, 99};
  NetFields fields{some_address(random),
                   some_address(random),
                   one_in(random, 2),
                   some_seq(random, state),
                   {kTrans[below(random, 6)], kApps[below(random, 5)]}};
  if (one_in(random, 2)) fields.dest = own_address(state);
  const std::uint16_t acked = some_seq(random, state);
  const std::size_t size = one_in(random, 4) ? below(random, 101) : 4;
  for (std::size_t i = 0; i < size; ++i) {
    const auto any = static_cast<std::uint8_t>(random());
    const std::uint8_t ack[] = {23, static_cast<std::uint8_t>(acked >> 8),
                                static_cast<std::uint8_t>(acked)};
    fields.payload.push_back(i < 3 ? ack[i] : any);
  }
  return net_msg(fields);
}

OwnFrame some_frame(Random& random, const State& state) {
  OwnFrame frame;
  const Descriptor what{static_cast<std::uint8_t>(random()), 0, 0x43};
  const std::uint16_t seq_num = some_seq(random, state);
  switch (below(random, 8)) {
    case 0: frame = join_request(some_devid(random), seq_num, what); break;
    case 1: frame = join_reply(some_devid(random), {some_pid(random), 5}, random(), seq_num); break;
    case 2:
      frame = ack_join({state.island, state.config.id}, {state.island, some_devid(random)}, seq_num,
                       what);
      if (one_in(random, 4)) {
        frame = ack_join(some_address(random), some_address(random), seq_num, what);
      }
      break;
    case 3: frame = config(one_in(random, 3) ? 10 : 3, some_pid(random)); break;
    default: frame.type = am::kNet; frame.payload = some_net_msg(random, state);
  }
  // Mostly on a line that the node has, for its address.
  const bool base = state.config.role == Role::kBaseStation;
  if (base && frame.type == am::kNet) frame.link = one_in(random, 2) ? Link::kPeis : Link::kSerial;
  if (one_in(random, 4)) frame.link = some_link(random);
  if (!one_in(random, 4)) frame.dest = frame.link == Link::kPeis ? state.island : state.config.id;
  if (one_in(random, 30)) frame.type = static_cast<std::uint8_t>(random());
  if (one_in(random, 10)) frame.payload.resize(below(random, 140));
  if (one_in(random, 10) && !frame.payload.empty()) {
    frame.payload[below(random, static_cast<std::uint32_t>(frame.payload.size()))] ^=
        static_cast<std::uint8_t>(1u << below(random, 8));
  }
  return frame;
}

// Not inlined: g++ 12 takes the variant's padding for uninitialised data.
[[gnu::noinline]] Call some_call(Random& random, const std::vector<std::uint8_t>& data) {
  switch (below(random, 14)) {
    case 0:
    case 1: return JoinIsland{kDescriptor};
    case 2: return SetInterface{some_link(random), !one_in(random, 9)};
    case 3: return GetInterface{some_link(random)};
    case 4:
      return CreateChannel{static_cast<Direction>(below(random, 2)), some_address(random),
                           static_cast<std::uint8_t>(below(random, 12)),
                           static_cast<Mode>(below(random, 2))};
    case 5: return DisposeChannel{some_channel(random)};
    case 6: return StartAllChannels{};
    case 7: return StopChannel{some_channel(random)};
    case 8:
      return WriteOutput{some_channel(random), static_cast<std::uint8_t>(below(random, 12)), 2.5F};
    case 9: return ReadInput{some_channel(random), static_cast<std::uint8_t>(below(random, 12))};
    case 10: return one_in(random, 4) ? Call(SetIslandId{some_pid(random)}) : Call(GetClock{});
    default:
      return Send{some_address(random),
                  static_cast<std::uint8_t>(below(random, 12)),
                  one_in(random, 2),
                  {data.data(), data.size()}};
  }
}

// One event and the bytes that it refers to.
struct Happening {
  OwnFrame frame;
  std::vector<std::uint8_t> data;
  Event event;
};

void happen(Random& random, const State& state, Happening& now) {
  switch (below(random, 12)) {
    case 0: now.event = SendDone{some_link(random), one_in(random, 2)}; return;
    case 1: now.event = SendDone{Link::kRadio, one_in(random, 2)}; return;
    case 2: now.event = LinkBusy{some_link(random), one_in(random, 3)}; return;
    case 3: now.event = AppBusy{one_in(random, 5)}; return;
    case 4: {
      const auto kind = static_cast<TimerKind>(below(random, 3));
      now.event = TimerDue{{kind, static_cast<std::uint8_t>(below(random, 10))}};
      return;
    }
    case 5:
    case 6:
    case 7:
      now.data.assign(below(random, one_in(random, 9) ? 120 : 9), 0x5A);
      now.event = Called{some_call(random, now.data)};
      return;
    default: now.frame = some_frame(random, state); now.event = Heard{now.frame.frame()};
  }
  if (one_in(random, 300) || (state.off && one_in(random, 4))) now.event = Reboot{};
  if (one_in(random, 400)) now.event = PowerOff{};
}

// Properties that hold after every step, and totals of the steps so far.
struct Watch {
  int open_calls = 0;  // joinIsland calls without their joined notice.
  int requests = 0;    // On the air for the present call.
  std::uint64_t digest = 0;
  std::string broken;  // The first promise that was.

  void must(bool holds, const char* promise) {
    if (!holds && broken.empty()) broken = promise;
  }

  void check(const State& before, const Event& event, const Device& node) {
    const State& state = node.state;
    const bool reboot =
        std::holds_alternative<Reboot>(event) || std::holds_alternative<PowerOff>(event);
    const auto* called = std::get_if<Called>(&event);
    const bool calls = called != nullptr && !before.off;
    if (calls && std::holds_alternative<JoinIsland>(called->call)) ++open_calls;
    if (reboot) open_calls = 0;
    const bool joining = state.join.phase == Phase::kJoining;
    if (joining && before.join.phase != Phase::kJoining) requests = 0;
    check_notices(node);
    const bool without = before.off && !std::holds_alternative<Reboot>(event);
    must(!without || (state.off && node.silent()), "without power nothing happens (N10-OFF)");
    if (!reboot) check_membership(before.join, event, state.join);
    for (const Transmit& frame : node.actions.transmits()) check_frame(state, frame);
    check_bounds(state);
    check_uniqueness(state);
    add_up(hash_value(state));
    for (const Action& action : node.actions.all()) {
      add_up(static_cast<std::uint64_t>(action.requirement) << 2 |
             static_cast<std::uint64_t>(action.what));
    }
  }

  void add_up(std::uint64_t word) { digest = (digest ^ word) * 0x100000001B3; }

  void check_notices(const Device& node) {
    for (const Notice& notice : node.actions.notices()) {
      const auto* joined = std::get_if<Joined>(&notice);
      if (joined == nullptr) continue;
      must(--open_calls >= 0, "one joined for each call (J5-ONCE)");
      const bool member = node.state.join.phase == Phase::kMember;
      must(!joined->success || member, "success makes a member (J5-SUCCESS)");
    }
  }

  void check_membership(const JoinMote& before, const Event& event, const JoinMote& join) {
    const bool member = join.phase == Phase::kMember;
    if (before.phase == Phase::kMember) {
      must(member && join.address == before.address, "one island (J7-ONE)");
    } else if (member) {
      must(before.phase == Phase::kJoining, "no membership without request (J4-JOINED)");
      // A reply that was heard now or had waited.
      const auto* heard = std::get_if<Heard>(&event);
      must(std::holds_alternative<AppBusy>(event) ||
               (heard != nullptr && heard->frame.type == am::kJoinReply),
           "no membership without reply (J5-ACCEPT)");
    }
  }

  void check_frame(const State& state, const Transmit& frame) {
    const Role role = state.config.role;
    const bool member = state.join.phase == Phase::kMember;
    if (frame.type == am::kJoin) {
      must(role == Role::kMote && state.join.phase == Phase::kJoining, "J1-CALLED, J5-STOP");
      must(++requests <= 5, "at most five requests (J8-LIMIT)");
    }
    must(frame.type != am::kAckJoin || member, "ack_join only after acceptance (J5-ACCEPT)");
    must(frame.type != am::kJoinReply || role == Role::kSink, "only sinks reply (J10-SINK)");
    if (frame.type == am::kNet) {
      must(role != Role::kMote || member, "no net_msg before joining (J11-SEND)");
      const auto message = rubicon::NetMsgView::parse(frame.bytes());
      must(message.has_value(), "well formed");
      const std::size_t whole = message.has_value() ? message->size_bytes() : 0;
      must(frame.size_bytes == (frame.link == Link::kSerial ? kAmPayloadMax : whole), "its size");
    }
    must(frame.link != Link::kRadio || (role != Role::kBaseStation && state.radio.sending),
         "radio only of motes and sinks, one frame at a time");
    must(frame.link != Link::kPeis || role == Role::kBaseStation, "PEIS only of base stations");
    for (const std::uint8_t byte : frame.bytes()) add_up(byte);
  }

  void check_bounds(const State& state) {
    must(state.radio.out.size() <= 4 && state.serial.out.size() <= 2, "outgoing buffers");
    const std::size_t in = state.radio.in.size() + state.serial.in.size();
    must(state.waiting.size() == in, "each frame that waits has its turn");
    must(state.app_busy || in == 0, "nothing waits for an idle application (N2-IN-ORDER)");
    must(state.awaited.size() <= kAwaitedMax, "awaited acks");
    must(state.sink.members.size() <= state.config.profile.members_max, "members");
    const std::size_t channels = state.config.profile.channels_max;
    must(state.synaptic.out.size() <= channels && state.synaptic.in.size() <= channels, "channels");
    const bool idle = state.radio.on && !state.radio.sending && !state.radio.taken;
    must(!idle || state.radio.out.empty(), "nothing waits for a free line (N2-QUEUE)");
    const bool room = state.serial.on && !state.serial.out.full();
    must(!room || state.sink.unreported.empty(), "a report that has room is made (J6-REPORT)");
  }

  void check_uniqueness(const State& state) {
    for (const Admission& member : state.sink.members) {
      must(find_member(state.sink, member.devid) == &member, "nobody is listed twice");
    }
    for (std::size_t i = 0; i < state.awaited.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        must(state.awaited[i].seq_num != state.awaited[k].seq_num, "N12-REUSE");
      }
    }
  }
};

struct Outcome {
  std::uint64_t digest = 0;
  int members = 0;  // New members and list entries: not vacuous.
  int deliveries = 0;
};

Outcome run(const Config& config, std::uint32_t seed, int events) {
  Random random{std::mt19937(seed)};
  Device node(config);
  Watch watch;
  Outcome result;
  Happening happening;
  for (int i = 0; i < events; ++i) {
    node.now += below(random, 40);
    happen(random, node.state, happening);
    const State before = node.state;
    node.step(happening.event);
    watch.check(before, happening.event, node);
    if (!watch.broken.empty()) {
      ADD_FAILURE() << watch.broken << ": seed " << seed << ", event " << i;
      break;
    }
    for (const Notice& notice : node.actions.notices()) {
      const auto* joined = std::get_if<Joined>(&notice);
      const bool success = joined != nullptr && joined->success;
      result.members += success || std::holds_alternative<MoteJoined>(notice);
      result.deliveries += std::holds_alternative<Received>(notice);
    }
  }
  result.digest = watch.digest;
  return result;
}

TEST(Property, AnythingInAnyOrder) {
  for (Config config : {mote_config(5), sink_config(), base_config()}) {
    Outcome all;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      config.random_seq = seed % 2 == 0;
      const Outcome once = run(config, seed, 2000);
      ASSERT_FALSE(HasFailure());
      ASSERT_EQ(once.digest, run(config, seed, 2000).digest) << "seed " << seed;
      all.members += once.members;
      all.deliveries += once.deliveries;
    }
    EXPECT_GT(all.members, config.role == Role::kBaseStation ? -1 : 30);
    EXPECT_GT(all.deliveries, 900);
  }
}

}  // namespace
}  // namespace rubric::machine
