#include "conformance/test/targets/line_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/enums.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/test/targets/process.h"
#include "conformance/test/targets/rct_text.h"
#include "conformance/trace/trace.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using runner::Ticks;
using runner::Unsupported;
using std::chrono::steady_clock;

constexpr lines::Milliseconds kQuiet{60};
constexpr lines::Milliseconds kQuietMax{2000};  // A node that never pauses is used as it is.
constexpr Ticks kStepTicks = 5;                 // For several nodes that go on together.
constexpr std::size_t kOutputsMax = 100'000;    // In a case.
constexpr std::uint32_t kFrameBits = (1 + 8 + machine::kAmPayloadMax + 4) * 10;

// Keeps an attachment's one node in use while it lives.
class UsedLineTarget : public LineTarget {
 public:
  UsedLineTarget(lines::PacketLine& line, const LineNode& node, const Options& options,
                 std::string& notes, std::shared_ptr<int> use)
      : LineTarget(line, node, options, notes), use_(std::move(use)) {}

 private:
  std::shared_ptr<int> use_;
};

}  // namespace

void LineTarget::reset(const machine::Config& config) {
  const machine::Role role = node_.identity.roles.front();
  if (config.role != role) {
    throw Unsupported(fmt::format("the node at the line is a {}, not a {}", role_word(role),
                                  role_word(config.role)));
  }
  if (role == machine::Role::kSink && config.id != config.profile.sink_id) {
    throw Unsupported(fmt::format("the id of the sink cannot be set to {}", config.id));
  }
  line_.open(step_deadline());
  if (!is_mote()) let_settle();  // A mote's line shows nothing.
  if (role == machine::Role::kSink) {
    set_island(config.island == 1 ? 2 : 1);
    set_island(config.island);
    let_settle();
  }
  outputs_.clear();
  clock_.start();
  now_ = 0;
}

void LineTarget::let_settle() {
  const lines::SteadyTime end = steady_clock::now() + kQuietMax;
  while (steady_clock::now() < end && line_.receive(steady_clock::now() + kQuiet)) {
  }
}

void LineTarget::set_island(std::uint16_t island) {
  rubicon::Config message;
  message.type = rubicon::CommandCode::kSetIslandId;
  message.value = island;
  std::uint8_t room[machine::kAmPayloadMax];
  const auto bytes = write(message, MutableBytes(room));
  if (!bytes) throw TargetBroken("no message sets an island");
  machine::Frame frame;
  frame.link = machine::Link::kSerial;
  frame.dest = 1;
  frame.type = static_cast<std::uint8_t>(rubicon::AmType::kConfig);
  frame.payload = *bytes;
  send(frame);
}

void LineTarget::give(Ticks now, const machine::Event& event) {
  while (run_until(now) < now) {
  }
  const auto* const heard = std::get_if<machine::Heard>(&event);
  if (!heard || heard->frame.link != machine::Link::kSerial) {
    throw Unsupported("a serial line alone cannot make that happen");
  }
  send(heard->frame);
  now_ = std::max(now_, clock_.now());
}

void LineTarget::send(const machine::Frame& frame) {
  line_.send(
      trace::packet_of(
          {frame.dest, frame.src, 0, frame.type, {frame.payload.begin(), frame.payload.end()}}),
      step_deadline());
}

std::optional<Ticks> LineTarget::next() const { return now_ + kStepTicks; }

Ticks LineTarget::run_until(Ticks time) {
  while (const auto packet = line_.receive(clock_.begin_of(time + 1))) {
    if (take(*packet)) return now_;
  }
  now_ = std::max(now_, time);
  return now_;
}

// Takes a packet. Returns false if it is not the node's.
bool LineTarget::take(const lines::TimedPacket& packet) {
  if (is_mote()) return false;
  using At = tinyos::AmHeaderLayout::DispatchAt;
  const std::uint8_t dispatch = packet.bytes.size() < At::kEnd ? 0 : packet.bytes[At::kAt];
  if (packet.bytes.empty() || !At::allows(dispatch)) {
    notes_ += fmt::format(
        "a packet of dispatch {:02x}, which is not an active message, is ignored\n", dispatch);
    return false;
  }
  trace::AmFrame frame;
  const std::string_view bytes(reinterpret_cast<const char*>(packet.bytes.data()),
                               packet.bytes.size());
  const bool whole = trace::parse_packet(bytes, frame);
  if (!whole || frame.payload.size() > machine::kAmPayloadMax) {
    line_.close();
    throw TargetBroken(fmt::format(
        "a packet of {} bytes on the serial line is not an active message", bytes.size()));
  }
  if (outputs_.size() >= kOutputsMax) {
    line_.close();
    throw TargetBroken(fmt::format("more than {} packets on the serial line", kOutputsMax));
  }
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
  const runner::Tolerance host = tolerance_of_this_host();
  const Ticks line = machine::ticks_to_hold(2 * machine::kUsPerSecond * kFrameBits / node_.baud);
  return {host.early + line, host.late + line};
}

lines::SteadyTime LineTarget::step_deadline() const {
  return steady_clock::now() + options_.step_timeout;
}

const Identity& LineAttachment::identity() {
  open();
  return node_.identity;
}

std::unique_ptr<runner::Target> LineAttachment::target() {
  if (!in_use_.expired()) {
    throw Unsupported("one real node is attached, and the case has several");
  }
  if (node_.restarts && used_) line_->close();
  open();
  used_ = true;
  auto use = std::make_shared<int>(0);
  in_use_ = use;
  return std::make_unique<UsedLineTarget>(*line_, node_, options_, notes_, std::move(use));
}

// Waits that long only for a node that starts and then connects by itself.
void LineAttachment::open() {
  const bool starts = node_.comes_to_us && (!opened_ || node_.restarts);
  line_->open(steady_clock::now() + (starts ? options_.start_timeout : options_.step_timeout));
  opened_ = true;
}

std::string LineAttachment::take_stderr() {
  if (notes_.size() > Process::kStderrBytesMax) {
    notes_.erase(0, notes_.size() - Process::kStderrBytesMax);
  }
  return std::exchange(notes_, {});
}

}  // namespace rubric::targets
