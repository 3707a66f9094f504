#include "tools/live/sender.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "codec/containers/sf_reader.h"
#include "conformance/runner/target.h"
#include "tools/live/stop.h"

namespace rubric::live {
namespace {

using attach::HostLink;
using attach::Milliseconds;
using attach::SteadyTime;
using runner::TargetBroken;
using std::chrono::steady_clock;

constexpr Milliseconds kOpenTime{1000};
constexpr Milliseconds kGreetTime{5000};
constexpr Milliseconds kWriteTime{5000};
constexpr Milliseconds kCloseTime{500};
/// How long is waited for anything before it is asked whether to stop: a signal may come just
/// before the wait begins.
constexpr Milliseconds kPatience{100};

ReaderOptions reader_options(const std::string& name) {
  ReaderOptions options;
  options.direction = Direction::kOutbound;
  options.interface_name = name;
  return options;
}

}  // namespace

Sender::Sender(Address address, const attach::HostLinkOptions& options, OnFrame on_frame)
    : line_(std::move(address), false),
      on_frame_(std::move(on_frame)),
      link_(options, [this](const HostLink::Outcome& outcome) { outcome_ = outcome; },
            reader_options(line_.address().name)),
      reader_(make_reader(InputFormat::kSf, reader_options(line_.address().name))) {}

std::size_t Sender::packet_bytes_max() const {
  return confirms() ? HostLink::kPacketBytesMax : kSfPacketMax;
}

void Sender::open() {
  line_.open(steady_clock::now() + kOpenTime);
  if (!confirms()) greet();
}

// The first bytes say whether there is a forwarder at all: it confirms nothing of what it gets.
void Sender::greet() {
  const SteadyTime deadline = steady_clock::now() + kGreetTime;
  std::uint8_t hello[2] = {};
  std::size_t size = 0;
  while (size < sizeof hello) {
    if (stop_requested()) return;
    if (steady_clock::now() >= deadline) {
      throw TargetBroken("the other end does not begin a serial forwarder's connection");
    }
    size += line_.read(MutableBytes(hello + size, sizeof hello - size),
                       steady_clock::now() + kPatience);
  }
  if (hello[0] != kSfMagic || hello[1] < kSfVersion) {
    throw TargetBroken(fmt::format("the other end is no serial forwarder's: it begins with "
                                   "{:02x} {:02x}, not with 55 20", hello[0], hello[1]));
  }
  auto nothing = [](const Packet&) {};
  reader_->feed(Bytes(hello, sizeof hello), nothing);
}

Sender::Result Sender::result_of(const HostLink::Outcome& outcome) const {
  Result result;
  result.done = outcome.confirmed;
  result.tries = outcome.tries;
  result.strange_acks = outcome.strange_acks;
  result.took = std::chrono::duration_cast<Milliseconds>(outcome.ended - outcome.begun);
  return result;
}

Sender::Result Sender::send(Bytes packet) {
  if (!confirms()) return send_to_forwarder(packet);
  std::string broken;
  outcome_.reset();
  try {
    const HostLink::Submitted submitted = link_.submit(packet, steady_clock::now());
    if (submitted != HostLink::Submitted::kTaken) throw std::logic_error("no packet of this line");
    while (!outcome_ && !stop_requested()) {
      step(link_.next().value_or(steady_clock::now()), -1);
    }
  } catch (const TargetBroken& error) {
    broken = error.what();
  }
  if (!outcome_) link_.reset(steady_clock::now());
  Result result = result_of(*outcome_);
  result.broken = std::move(broken);
  return result;
}

Sender::Result Sender::send_to_forwarder(Bytes packet) {
  Result result;
  //= WIRE-SF-LENGTH: A serial forwarder packet is a length byte of 1 to 255 and that many bytes
  //= from the dispatch byte on.
  std::vector<std::uint8_t> out{static_cast<std::uint8_t>(packet.size())};
  out.insert(out.end(), packet.begin(), packet.end());
  const SteadyTime begun = steady_clock::now();
  try {
    result.tries = 1;
    line_.write(Bytes(out.data(), out.size()), begun + kWriteTime);
    result.done = true;
  } catch (const TargetBroken& error) {
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

// Waits once, at most until then, and does what there is to do. Whether `fd` is ready.
bool Sender::step(SteadyTime until, int fd) {
  flush();
  const auto left = std::chrono::ceil<Milliseconds>(until - steady_clock::now());
  pollfd both[] = {{line_.fd(), POLLIN, 0}, {fd, POLLIN, 0}};
  const auto wait = std::clamp(left, Milliseconds{0}, kPatience);
  const int ready = ::poll(both, 2, static_cast<int>(wait.count()));
  if (ready < 0 && errno != EINTR) throw TargetBroken(std::strerror(errno));
  if (ready > 0 && both[0].revents != 0) read();
  link_.tick(steady_clock::now());
  flush();
  return ready > 0 && both[1].revents != 0;
}

void Sender::read() {
  std::uint8_t room[4096];
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
}

void Sender::flush() {
  if (link_.output().empty()) return;
  line_.write(link_.output(), steady_clock::now() + kWriteTime);
  link_.written(link_.output().size());
}

// To close a connection with bytes unread may cost the other end what it has not read yet.
void Sender::close() {
  const SteadyTime deadline = steady_clock::now() + kCloseTime;
  try {
    line_.end_output();
    std::uint8_t room[4096];
    while (line_.address().kind != Address::Kind::kSerial && steady_clock::now() < deadline) {
      line_.read(MutableBytes(room, sizeof room), deadline);
    }
  } catch (const TargetBroken&) {  // As it should: the other end closed it, too.
  }
  line_.close();
}

}  // namespace rubric::live
