#include "tools/commands/run/pty_line.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

namespace rubric::run {
namespace {

// Nobody reads on for a packet that never comes: the node has more to do.
TEST(PtyLine, GarbageDoesNotHoldItsReader) {
  PtyLine line;
  line.open({});
  const lines::Descriptor host(::open(line.device().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  const std::vector<std::uint8_t> garbage(3000, 0x55);
  ASSERT_EQ(::write(host.get(), garbage.data(), garbage.size()), 3000);
  const auto unread = [&] {
    int count = 0;
    EXPECT_EQ(::ioctl(line.fd(), FIONREAD, &count), 0);
    return count;
  };
  while (unread() < 3000) std::this_thread::yield();  // The kernel brings it in its own time.
  EXPECT_FALSE(line.receive(std::chrono::steady_clock::now()));
  EXPECT_GT(unread(), 0);
}

}  // namespace
}  // namespace rubric::run
