#include "conformance/trace/events/lines.h"

#include <bit>
#include <string>
#include <type_traits>
#include <utility>

#include "conformance/trace/schema.h"

namespace rubric::events {

using machine::Address;
using machine::Descriptor;
using trace::AppField;
using trace::AppMessage;
using trace::Concrete;
using trace::Domain;
using trace::Message;
using trace::Value;

namespace {

using machine::Link;
using trace::Line;
using trace::Op;
using trace::ParameterId;

Line frame_line(std::int64_t now, const NodeNames& names, Op op, const machine::Frame& frame) {
  return trace::frame_line(now, names.node, op, names.link(frame.link), kind_of(frame.link),
                           frame_of(names, frame));
}

Line with_rule(Line line, ReqId rule) {
  const std::string_view text = trace::requirement_text(rule);
  if (!text.empty()) line.requirements.emplace_back(text);
  return line;
}

// Calls `call` with the member of the profile, whatever its type.
template <class AnyProfile, class Call>
void visit(AnyProfile& profile, ParameterId id, Call call) {
  switch (id) {
    case ParameterId::kResponse: return call(profile.response_ticks);
    case ParameterId::kJoinPeriod: return call(profile.join_period_ticks);
    case ParameterId::kJoinRequests: return call(profile.join_requests_max);
    case ParameterId::kAckJoins: return call(profile.ack_join_max);
    case ParameterId::kAckTimeout: return call(profile.ack_timeout_ticks);
    case ParameterId::kChannelAccess: return call(profile.early_ticks);
    case ParameterId::kMembers: return call(profile.members_max);
    case ParameterId::kChannels: return call(profile.channels_max);
    case ParameterId::kSynapticPeriod: return call(profile.synaptic_period_ticks);
    case ParameterId::kSynapticPhase: return call(profile.synaptic_phase_ticks);
    case ParameterId::kGoneAfter: return call(profile.gone_after_ticks);
    case ParameterId::kBuffers: return;  // The machine has those of Table 1.
  }
}

// Builds a message of the application table, with its fields in the order of the table.
class Writer {
 public:
  explicit Writer(std::string_view name)
      : message_(Message::named(name)), app_(trace::Schema::get().find(name)->app) {}

  Writer& number(std::int64_t value) { return add(Domain::of(field()).show(value)); }
  Writer& address(Address value) { return add(Value::address(value.pid, value.devid)); }
  Writer& channel(machine::ChannelId id) { return add(Value::channel(id)); }
  Writer& real(float value) { return add(Value::real(value)); }
  Writer& bytes(Bytes value) {
    return add(Value::bytes({reinterpret_cast<const char*>(value.data()), value.size()}));
  }
  Writer& descriptor(const Descriptor& value) {
    return number(value.mote_type).number(value.transducers).number(value.actuators);
  }
  Message take() { return std::move(message_); }

 private:
  const AppField& field() const { return app_->fields[next_]; }
  Writer& add(Value value) {
    message_.with(field().name, std::move(value));
    ++next_;
    return *this;
  }

  Message message_;
  const AppMessage* app_;
  std::size_t next_ = 0;
};

// Reads the values of such a message, in the order of the table.
class Reader {
 public:
  explicit Reader(const Concrete& from) : from_(from) {
    const trace::Shape* shape = trace::Schema::get().find(from.name);
    app_ = shape ? shape->app : nullptr;
  }

  bool named(std::string_view name) const { return app_ && name == app_->name; }

  template <typename T>
  T number() {
    return static_cast<T>(from_.number(next()).value_or(0));
  }
  Address address() {
    const auto pair = from_.pair(next()).value_or(std::pair<std::uint16_t, std::uint16_t>());
    return {pair.first, pair.second};
  }
  machine::ChannelId channel() {
    const auto [source, destination] = address();
    return static_cast<machine::ChannelId>(source) << 16 | destination;
  }
  float real() { return std::bit_cast<float>(number<std::uint32_t>()); }
  Bytes bytes() {
    const trace::Leaf* leaf = from_.leaf(next());
    if (!leaf) return {};
    return {reinterpret_cast<const std::uint8_t*>(leaf->bytes.data()), leaf->bytes.size()};
  }
  Descriptor descriptor() {
    Descriptor out;
    out.mote_type = number<std::uint8_t>();
    out.transducers = number<std::uint16_t>();
    out.actuators = number<std::uint8_t>();
    return out;
  }

 private:
  std::string_view next() { return app_->fields[next_++].name; }

  const Concrete& from_;
  const AppMessage* app_ = nullptr;
  std::size_t next_ = 0;
};

struct CallWriter {
  Message operator()(const machine::JoinIsland& c) const {
    return Writer("join").descriptor(c.descriptor).take();
  }
  Message operator()(const machine::Send& c) const {
    return Writer("send").address(c.dest).number(c.app_id).number(c.reliable).bytes(c.data).take();
  }
  Message operator()(const machine::SetInterface& c) const {
    return Writer("interface").number(static_cast<int>(c.link)).number(c.on).take();
  }
  Message operator()(const machine::GetInterface& c) const {
    return Writer("get_interface").number(static_cast<int>(c.link)).take();
  }
  Message operator()(const machine::CreateChannel& c) const {
    const bool out = c.direction == machine::Direction::kOut;
    return Writer(out ? "create_out" : "create_in")
        .address(c.peer)
        .number(c.size)
        .number(static_cast<int>(c.mode))
        .take();
  }
  Message operator()(const machine::DisposeChannel& c) const {
    return Writer("dispose").channel(c.id).take();
  }
  Message operator()(const machine::StartChannel& c) const {
    return Writer("start").channel(c.id).take();
  }
  Message operator()(const machine::StopChannel& c) const {
    return Writer("stop").channel(c.id).take();
  }
  Message operator()(const machine::StartAllChannels&) const { return Writer("start_all").take(); }
  Message operator()(const machine::StopAllChannels&) const { return Writer("stop_all").take(); }
  Message operator()(const machine::WriteOutput& c) const {
    return Writer("write_output").channel(c.id).number(c.pos).real(c.value).take();
  }
  Message operator()(const machine::ReadInput& c) const {
    return Writer("read_input").channel(c.id).number(c.pos).take();
  }
  Message operator()(const machine::SetTimeStep& c) const {
    return Writer("set_time_step").number(c.ticks).take();
  }
  Message operator()(const machine::SetIslandId& c) const {
    return Writer("set_island_id").number(c.island).take();
  }
  Message operator()(const machine::GetClock&) const { return Writer("get_clock").take(); }
};

struct NoticeWriter {
  Message operator()(const machine::Joined& n) const {
    return Writer("joined").address(n.address).number(n.success).take();
  }
  Message operator()(const machine::MoteJoined& n) const {
    return Writer("mote_joined").address(n.address).descriptor(n.descriptor).take();
  }
  Message operator()(const machine::MoteLeft& n) const {
    return Writer("mote_left").address(n.address).take();
  }
  Message operator()(const machine::SendResult& n) const {
    return Writer("send_result").number(n.seq_num).take();
  }
  Message operator()(const machine::Received& n) const {
    return Writer("received").address(n.src).number(n.app_id).bytes(n.data).take();
  }
  Message operator()(const machine::AckReceived& n) const {
    return Writer("ack_received").number(n.app_id).number(n.seq_num).number(n.success).take();
  }
  Message operator()(const machine::SynDataReceived& n) const {
    return Writer("syn_data").channel(n.id).number(static_cast<int>(n.status)).take();
  }
  Message operator()(const machine::ChannelResult& n) const {
    return Writer("channel_result").channel(n.id).number(n.success).take();
  }
  Message operator()(const machine::OperationResult& n) const {
    return Writer("op_result").number(n.success).take();
  }
  Message operator()(const machine::InputValue& n) const {
    return Writer("input_value").real(n.value).number(n.success).take();
  }
  Message operator()(const machine::InterfaceState& n) const {
    return Writer("interface_state").number(static_cast<int>(n.link)).number(n.on).take();
  }
  Message operator()(const machine::Clock& n) const { return Writer("clock").number(n.ms).take(); }
};

machine::CreateChannel create(Reader& in, machine::Direction direction) {
  machine::CreateChannel out;
  out.direction = direction;
  out.peer = in.address();
  out.size = in.number<std::uint8_t>();
  out.mode = in.number<machine::Mode>();
  return out;
}

std::optional<machine::Call> read_call(Reader& in) {
  if (in.named("join")) return machine::JoinIsland{in.descriptor()};
  if (in.named("send")) {
    machine::Send out;
    out.dest = in.address();
    out.app_id = in.number<std::uint8_t>();
    out.reliable = in.number<std::uint8_t>() != 0;
    out.data = in.bytes();
    return out;
  }
  if (in.named("interface")) {
    const auto link = in.number<machine::Link>();
    return machine::SetInterface{link, in.number<std::uint8_t>() != 0};
  }
  if (in.named("get_interface")) return machine::GetInterface{in.number<machine::Link>()};
  if (in.named("create_out")) return create(in, machine::Direction::kOut);
  if (in.named("create_in")) return create(in, machine::Direction::kIn);
  if (in.named("dispose")) return machine::DisposeChannel{in.channel()};
  if (in.named("start")) return machine::StartChannel{in.channel()};
  if (in.named("stop")) return machine::StopChannel{in.channel()};
  if (in.named("start_all")) return machine::StartAllChannels{};
  if (in.named("stop_all")) return machine::StopAllChannels{};
  if (in.named("write_output")) {
    machine::WriteOutput out;
    out.id = in.channel();
    out.pos = in.number<std::uint8_t>();
    out.value = in.real();
    return out;
  }
  if (in.named("read_input")) {
    const machine::ChannelId id = in.channel();
    return machine::ReadInput{id, in.number<std::uint8_t>()};
  }
  if (in.named("set_time_step")) return machine::SetTimeStep{in.number<std::uint16_t>()};
  if (in.named("set_island_id")) return machine::SetIslandId{in.number<std::uint16_t>()};
  if (in.named("get_clock")) return machine::GetClock{};
  return std::nullopt;
}

std::optional<machine::Notice> read_notice(Reader& in) {
  if (in.named("joined")) {
    const Address address = in.address();
    return machine::Joined{address, in.number<std::uint8_t>() != 0};
  }
  if (in.named("mote_joined")) {
    const Address address = in.address();
    return machine::MoteJoined{address, in.descriptor()};
  }
  if (in.named("mote_left")) return machine::MoteLeft{in.address()};
  if (in.named("send_result")) return machine::SendResult{in.number<std::uint16_t>()};
  if (in.named("received")) {
    machine::Received out;
    out.src = in.address();
    out.app_id = in.number<std::uint8_t>();
    out.data = in.bytes();
    return out;
  }
  if (in.named("ack_received")) {
    machine::AckReceived out;
    out.app_id = in.number<std::uint8_t>();
    out.seq_num = in.number<std::uint16_t>();
    out.success = in.number<std::uint8_t>() != 0;
    return out;
  }
  if (in.named("syn_data")) {
    const machine::ChannelId id = in.channel();
    return machine::SynDataReceived{id, in.number<machine::DataStatus>()};
  }
  if (in.named("channel_result")) {
    const machine::ChannelId id = in.channel();
    return machine::ChannelResult{id, in.number<std::uint8_t>() != 0};
  }
  if (in.named("op_result")) return machine::OperationResult{in.number<std::uint8_t>() != 0};
  if (in.named("input_value")) {
    const float value = in.real();
    return machine::InputValue{value, in.number<std::uint8_t>() != 0};
  }
  if (in.named("interface_state")) {
    const auto link = in.number<machine::Link>();
    return machine::InterfaceState{link, in.number<std::uint8_t>() != 0};
  }
  if (in.named("clock")) return machine::Clock{in.number<std::uint32_t>()};
  return std::nullopt;
}

}  // namespace

const std::string& NodeNames::link(Link link) const {
  if (link == Link::kRadio) return radio;
  return link == Link::kSerial ? serial : peis;
}

trace::NodeHeader header_of(const machine::Config& config, std::string name) {
  trace::NodeHeader node;
  node.name = std::move(name);
  node.role = static_cast<trace::Role>(config.role);
  if (config.role != machine::Role::kBaseStation) node.id = config.id;
  if (config.role != machine::Role::kMote) node.island = config.island;
  node.iut = true;
  return node;
}

trace::LinkKind kind_of(Link link) {
  if (link == Link::kRadio) return trace::LinkKind::kRadio;
  return link == Link::kSerial ? trace::LinkKind::kSerial : trace::LinkKind::kPeis;
}

trace::AmFrame frame_of(const NodeNames& names, const machine::Frame& frame) {
  const std::uint8_t group = frame.link == Link::kRadio ? names.radio_group : std::uint8_t{0};
  return {frame.dest,
          frame.src,
          group,
          frame.type,
          {frame.payload.begin(), frame.payload.end()},
          {frame.packet.begin(), frame.packet.end()}};
}

std::vector<std::uint8_t> packet_of(const machine::Frame& frame) {
  return trace::packet_of(frame_of({}, frame));
}

std::optional<Line> given_line(std::int64_t now, const NodeNames& names,
                               const machine::Event& event) {
  const auto line = [&](const std::string& link, Message message) {
    return trace::app_line(now, names.node, Op::kGiven, link, std::move(message));
  };
  const auto busy = [](bool is) { return Message::named(is ? "busy" : "idle"); };
  if (const auto* heard = std::get_if<machine::Heard>(&event)) {
    return frame_line(now, names, Op::kGiven, heard->frame);
  }
  if (const auto* called = std::get_if<machine::Called>(&event)) {
    return line("app", from_call(called->call));
  }
  if (const auto* done = std::get_if<machine::SendDone>(&event)) {
    const auto acked = trace::Value::of(done->acked ? 1 : 0);
    return line(names.link(done->link), Message::named("linkack").with("acked", acked));
  }
  if (const auto* one = std::get_if<machine::LinkBusy>(&event)) {
    return line(names.link(one->link), busy(one->busy));
  }
  if (const auto* app = std::get_if<machine::AppBusy>(&event)) return line("app", busy(app->busy));
  if (std::holds_alternative<machine::TimerDue>(event)) return {};
  const bool reboot = std::holds_alternative<machine::Reboot>(event);
  return line("power", Message::named(reboot ? "reboot" : "off"));
}

Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Frame& frame,
                  ReqId rule) {
  return with_rule(frame_line(now, names, Op::kEmits, frame), rule);
}

Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Notice& notice,
                  ReqId rule) {
  return with_rule(trace::app_line(now, names.node, Op::kEmits, "app", from_notice(notice)), rule);
}

std::vector<Line> emitted_lines(std::int64_t now, const NodeNames& names,
                                const machine::Actions& actions) {
  std::vector<Line> out;
  for (const machine::Action& action : actions.all()) {
    if (action.what == machine::Action::What::kTransmit) {
      const machine::Frame frame = actions.transmit_of(action).frame();
      out.push_back(emitted_line(now, names, frame, action.requirement));
    } else if (action.what == machine::Action::What::kNotify) {
      out.push_back(emitted_line(now, names, actions.notice_of(action), action.requirement));
    }
  }
  return out;
}

std::int64_t value_of(const machine::Profile& profile, ParameterId id) {
  std::int64_t out = trace::parameter(id).unstated;
  visit(profile, id, [&](auto value) { out = value; });
  return out;
}

std::int64_t assumed(const machine::Profile& profile, ParameterId id) {
  if (id == ParameterId::kChannelAccess) return 0;
  const std::int64_t own = value_of(profile, id);
  return own == 0 && id == ParameterId::kAckTimeout ? value_of({}, id) : own;
}

std::string contradiction(const trace::Statement& statement) {
  if (!trace::protocol().has_machine) return {};
  constexpr std::int64_t kShortest = 150;  // From the latest ack to the timeout, in golden traces.
  constexpr std::int64_t kReply = 20;      // From a request to its reply, in golden traces.
  machine::Profile profile;
  state(profile, statement);
  const std::int64_t timeout = assumed(profile, ParameterId::kAckTimeout);
  const std::int64_t response = value_of(profile, ParameterId::kResponse);
  const std::int64_t period = value_of(profile, ParameterId::kJoinPeriod);
  // Who states a short period alone is as prompt as that needs.
  if (trace::find(statement, ParameterId::kResponse) && period < response + kReply) {
    return "response=" + std::to_string(response) +
           " leaves no time for a reply within join_period=" + std::to_string(period) +
           ": expected a join_period of at least " + std::to_string(response + kReply);
  }
  if (timeout >= response + kShortest) return {};
  return "ack_timeout=" + std::to_string(timeout) +
         " leaves no time for an ack, which may take response=" + std::to_string(response) +
         ": expected at least " + std::to_string(response + kShortest);
}

void state(machine::Profile& profile, const trace::Statement& statement) {
  for (const trace::Stated& one : statement) {
    visit(profile, one.id, [&](auto& value) {
      value = static_cast<std::remove_reference_t<decltype(value)>>(one.value);
    });
  }
}

Message from_call(const machine::Call& call) { return std::visit(CallWriter{}, call); }
Message from_notice(const machine::Notice& notice) { return std::visit(NoticeWriter{}, notice); }

std::optional<machine::Call> to_call(const Concrete& message) {
  Reader in(message);
  return read_call(in);
}

std::optional<machine::Notice> to_notice(const Concrete& message) {
  Reader in(message);
  return read_notice(in);
}

std::optional<machine::Event> to_state(const Concrete& message, trace::LinkKind kind) {
  Reader in(message);
  const auto link = to_link(kind);
  const bool busy = in.named("busy");
  if (busy || in.named("idle")) {
    if (link) return machine::LinkBusy{*link, busy};
    if (kind == trace::LinkKind::kApp) return machine::AppBusy{busy};
  } else if (in.named("linkack") && link) {
    return machine::SendDone{*link, in.number<std::uint8_t>() != 0};
  } else if (in.named("reboot")) {
    return machine::Reboot{};
  } else if (in.named("off")) {
    return machine::PowerOff{};
  }
  return std::nullopt;
}

std::optional<machine::Link> to_link(trace::LinkKind kind) {
  switch (kind) {
    case trace::LinkKind::kRadio: return machine::Link::kRadio;
    case trace::LinkKind::kSerial: return machine::Link::kSerial;
    case trace::LinkKind::kPeis: return machine::Link::kPeis;
    default: return std::nullopt;
  }
}

}  // namespace rubric::events
