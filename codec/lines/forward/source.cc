#include "codec/lines/forward/source.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "codec/containers/sf_reader.h"
#include "codec/lines/broken.h"
#include "codec/lines/serial.h"

namespace rubric::forward {
namespace {

constexpr std::size_t kReadBytes = 16 * 1024;

std::int64_t wall_ns() {
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

ReaderOptions reader_options(const std::string& name, Direction direction) {
  return {.direction = direction, .interface_name = name};
}

}  // namespace

Source::Source(Options options, Handlers handlers)
    : options_(std::move(options)),
      handlers_(std::move(handlers)),
      link_(
          options_.link, [this](const lines::HostLink::Outcome& done) { outcome(done); },
          reader_options(name(), Direction::kOutbound)) {}

std::size_t Source::packet_max() const {
  return is_forwarder() ? kSfPacketMax : lines::HostLink::kPacketBytesMax;
}

void Source::open(lines::SteadyTime now) {
  heard_bytes_ = 0;
  broken_.clear();
  const InputFormat format = is_forwarder() ? InputFormat::kSf : InputFormat::kHdlc;
  forwarded_ = make_reader(format, reader_options(name(), Direction::kOutbound));
  sent_ = make_reader(format, reader_options(name(), Direction::kInbound));
  if (options_.address.kind == lines::Address::Kind::kSerial) {
    stream_.close();
    stream_ = lines::open_serial_device(options_.address.device, options_.address.baud);
    return up(now);
  }
  if (!connector_) {
    connector_.emplace(resolve(options_.address.at.host, options_.address.at.port, false));
  }
  state_ = State::kConnecting;
  connector_->begin(now);
  if (connector_->connected()) connected(now);
}

void Source::connected(lines::SteadyTime now) {
  stream_ = connector_->take();
  if (!is_forwarder()) return up(now);
  state_ = State::kGreeting;
  greet_by_ = now + options_.patience;
  output_ = {kSfMagic, kSfVersion};
  write();
}

void Source::up(lines::SteadyTime now) {
  state_ = State::kUp;
  if (!given_.empty()) begin_given(now);
}

void Source::close(lines::SteadyTime now) {
  closing_ = true;
  auto last = [this](const Packet& packet) { heard(packet); };
  if (is_forwarder()) {
    if (forwarded_) forwarded_->finish(last);
  } else {
    link_.reset(now, last);
  }
  closing_ = false;
  output_.clear();
  stream_.close();
  if (connector_) connector_->close();
  state_ = State::kClosed;
}

int Source::socket() const {
  const bool has = options_.address.kind != lines::Address::Kind::kSerial;
  return has ? stream_.fd() : -1;
}

pollfd Source::wanted() const {
  if (state_ == State::kClosed) return {-1, 0, 0};
  if (state_ == State::kConnecting) return {connector_->fd(), POLLOUT, 0};
  return {stream_.fd(), static_cast<short>(POLLIN | (output().empty() ? 0 : POLLOUT)), 0};
}

std::optional<lines::SteadyTime> Source::next() const {
  if (state_ == State::kConnecting) return connector_->deadline();
  if (state_ == State::kGreeting) return greet_by_;
  if (state_ == State::kUp && !is_forwarder()) return link_.next();
  return std::nullopt;
}

void Source::turn(short found, lines::SteadyTime now) {
  if (state_ == State::kClosed) return;
  if (state_ == State::kConnecting) {
    connector_->go_on(found != 0, now);
    if (connector_->connected()) connected(now);
    return;
  }
  // A hangup shows when reading, after the bytes that had come before it.
  if (found & ~POLLOUT) read(now);
  if (state_ == State::kGreeting && now >= greet_by_) {
    throw lines::Broken("the other end does not begin a serial forwarder's connection");
  }
  link_.tick(now);
  write();
}

void Source::read(lines::SteadyTime now) {
  std::uint8_t room[kReadBytes];
  const ssize_t count = ::read(stream_.fd(), room, sizeof room);
  if (count < 0 && would_block(errno)) return;
  if (count <= 0) {
    const bool greeted = state_ != State::kGreeting || heard_bytes_ > 0;
    if (!greeted) throw lines::Broken(lines::kTurnedAway);
    throw lines::Broken(fmt::format("the line broke: {}",
                                    count == 0 ? "the other end closed it" : std::strerror(errno)));
  }
  const Bytes bytes(room, static_cast<std::size_t>(count));
  heard_bytes_ += bytes.size();
  auto take = [this](const Packet& packet) { heard(packet); };
  if (!is_forwarder()) return link_.take(bytes, now, take);
  forwarded_->feed(bytes, take);
  if (!broken_.empty()) throw lines::Broken(broken_);
  if (state_ == State::kGreeting && heard_bytes_ >= 2) up(now);
}

void Source::heard(const Packet& packet) {
  if (!broken_.empty()) return;
  if (packet.error.fault == Fault::kHandshake) {
    broken_ = "the other end is not a serial forwarder: it does not begin with 55 20";
    return;
  }
  if (handlers_.on_frame) {
    Packet stamped = packet;
    stamped.time_ns = wall_ns();
    handlers_.on_frame(stamped);
  }
  if (packet.error.fault != Fault::kNone) return handlers_.on_malformed();
  if (is_forwarder() || lines::brings_packet(packet)) handlers_.on_packet(packet.bytes);
}

void Source::send(Bytes packet, lines::SteadyTime now) {
  given_.assign(packet.begin(), packet.end());
  begin_given(now);
}

void Source::begin_given(lines::SteadyTime now) {
  const Bytes packet(given_.data(), given_.size());
  if (is_forwarder()) {
    output_.push_back(static_cast<std::uint8_t>(packet.size()));
    output_.insert(output_.end(), packet.begin(), packet.end());
  } else {
    link_.submit(packet, now);
  }
  write();
}

void Source::outcome(const lines::HostLink::Outcome& done) {
  if (closing_) return;  // Not its last word: it is begun anew when the line is back.
  given_.clear();
  handlers_.on_given(done.confirmed);
}

Bytes Source::output() const {
  return is_forwarder() ? Bytes(output_.data(), output_.size()) : link_.output();
}

void Source::write() {
  while (!output().empty()) {
    const Bytes bytes = output();
    ssize_t count = ::send(stream_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == ENOTSOCK) count = ::write(stream_.fd(), bytes.data(), bytes.size());
    if (count < 0 && would_block(errno)) return;
    if (count < 0) throw lines::Broken(fmt::format("the line broke: {}", std::strerror(errno)));
    written(static_cast<std::size_t>(count));
  }
}

void Source::written(std::size_t count) {
  auto seen = [this](const Packet& packet) {
    if (!handlers_.on_frame) return;
    Packet stamped = packet;
    stamped.time_ns = wall_ns();
    handlers_.on_frame(stamped);
  };
  sent_->feed(output().first(count), seen);
  if (!is_forwarder()) return link_.written(count);
  output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(count));
  if (is_up() && output_.empty() && !given_.empty()) {
    given_.clear();
    handlers_.on_given(true);
  }
}

}  // namespace rubric::forward
