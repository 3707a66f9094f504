#include "codec/lines/forward/server.h"

#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "codec/lines/broken.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"

namespace rubric::forward {
namespace {

using lines::Milliseconds;
using std::chrono::steady_clock;

constexpr int kSilentPatiences = 6;  // A client may be silent so long when places are rare.
constexpr Milliseconds kReconnectEvery{1000};
// Packets within this time go to a client in one piece. The first packet after a pause does not
// wait.
constexpr Milliseconds kGather{2};
constexpr Milliseconds kDrainTime{1000};
constexpr Milliseconds kNoRoomPause{1000};
constexpr int kAcceptedAtOnce = 64;
constexpr rlim_t kOtherDescriptors = 32;  // Besides those of clients.

Source::Options limited(Source::Options options, Milliseconds patience) {
  options.patience = patience;
  return options;
}

// Returns as many of these clients as there can be descriptors for, so that the source always has
// its own.
std::size_t clients_possible(std::size_t wanted) {
  const rlim_t needed = wanted + kOtherDescriptors;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return wanted;
  limit.rlim_cur = std::min(needed, limit.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &limit);
  ::getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur >= needed) return wanted;
  const rlim_t left = std::max(limit.rlim_cur, kOtherDescriptors + 1) - kOtherDescriptors;
  text::print(stderr, "rubric: no more than {} clients at once: only {} descriptors are allowed\n",
              left, limit.rlim_cur);
  return static_cast<std::size_t>(left);
}

}  // namespace

Server::Server(const ServerOptions& options)
    : options_(options),
      listener_(listen_at(options.bind, options.port)),
      here_(address_here(listener_.get())),
      source_(limited(options.source, options.limits.patience), handlers()),
      backlog_(options.backlog_bytes) {
  options_.limits.packet_max = source_.packet_max();
  options_.clients_max = clients_possible(options.clients_max);
  if (!options.write.empty()) capture_.emplace(options.write, options.write_mode, options.rotation);
}

Source::Handlers Server::handlers() {
  Source::Handlers out;
  if (!options_.write.empty()) {
    out.on_frame = [this](const Packet& frame) { capture_->write(frame, source_.name()); };
  }
  out.on_packet = [this](Bytes bytes) { on_packet(bytes); };
  out.on_malformed = [this] { ++counts_.malformed; };
  out.on_given = [this](bool confirmed) { on_given(confirmed); };
  return out;
}

void Server::on_packet(Bytes bytes) {
  if (options_.passes && !options_.passes(bytes)) {
    ++counts_.withheld;
    return;
  }
  const auto size = static_cast<std::uint8_t>(bytes.size());
  backlog_.append(Bytes(&size, 1));
  backlog_.append(bytes);
  ++counts_.from_source;
}

void Server::on_given(bool confirmed) {
  ++(confirmed ? counts_.to_source : counts_.unconfirmed);
  if (confirmed == !unconfirmed_) return;
  unconfirmed_ = !confirmed;
  text::print(stderr, "rubric: {}: {}\n", source_.name(),
              confirmed ? "the mote confirms packets again"
                        : "the mote does not confirm a packet; it is given up (said once)");
}

void Server::announce() {
  if (announced_) return;
  announced_ = true;
  text::print(stdout, "listening on {}\n", here_.text());
  std::fflush(stdout);
  if (here_.is_loopback()) return;
  text::print(stderr,
              "rubric: WARNING: {} can be reached from other hosts: everybody who connects there "
              "reads all packets and can send to the motes\n",
              here_.text());
}

void Server::open_source(Time now) {
  open_at_.reset();
  try {
    source_.open(now);
    connected();
  } catch (const lines::Broken& broken) {
    lose_source(broken.what(), now);
  }
}

void Server::turn_source(short found, Time now) {
  const std::optional<Time> due = source_.next();
  if (found == 0 && !(due && *due <= now)) return;
  try {
    const bool was_up = source_.is_up();
    source_.turn(found, now);
    if (!was_up) connected();
  } catch (const lines::Broken& broken) {
    lose_source(broken.what(), now);
  }
}

// Handles that the source is up.
void Server::connected() {
  if (source_.socket() >= 0) {
    const SocketAddress peer = address_of_peer(source_.socket());
    const SocketAddress mine = here_.is_any() ? address_here(source_.socket()) : here_;
    if (peer.port() == here_.port() && peer.same_host(mine)) {
      throw lines::Broken("this is where this forwarder itself listens");
    }
  }
  if (!source_.is_up()) return;
  if (capture_ && !capture_->is_started() && !capture_->open()) {
    over_ = true;
    return;
  }
  announce();
  if (std::exchange(lost_, false)) text::print(stderr, "rubric: {}: again\n", source_.name());
}

void Server::lose_source(const std::string& why, Time now) {
  source_.close(now);
  if (!std::exchange(lost_, true)) text::print(stderr, "rubric: {}: {}\n", source_.name(), why);
  over_ = !options_.reconnect;
  if (over_) return;
  announce();
  open_at_ = now + kReconnectEvery;
}

// Passes on one packet of each client in turn, as long as the source takes them.
void Server::give_packets(Time now) {
  const bool mute = options_.source.link.listen_only;
  for (std::size_t idle = 0; idle < clients_.size() && (mute || source_.takes());) {
    Client& client = *clients_[turn_++ % clients_.size()];
    const std::optional<Bytes> packet = client.packet();
    if (!packet) {
      ++idle;
      continue;
    }
    idle = 0;
    if (mute) {
      ++counts_.not_sent;
    } else {
      try {
        source_.send(*packet, now);
      } catch (const lines::Broken& broken) {
        lose_source(broken.what(), now);
      }
    }
    client.drop_packet();
  }
}

void Server::accept_clients(Time now) {
  accept_at_.reset();
  for (int count = 0; count < kAcceptedAtOnce; ++count) {
    // Clients are only dropped after all were checked, as before the first new one here.
    if (count > 0 && clients_.size() >= options_.clients_max) return;
    lines::Descriptor socket(
        ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.is_open()) {
      admit(std::move(socket), now);
    } else if (would_block(errno)) {
      return;
    } else if (errno != ECONNABORTED) {
      if (!std::exchange(full_, true)) {
        text::print(stderr, "rubric: cannot take another client: {}\n", std::strerror(errno));
      }
      accept_at_ = now + kNoRoomPause;
      return;
    }
  }
}

void Server::admit(lines::Descriptor socket, Time now) {
  const std::string name = address_of_peer(socket.get()).text();
  if (clients_.size() >= options_.clients_max && !make_room(now)) {
    ++counts_.refused;
    if (!std::exchange(full_, true)) {
      text::print(stderr, "rubric: client {} is refused: there are {} already (--clients)\n", name,
                  clients_.size());
    }
    return;
  }
  ++counts_.served;
  if (options_.verbose) text::print(stderr, "rubric: client {} has come\n", name);
  clients_.push_back(
      std::make_unique<Client>(std::move(socket), name, backlog_.end(), options_.limits, now));
}

// Makes room: clients that have left give way, even if the source has not taken their packets; then
// the one that has been silent for longest, since many that only listen must not lock others out.
bool Server::make_room(Time now) {
  const auto gone = std::find_if(clients_.begin(), clients_.end(),
                                 [](const auto& client) { return client->has_left(); });
  if (gone == clients_.end()) return end_most_silent(now);
  counts_.not_sent += (*gone)->packets_waiting();
  text::print(stderr, "rubric: client {} has left; {} packets of it are given up\n",
              (*gone)->name(), (*gone)->packets_waiting());
  clients_.erase(gone);
  return true;
}

bool Server::end_most_silent(Time now) {
  const auto silent =
      std::min_element(clients_.begin(), clients_.end(),
                       [](const auto& a, const auto& b) { return a->heard() < b->heard(); });
  const auto time = now - (*silent)->heard();
  if (time < kSilentPatiences * options_.limits.patience) return false;
  text::print(stderr, "rubric: client {} gives way: it has sent nothing for {:.0f} s\n",
              (*silent)->name(), std::chrono::duration<double>(time).count());
  ++counts_.cut_off;
  clients_.erase(silent);
  return true;
}

void Server::write_clients(Time now) {
  for (const auto& client : clients_) client->write(backlog_, now);
  written_end_ = backlog_.end();
  written_at_ = now;
}

void Server::remove_clients() {
  const auto done = [this](const std::unique_ptr<Client>& client) {
    if (!client->fault().empty()) {
      ++counts_.cut_off;
      counts_.not_sent += client->packets_waiting();
      text::print(stderr, "rubric: client {} is cut off: {}\n", client->name(), client->fault());
      return true;
    }
    if (!client->is_over()) return false;
    if (options_.verbose) text::print(stderr, "rubric: client {} has left\n", client->name());
    return true;
  };
  if (std::erase_if(clients_, done) > 0) full_ = false;
}

// Delivers the source's last output to all who take it.
void Server::drain() {
  listener_.close();  // No new clients: their waiting must not keep this awake.
  const Time end = steady_clock::now() + kDrainTime;
  while (true) {
    write_clients(steady_clock::now());
    remove_clients();
    const bool served = std::all_of(clients_.begin(), clients_.end(), [this](const auto& client) {
      return client->is_served(backlog_);
    });
    if (served || lines::stop_requested() || steady_clock::now() >= end) return;
    wait(end);
    for (std::size_t i = 2; i < polled_.size(); ++i) {
      clients_[i - 2]->turn(polled_[i].revents, backlog_, steady_clock::now());
    }
  }
}

bool Server::write_due(Time now) const {
  const std::uint64_t waiting = backlog_.end() - written_end_;
  return waiting > 0 && (now >= written_at_ + kGather || waiting > backlog_.size_bytes() / 4);
}

std::optional<Server::Time> Server::next() const {
  std::optional<Time> out;
  const auto at = [&out](std::optional<Time> time) {
    if (time && (!out || *time < *out)) out = time;
  };
  at(open_at_);
  at(accept_at_);
  at(source_.next());
  if (backlog_.end() != written_end_) at(written_at_ + kGather);
  for (const auto& client : clients_) at(client->deadline());
  return out;
}

void Server::wait(std::optional<Time> until) {
  polled_.clear();
  polled_.push_back({accept_at_ ? -1 : listener_.get(), POLLIN, 0});
  polled_.push_back(source_.wanted());
  for (const auto& client : clients_) polled_.push_back({client->poll_fd(), client->events(), 0});
  timespec left{};
  if (until) {
    const auto time = std::max(*until - steady_clock::now(), Time::duration::zero());
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time);
    left = {static_cast<time_t>(whole.count()), static_cast<long>((time - whole).count())};
  }
  // A signal that comes just before poll must end it, too: signals are allowed within it alone.
  sigset_t signals;
  sigset_t before;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  ::sigprocmask(SIG_BLOCK, &signals, &before);
  const bool asked = lines::stop_requested();
  const int found =
      asked ? 0 : ::ppoll(polled_.data(), polled_.size(), until ? &left : nullptr, &before);
  const int error = found < 0 ? errno : 0;
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  if (error != 0 && error != EINTR) {
    throw std::system_error(error, std::generic_category(), "cannot wait for source and clients");
  }
  if (found > 0) return;
  for (pollfd& one : polled_) one.revents = 0;
}

void Server::turn() {
  Time now = steady_clock::now();
  if (open_at_ && now >= *open_at_) open_source(now);
  give_packets(now);
  if (write_due(now)) write_clients(now);
  remove_clients();
  if (over_) return;
  wait(next());
  now = steady_clock::now();
  for (std::size_t i = 2; i < polled_.size(); ++i) {
    Client& client = *clients_[i - 2];
    if (polled_[i].revents != 0) client.turn(polled_[i].revents, backlog_, now);
    client.tick(now);
  }
  turn_source(polled_[1].revents, now);
  if (polled_[0].revents != 0 || (accept_at_ && now >= *accept_at_)) accept_clients(now);
}

bool Server::run() {
  lines::stop_on_signals();
  open_at_ = steady_clock::now();
  while (!over_ && !lines::stop_requested()) turn();
  drain();
  const bool failed = lost_ && over_;
  counts_.not_sent += source_.is_giving() ? 1 : 0;
  for (const auto& client : clients_) counts_.not_sent += client->packets_waiting();
  source_.close(steady_clock::now());
  // A source that cannot be had costs no file.
  capture_failed_ = capture_ && capture_->is_started() && !capture_->finish();
  return !failed;
}

}  // namespace rubric::forward
