#include "codec/lines/sender.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "codec/containers/sf_reader.h"
#include "codec/lines/broken.h"
#include "codec/lines/stop.h"

namespace rubric::lines {
namespace {

using lines::HostLink;
using lines::Milliseconds;
using lines::SteadyTime;
using std::chrono::steady_clock;

constexpr Milliseconds kOpenTime{1000};
constexpr Milliseconds kGreetTime{5000};
constexpr Milliseconds kWriteTime{5000};
constexpr Milliseconds kCloseTime{5000};
constexpr Milliseconds kQuietTime{500};
/// How long any wait takes before checking whether to stop: a signal may come just
/// before the wait begins.
constexpr Milliseconds kSendPatience{100};
constexpr std::size_t kReadBytes = 4096;
/// A forwarder that sends more than so many times kReadBytes at once is read on after the packet.
constexpr int kReadsMost = 256;

ReaderOptions reader_options(const std::string& name) {
  return {.direction = Direction::kOutbound, .interface_name = name};
}

}  // namespace

Sender::Sender(Address address, const lines::HostLinkOptions& options, OnFrame on_frame)
    : line_(std::move(address), false),
      on_frame_(std::move(on_frame)),
      link_(
          options, [this](const HostLink::Outcome& outcome) { outcome_ = outcome; },
          reader_options(line_.address().name)),
      reader_(make_reader(InputFormat::kSf, reader_options(line_.address().name))) {}

std::size_t Sender::packet_bytes_max() const {
  return confirms() ? HostLink::kPacketBytesMax : kSfPacketMax;
}

void Sender::open() {
  line_.open(steady_clock::now() + kOpenTime);
  if (!confirms()) greet();
}

// Checks the first bytes, which show whether there is a forwarder at all: it confirms nothing.
void Sender::greet() {
  const SteadyTime deadline = steady_clock::now() + kGreetTime;
  std::uint8_t hello[2] = {};
  std::size_t size = 0;
  while (size < sizeof hello) {
    if (stop_requested()) return;
    if (steady_clock::now() >= deadline) {
      throw Broken("the other end does not begin a serial forwarder's connection");
    }
    size += line_.read(MutableBytes(hello + size, sizeof hello - size),
                       steady_clock::now() + kSendPatience);
  }
  if (hello[0] != kSfMagic || hello[1] < kSfVersion) {
    throw Broken(
        fmt::format("the other end is not a serial forwarder's: it begins with "
                    "{:02x} {:02x}, not with 55 20",
                    hello[0], hello[1]));
  }
  auto nothing = [](const Packet&) {};
  reader_->feed(Bytes(hello, sizeof hello), nothing);
}

Sender::Result Sender::result_of(const HostLink::Outcome& outcome) const {
  return {.done = outcome.confirmed,
          .tries = outcome.tries,
          .strange_acks = outcome.strange_acks,
          .took = std::chrono::duration_cast<Milliseconds>(outcome.ended - outcome.begun)};
}

Sender::Result Sender::send(Bytes packet) {
  if (!confirms()) return send_to_forwarder(packet);
  std::string broken;
  outcome_.reset();
  try {
    const HostLink::Submitted submitted = link_.submit(packet, steady_clock::now());
    if (submitted != HostLink::Submitted::kTaken) throw std::logic_error("no packet of this line");
    while (!outcome_ && !stop_requested()) step(link_.next().value_or(steady_clock::now()), -1);
  } catch (const Broken& error) {
    broken = error.what();
  }
  if (!outcome_) link_.reset(steady_clock::now());
  Result result = result_of(*outcome_);
  result.broken = std::move(broken);
  return result;
}

Sender::Result Sender::send_to_forwarder(Bytes packet) {
  Result result;
  const SteadyTime begun = steady_clock::now();
  try {
    // Some forwarders cut off a client that lags behind, others wait for it.
    for (int i = 0; i < kReadsMost && read() == kReadBytes; ++i) continue;
    //= WIRE-SF-LENGTH: A serial forwarder packet is a length byte of 1 to 255 and that many bytes
    //= from the dispatch byte on.
    out_.push_back(static_cast<std::uint8_t>(packet.size()));
    out_.insert(out_.end(), packet.begin(), packet.end());
    result.tries = 1;
    flush();
    while (!out_.empty() && !stop_requested()) step(steady_clock::now() + kSendPatience, -1);
    result.done = out_.empty();
  } catch (const Broken& error) {
    result.broken = error.what();
  }
  result.took = std::chrono::duration_cast<Milliseconds>(steady_clock::now() - begun);
  return result;
}

bool Sender::hear(SteadyTime until, int fd) {
  while (!stop_requested()) {
    if (step(until, fd)) return true;
    if (steady_clock::now() >= until) return false;
  }
  return false;
}

// Waits once, at most until then, and does what is due. Returns whether `fd` is ready.
bool Sender::step(SteadyTime until, int fd) {
  flush();
  const auto left = std::chrono::ceil<Milliseconds>(until - steady_clock::now());
  const auto wanted = static_cast<short>(POLLIN | (output().empty() ? 0 : POLLOUT));
  pollfd both[] = {{line_.fd(), wanted, 0}, {fd, POLLIN, 0}};
  const auto wait = std::clamp(left, Milliseconds{0}, kSendPatience);
  const int ready = ::poll(both, 2, static_cast<int>(wait.count()));
  if (ready < 0 && errno != EINTR) throw Broken(std::strerror(errno));
  if (ready > 0 && (both[0].revents & ~POLLOUT) != 0) read();
  link_.tick(steady_clock::now());
  flush();
  return ready > 0 && both[1].revents != 0;
}

// Reads and returns how many bytes there were, at most kReadBytes.
std::size_t Sender::read() {
  std::uint8_t room[kReadBytes];
  const SteadyTime now = steady_clock::now();
  const std::size_t size = line_.read(MutableBytes(room, sizeof room), now);
  const std::int64_t now_ns =
      std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  auto deliver = [&](const Packet& packet) {
    Packet stamped = packet;
    stamped.time_ns = now_ns;
    on_frame_(stamped);
  };
  if (confirms()) {
    link_.take(Bytes(room, size), now, deliver);
  } else {
    reader_->feed(Bytes(room, size), deliver);
  }
  return size;
}

Bytes Sender::output() const {
  return confirms() ? link_.output() : Bytes(out_.data(), out_.size());
}

void Sender::written(std::size_t count) {
  if (confirms()) return link_.written(count);
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(count));
}

// Writes as much as the line takes now: waiting for the rest without reading would last for ever if
// the other end did the same.
void Sender::flush() {
  while (!output().empty()) {
    const std::size_t count = line_.write_some(output());
    if (count == 0) {
      const SteadyTime now = steady_clock::now();
      if (!stuck_since_) stuck_since_ = now;
      if (now - *stuck_since_ >= kWriteTime) throw Broken("the line takes no more bytes");
      return;
    }
    stuck_since_.reset();
    written(count);
  }
}

// Reads before closing: unread bytes may cost the other end its own unread ones.
void Sender::close() {
  const SteadyTime deadline = steady_clock::now() + kCloseTime;
  bool quiet = line_.address().kind == Address::Kind::kSerial;
  try {
    line_.end_output();
    std::uint8_t room[kReadBytes];
    while (!quiet && steady_clock::now() < deadline) {
      const SteadyTime until = std::min(deadline, steady_clock::now() + kQuietTime);
      quiet = line_.read(MutableBytes(room, sizeof room), until) == 0;
    }
  } catch (const Broken&) {  // Expected: the other end closed it, too.
  }
  line_.close();
}

}  // namespace rubric::lines
