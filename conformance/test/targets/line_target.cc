#include "conformance/test/targets/line_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <iterator>
#include <thread>
#include <utility>

#include "codec/generated/rubicon/app_msg.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/enums.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/machine/messages.h"
#include "conformance/test/targets/process.h"
#include "conformance/test/targets/rct_text.h"
#include "conformance/trace/events/lines.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using runner::Ticks;
using runner::Unsupported;
using std::chrono::steady_clock;

constexpr lines::Milliseconds kQuiet{60};
constexpr lines::Milliseconds kQuietMax{2000};      // A node that never pauses is used as it is.
constexpr lines::Milliseconds kAnswerMax{350};      // 300 ticks, and the way.
constexpr lines::Milliseconds kNodeStartMax{3000};  // For a node to start behind a new line.
constexpr lines::Milliseconds kAskAgain{500};
constexpr lines::Milliseconds kAcceptAgain{5};
constexpr std::uint16_t kAskedSeqNum = 0xFFF0;
constexpr lines::Milliseconds kAskApp{5};     // How often the app is asked for news.
constexpr Ticks kStepTicks = 5;               // For several nodes that go on together.
constexpr std::size_t kOutputsMax = 100'000;  // In a case.
constexpr std::uint32_t kFrameBits = (1 + 8 + machine::kAmPayloadMax + 4) * 10;

// Keeps an attachment's one node in use while it lives.
class UsedLineTarget : public LineTarget {
 public:
  UsedLineTarget(NodeLine& line, std::unique_ptr<AppChannel> app, std::shared_ptr<int> use)
      : LineTarget(line, std::move(app)), use_(std::move(use)) {}

 private:
  std::shared_ptr<int> use_;
};

bool read_packet(const lines::TimedPacket& packet, trace::AmFrame& out) {
  const std::string_view bytes(reinterpret_cast<const char*>(packet.bytes.data()),
                               packet.bytes.size());
  return trace::parse_packet(bytes, out) && out.payload.size() <= machine::kAmPayloadMax;
}

machine::Frame to_sink(std::uint8_t type, Bytes payload) {
  return {machine::Link::kSerial, 1, 0, type, payload};
}

// Returns the island that a base station tells its sink by this, or nothing.
std::optional<std::uint16_t> told_island(const trace::AmFrame& frame) {
  const auto told = rubicon::ConfigView::parse(Bytes(frame.payload.data(), frame.payload.size()));
  const bool tells = frame.type == machine::am::kConfig && told &&
                     told->type() == rubicon::CommandCode::kSetIslandId;
  return tells ? std::optional(told->value()) : std::nullopt;
}

// Returns whether a node that starts with `config` has sent this, and is there.
bool shows_node(const trace::AmFrame& frame, const machine::Config& config) {
  if (config.role == machine::Role::kBaseStation) return told_island(frame).has_value();
  const Bytes payload(frame.payload.data(), frame.payload.size());
  const auto message = rubicon::NetMsgView::parse(payload);
  return frame.type == machine::am::kNet && message &&
         machine::address_of(message->src()) == machine::Address{config.island, config.id};
}

}  // namespace

void LineTarget::reset(const machine::Config& config) {
  if (config.role != role()) {
    throw Unsupported(fmt::format("the node at the line is a {}, not a {}", role_word(role()),
                                  role_word(config.role)));
  }
  if (role() == machine::Role::kSink && config.id != config.profile.sink_id) {
    throw Unsupported(fmt::format("the id of the sink cannot be set to {}", config.id));
  }
  expect_built(config);
  std::future<void> started;  // An app that starts the node is ready when the node has connected.
  if (app_) {
    started =
        std::async(std::launch::async, [&] { app_->reset(config, line_.node.identity.stated); });
  }
  line_.open();
  line_.asked = true;
  island_ = config.island;
  if (app_) started.get();
  if (!is_mote()) {  // A mote's line shows nothing.
    if (!line_.is_new) wait_until_quiet();
    if (role() == machine::Role::kSink) set_island(config);
    if (line_.is_new) await_node(config);
    wait_until_quiet();
  }
  line_.is_new = false;
  tolerance_of_this_host();  // Measures now, not in the middle of the case.
  if (app_) app_->poll();
  outputs_.clear();
  line_.line->take_damage();
  clock_.start();
  now_ = 0;
}

// Throws if the node would have to be another than it is.
void LineTarget::expect_built(const machine::Config& config) const {
  const trace::Statement& own = line_.node.identity.stated;
  trace::Statement wanted = asked_for(config, own);
  const trace::ParameterId id = trace::ParameterId::kChannels;
  const std::int64_t* const channels = find(own, id);
  const std::int64_t has = channels ? *channels : machine::Profile{}.channels_max;
  if (config.profile.channels_max != has) wanted.push_back({id, config.profile.channels_max});
  if (wanted.empty()) return;
  throw runner::NotBuilt("the node at the line is not built with " + statement_text(wanted));
}

void LineTarget::await_node(const machine::Config& config) {
  const bool is_sink = role() == machine::Role::kSink;
  const lines::SteadyTime end = steady_clock::now() + kNodeStartMax;
  for (bool again = false; steady_clock::now() < end; again = true) {
    if (is_sink && again) set_island(config);
    if (is_sink) ask_for_ack(config);
    const lines::SteadyTime pause = is_sink ? steady_clock::now() + kAskAgain : end;
    while (const auto packet = line_.line->receive(pause)) {
      trace::AmFrame frame;
      if (!read_packet(*packet, frame)) continue;
      note_island(frame);
      if (shows_node(frame, config)) return;
    }
  }
  line_.mishaps.push_back(
      {fmt::format("{} within {} s after its line was opened",
                   is_sink ? "confirmed no reliable message" : "did not tell its sink the island",
                   kNodeStartMax.count() / 1000),
       false,
       {}});
}

void LineTarget::note_island(const trace::AmFrame& frame) {
  line_.told = line_.told || told_island(frame) == island_;
}

void LineTarget::wait_until_quiet() {
  const lines::SteadyTime end = steady_clock::now() + kQuietMax;
  const lines::SteadyTime answered = std::min(end, line_.last_given + kAnswerMax);
  while (steady_clock::now() < end) {
    const auto packet = line_.line->receive(std::max(answered, steady_clock::now() + kQuiet));
    if (!packet) return;
    trace::AmFrame frame;
    if (read_packet(*packet, frame)) note_island(frame);
  }
}

// Sets another island, and then that of the case.
void LineTarget::set_island(const machine::Config& config) {
  for (const int island : {config.island == 1 ? 2 : 1, int{config.island}}) {
    rubicon::Config message;
    message.type = rubicon::CommandCode::kSetIslandId;
    message.value = static_cast<std::uint16_t>(island);
    std::uint8_t room[rubicon::ConfigView::kMaxSizeBytes];
    rubicon::ConfigLayout::store(message, room);
    send(to_sink(machine::am::kConfig, Bytes(room, sizeof room)));
  }
}

// Sends a reliable message for the sink, as long as they are on serial lines.
void LineTarget::ask_for_ack(const machine::Config& config) {
  rubicon::AppMsg app;
  app.trans_id = rubicon::Component::kConnless;
  app.app_id = rubicon::Component::kMockup;
  std::uint8_t body[2];
  rubicon::AppMsgLayout::store(app, body);
  rubicon::NetMsg message;
  message.dest = machine::wire_of(machine::Address{config.island, config.id});
  message.src = machine::wire_of(machine::Address{config.island, machine::kNullDevid});
  message.reliable = 1;
  message.seq_num = kAskedSeqNum;
  message.payload = Bytes(body, sizeof body);
  std::uint8_t room[machine::kAmPayloadMax] = {};
  rubicon::NetMsgLayout::store(message, room);
  send(to_sink(machine::am::kNet, Bytes(room, sizeof room)));
  line_.last_given = steady_clock::now();
}

void LineTarget::give(Ticks now, const machine::Event& event) {
  while (run_until(now) < now) {
  }
  const auto* const heard = std::get_if<machine::Heard>(&event);
  const bool is_serial = heard && heard->frame.link == machine::Link::kSerial;
  if (!is_serial && !app_) throw Unsupported("a serial line alone cannot make that happen");
  if (app_) take(app_->poll());
  while (const auto packet = line_.line->receive(steady_clock::now())) take(*packet);
  now_ = std::max(now_, clock_.now());
  if (!outputs_.empty() && outputs_.back().time == now_) ++now_;  // Seen before it.
  given_ = {now_, now_};
  if (is_serial) {
    send(heard->frame);
  } else {
    take(app_->give(event));
  }
  line_.last_given = steady_clock::now();
  given_->to = std::max(now_, clock_.now());
}

void LineTarget::send(const machine::Frame& frame) {
  line_.line->send(events::packet_of(frame), step_deadline());
}

std::optional<Ticks> LineTarget::next() const { return now_ + kStepTicks; }

Ticks LineTarget::run_until(Ticks time) {
  const lines::SteadyTime end = clock_.begin_of(time + 1);
  while (true) {
    const lines::SteadyTime pause = app_ ? std::min(end, steady_clock::now() + kAskApp) : end;
    const auto packet = line_.line->receive(pause);
    const bool any = packet && take(*packet);
    if ((app_ && take(app_->poll())) || any) return now_;
    if (!packet && pause == end) break;
  }
  now_ = std::max(now_, time);
  return now_;
}

// Takes what the app says. Returns whether it is anything.
bool LineTarget::take(std::vector<Output> outputs) {
  now_ = outputs.empty() ? now_ : std::max(now_, clock_.now());
  for (Output& output : outputs) {
    output.time = now_;
    outputs_.push_back(std::move(output));
  }
  return !outputs.empty();
}

// Takes a packet. Returns false if it is not the node's.
bool LineTarget::take(const lines::TimedPacket& packet) {
  if (is_mote()) return false;
  using At = tinyos::AmHeaderLayout::DispatchAt;
  const std::uint8_t dispatch = packet.bytes.size() < At::kEnd ? 0 : packet.bytes[At::kAt];
  if (packet.bytes.empty() || !At::allows(dispatch)) {
    line_.notes += fmt::format(
        "a packet of dispatch {:02x}, which is not an active message, is ignored\n", dispatch);
    return false;
  }
  trace::AmFrame frame;
  if (!read_packet(packet, frame)) {
    line_.line->close();
    throw TargetBroken(fmt::format(
        "a packet of {} bytes on the serial line is not an active message", packet.bytes.size()));
  }
  if (outputs_.size() >= kOutputsMax) {
    line_.line->close();
    throw TargetBroken(fmt::format("more than {} packets on the serial line", kOutputsMax));
  }
  note_island(frame);
  now_ = std::max(now_, clock_.tick_of(packet.time));
  runner::Output& output = outputs_.emplace_back();
  output.time = now_;
  output.is_frame = true;
  output.frame.link = machine::Link::kSerial;
  output.frame.type = frame.type;
  output.frame.dest = frame.dest;
  output.frame.src = frame.src;
  output.frame.size_bytes = static_cast<std::uint8_t>(frame.payload.size());
  std::copy(frame.payload.begin(), frame.payload.end(), output.frame.payload.begin());
  return true;
}

runner::Tolerance LineTarget::tolerance() const {
  const runner::Tolerance host = tolerance_of_this_host(delays_.worst());
  const Ticks line =
      machine::ticks_to_hold(2 * machine::kUsPerSecond * kFrameBits / line_.node.baud);
  return {host.early + line, host.late + line};
}

lines::SteadyTime LineTarget::step_deadline() const {
  return steady_clock::now() + line_.options.step_timeout;
}

LineAttachment::LineAttachment(std::unique_ptr<lines::PacketLine> line, LineNode node,
                               const Options& options) {
  line_.line = std::move(line);
  line_.node = std::move(node);
  line_.options = options;
  if (options.app.empty()) return;
  app_.emplace([command = options.app] { return Process::run(command); }, options);
}

const Identity& LineAttachment::identity() {
  if (!app_) {
    if (!line_.opened) line_.open();  // Whether it is still there is asked by cases alone.
    return line_.node.identity;
  }
  Identity& ours = line_.node.identity;
  const Identity& app = app_->identity();
  if (!app.real_time || std::ranges::find(app.roles, ours.roles.front()) == app.roles.end()) {
    throw TargetBroken(fmt::format("its app is no {} in real time", role_word(ours.roles.front())));
  }
  ours.name = app.name;
  ours.version = app.version;
  return ours;
}

std::unique_ptr<runner::Target> LineAttachment::target() {
  if (!in_use_.expired()) throw Unsupported("one real node is attached, and the case has several");
  identity();
  if (line_.node.restarts && used_) line_.line->close();
  std::unique_ptr<AppChannel> app;
  if (app_) {
    app = std::make_unique<AppChannel>(app_->take(), [this](std::unique_ptr<RctClient> client) {
      app_->give_back(std::move(client));
    });
  } else {
    line_.open();
  }
  used_ = true;
  auto use = std::make_shared<int>(0);
  in_use_ = use;
  return std::make_unique<UsedLineTarget>(line_, std::move(app), std::move(use));
}

void NodeLine::open() {
  // One that has not come is hardly about to start: the next cases need not wait for it as long.
  const bool starts = node.comes_to_us && (!opened || node.restarts) && !absent;
  absent = true;
  const lines::SteadyTime end =
      steady_clock::now() + (starts ? options.start_timeout : options.step_timeout);
  while (true) {
    try {
      if (line->open(end)) is_new = true;
      break;
    } catch (const TargetBroken&) {  // Who looks only whether anybody listens is not the node.
      if (!node.comes_to_us || steady_clock::now() + kAcceptAgain >= end) throw;
      std::this_thread::sleep_for(kAcceptAgain);
    }
  }
  opened = true;
  absent = false;
}

// Whether a base station that connects has just started nobody can see; but the first thing that
// its sink needs is the island.
void LineAttachment::finish() {
  const bool is_base = line_.node.identity.roles.front() == machine::Role::kBaseStation;
  if (is_base && line_.asked && !line_.told) {
    line_.mishaps.push_back({"did not tell its sink the island", false, {}, "N9-SET"_rule});
  }
  if (app_) app_->finish();
}

std::vector<Mishap> LineAttachment::take_mishaps() {
  std::vector<Mishap> out = std::exchange(line_.mishaps, {});
  if (app_) std::ranges::move(app_->take_mishaps(), std::back_inserter(out));
  return out;
}

std::string LineAttachment::take_stderr() {
  std::string& notes = line_.notes;
  if (app_) notes += app_->take_stderr();
  if (notes.size() > Process::kStderrBytesMax) {
    notes.erase(0, notes.size() - Process::kStderrBytesMax);
  }
  return std::exchange(notes, {});
}

runner::Reach AppChannel::shown() const {
  return client_->identity().shown.value_or(runner::Reach{false, false, false, true});
}

void AppChannel::reset(const machine::Config& config, const trace::Statement& own) {
  Asked asked{.command = reset_command(config, own), .closing = "ready"};
  client_->ask(asked);
  now_ = 0;
}

std::vector<Output> AppChannel::give(const machine::Event& event) {
  const auto* const heard = std::get_if<machine::Heard>(&event);
  if (heard && !(heard->frame.link == machine::Link::kPeis && shown().peis)) {
    throw runner::Unsupported("neither the line nor the app can make that happen");
  }
  return ask(command_of(event, now_), false);
}

// `until` a time that has passed is answered at once.
std::vector<Output> AppChannel::poll() { return ask(fmt::format("until {}", now_), true); }

std::vector<Output> AppChannel::ask(std::string command, bool passes_time) {
  Asked asked{.command = std::move(command)};
  asked.from = asked.to = now_;
  asked.passes_time = passes_time;
  asked.real_time = true;
  Answer answer = client_->ask(asked);
  now_ = answer.done;
  for (const Output& output : answer.outputs) {
    const bool is_shown =
        output.is_frame ? output.frame.link == machine::Link::kPeis && shown().peis : shown().app;
    if (is_shown) continue;
    client_->give_up();
    throw runner::TargetBroken(fmt::format("`{}`: the app shows {}, a link that is not its own",
                                           asked.command, output_line(output)));
  }
  return std::move(answer.outputs);
}

}  // namespace rubric::targets
