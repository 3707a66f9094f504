#include "conformance/trace/events/lines.h"

#include <bit>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "conformance/trace/schema.h"

namespace rubric::events {

using machine::Address;
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

  template <class T>
  void number(T value) {
    add(Domain::of(field()).show(static_cast<std::int64_t>(value)));
  }
  void address(Address value) { add(Value::address(value.pid, value.devid)); }
  void channel(machine::ChannelId id) { add(Value::channel(id)); }
  void real(float value) { add(Value::real(value)); }
  void bytes(Bytes value) {
    add(Value::bytes({reinterpret_cast<const char*>(value.data()), value.size()}));
  }
  Message take() { return std::move(message_); }

 private:
  const AppField& field() const { return app_->fields[next_]; }
  void add(Value value) {
    message_.with(field().name, std::move(value));
    ++next_;
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

  template <class T>
  void number(T& out) {
    out = static_cast<T>(from_.number(next()).value_or(0));
  }
  void address(Address& out) {
    const auto pair = from_.pair(next()).value_or(std::pair<std::uint16_t, std::uint16_t>());
    out = {pair.first, pair.second};
  }
  void channel(machine::ChannelId& out) {
    Address ends;
    address(ends);
    out = machine::ChannelId{ends.pid} << 16 | ends.devid;
  }
  void real(float& out) {
    std::uint32_t bits = 0;
    number(bits);
    out = std::bit_cast<float>(bits);
  }
  void bytes(Bytes& out) {
    const trace::Leaf* leaf = from_.leaf(next());
    if (leaf) out = {reinterpret_cast<const std::uint8_t*>(leaf->bytes.data()), leaf->bytes.size()};
  }

 private:
  std::string_view next() { return app_->fields[next_++].name; }

  const Concrete& from_;
  const AppMessage* app_ = nullptr;
  std::size_t next_ = 0;
};

// Passes the fields of a call or a notice to a Writer or a Reader, in the order of the table.
template <class Io, class What>
void pass(Io& io, What& what) {
  if constexpr (requires { what.id; }) io.channel(what.id);
  if constexpr (requires { what.address; }) io.address(what.address);
  if constexpr (requires { what.dest; }) io.address(what.dest);
  if constexpr (requires { what.src; }) io.address(what.src);
  if constexpr (requires { what.peer; }) io.address(what.peer);
  if constexpr (requires { what.descriptor; }) {
    io.number(what.descriptor.mote_type);
    io.number(what.descriptor.transducers);
    io.number(what.descriptor.actuators);
  }
  if constexpr (requires { what.app_id; }) io.number(what.app_id);
  if constexpr (requires { what.reliable; }) io.number(what.reliable);
  if constexpr (requires { what.data; }) io.bytes(what.data);
  if constexpr (requires { what.seq_num; }) io.number(what.seq_num);
  if constexpr (requires { what.link; }) io.number(what.link);
  if constexpr (requires { what.on; }) io.number(what.on);
  if constexpr (requires { what.size; }) io.number(what.size);
  if constexpr (requires { what.mode; }) io.number(what.mode);
  if constexpr (requires { what.pos; }) io.number(what.pos);
  if constexpr (requires { what.value; }) io.real(what.value);
  if constexpr (requires { what.ticks; }) io.number(what.ticks);
  if constexpr (requires { what.island; }) io.number(what.island);
  if constexpr (requires { what.ms; }) io.number(what.ms);
  if constexpr (requires { what.status; }) io.number(what.status);
  if constexpr (requires { what.success; }) io.number(what.success);
}

// Names in the order of the variants.
constexpr const char* kCalls[] = {"join",          "send",          "interface",    "get_interface",
                                  "create_out",    "dispose",       "start",        "stop",
                                  "start_all",     "stop_all",      "write_output", "read_input",
                                  "set_time_step", "set_island_id", "get_clock"};
constexpr const char* kCreateIn = "create_in";
constexpr const char* kNotices[] = {
    "joined",   "mote_joined",    "mote_left", "send_result", "received",        "ack_received",
    "syn_data", "channel_result", "op_result", "input_value", "interface_state", "clock"};

template <class Variant>
Message written(const Variant& variant, const char* name) {
  Writer out(name);
  std::visit([&](const auto& one) { pass(out, one); }, variant);
  return out.take();
}

template <class Variant, std::size_t kIndex = 0, std::size_t kNames>
std::optional<Variant> read_as(Reader& in, const char* const (&names)[kNames]) {
  static_assert(kNames == std::variant_size_v<Variant>);
  if constexpr (kIndex < kNames) {
    if (!in.named(names[kIndex])) return read_as<Variant, kIndex + 1>(in, names);
    std::variant_alternative_t<kIndex, Variant> out{};
    pass(in, out);
    return out;
  } else {
    return std::nullopt;
  }
}

}  // namespace

const std::string& NodeNames::link(Link link) const {
  if (link == Link::kRadio) return radio;
  return link == Link::kSerial ? serial : peis;
}

trace::NodeHeader header_of(const machine::Config& config, std::string name) {
  trace::NodeHeader node{.name = std::move(name), .role = static_cast<trace::Role>(config.role)};
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

Message from_call(const machine::Call& call) {
  const auto* create = std::get_if<machine::CreateChannel>(&call);
  const bool in = create && create->direction == machine::Direction::kIn;
  return written(call, in ? kCreateIn : kCalls[call.index()]);
}
Message from_notice(const machine::Notice& notice) {
  return written(notice, kNotices[notice.index()]);
}

std::optional<machine::Call> to_call(const Concrete& message) {
  Reader in(message);
  if (!in.named(kCreateIn)) return read_as<machine::Call>(in, kCalls);
  machine::CreateChannel out{.direction = machine::Direction::kIn};
  pass(in, out);
  return out;
}

std::optional<machine::Notice> to_notice(const Concrete& message) {
  Reader in(message);
  return read_as<machine::Notice>(in, kNotices);
}

std::optional<machine::Event> to_state(const Concrete& message, trace::LinkKind kind) {
  Reader in(message);
  const auto link = to_link(kind);
  const bool busy = in.named("busy");
  if (busy || in.named("idle")) {
    if (link) return machine::LinkBusy{*link, busy};
    if (kind == trace::LinkKind::kApp) return machine::AppBusy{busy};
  } else if (in.named("linkack") && link) {
    machine::SendDone done{*link, false};
    in.number(done.acked);
    return done;
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
