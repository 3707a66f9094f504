#include "conformance/selftest/scripts/bytes.h"

#include <algorithm>
#include <bit>

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
  machine::Address address() {
    const std::uint16_t pid = u16();
    return {pid, u16()};
  }
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
  Writer& bytes(const std::vector<std::uint8_t>& bytes) {
    u8(bytes.size());
    out_.insert(out_.end(), bytes.begin(), bytes.end());
    return *this;
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

machine::Descriptor read_descriptor(Reader& in) {
  machine::Descriptor out;
  out.mote_type = in.u8();
  out.actuators = in.u8();
  out.transducers = in.u16();
  return out;
}

machine::CreateChannel read_channel(Reader& in) {
  machine::CreateChannel out;
  out.direction = static_cast<machine::Direction>(in.flag());
  out.peer = in.address();
  out.size = in.u8();
  out.mode = static_cast<machine::Mode>(in.flag());
  return out;
}

machine::WriteOutput read_value(Reader& in) {
  machine::WriteOutput out;
  out.id = in.u32();
  out.pos = in.u8();
  out.value = std::bit_cast<float>(in.u32());
  if (out.value != out.value) out.value = std::bit_cast<float>(kNan);
  return out;
}

// Not inlined: g++ 12 takes the variant's padding for uninitialised data.
[[gnu::noinline]] machine::Call read_call(std::size_t which, Reader& in,
                                          std::vector<std::uint8_t>& bytes) {
  switch (which) {
    case 0: return machine::JoinIsland{read_descriptor(in)};
    case 1: {
      machine::Send send;
      send.dest = in.address();
      send.app_id = in.u8();
      send.reliable = in.flag();
      bytes = in.bytes(kSendBytesMax);
      return send;
    }
    case 2: {
      const auto link = static_cast<Link>(in.below(3));
      return machine::SetInterface{link, in.flag()};
    }
    case 3: return machine::GetInterface{static_cast<Link>(in.below(3))};
    case 4: return read_channel(in);
    case 5: return machine::DisposeChannel{in.u32()};
    case 6: return machine::StartChannel{in.u32()};
    case 7: return machine::StopChannel{in.u32()};
    case 8: return machine::StartAllChannels{};
    case 9: return machine::StopAllChannels{};
    case 10: return read_value(in);
    case 11: {
      const machine::ChannelId id = in.u32();
      return machine::ReadInput{id, in.u8()};
    }
    case 12: return machine::SetTimeStep{in.u16()};
    case 13: return machine::SetIslandId{in.u16()};
    default: return machine::GetClock{};
  }
}

struct CallWriter {
  Writer& out;
  const std::vector<std::uint8_t>& bytes;

  void operator()(const machine::JoinIsland& c) const {
    out.u8(c.descriptor.mote_type).u8(c.descriptor.actuators).u16(c.descriptor.transducers);
  }
  void operator()(const machine::Send& c) const {
    out.address(c.dest).u8(c.app_id).u8(c.reliable).bytes(bytes);
  }
  void operator()(const machine::SetInterface& c) const {
    out.u8(static_cast<std::size_t>(c.link)).u8(c.on);
  }
  void operator()(const machine::GetInterface& c) const {
    out.u8(static_cast<std::size_t>(c.link));
  }
  void operator()(const machine::CreateChannel& c) const {
    out.u8(static_cast<std::size_t>(c.direction)).address(c.peer).u8(c.size);
    out.u8(static_cast<std::size_t>(c.mode));
  }
  void operator()(const machine::DisposeChannel& c) const { out.u32(c.id); }
  void operator()(const machine::StartChannel& c) const { out.u32(c.id); }
  void operator()(const machine::StopChannel& c) const { out.u32(c.id); }
  void operator()(const machine::WriteOutput& c) const {
    out.u32(c.id).u8(c.pos).u32(std::bit_cast<std::uint32_t>(c.value));
  }
  void operator()(const machine::ReadInput& c) const { out.u32(c.id).u8(c.pos); }
  void operator()(const machine::SetTimeStep& c) const { out.u16(c.ticks); }
  void operator()(const machine::SetIslandId& c) const { out.u16(c.island); }
  template <class Other>
  void operator()(const Other&) const {}
};

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
    step.event = machine::Called{read_call(kind - kCall, in, step.bytes)};
    return step;
  }
  machine::Frame frame;
  frame.link = link_of(role, in.below(2));
  frame.dest = in.u16();
  frame.src = in.u16();
  frame.type = in.u8();
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
    out.bytes(step.bytes);
  } else if (const auto* called = std::get_if<machine::Called>(&step.event)) {
    begin(kCall + called->call.index());
    std::visit(CallWriter{out, step.bytes}, called->call);
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
  Script script;
  script.config = read_config(in);
  script.rest = in.u16();
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
