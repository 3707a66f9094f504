#include "fuzz/mutators/packet_mutator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/reflect/am_frames.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/mutate_bytes.h"

namespace rubric::fuzz {
namespace {

using Buffer = std::vector<std::uint8_t>;
using IFrame = rubicon::RadioIFrameLayout;
using Mac = tinyos::MacHeaderLayout;

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

constexpr std::size_t kAmLengthMax = 255;

void put(std::vector<std::uint8_t>& out, std::size_t at, std::size_t width, bool little,
         std::uint32_t value) {
  if (at + width > out.size()) return;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t shift = 8 * (little ? i : width - 1 - i);
    out[at + i] = static_cast<std::uint8_t>(value >> shift);
  }
}

// Returns whether the bytes lead to the route's message by their types. Wider choices are
// addresses, of which any but one may occur as well.
bool follows(const reflect::Route& route, const std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i < route.choice_count; ++i) {
    const reflect::RouteChoice& choice = route.choices[i];
    if (choice.width_bytes != 1) continue;
    if (choice.offset >= bytes.size() || bytes[choice.offset] != choice.value) return false;
  }
  return true;
}

const char* carrier_of(const StreamPacket& packet) {
  if (packet.packet.framing != Framing::kRadio) return "serial";
  const bool network = packet.bytes.size() >= IFrame::NetworkAt::kEnd &&
                       IFrame::NetworkAt::allows(packet.bytes[IFrame::NetworkAt::kAt]);
  return network ? "radio_i" : "radio_t";
}

// Returns the serial packet with the contents of an I-frame.
std::vector<std::uint8_t> as_serial(const std::vector<std::uint8_t>& frame) {
  if (frame.size() < reflect::kRadioIHeaderBytes) return frame;
  const std::uint8_t* const p = frame.data();
  const Bytes payload = Bytes(p, frame.size()).from(reflect::kRadioIHeaderBytes);
  std::vector<std::uint8_t> out =
      reflect::serial_packet({.dest = Mac::DestAt::load(p),
                              .src = Mac::SrcAt::load(p),
                              .group = static_cast<std::uint8_t>(Mac::DestpanAt::load(p)),
                              .type = static_cast<std::uint8_t>(IFrame::TypeAt::load(p))},
                             payload);
  const std::size_t length = std::min(payload.size(), kAmLengthMax);
  tinyos::AmHeaderLayout::LengthAt::store(out.data(), static_cast<std::uint8_t>(length));
  return out;
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

Packet StreamPacket::view() const {
  Packet out = packet;
  out.bytes = Bytes(bytes.data(), bytes.size());
  out.comment = comment;
  return out;
}

PacketStream read_stream(InputFormat format, Bytes input) {
  PacketStream stream{.format = format};
  const std::unique_ptr<Reader> reader = make_reader(format);
  auto take = [&](const Packet& packet) {
    StreamPacket kept{.packet = packet};
    kept.packet.bytes = Bytes();
    kept.packet.comment = {};
    kept.bytes.assign(packet.bytes.begin(), packet.bytes.end());
    kept.comment = packet.comment;
    const std::vector<Interface>& interfaces = reader->interfaces();
    if (packet.interface_id < interfaces.size()) {
      kept.interface_name = interfaces[packet.interface_id].name;
    }
    stream.packets.push_back(std::move(kept));
  };
  reader->feed(input, take);
  reader->finish(take);
  if (format == InputFormat::kPcap && !reader->interfaces().empty()) {
    stream.link_type = reader->interfaces()[0].link_type;
  }
  return stream;
}

std::vector<std::uint8_t> write_stream(const PacketStream& stream) {
  const std::unique_ptr<Writer> writer = make_writer(stream.format, stream.link_type);
  std::string out;
  writer->begin(out);
  for (const StreamPacket& packet : stream.packets) {
    writer->write(packet.view(), packet.interface_name, out);
  }
  writer->finish(out);
  return {out.begin(), out.end()};
}

std::vector<std::uint8_t> write_within(PacketStream& stream, std::size_t max_size,
                                       generate::Random& random) {
  for (;;) {
    std::vector<std::uint8_t> out = write_stream(stream);
    if (out.size() <= max_size) return out;
    if (stream.packets.empty()) {
      out.resize(max_size);
      return out;
    }
    // In proportion to the excess, so that long streams are not written a hundred times.
    const std::size_t excess = out.size() - max_size;
    std::size_t gone = std::max<std::size_t>(1, stream.packets.size() * excess / out.size());
    for (; gone > 0; --gone) {
      const std::size_t at = random.below(stream.packets.size());
      stream.packets.erase(stream.packets.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

bool takes_radio(const PacketStream& stream) {
  if (stream.format == InputFormat::kPcapng) return true;
  return stream.format == InputFormat::kPcap &&
         (stream.link_type == kLinkRadioFcs || stream.link_type == kLinkRadioNoFcs);
}

bool takes_serial(const PacketStream& stream) {
  if (stream.format != InputFormat::kPcap) return true;
  return stream.link_type == kLinkSerial || stream.link_type == kLinkSf;
}

StreamPacket make_packet(const generate::Generated& frame, const PacketStream& stream,
                         generate::Random& random) {
  StreamPacket out{.bytes = frame.bytes};
  Packet& packet = out.packet;
  const bool file = stream.format == InputFormat::kPcap || stream.format == InputFormat::kPcapng;
  if (frame.framing == Framing::kRadio && takes_radio(stream)) {
    packet.framing = Framing::kRadio;
    const bool has_fcs = stream.format == InputFormat::kPcap ? stream.link_type == kLinkRadioFcs
                                                             : random.below(4) != 0;
    packet.fcs = has_fcs ? 0 : kAbsent;
    packet.link_type = has_fcs ? kLinkRadioFcs : kLinkRadioNoFcs;
  } else {
    if (frame.framing == Framing::kRadio) out.bytes = as_serial(frame.bytes);
    const bool hdlc = stream.format == InputFormat::kHdlc || stream.link_type == kLinkSerial ||
                      (stream.format == InputFormat::kPcapng && random.below(4) != 0);
    packet.framing = hdlc ? Framing::kHdlc : Framing::kSf;
    if (hdlc) packet.kind = random.below(4) == 0 ? kSerialPacketAck : kSerialPacketNoAck;
    if (hdlc && packet.kind == kSerialPacketAck) {
      packet.serial_seq = static_cast<std::int32_t>(random.below(256));
    }
    if (file) packet.link_type = hdlc ? kLinkSerial : kLinkSf;
  }
  repair_sums(out);
  return out;
}

void repair_sums(StreamPacket& packet) {
  packet.packet.error = Error{Fault::kNone, 0, ReqId::kNone};
  packet.packet.dropped_bytes = 0;
  if (packet.packet.framing == Framing::kRadio && packet.packet.fcs != kAbsent) {
    packet.packet.fcs = fcs_fast(Bytes(packet.bytes.data(), packet.bytes.size()));
  }
  if (packet.packet.framing != Framing::kHdlc) return;
  if (packet.packet.kind == kAbsent) packet.packet.kind = kSerialPacketNoAck;
  const bool has_seq = serial_kind_has_seq(packet.packet.kind);
  if (has_seq == (packet.packet.serial_seq == kAbsent)) {
    packet.packet.serial_seq = has_seq ? 0 : kAbsent;
  }
  packet.packet.crc = kAbsent;
  std::string content;
  append_serial_content(packet.view(), content);
  packet.packet.crc =
      crc16_fast(Bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size()));
}

void repair_lengths(StreamPacket& packet, const reflect::RouteTable& routes) {
  const char* const carrier = carrier_of(packet);
  const reflect::Route* best = nullptr;
  for (std::size_t i = 0; i < routes.count; ++i) {
    const reflect::Route& route = routes.routes[i];
    if (std::strcmp(route.carrier, carrier) != 0 || !follows(route, packet.bytes)) continue;
    if (best == nullptr || route.choice_count > best->choice_count) best = &route;
  }
  if (best == nullptr) return;
  for (std::size_t i = 0; i < best->length_count; ++i) {
    const reflect::RouteLength& length = best->lengths[i];
    const std::size_t from = std::min<std::size_t>(length.from, packet.bytes.size());
    const std::size_t bytes = packet.bytes.size() - from;
    put(packet.bytes, length.offset, length.width_bytes, length.little_endian,
        static_cast<std::uint32_t>(std::min(bytes, kAmLengthMax)));
  }
}

}  // namespace rubric::fuzz
