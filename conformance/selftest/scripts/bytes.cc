#include "conformance/selftest/scripts/bytes.h"

#include <bit>
#include <cassert>
#include <utility>

#include "conformance/generated/profiles.h"
#include "conformance/machine/address.h"

namespace rubric::script {
namespace {

using machine::Link;
using machine::Role;

// Frames occur more often among the kinds than anything else, as they do in real runs.
enum Kind : std::uint8_t {
  kHeard = 0,
  kCall = 5,  // And which of the calls.
  kLinkAck = kCall + std::variant_size_v<machine::Call>,
  kLineBusy,
  kAppBusy,
  kReboot,
  kPowerOff,
  kKinds = 32,
};

constexpr std::make_index_sequence<std::variant_size_v<machine::Call>> kCalls;

constexpr std::uint8_t kDeployedBit = 0x80;
constexpr std::uint32_t kNan = 0x7FC00000;  // Text has one NaN only.

class Reader {
 public:
  explicit Reader(Bytes bytes) : rest_(bytes) {}
  bool at_end() const { return rest_.empty(); }
  std::uint8_t u8() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_[0];
    rest_ = rest_.from(1);
    return value;
  }
  std::uint16_t u16() {
    const unsigned high = u8();
    return static_cast<std::uint16_t>(high << 8 | u8());
  }
  std::uint32_t u32() {
    const std::uint32_t high = u16();
    return high << 16 | u16();
  }
  std::size_t below(std::size_t n) { return u8() % n; }
  bool flag() { return below(2) == 1; }
  template <class T>
  void u8(T& value) {
    value = static_cast<T>(u8());
  }
  template <class T>
  void u16(T& value) {
    value = static_cast<T>(u16());
  }
  void u32(std::uint32_t& value) { value = u32(); }
  template <class T>
  void choice(T& value, std::size_t n) {
    value = static_cast<T>(below(n));
  }
  void address(machine::Address& value) {
    u16(value.pid);
    u16(value.devid);
  }
  void real(float& value) {
    value = std::bit_cast<float>(u32());
    if (value != value) value = std::bit_cast<float>(kNan);
  }
  void bytes(std::vector<std::uint8_t>& value, std::size_t max) { value = bytes(max); }
  std::vector<std::uint8_t> bytes(std::size_t max) {
    std::vector<std::uint8_t> out(below(max + 1));
    for (std::uint8_t& byte : out) byte = u8();
    return out;
  }

 private:
  Bytes rest_;
};

class Writer {
 public:
  Writer& u8(std::size_t value) {
    out_.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Writer& u16(std::size_t value) { return u8(value >> 8).u8(value); }
  Writer& u32(std::uint32_t value) { return u16(value >> 16).u16(value); }
  Writer& address(machine::Address value) { return u16(value.pid).u16(value.devid); }
  void choice(auto value, std::size_t) { u8(static_cast<std::size_t>(value)); }
  void real(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void bytes(const std::vector<std::uint8_t>& bytes, std::size_t) {
    u8(bytes.size());
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  std::size_t size() const { return out_.size(); }
  std::vector<std::uint8_t> take() { return std::move(out_); }

 private:
  std::vector<std::uint8_t> out_;
};

// The two lines of a node; a mote's are the same.
constexpr Link kLinesOf[][2] = {
    {Link::kRadio, Link::kRadio}, {Link::kRadio, Link::kSerial}, {Link::kSerial, Link::kPeis}};
Link link_of(Role role, std::size_t number) {
  return kLinesOf[static_cast<std::size_t>(role)][number];
}
std::size_t number_of(Role role, Link line) { return link_of(role, 0) == line ? 0 : 1; }

machine::Config read_config(Reader& in) {
  machine::Config config;
  const std::uint8_t first = in.u8();
  const std::size_t role = (first & ~kDeployedBit) % 3U;
  config.role = static_cast<Role>(role);
  config.profile = (first & kDeployedBit) != 0 ? machine::kDeployed : machine::kPaper;
  const std::uint16_t id = in.u16();
  const std::uint16_t island = in.u16();
  const std::size_t channels = in.below(machine::kChannelsRoom);
  config.first_seq = in.u16();
  if (config.role == Role::kMote) {
    // Not a sink's, and not 0, which means the sink in older parts of release 1.0.
    const bool good = id > config.profile.sink_id && !machine::is_reserved(id);
    config.id = good ? id : static_cast<std::uint16_t>(5);
  } else {
    config.island = machine::is_reserved(island) ? std::uint16_t{11} : island;
    config.id = config.role == Role::kSink ? std::uint16_t{config.profile.sink_id} : 0;
  }
  if (config.role != Role::kBaseStation) {
    config.profile.channels_max = static_cast<std::uint8_t>(channels + 1);
  }
  return config;
}

void write_config(const machine::Config& config, Writer& out) {
  const bool deployed = is_deployed(config.profile);
  out.u8(static_cast<std::size_t>(config.role) | (deployed ? kDeployedBit : 0U));
  out.u16(config.role == Role::kMote ? config.id : 0U).u16(config.island);
  out.u8(config.profile.channels_max - 1U).u16(config.first_seq);
}

// Passes the fields of a call in the order of their bytes to a Reader or a Writer. `bytes` are the
// data of a send.
template <class Io, class Call>
void pass(Io& io, Call& call, auto& bytes) {
  if constexpr (requires { call.descriptor; }) {
    io.u8(call.descriptor.mote_type);
    io.u8(call.descriptor.actuators);
    io.u16(call.descriptor.transducers);
  }
  if constexpr (requires { call.reliable; }) {
    io.address(call.dest);
    io.u8(call.app_id);
    io.choice(call.reliable, 2);
    io.bytes(bytes, kSendBytesMax);
  }
  if constexpr (requires { call.link; }) io.choice(call.link, 3);
  if constexpr (requires { call.on; }) io.choice(call.on, 2);
  if constexpr (requires { call.direction; }) {
    io.choice(call.direction, 2);
    io.address(call.peer);
    io.u8(call.size);
    io.choice(call.mode, 2);
  }
  if constexpr (requires { call.id; }) io.u32(call.id);
  if constexpr (requires { call.pos; }) io.u8(call.pos);
  if constexpr (requires { call.value; }) io.real(call.value);
  if constexpr (requires { call.ticks; }) io.u16(call.ticks);
  if constexpr (requires { call.island; }) io.u16(call.island);
}

// Not inlined: g++ 12 takes the variant's padding for uninitialised data.
template <std::size_t... kIndex>
[[gnu::noinline]] machine::Call read_call(std::size_t which, Reader& in,
                                          std::vector<std::uint8_t>& bytes,
                                          std::index_sequence<kIndex...>) {
  machine::Call call;
  const bool known = ((which == kIndex && (pass(in, call.emplace<kIndex>(), bytes), true)) || ...);
  assert(known);
  (void)known;
  return call;
}

Ticks read_delay(Reader& in) {
  const Ticks value = in.u16();
  if (value <= kShortDelayMax) return value;
  return kShortDelayMax + (value - kShortDelayMax) * kLongTicks;
}

Step read_step(Role role, Reader& in) {
  Step step;
  const std::size_t kind = in.below(kKinds);
  step.delay = read_delay(in);
  switch (kind) {
    case kLinkAck:
      if (role == Role::kBaseStation) break;  // It has no radio.
      step.event = machine::SendDone{Link::kRadio, in.flag()};
      return step;
    case kLineBusy: {
      const Link line = role == Role::kBaseStation ? Link::kSerial : link_of(role, in.below(2));
      step.event = machine::LinkBusy{line, in.flag()};
      return step;
    }
    case kAppBusy: step.event = machine::AppBusy{in.flag()}; return step;
    case kReboot: step.event = machine::Reboot{}; return step;
    case kPowerOff: step.event = machine::PowerOff{}; return step;
    default: break;
  }
  if (kind >= kCall && kind < kLinkAck) {
    step.event = machine::Called{read_call(kind - kCall, in, step.bytes, kCalls)};
    return step;
  }
  machine::Frame frame{
      .link = link_of(role, in.below(2)), .dest = in.u16(), .src = in.u16(), .type = in.u8()};
  step.bytes = in.bytes(machine::kAmPayloadMax);
  step.event = machine::Heard{frame};
  return step;
}

void write_delay(Ticks delay, Writer& out) {
  if (delay <= kShortDelayMax) {
    out.u16(delay);
  } else {
    out.u16(kShortDelayMax + (delay - kShortDelayMax) / kLongTicks);
  }
}

void write_step(Role role, const Step& step, Writer& out) {
  const auto begin = [&](std::size_t kind) {
    out.u8(kind);
    write_delay(step.delay, out);
  };
  if (const auto* heard = std::get_if<machine::Heard>(&step.event)) {
    begin(kHeard);
    const machine::Frame& frame = heard->frame;
    out.u8(number_of(role, frame.link)).u16(frame.dest).u16(frame.src).u8(frame.type);
    out.bytes(step.bytes, machine::kAmPayloadMax);
  } else if (const auto* called = std::get_if<machine::Called>(&step.event)) {
    begin(kCall + called->call.index());
    std::visit([&](const auto& call) { pass(out, call, step.bytes); }, called->call);
  } else if (const auto* done = std::get_if<machine::SendDone>(&step.event)) {
    begin(kLinkAck);
    out.u8(done->acked);
  } else if (const auto* line = std::get_if<machine::LinkBusy>(&step.event)) {
    begin(kLineBusy);
    if (role != Role::kBaseStation) out.u8(number_of(role, line->link));
    out.u8(line->busy);
  } else if (const auto* app = std::get_if<machine::AppBusy>(&step.event)) {
    begin(kAppBusy);
    out.u8(app->busy);
  } else {
    begin(std::holds_alternative<machine::Reboot>(step.event) ? kReboot : kPowerOff);
  }
}

}  // namespace

Ticks fitting_delay(Ticks delay) {
  if (delay <= kShortDelayMax) return delay;
  return delay - (delay - kShortDelayMax) % kLongTicks;
}

Script decode(Bytes bytes) {
  Reader in(bytes);
  Script script{.config = read_config(in), .rest = in.u16()};
  Ticks length = script.rest;
  while (!in.at_end() && script.steps.size() < kStepsMax) {
    Step& step = script.steps.emplace_back(read_step(script.config.role, in));
    if (length + step.delay > kLengthMax) step.delay = 0;
    length += step.delay;
  }
  return script;
}

std::vector<std::uint8_t> encode(const Script& script) {
  Writer out;
  write_config(script.config, out);
  out.u16(script.rest);
  for (const Step& step : script.steps) write_step(script.config.role, step, out);
  return out.take();
}

std::vector<std::size_t> step_offsets(const Script& script) {
  Writer out;
  write_config(script.config, out);
  out.u16(script.rest);
  std::vector<std::size_t> offsets{out.size()};
  for (const Step& step : script.steps) {
    write_step(script.config.role, step, out);
    offsets.push_back(out.size());
  }
  return offsets;
}

}  // namespace rubric::script
