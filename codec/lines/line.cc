#include "codec/lines/line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

#include "codec/lines/broken.h"
#include "codec/lines/host_link.h"
#include "codec/lines/serial.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

/// How long a read waits, so that the caller can check in between whether to stop.
constexpr lines::Milliseconds kPatience{100};
constexpr lines::Milliseconds kAnswerTime{1000};

Address serial(std::string_view text, std::string_view rest) {
  Address out;
  const std::size_t colon = rest.rfind(':');
  const std::string_view speed = colon == rest.npos ? std::string_view{} : rest.substr(colon + 1);
  const auto baud = lines::baud_of(speed);
  if (!baud || colon == 0) {
    throw std::invalid_argument(fmt::format(
        "'{}': expected serial@DEVICE:BAUD, where BAUD is a usual speed or a platform such as "
        "telosb or micaz",
        text));
  }
  out.kind = Address::Kind::kSerial;
  out.device = rest.substr(0, colon);
  out.baud = *baud;
  return out;
}

Address network(Address::Kind kind, std::string_view text, std::string_view rest) {
  Address out{.kind = kind};
  try {
    if (rest.find(':') == rest.npos) throw std::invalid_argument("no port");
    out.at = lines::read_host_port(rest);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(fmt::format("'{}': expected HOST:PORT after the @", text));
  }
  return out;
}

// A port 0 is any that is free.
Address air(std::string_view text, std::string_view rest) {
  Address out{.kind = Address::Kind::kAir, .name = std::string(text)};
  if (rest == "0") {
    out.at = {"127.0.0.1", 0};
    return out;
  }
  try {
    out.at = lines::read_host_port(rest);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(fmt::format("'{}': expected zep:PORT or zep:HOST:PORT", text));
  }
  return out;
}

}  // namespace

std::optional<Address> parse_address(std::string_view text) {
  if (text.starts_with("zep:")) return air(text, text.substr(4));
  const std::size_t at = text.find('@');
  if (at == text.npos) return std::nullopt;
  const std::string_view scheme = text.substr(0, at);
  const std::string_view rest = text.substr(at + 1);
  Address out;
  if (scheme == "serial") {
    out = serial(text, rest);
  } else if (scheme == "network") {
    out = network(Address::Kind::kNetwork, text, rest);
  } else if (scheme == "sf") {
    out = network(Address::Kind::kForwarder, text, rest);
  } else {
    return std::nullopt;
  }
  out.name = text;
  return out;
}

Address required_address(std::string_view text) {
  const auto address = parse_address(text);
  if (address && address->kind != Address::Kind::kAir) return *address;
  throw std::invalid_argument(
      fmt::format("'{}': expected serial@DEVICE:BAUD, network@HOST:PORT or "
                  "sf@HOST:PORT",
                  text));
}

std::string default_address() {
  const char* const set = std::getenv("MOTECOM");
  return set != nullptr && *set != '\0' ? set : "sf@localhost:9002";
}

bool asked_by_motecom() { return ::isatty(0) != 0 && std::getenv("MOTECOM") != nullptr; }

InputFormat Line::format() const {
  return address_.kind == Address::Kind::kForwarder ? InputFormat::kSf : InputFormat::kHdlc;
}

void Line::open(lines::SteadyTime deadline) {
  stream_.close();  // A device is not had twice.
  began_ = address_.kind != Address::Kind::kForwarder;
  stream_ = address_.kind == Address::Kind::kSerial
                ? lines::open_serial_device(address_.device, address_.baud)
                : lines::connect_tcp(address_.at, deadline);
  if (address_.kind != Address::Kind::kForwarder) return;
  //= WIRE-SF-HANDSHAKE: A serial forwarder stream begins with the byte 0x55 and a version byte
  //= from each side.
  const std::uint8_t hello[] = {'U', ' '};
  stream_.write(Bytes(hello, sizeof hello), deadline);
}

std::size_t Line::read(MutableBytes out) { return read(out, steady_clock::now() + kPatience); }

std::size_t Line::read(MutableBytes out, lines::SteadyTime deadline) {
  try {
    const std::size_t size = stream_.read(out, deadline);
    began_ = began_ || size > 0;
    return size;
  } catch (const Broken&) {
    if (!began_) throw Broken(kTurnedAway);
    throw;
  }
}

void Line::answer(const Packet& packet) {
  if (mute_) return;
  std::uint8_t room[lines::kHostAnswerRoom];
  const std::size_t size = lines::host_answer(packet, MutableBytes(room, sizeof room));
  if (size > 0) stream_.write_or_keep(Bytes(room, size), steady_clock::now() + kAnswerTime);
}

}  // namespace rubric::lines
