// Property: whatever bytes a forwarder's client sends, in whatever pieces, its packets are those
// that a plain reader finds before the first breach of the protocol, it is cut off for that breach
// alone, and until then it gets every byte of the backlog in order.
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "codec/lines/forward/client.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;
using Packets = std::vector<std::vector<std::uint8_t>>;

constexpr std::uint8_t kHello[] = {0x55, 0x20};
constexpr std::size_t kBacklogBytes = 600;

// What a reader of the protocol's text makes of all bytes at once.
struct Expected {
  Packets packets;
  bool fault = false;
  bool cut_short = false;  // The bytes end within a packet or the handshake.
};

Expected expected_of(const std::vector<std::uint8_t>& sent, std::size_t packet_max) {
  Expected out;
  const std::size_t greeted = std::min<std::size_t>(sent.size(), 2);
  out.fault = (greeted > 0 && sent[0] != kHello[0]) || (greeted == 2 && sent[1] < kHello[1]);
  out.cut_short = sent.size() == 1;
  for (std::size_t at = 2; !out.fault && at < sent.size(); at += sent[at] + std::size_t{1}) {
    out.fault = sent[at] == 0 || sent[at] > packet_max;
    out.cut_short = !out.fault && at + sent[at] >= sent.size();
    if (out.fault || out.cut_short) break;
    const auto* const begin = sent.data() + at + 1;
    out.packets.emplace_back(begin, begin + sent[at]);
  }
  return out;
}

class Conversation {
 public:
  explicit Conversation(fuzz::Input input) : input_(input) {
    limits_.packet_max = 1 + input_.below(255);
    int ends[2];
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) == 0,
            "there is a socket");
    client_.emplace(lines::Descriptor(ends[0]), "peer", 0, limits_, now_);
    peer_ = lines::Descriptor(ends[1]);
    wanted_.assign(kHello, kHello + sizeof kHello);
  }

  void run() {
    while (!input_.at_end() && client_->fault().empty()) step();
    if (client_->fault().empty()) end();
    const Expected expected = expected_of(sent_, limits_.packet_max);
    require(std::equal(taken_.begin(), taken_.end(), expected.packets.begin(),
                       expected.packets.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                      taken_.size(), expected.packets.size()))),
            "packets are those that were sent");
    if (late_) return;
    require(taken_ == expected.packets, "all of them, and none more");
    require(client_->fault().empty() == !(expected.fault || (ended_ && expected.cut_short)),
            "it is cut off where the protocol is broken, and nowhere else");
  }

 private:
  void step() {
    switch (input_.below(8)) {
      case 0: give(); break;
      case 1: wait(); break;
      default: send(input_.bytes(1 + input_.below(64))); break;
    }
    take();
  }

  void send(Bytes bytes) {
    const ssize_t count = ::send(peer_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    require(count == static_cast<ssize_t>(bytes.size()), "the socket takes it");
    sent_.insert(sent_.end(), bytes.begin(), bytes.end());
    client_->turn(POLLIN, backlog_, now_);
  }

  // Something for the client, and for all others.
  void give() {
    const Bytes bytes = input_.bytes(input_.below(100));
    backlog_.append(bytes);
    wanted_.insert(wanted_.end(), bytes.begin(), bytes.end());
    client_->write(backlog_, now_);
    std::vector<std::uint8_t> got(wanted_.size() + 1);
    const ssize_t count = ::recv(peer_.get(), got.data(), got.size(), 0);
    if (count > 0) got_.insert(got_.end(), got.begin(), got.begin() + count);
    require(got_ == wanted_, "it gets the backlog in order");
    require(client_->is_served(backlog_), "and lacks nothing of it");
  }

  void wait() {
    now_ += lines::Milliseconds(input_.u16());
    const std::optional<lines::SteadyTime> end = client_->deadline();
    client_->tick(now_);
    late_ = !client_->fault().empty();
    require(late_ == (end && *end <= now_), "its patience ends when it says");
  }

  void take() {
    std::size_t waiting = client_->packets_waiting();
    while (const std::optional<Bytes> packet = client_->packet()) {
      require(waiting-- > 0, "packets are counted");
      taken_.emplace_back(packet->begin(), packet->end());
      client_->drop_packet();
    }
  }

  void end() {
    peer_.close();
    client_->turn(POLLIN | POLLHUP, backlog_, now_);
    ended_ = true;
    take();
    require(client_->is_over() || !client_->fault().empty(), "nothing is left of who has left");
  }

  fuzz::Input input_;
  forward::Client::Limits limits_;
  lines::SteadyTime now_ = lines::SteadyTime(std::chrono::hours(1));
  forward::Backlog backlog_{kBacklogBytes};
  lines::Descriptor peer_;
  std::optional<forward::Client> client_;
  std::vector<std::uint8_t> sent_;
  std::vector<std::uint8_t> wanted_;
  std::vector<std::uint8_t> got_;
  Packets taken_;
  bool late_ = false;
  bool ended_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Conversation(fuzz::Input(data, size)).run();
  return 0;
}
