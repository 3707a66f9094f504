#include "tools/commands/run/serial_end.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "codec/lines/address.h"
#include "codec/lines/broken.h"
#include "codec/lines/forwarder.h"
#include "codec/lines/serial.h"
#include "codec/text/text.h"
#include "tools/commands/run/pty_line.h"

namespace rubric::run {
namespace {

using lines::Broken;
using lines::ByteStream;
using lines::Milliseconds;
using lines::SteadyTime;
using std::chrono::steady_clock;

constexpr Milliseconds kFirstPause{250};
constexpr Milliseconds kLongestPause{4000};
constexpr Milliseconds kOpenTime{1000};
constexpr Milliseconds kSendTime{3000};

// Returns the next program that connects; no descriptor where there is none.
lines::Descriptor accepted(const lines::Descriptor& listener) {
  return lines::Descriptor(
      ::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
}

}  // namespace

SerialEnd::SerialEnd(const lines::Address& to) : name_(to.name), pause_(kFirstPause) {
  const lines::Address address = to;
  switch (to.kind) {
    case lines::Address::Kind::kSerial:
      line_ = std::make_unique<lines::SerialLine>([address](SteadyTime) {
        return lines::open_serial_device(address.device, address.baud);
      });
      break;
    case lines::Address::Kind::kNetwork:
      line_ = std::make_unique<lines::SerialLine>(
          [address](SteadyTime deadline) { return lines::connect_tcp(address.at, deadline); });
      break;
    case lines::Address::Kind::kForwarder:
    case lines::Address::Kind::kAir:
      line_ = std::make_unique<lines::ForwarderLine>(
          [address](SteadyTime deadline) { return lines::connect_tcp(address.at, deadline); });
  }
}

SerialEnd::SerialEnd(const std::string& offered) : waits_for_others_(true), pause_(kFirstPause) {
  if (offered == "pty") {
    auto pty = std::make_unique<PtyLine>();
    name_ = fmt::format("serial@{}:115200", pty->device());
    other_end_ = name_;
    line_ = std::move(pty);
    open_ = line_->open({});
    return;
  }
  const auto port = static_cast<std::uint16_t>(std::stoul(offered.substr(offered.find(':') + 1)));
  listener_ = std::make_shared<lines::Descriptor>(lines::listen_at("127.0.0.1", port));
  const std::uint16_t taken = lines::address_here(listener_->get()).port();
  name_ = fmt::format("sf-server:{}", taken);
  other_end_ = fmt::format("sf@127.0.0.1:{}", taken);
  line_ = std::make_unique<lines::ForwarderLine>([listener = listener_](SteadyTime) {
    lines::Descriptor other = accepted(*listener);
    if (other.get() < 0) throw Broken("nobody has connected");
    return ByteStream(std::move(other));
  });
}

bool SerialEnd::open() {
  const SteadyTime now = steady_clock::now();
  if (now < next_try_) return false;
  if (open_) {
    turn_another_away();
    return false;
  }
  try {
    line_->open(now + kOpenTime);
    open_ = true;
    said_ = turned_away_ = false;
    pause_ = kFirstPause;
    text::print(stderr, "rubric: {}: connected\n", name_);
  } catch (const Broken& broken) {
    if (!waits_for_others_) lost(broken.what());
    next_try_ = steady_clock::now() + (waits_for_others_ ? kFirstPause / 5 : pause_);
    pause_ = std::min(2 * pause_, kLongestPause);
  }
  return open_;
}

// Without a word, a second program would wait for ever.
void SerialEnd::turn_another_away() {
  if (!listener_) return;
  next_try_ = steady_clock::now() + kFirstPause;
  if (accepted(*listener_).get() < 0 || std::exchange(turned_away_, true)) return;
  text::print(stderr, "rubric: {}: another program was turned away: one at a time is served\n",
              name_);
}

void SerialEnd::lost(const std::string& why) {
  open_ = false;
  if (!said_) text::print(stderr, "rubric: {}: {}\n", name_, why);
  said_ = true;
}

bool SerialEnd::send(const std::vector<std::uint8_t>& packet) {
  if (!open_) return false;
  try {
    line_->send(packet, steady_clock::now() + kSendTime);
    return true;
  } catch (const Broken& broken) {
    lost(broken.what());
    return false;
  }
}

std::vector<std::uint8_t> SerialEnd::receive(SteadyTime deadline) {
  if (!open_) return {};
  try {
    auto packet = line_->receive(deadline);
    return packet ? std::move(packet->bytes) : std::vector<std::uint8_t>();
  } catch (const Broken& broken) {
    lost(broken.what());
    return {};
  }
}

}  // namespace rubric::run
