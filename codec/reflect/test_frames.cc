#include "codec/reflect/test_frames.h"

#include <algorithm>
#include <filesystem>

#include "codec/containers/test/testing.h"
#include "codec/reflect/decode.h"
#include "codec/runtime/hdlc.h"

namespace rubric::reflect {
namespace {

constexpr std::size_t kSerialHead = 8;
constexpr std::size_t kRadioIHead = 11;
constexpr std::size_t kRadioTHead = 10;
constexpr std::size_t kNetHead = 12;
constexpr int kNetMsgType = 28;
constexpr int kInteresting[] = {0,  1,  2,   3,   9,   10,  16,  22,  23,  24,  25,  34,  35, 36,
                                92, 93, 100, 102, 103, 113, 114, 115, 127, 128, 253, 254, 255};

InputFormat format_of(const std::string& path) {
  if (path.ends_with(".bin")) return InputFormat::kHdlc;
  if (path.ends_with(".sfstream")) return InputFormat::kSf;
  if (path.ends_with(".pcapng")) return InputFormat::kPcapng;
  return InputFormat::kUnknown;
}

}  // namespace

std::vector<TestFrame> captured_frames(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<TestFrame> frames;
  for (const std::string& path : paths) {
    const auto reader = make_reader(format_of(path));
    if (!reader) continue;
    const std::string input = rubric::testing::read_file(path);
    for (const auto& kept : rubric::testing::read_all(*reader, rubric::testing::view(input))) {
      const Packet& packet = kept.packet;
      if (packet.framing == Framing::kHdlc && packet.kind == kSerialAck) continue;
      if (packet.framing == Framing::kBare || kept.bytes.empty()) continue;
      frames.push_back({packet.framing == Framing::kRadio, {kept.bytes.begin(), kept.bytes.end()}});
    }
  }
  return frames;
}

std::string hex(const std::vector<std::uint8_t>& bytes) {
  return rubric::testing::to_hex(Bytes(bytes.data(), bytes.size()));
}

FrameMaker::FrameMaker(std::vector<TestFrame> real, const Protocol& protocol, std::uint64_t seed)
    : real_(std::move(real)),
      shapes_{{find_carrier(protocol, "serial"), false, kSerialHead},
              {find_carrier(protocol, "radio_i"), true, kRadioIHead},
              {find_carrier(protocol, "radio_t"), true, kRadioTHead}},
      random_(seed) {}

TestFrame FrameMaker::make() {
  const Shape& shape = shapes_[below(shapes_.size())];
  const std::size_t kind = below(10);
  const auto sound = [&] {
    if (kind < 2) return real_[below(real_.size())];
    return kind < 7 ? carried(shape, kNetMsgType, net_msg()) : other_type(shape);
  };
  TestFrame frame = sound();
  for (std::size_t n = below(3); n > 0; --n) mutate(frame, shape.head_bytes);
  return frame;
}

TestFrame FrameMaker::carried(const Shape& shape, int am_type,
                              const std::vector<std::uint8_t>& message) {
  TestFrame frame{shape.radio, std::vector<std::uint8_t>(shape.head_bytes)};
  for (auto& b : frame.bytes) b = byte();
  if (shape.radio) {
    frame.bytes[0] = 0x41;  // Data, short addresses, compressed PAN.
    frame.bytes[1] = 0x88;
    if (shape.head_bytes == kRadioIHead) frame.bytes[9] = 0x3f;
  } else {
    frame.bytes[0] = 0;
    frame.bytes[5] = static_cast<std::uint8_t>(message.size());
  }
  frame.bytes.back() = static_cast<std::uint8_t>(am_type);
  frame.bytes.insert(frame.bytes.end(), message.begin(), message.end());
  return frame;
}

// Returns a net_msg with a body whose kind, size and counts are near real ones.
std::vector<std::uint8_t> FrameMaker::net_msg() {
  const std::size_t size = chance(30) ? 100 : below(101);
  std::vector<std::uint8_t> out(kNetHead + 2 + size);
  for (auto& b : out) b = byte();
  std::uint8_t* const body = out.data() + kNetHead + 2;
  if (size > 0) {
    body[0] = static_cast<std::uint8_t>(
        one_of({1, 8, 9, 10, 11, 12, 13, 16, 18, 20, 22, 23, 24, 25, 28, 34, 35, 36}));
  }
  for (const std::size_t at : {1u, 3u, 7u, 13u, 34u}) {  // Places of counts in some body.
    if (at < size && chance(70)) body[at] = static_cast<std::uint8_t>(below(26));
  }
  store_be16(out.data() + 6, chance(50) ? 0xfffd : chance(80) ? 2 : 0xfffe);
  out[8] = static_cast<std::uint8_t>(below(2));
  out[11] = static_cast<std::uint8_t>(size + 2);
  const int any = static_cast<int>(below(12));
  out[12] = static_cast<std::uint8_t>(one_of({3, 3, 3, 1, 9, any}));
  out[13] = static_cast<std::uint8_t>(one_of({5, 6, 6, 10, 11, any}));
  return out;
}

// Returns a message that travels as an AM type of its own, of about the size that it needs.
TestFrame FrameMaker::other_type(const Shape& shape) {
  const Switch& choice = *shape.carrier->fields[shape.carrier->field_count - 1].choice;
  const SwitchCase& chosen = choice.cases[below(choice.count)];
  const int am_type = static_cast<int>(chance(90) ? chosen.key : byte());
  const std::size_t size = (chosen.type->min_size + below(20) + 113) % 115;  // From 2 too few.
  std::vector<std::uint8_t> message(size);
  for (auto& b : message) b = byte();
  if (size > 7 && chance(70)) message[7] = static_cast<std::uint8_t>(below(26));
  return carried(shape, am_type, message);
}

void FrameMaker::mutate(TestFrame& frame, std::size_t head_bytes) {
  std::vector<std::uint8_t>& bytes = frame.bytes;
  switch (below(10)) {
    case 0: bytes.resize(below(bytes.size() + 1)); break;
    case 1: bytes.resize(bytes.size() + 1 + below(5), byte()); break;
    case 2:
      for (std::size_t n = 1 + below(4); n > 0 && !bytes.empty(); --n) {
        bytes[below(bytes.size())] ^= static_cast<std::uint8_t>(1u << below(8));
      }
      break;
    default: change(frame, head_bytes); break;
  }
}

// Changes a number that decides about the fields after it.
void FrameMaker::change(TestFrame& frame, std::size_t head_bytes) {
  const auto set = [&](std::size_t at, int value) {
    if (at < frame.bytes.size()) frame.bytes[at] = static_cast<std::uint8_t>(value);
  };
  const std::size_t length_at = frame.radio ? 9 : 5;  // On the radio, the network byte.
  switch (below(6)) {
    case 0: return set(length_at, one_of(kInteresting));
    case 1: return set(head_bytes + 11, one_of(kInteresting));  // nbytes
    case 2: return set(head_bytes + 8, static_cast<int>(below(chance(50) ? 3 : 256)));
    case 3: return set(chance(30) ? 0 : head_bytes + 7, byte());      // Dispatch, sender.
    case 4: return set(head_bytes - 1, static_cast<int>(below(40)));  // AM type
    default: return set(head_bytes + kNetHead + below(6), static_cast<int>(below(40)));
  }
}

}  // namespace rubric::reflect
