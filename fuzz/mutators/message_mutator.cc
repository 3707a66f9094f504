#include "fuzz/mutators/message_mutator.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

#include "codec/containers/link_record.h"
#include "codec/containers/writer.h"
#include "codec/generated/rubicon/messages.h"
#include "fuzz/support/mutate_bytes.h"

namespace rubric::fuzz {
namespace {

using Buffer = std::vector<std::uint8_t>;

constexpr std::size_t kRadioFrameRoom = kRadioFrameMax - 2;  // The FCS follows.

void put(Buffer& out, std::size_t at, std::size_t width, bool little, std::uint32_t value) {
  if (at + width > out.size()) return;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t shift = 8 * (little ? i : width - 1 - i);
    out[at + i] = static_cast<std::uint8_t>(value >> shift);
  }
}

bool is_serial(const reflect::Route& route) { return std::strcmp(route.carrier, "serial") == 0; }

Buffer to_buffer(const std::string& text) { return Buffer(text.begin(), text.end()); }

Buffer written(Writer& writer, Framing framing, const Buffer& frame, bool whole_file) {
  Packet packet;
  packet.framing = framing;
  packet.bytes = Bytes(frame.data(), frame.size());
  std::string out;
  if (whole_file) writer.begin(out);
  writer.write(packet, out);
  if (whole_file) writer.finish(out);
  return to_buffer(out);
}

Buffer hex_line(const Buffer& frame) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : frame) {
    out += kDigits[byte >> 4];
    out += kDigits[byte & 15];
  }
  return to_buffer(out + "\n");
}

}  // namespace

Buffer MessageMaker::noise(std::size_t size) {
  Buffer out(size);
  // Half of them small: only counts that fit let a decoder see what they count.
  for (std::uint8_t& byte : out) {
    byte = static_cast<std::uint8_t>(below(below(2) == 0 ? 4 : 256));
  }
  return out;
}

std::size_t MessageMaker::near_size(const reflect::Type& type, std::size_t room) {
  const std::size_t most = std::min<std::size_t>(type.max_size, room);
  const std::size_t least = std::min<std::size_t>(type.min_size, most);
  const std::size_t size = below(2) == 0 ? least : least + below(most - least + 1);
  const std::size_t beside = below(8);  // Mostly right, else one off.
  if (beside == 0 && size > 0) return size - 1;
  return std::min(beside == 1 ? size + 1 : size, room);
}

const reflect::Route& MessageMaker::pick(bool radio) {
  for (;;) {  // Every protocol has routes on the serial line.
    const reflect::Route& route = routes_.routes[below(routes_.count)];
    if (radio || is_serial(route)) return route;
  }
}

Buffer MessageMaker::frame(const reflect::Route& route) {
  const std::size_t most = is_serial(route) ? 255 : kRadioFrameRoom;
  const std::size_t room = std::min<std::size_t>(route.room, most - route.offset);
  Buffer out = noise(route.offset + near_size(*route.type, room));
  out[0] = 0;  // The dispatch byte of active messages.
  if (!is_serial(route)) {
    put(out, 0, 2, true, 0x8841);
    if (std::strcmp(route.carrier, "radio_i") == 0) out[9] = 0x3f;
  }
  for (std::size_t i = 0; i < route.choice_count; ++i) {
    const reflect::RouteChoice& choice = route.choices[i];
    put(out, choice.offset, choice.width_bytes, choice.little_endian, choice.value);
  }
  for (std::size_t i = 0; i < route.length_count; ++i) {
    const reflect::RouteLength& length = route.lengths[i];
    const std::size_t bytes = out.size() - std::min<std::size_t>(length.from, out.size());
    put(out, length.offset, length.width_bytes, length.little_endian,
        static_cast<std::uint32_t>(bytes));
  }
  return out;
}

Buffer MessageMaker::framed(Format format) {
  const bool capture = format == Format::kPcap || format == Format::kPcapng;
  const reflect::Route& route = pick(capture);
  Buffer bytes = frame(route);
  const Framing framing = is_serial(route) ? Framing::kSf : Framing::kRadio;
  switch (format) {
    case Format::kHdlc: {
      HdlcWriter writer;
      return written(writer, framing, bytes, false);
    }
    case Format::kSf:
      bytes.insert(bytes.begin(), static_cast<std::uint8_t>(bytes.size()));
      return bytes;
    case Format::kPcap: {
      PcapWriter writer(framing == Framing::kSf ? kLinkSf : kLinkRadioNoFcs);
      return written(writer, framing, bytes, true);
    }
    case Format::kPcapng: {
      PcapngWriter writer;
      return written(writer, framing, bytes, true);
    }
    case Format::kHex:
      return hex_line(bytes);
  }
  return bytes;
}

}  // namespace rubric::fuzz

/// Every fourth time a frame of a message stands in place of some of the input; else libFuzzer does
/// what it does. It cannot guess a check sum or five bytes that must agree.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  using namespace rubric;
  constexpr std::size_t kHead = 2;  // Format and split, see decode_fuzz.cc.
  fuzz::MessageMaker maker(rubicon::messages::kRoutes, seed);
  if (max_size < kHead || maker.below(4) != 0) {
    return fuzz::mutate_bytes(data, size, max_size, seed);
  }
  std::vector<std::uint8_t> input(data, data + size);
  if (size < kHead) {
    input.assign(kHead, 0x80);
    input[0] = static_cast<std::uint8_t>(maker.below(fuzz::kFormats));
  }
  const auto format = static_cast<fuzz::Format>(input[0] % fuzz::kFormats);
  const std::vector<std::uint8_t> framed = maker.framed(format);
  // A capture file begins with its header; in streams and text the frame may stand anywhere.
  const bool file = format == fuzz::Format::kPcap || format == fuzz::Format::kPcapng;
  const std::size_t at = kHead + (file ? 0 : maker.below(input.size() - kHead + 1));
  const std::size_t gone = maker.below(input.size() - at + 1);
  const auto where = input.begin() + static_cast<std::ptrdiff_t>(at);
  input.insert(input.erase(where, where + static_cast<std::ptrdiff_t>(gone)), framed.begin(),
               framed.end());
  const std::size_t kept = std::min(input.size(), max_size);
  std::memcpy(data, input.data(), kept);
  return kept;
}
