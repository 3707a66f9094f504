#include "fuzz/mutators/packet_mutator.h"

#include <algorithm>
#include <cstring>

#include "codec/containers/link_record.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/mutate_bytes.h"

namespace rubric::fuzz {
namespace {

using Buffer = std::vector<std::uint8_t>;

constexpr std::size_t kSerialMax = 255;
constexpr std::size_t kRadioMax = 125;  // The FCS follows.
// A look at more packets than these would cost more than it is worth.
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
    const reflect::Type* const type = routes.routes[i].type;
    if (std::find(messages_.begin(), messages_.end(), type) != messages_.end()) continue;
    messages_.push_back(type);
  }
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

Buffer PacketMutator::cross_over(InputFormat format, Bytes one, Bytes other,
                                 std::size_t max_size) {
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
      const bool first = b == second.packets.size() ||
                         (a < stream.packets.size() && random().below(2) == 0);
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
  switch (random().below(16)) {
    case 0: case 1: case 2: case 3: case 4:
      return insert_message(stream);
    case 5: case 6: case 7:
      return copy_number(stream);
    case 8:
      packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(at));
      return;
    case 9:
      return insert(stream, random().below(packets.size() + 1), StreamPacket(packets[at]));
    case 10:
      return std::swap(packets[at], packets[random().below(packets.size())]);
    default:
      return change_packet(stream, at);
  }
}

void PacketMutator::insert_message(PacketStream& stream) {
  const reflect::Route* const route = pick_route(stream);
  if (route == nullptr) return;
  const bool near = random().below(6) == 0;
  const generate::Generated made =
      near ? generator_.near_valid(*route) : generator_.valid(*route);
  std::vector<StreamPacket>& packets = stream.packets;
  // Behind all others a message goes on with what they began.
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
  if (random().below(2) == 0) adopt_values(stream, at);
}

// A message that answers another repeats its numbers: those of the same name, mostly.
void PacketMutator::adopt_values(PacketStream& stream, std::size_t at) {
  std::vector<Number> known;
  for (std::size_t i = at - std::min(at, kLookBack); i < at; ++i) add_numbers(stream, i, known);
  if (known.empty()) return;
  std::vector<Number> own;
  add_numbers(stream, at, own);
  for (const Number& to : own) {
    if (random().below(3) == 0) continue;
    // From a random place on, so that no packet is preferred.
    const std::size_t start = random().below(known.size());
    for (std::size_t i = 0; i < known.size(); ++i) {
      const Number& from = known[(start + i) % known.size()];
      if (from.width != to.width || std::strcmp(from.name, to.name) != 0) continue;
      copy(stream, from, to);
      break;
    }
  }
  repair_sums(stream.packets[at]);
}

void PacketMutator::copy_number(PacketStream& stream) {
  const std::size_t at = pick_packet(stream);
  std::vector<Number> own;
  add_numbers(stream, at, own);
  if (own.empty()) return;
  const Number to = own[random().below(own.size())];
  std::vector<Number> known;
  const std::size_t end = std::min(stream.packets.size(), at + kLookBack / 4);
  for (std::size_t i = at - std::min(at, kLookBack); i < end; ++i) add_numbers(stream, i, known);
  std::vector<Number> fit;
  for (const Number& from : known) {
    if (from.width == to.width && (from.packet != to.packet || from.offset != to.offset)) {
      fit.push_back(from);
    }
  }
  if (fit.empty()) return;
  copy(stream, fit[random().below(fit.size())], to);
  repair_sums(stream.packets[at]);
}

void PacketMutator::copy(PacketStream& stream, const Number& from, const Number& to) {
  const Buffer source = stream.packets[from.packet].bytes;
  Buffer& target = stream.packets[to.packet].bytes;
  for (std::size_t i = 0; i < to.width; ++i) {
    const std::size_t other = from.little == to.little ? i : to.width - 1 - i;
    target[to.offset + i] = source[from.offset + other];
  }
}

void PacketMutator::add_numbers(const PacketStream& stream, std::size_t at,
                                std::vector<Number>& out) {
  const Packet packet = stream.packets[at].view();
  decoder_.decode(packet, frame_);
  const reflect::Decoded& decoded = frame_.decoded;
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const reflect::Node& node = decoded[i];
    if (node.kind != reflect::NodeKind::kNumber || node.field == nullptr) continue;
    out.push_back({at, node.offset, node.size, node.field->little_endian, node.field->name});
  }
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

// Bytes without regard to what they are; half of the time the lengths around them are true.
void PacketMutator::change_frame(StreamPacket& packet) {
  const Bytes bytes(packet.bytes.data(), packet.bytes.size());
  packet.bytes = mutated_bytes(bytes, room_of(packet), random());
  if (random().below(2) == 0) repair_lengths(packet, routes_);
}

// What the packet's bytes lack: how it was framed, when and how it was heard.
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
      outside.time_ns = random().below(8) == 0
                            ? static_cast<std::int64_t>(random().next() >> 1)
                            : random().between(0, 1000) * kSecondNs / 1024;
      return;
    case 3:
      outside.direction = static_cast<Direction>(random().below(3));
      return;
    case 4:
      packet.comment = kTexts[random().below(std::size(kTexts))];
      return;
    default:
      packet.interface_name = kTexts[random().below(std::size(kTexts))];
      return;
  }
}

// The last packets are those that a sequence has come to.
std::size_t PacketMutator::pick_packet(const PacketStream& stream) {
  const std::size_t count = stream.packets.size();
  return random().below(3) == 0 ? count - 1 : random().below(count);
}

// Every message as often as any other, however many ways lead to it. Null where none fits.
const reflect::Route* PacketMutator::pick_route(const PacketStream& stream) {
  const bool radio = takes_radio(stream);
  const bool serial = takes_serial(stream);
  for (std::size_t tries = 0; tries < 8; ++tries) {
    const reflect::Type* const type = messages_[random().below(messages_.size())];
    const reflect::Route* found = nullptr;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < routes_.count; ++i) {
      const reflect::Route& route = routes_.routes[i];
      if (route.type != type) continue;
      const bool on_line = std::strcmp(route.carrier, "serial") == 0;
      const bool converts = std::strcmp(route.carrier, "radio_i") == 0;
      if (on_line ? !serial : !radio && !(serial && converts)) continue;
      if (random().below(++seen) == 0) found = &route;
    }
    if (found != nullptr) return found;
  }
  return nullptr;
}

}  // namespace rubric::fuzz
