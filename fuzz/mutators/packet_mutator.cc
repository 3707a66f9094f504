#include "fuzz/mutators/packet_mutator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "codec/containers/link_record.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/mutate_bytes.h"

namespace rubric::fuzz {
namespace {

using Buffer = std::vector<std::uint8_t>;

constexpr std::size_t kSerialMax = 255;
constexpr std::size_t kRadioMax = 125;  // The FCS follows.
// Looking at more packets than these would cost more than it is worth.
constexpr std::size_t kLookBack = 12;

Buffer mutated_bytes(Bytes input, std::size_t max_size, generate::Random& random) {
  Buffer out(input.begin(), input.end());
  out.resize(std::max(out.size(), max_size));
  const std::size_t size = std::min(input.size(), max_size);
  out.resize(mutate_bytes(out.data(), size, max_size, static_cast<unsigned>(random.next())));
  return out;
}

std::size_t room_of(const StreamPacket& packet) {
  return packet.packet.framing == Framing::kRadio ? kRadioMax : kSerialMax;
}

void insert(PacketStream& stream, std::size_t at, const StreamPacket& packet) {
  stream.packets.insert(stream.packets.begin() + static_cast<std::ptrdiff_t>(at), packet);
}

}  // namespace

PacketMutator::PacketMutator(const reflect::Protocol& protocol, const reflect::RouteTable& routes,
                             std::uint64_t seed)
    : protocol_(protocol), routes_(routes), generator_(protocol, routes, seed), decoder_(protocol) {
  for (std::size_t i = 0; i < routes.count; ++i) {
    const reflect::Route& route = routes.routes[i];
    try {
      generator_.valid(route);
    } catch (const std::logic_error&) {
      continue;  // No frame can take this route.
    }
    ways_.push_back(&route);
    const bool known = std::find(messages_.begin(), messages_.end(), route.type) != messages_.end();
    if (!known) messages_.push_back(route.type);
  }
  reseed(seed);
}

Buffer PacketMutator::mutate(InputFormat format, Bytes input, std::size_t max_size) {
  if (random().below(16) == 0) return mutated_bytes(input, max_size, random());
  PacketStream stream = read_stream(format, input);
  if (format == InputFormat::kPcap && !takes_radio(stream) && !takes_serial(stream)) {
    constexpr std::uint16_t kLinks[] = {kLinkRadioFcs, kLinkRadioNoFcs, kLinkSerial, kLinkSf};
    stream.link_type = kLinks[random().below(std::size(kLinks))];
  }
  const std::size_t changes = 1 + random().below(random().below(4) == 0 ? 6 : 3);
  for (std::size_t i = 0; i < changes; ++i) change(stream);
  Buffer out = write_within(stream, max_size, random());
  const bool same = equal(Bytes(out.data(), out.size()), input);
  return same ? mutated_bytes(input, max_size, random()) : out;
}

Buffer PacketMutator::cross_over(InputFormat format, Bytes one, Bytes other, std::size_t max_size) {
  PacketStream stream = read_stream(format, one);
  PacketStream second = read_stream(format, other);
  if (random().below(2) == 0) std::swap(stream, second);
  std::vector<StreamPacket> mixed;
  if (random().below(2) == 0) {
    const std::size_t head = random().below(stream.packets.size() + 1);
    const std::size_t tail = random().below(second.packets.size() + 1);
    mixed.assign(stream.packets.begin(),
                 stream.packets.begin() + static_cast<std::ptrdiff_t>(head));
    mixed.insert(mixed.end(), second.packets.end() - static_cast<std::ptrdiff_t>(tail),
                 second.packets.end());
  } else {
    std::size_t a = 0;
    std::size_t b = 0;
    while (a < stream.packets.size() || b < second.packets.size()) {
      const bool first =
          b == second.packets.size() || (a < stream.packets.size() && random().below(2) == 0);
      const StreamPacket& next = first ? stream.packets[a++] : second.packets[b++];
      if (random().below(4) != 0) mixed.push_back(next);
    }
  }
  stream.packets = std::move(mixed);
  if (random().below(2) == 0) change(stream);
  return write_within(stream, max_size, random());
}

void PacketMutator::change(PacketStream& stream) {
  std::vector<StreamPacket>& packets = stream.packets;
  if (packets.empty()) return insert_message(stream);
  const std::size_t at = pick_packet(stream);
  switch (random().below(20)) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
    case 5: return insert_message(stream);
    case 6:
    case 7:
    case 8:
    case 9:
    case 10:
    case 11: return copy_number(stream);
    case 12: packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(at)); return;
    case 13: return insert(stream, random().below(packets.size() + 1), StreamPacket(packets[at]));
    case 14: return std::swap(packets[at], packets[random().below(packets.size())]);
    default: return change_packet(stream, at);
  }
}

void PacketMutator::insert_message(PacketStream& stream) {
  const reflect::Route* const route = pick_route(stream);
  if (route == nullptr) return;
  const bool near = random().below(8) == 0;
  const generate::Generated made = near ? generator_.near_valid(*route) : generator_.valid(*route);
  std::vector<StreamPacket>& packets = stream.packets;
  // At the end a message continues what the others began.
  const bool last = random().below(4) != 0;
  const std::size_t at = last ? packets.size() : random().below(packets.size() + 1);
  StreamPacket packet = make_packet(made, stream, random());
  if (at > 0) {
    const StreamPacket& before = packets[at - 1];
    packet.packet.time_ns = before.packet.time_ns;
    packet.packet.direction = before.packet.direction;
    packet.interface_name = before.interface_name;
  }
  insert(stream, at, packet);
  if (random().below(4) != 0) adopt_values(stream, at);
}

// Repeats the numbers of an older message in its answer: those of the same name, and, as names
// differ, others.
void PacketMutator::adopt_values(PacketStream& stream, std::size_t at) {
  const std::vector<Number> known = numbers(stream, at - std::min(at, kLookBack), at);
  const std::vector<Number> own = numbers(stream, at, at + 1);
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (random().below(4) != 0) copy_some(stream, known, own, i, random().below(4) != 0);
  }
  repair_sums(stream.packets[at]);
}

void PacketMutator::copy_number(PacketStream& stream) {
  const std::size_t at = pick_packet(stream);
  const std::vector<Number> own = numbers(stream, at, at + 1);
  if (own.empty()) return;
  const std::size_t end = std::min(stream.packets.size(), at + kLookBack / 4);
  const std::vector<Number> known = numbers(stream, at - std::min(at, kLookBack), end);
  copy_some(stream, known, own, random().below(own.size()), random().below(2) == 0);
  repair_sums(stream.packets[at]);
}

// Copies one of `known` into own[to], and perhaps its successors into the successors: the parts of
// an address come in the same order everywhere.
void PacketMutator::copy_some(PacketStream& stream, const std::vector<Number>& known,
                              const std::vector<Number>& own, std::size_t to, bool by_name) {
  const auto fits = [&](const Number& from) {
    const bool itself = from.packet == own[to].packet && from.offset == own[to].offset;
    return !itself && from.width == own[to].width &&
           (!by_name || std::strcmp(from.name, own[to].name) == 0);
  };
  std::size_t chosen = known.size();
  std::size_t seen = 0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (fits(known[i]) && random().below(++seen) == 0) chosen = i;
  }
  if (chosen == known.size()) return;
  const Message message = message_of(stream.packets[own[to].packet]);
  for (; chosen < known.size() && to < own.size() && fits(known[chosen]); ++chosen, ++to) {
    copy(stream, known[chosen], own[to], message);
    if (by_name || random().below(4) == 0) return;
  }
}

// Copies a number, unless the packet would become another message: lengths and types are no values.
void PacketMutator::copy(PacketStream& stream, const Number& from, const Number& to,
                         const Message& message) {
  StreamPacket& packet = stream.packets[to.packet];
  std::uint8_t* const target = packet.bytes.data() + to.offset;
  const std::uint8_t* const source = stream.packets[from.packet].bytes.data() + from.offset;
  std::array<std::uint8_t, 8> old{};
  std::array<std::uint8_t, 8> copied{};
  for (std::size_t i = 0; i < to.width; ++i) {
    old[i] = target[i];
    copied[i] = source[from.little == to.little ? i : to.width - 1 - i];
  }
  std::copy_n(copied.data(), to.width, target);
  if (message_of(packet) != message) std::copy_n(old.data(), to.width, target);
}

PacketMutator::Message PacketMutator::message_of(const StreamPacket& packet) {
  const Packet view = packet.view();
  decoder_.decode(view, frame_);
  return {frame_.decoded.message(), frame_.decoded.error.fault};
}

// Returns the numbers of the messages; the headers around them mostly follow from the message.
std::vector<PacketMutator::Number> PacketMutator::numbers(const PacketStream& stream,
                                                          std::size_t begin, std::size_t end) {
  std::vector<Number> out;
  out.reserve(64);
  for (std::size_t at = begin; at < end; ++at) {
    const Packet packet = stream.packets[at].view();
    decoder_.decode(packet, frame_);
    const reflect::Decoded& decoded = frame_.decoded;
    const bool all = random().below(8) == 0;
    for (std::size_t i = all ? 0 : frame_.payload_node; i < decoded.node_count(); ++i) {
      const reflect::Node& node = decoded[i];
      if (node.kind != reflect::NodeKind::kNumber || node.field == nullptr) continue;
      out.push_back({at, node.offset, node.size, node.field->little_endian, node.field->name});
    }
  }
  return out;
}

void PacketMutator::change_packet(PacketStream& stream, std::size_t at) {
  StreamPacket& packet = stream.packets[at];
  const std::size_t how = random().below(16);
  if (how < 10) {
    generate::change_field(protocol_, packet.packet.framing, packet.bytes, room_of(packet),
                           random());
  } else if (how < 14) {
    change_frame(packet);
  } else {
    change_outside(packet);
  }
  repair_sums(packet);
  if (random().below(16) != 0) return;
  const auto flipped = static_cast<std::int32_t>(1u << random().below(16));
  if (packet.packet.crc != kAbsent) packet.packet.crc ^= flipped;
  if (packet.packet.fcs != kAbsent) packet.packet.fcs ^= flipped;
}

// Changes bytes regardless of their meaning; half of the time the lengths around them are repaired.
void PacketMutator::change_frame(StreamPacket& packet) {
  const Bytes bytes(packet.bytes.data(), packet.bytes.size());
  packet.bytes = mutated_bytes(bytes, room_of(packet), random());
  if (random().below(2) == 0) repair_lengths(packet, routes_);
}

// Changes the facts besides the packet's bytes: its framing, its time, its interface.
void PacketMutator::change_outside(StreamPacket& packet) {
  constexpr std::int32_t kKinds[] = {kSerialAck, kSerialPacketAck, kSerialPacketNoAck,
                                     kSerialUnknown, 0};
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  constexpr const char* kTexts[] = {"", "radio", "serial:1", "\x1b[31m\"\\\n", "\xff\xfe"};
  Packet& outside = packet.packet;
  switch (random().below(6)) {
    case 0:
      if (outside.framing == Framing::kHdlc) outside.kind = kKinds[random().below(5)];
      return;
    case 1:
      if (outside.serial_seq != kAbsent) {
        outside.serial_seq = static_cast<std::int32_t>(random().below(256));
      }
      return;
    case 2:
      outside.time_ns = random().below(8) == 0 ? static_cast<std::int64_t>(random().next() >> 1)
                                               : random().between(0, 1000) * kSecondNs / 1024;
      return;
    case 3: outside.direction = static_cast<Direction>(random().below(3)); return;
    case 4: packet.comment = kTexts[random().below(std::size(kTexts))]; return;
    default: packet.interface_name = kTexts[random().below(std::size(kTexts))]; return;
  }
}

// Picks a packet; the last ones are the end of the present sequence.
std::size_t PacketMutator::pick_packet(const PacketStream& stream) {
  const std::size_t count = stream.packets.size();
  return random().below(2) == 0 ? count - 1 : random().below(count);
}

// Returns whether a message of that type may repeat one of `numbers`.
bool PacketMutator::answers(const reflect::Type& type, const std::vector<Number>& numbers) {
  for (std::size_t i = 0; i < type.field_count; ++i) {
    const reflect::Field& field = type.fields[i];
    if (field.width_bytes < 2) continue;  // Types and counts.
    for (const Number& number : numbers) {
      if (number.width == field.width_bytes && std::strcmp(number.name, field.name) == 0) {
        return true;
      }
    }
  }
  return false;
}

// Picks a route: every message as often as any other, however many routes lead to it; half of the
// time one that may continue the last packet. Returns null if none fits.
const reflect::Route* PacketMutator::pick_route(const PacketStream& stream) {
  const bool radio = takes_radio(stream);
  const bool serial = takes_serial(stream);
  std::vector<Number> last;
  if (!stream.packets.empty() && random().below(2) == 0) {
    last = numbers(stream, stream.packets.size() - 1, stream.packets.size());
  }
  for (std::size_t tries = 0; tries < 16; ++tries) {
    const reflect::Type* const type = messages_[random().below(messages_.size())];
    if (!last.empty() && tries < 12 && !answers(*type, last)) continue;
    const reflect::Route* found = nullptr;
    std::size_t seen = 0;
    for (const reflect::Route* const way : ways_) {
      if (way->type != type) continue;
      const bool on_line = std::strcmp(way->carrier, "serial") == 0;
      const bool converts = std::strcmp(way->carrier, "radio_i") == 0;
      if (on_line ? !serial : !radio && !(serial && converts)) continue;
      if (random().below(++seen) == 0) found = way;
    }
    if (found != nullptr) return found;
  }
  return nullptr;
}

}  // namespace rubric::fuzz
