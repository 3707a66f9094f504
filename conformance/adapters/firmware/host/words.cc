#include "conformance/adapters/firmware/host/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "conformance/adapters/firmware/bench/records.h"

namespace rubric::firmware {
namespace {

// Kinds of arguments: b 8, w 16, l 32 bits, f real, a address, c channel, d bytes up to the end.
struct Word {
  std::uint8_t code;
  const char* name;
  const char* kinds;
};

template <class Code>
constexpr Word word(Code code, const char* name, const char* kinds) {
  return {static_cast<std::uint8_t>(code), name, kinds};
}

constexpr std::array kCalls{
    word(CallCode::kJoin, "join", "bwb"),
    word(CallCode::kSend, "send", "abbd"),
    word(CallCode::kInterface, "interface", "bb"),
    word(CallCode::kGetInterface, "get_interface", "b"),
    word(CallCode::kCreateOut, "create_out", "abb"),
    word(CallCode::kCreateIn, "create_in", "abb"),
    word(CallCode::kDispose, "dispose", "c"),
    word(CallCode::kStart, "start", "c"),
    word(CallCode::kStop, "stop", "c"),
    word(CallCode::kStartAll, "start_all", ""),
    word(CallCode::kStopAll, "stop_all", ""),
    word(CallCode::kWriteOutput, "write_output", "cbf"),
    word(CallCode::kReadInput, "read_input", "cb"),
    word(CallCode::kSetTimeStep, "set_time_step", "w"),
    word(CallCode::kSetIslandId, "set_island_id", "w"),
    word(CallCode::kGetClock, "get_clock", ""),
};

constexpr std::array kEvents{
    word(EventCode::kJoined, "joined", "ab"),
    word(EventCode::kMoteJoined, "mote_joined", "abwb"),
    word(EventCode::kReceived, "received", "abd"),
    word(EventCode::kAckReceived, "ack_received", "bwb"),
    word(EventCode::kSynData, "syn_data", "cb"),
    word(EventCode::kSendResult, "send_result", "w"),
    word(EventCode::kChannelResult, "channel_result", "cb"),
    word(EventCode::kOpResult, "op_result", "b"),
    word(EventCode::kInputValue, "input_value", "fb"),
    word(EventCode::kInterfaceState, "interface_state", "bb"),
    word(EventCode::kClock, "clock", "l"),
    word(EventCode::kMoteLeft, "mote_left", "a"),
};

// A record has no room for more data, and a node refuses as much already.
constexpr std::size_t kDataMax = 101;

void put16(ByteVector& out, std::uint32_t value) {
  out.push_back(static_cast<std::uint8_t>(value >> 8));
  out.push_back(static_cast<std::uint8_t>(value));
}

void put_pair(ByteVector& out, std::string_view value, std::string_view between) {
  const std::size_t at = value.find(between);
  if (at == std::string_view::npos) throw BadWord(fmt::format("no {} in {}", between, value));
  put16(out, number_of(value.substr(0, at), 0xFFFF));
  put16(out, number_of(value.substr(at + between.size()), 0xFFFF));
}

void put_real(ByteVector& out, std::string_view value) {
  float real = 0;
  const auto end = std::from_chars(value.data(), value.data() + value.size(), real);
  if (end.ptr != value.data() + value.size()) throw BadWord(fmt::format("{} is not a real", value));
  const std::uint32_t bits = bits_of_float(real);
  put16(out, bits >> 16);
  put16(out, bits & 0xFFFF);
}

void put(ByteVector& out, char kind, std::string_view value) {
  switch (kind) {
    case 'b': out.push_back(static_cast<std::uint8_t>(number_of(value, 0xFF))); return;
    case 'w': return put16(out, number_of(value, 0xFFFF));
    case 'a': return put_pair(out, value, ":");
    case 'c': return put_pair(out, value, "->");
    case 'f': return put_real(out, value);
    default: {
      if (value.empty() || value[0] != 'x') throw BadWord(fmt::format("{} is not x...", value));
      const ByteVector data = bytes_of_hex(value.substr(1));
      out.insert(out.end(), data.begin(),
                 data.begin() + static_cast<std::ptrdiff_t>(std::min(data.size(), kDataMax)));
    }
  }
}

// Takes an argument from the front of `body`.
std::string take(Bytes& body, char kind) {
  constexpr std::array<std::pair<char, std::size_t>, 6> kSizes{
      {{'b', 1}, {'w', 2}, {'l', 4}, {'f', 4}, {'a', 4}, {'c', 4}}};
  std::size_t size = body.size();
  for (const auto& [name, bytes] : kSizes) {
    if (name == kind) size = bytes;
  }
  if (size > body.size()) throw BadWord("an event of the board is too short");
  const Bytes one = body.first(size);
  body = body.from(size);
  switch (kind) {
    case 'b': return fmt::format("{}", one[0]);
    case 'w': return fmt::format("{}", load_be16(one.data()));
    case 'l': return fmt::format("{}", load_be32(one.data()));
    case 'f': return fmt::format("{}", float_of_bits(load_be32(one.data())));
    case 'a': return fmt::format("{}:{}", load_be16(one.data()), load_be16(one.data() + 2));
    case 'c': return fmt::format("{}->{}", load_be16(one.data()), load_be16(one.data() + 2));
    default: return "x" + hex_of_bytes(one);
  }
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(at), text.size());
    if (end > 0) words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

std::uint32_t number_of(std::string_view word, std::uint32_t max) {
  std::uint32_t value = 0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end.ec != std::errc{} || end.ptr != word.data() + word.size() || value > max) {
    throw BadWord(fmt::format("{} is not a number up to {}", word, max));
  }
  return value;
}

ByteVector bytes_of_hex(std::string_view hex) {
  ByteVector bytes;
  if (hex.size() % 2 != 0) throw BadWord("half a byte");
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    std::uint8_t byte = 0;
    const char* const at = hex.data() + i;
    if (std::from_chars(at, at + 2, byte, 16).ptr != at + 2) throw BadWord("no hex digits");
    bytes.push_back(byte);
  }
  return bytes;
}

std::string hex_of_bytes(Bytes bytes) { return fmt::format("{:02x}", fmt::join(bytes, "")); }

ByteVector call_record(std::string_view text) {
  const std::size_t open = text.find('(');
  if (open == std::string_view::npos || text.back() != ')') {
    throw BadWord(fmt::format("{} is not a call", text));
  }
  const std::string_view name = text.substr(0, open);
  const auto* const call =
      std::find_if(kCalls.begin(), kCalls.end(), [&](const Word& one) { return one.name == name; });
  if (call == kCalls.end()) throw BadWord(fmt::format("there is no call {}", name));
  const auto arguments = split(text.substr(open + 1, text.size() - open - 2));
  const std::string_view kinds = call->kinds;
  if (arguments.size() != kinds.size()) {
    throw BadWord(fmt::format("{} has {} arguments", name, kinds.size()));
  }
  ByteVector out{call->code};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    put(out, kinds[i], arguments[i].substr(arguments[i].find('=') + 1));
  }
  return out;
}

std::string event_text(Bytes body) {
  const auto* const event = std::find_if(kEvents.begin(), kEvents.end(), [&](const Word& one) {
    return !body.empty() && one.code == body[0];
  });
  if (event == kEvents.end()) throw BadWord("the board sends an event that there is not");
  Bytes rest = body.from(1);
  std::string arguments;
  for (const char* kind = event->kinds; *kind != '\0'; ++kind) {
    arguments += (arguments.empty() ? "" : " ") + take(rest, *kind);
  }
  return fmt::format("{}({})", event->name, arguments);
}

}  // namespace rubric::firmware
