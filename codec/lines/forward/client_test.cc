#include "codec/lines/forward/client.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

namespace {

int send_error = 0;  // The error of the next call; 0: none.

}  // namespace

// Replaces the system's function, which cannot be made to lack memory.
extern "C" ssize_t send(int fd, const void* bytes, size_t size, int flags) {
  if (send_error == 0) return ::sendto(fd, bytes, size, flags, nullptr, 0);
  errno = send_error;
  return -1;
}

namespace rubric::forward {
namespace {

class ClientTest : public ::testing::TestWithParam<int> {
 protected:
  ClientTest() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    client_.emplace(lines::Descriptor(ends[0]), "here", 0, Client::Limits{}, now_);
    peer_ = lines::Descriptor(ends[1]);
  }
  ~ClientTest() override { send_error = 0; }

  std::vector<std::uint8_t> received() const {
    std::array<std::uint8_t, 100> room{};
    const ssize_t count = ::read(peer_.get(), room.data(), room.size());
    return {room.begin(), room.begin() + std::max<ssize_t>(count, 0)};
  }

  const lines::SteadyTime now_ = std::chrono::steady_clock::now();
  Backlog backlog_{1024};
  lines::Descriptor peer_;
  std::optional<Client> client_;
};

TEST_P(ClientTest, GetsLaterWhatTheSystemHasNoRoomForNow) {
  const std::vector<std::uint8_t> bytes{2, 0, 7};
  backlog_.append({bytes.data(), bytes.size()});
  send_error = GetParam();
  client_->write(backlog_, now_);
  EXPECT_TRUE(client_->events() & POLLOUT);
  EXPECT_FALSE(client_->is_served(backlog_));
  send_error = 0;
  client_->turn(POLLOUT, backlog_, now_);
  EXPECT_TRUE(client_->is_served(backlog_));
  EXPECT_EQ(client_->fault(), "");
  EXPECT_EQ(received(), (std::vector<std::uint8_t>{0x55, 0x20, 2, 0, 7}));
}

TEST_P(ClientTest, HasPatienceForAPacketNotForEachByte) {
  const auto send_byte = [&](std::uint8_t byte, lines::Milliseconds at) {
    EXPECT_EQ(::write(peer_.get(), &byte, 1), 1);
    client_->turn(POLLIN, backlog_, now_ + at);
    client_->tick(now_ + at);
  };
  using lines::Milliseconds;
  send_byte('U', Milliseconds(5'000));
  send_byte(' ', Milliseconds(9'000));
  for (int i = 0; i < 3; ++i) {  // Whole packets in time, each with the first byte of the next.
    const Milliseconds at(20'000 + 9'000 * i);
    send_byte(1, at);
    send_byte(7, at + Milliseconds(8'000));
    client_->drop_packet();
  }
  EXPECT_EQ(client_->fault(), "");
  send_byte(200, Milliseconds(60'000));
  for (int i = 1; i < 10; ++i) send_byte(7, Milliseconds(60'000 + 1'000 * i));
  EXPECT_EQ(client_->fault(), "");
  send_byte(7, Milliseconds(70'000));
  EXPECT_EQ(client_->fault(), "it has not ended its packet in 10.0 s");
}

INSTANTIATE_TEST_SUITE_P(Errors, ClientTest, ::testing::Values(EAGAIN, EINTR, ENOBUFS, ENOMEM));

}  // namespace
}  // namespace rubric::forward
