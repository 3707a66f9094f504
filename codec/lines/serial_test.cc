#include "codec/lines/serial.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <chrono>
#include <string>
#include <vector>

#include "codec/lines/broken.h"
#include "codec/runtime/hdlc.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

// A serial line whose far end is a socket of the test's.
class SerialLineTest : public testing::Test {
 protected:
  SerialLineTest() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    far_ = Descriptor(ends[0]);
    near_ = Descriptor(ends[1]);
    line_.open({});
  }
  void write(Bytes bytes) {
    ASSERT_EQ(::write(far_.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  int unread() {
    int count = 0;
    EXPECT_EQ(::ioctl(line_.fd(), FIONREAD, &count), 0);
    return count;
  }

  Descriptor far_;
  Descriptor near_;
  SerialLine line_{[this](SteadyTime) { return ByteStream(std::move(near_)); }};
};

// Nobody reads on for a packet that never comes: the node has more to do.
TEST_F(SerialLineTest, GarbageDoesNotHoldItsReader) {
  const std::vector<std::uint8_t> garbage(1 << 15, 0x55);
  write(Bytes(garbage.data(), garbage.size()));
  EXPECT_FALSE(line_.receive(steady_clock::now()));
  EXPECT_GT(unread(), 0);
  EXPECT_FALSE(line_.open(steady_clock::now()));
  EXPECT_GT(unread(), 0);
}

TEST_F(SerialLineTest, APacketAfterGarbageIsReceived) {
  const std::vector<std::uint8_t> garbage(1 << 15, 0x55);
  write(Bytes(garbage.data(), garbage.size()));
  const std::uint8_t content[] = {kSerialPacketNoAck, 0, 1, 2};
  std::uint8_t room[hdlc_frame_room(sizeof content)];
  const auto size = write_hdlc_frame(content, MutableBytes(room, sizeof room));
  ASSERT_TRUE(size);
  write(Bytes(room, *size));
  std::optional<TimedPacket> packet;
  for (int i = 0; i < 100 && !packet; ++i) packet = line_.receive(steady_clock::now());
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->bytes, (std::vector<std::uint8_t>{0, 1, 2}));
}

// Two readers of a device would each get a part of its bytes.
TEST(SerialDeviceTest, HasOneProgram) {
  const Descriptor far(::posix_openpt(O_RDWR | O_NOCTTY));
  ASSERT_EQ(::grantpt(far.get()), 0);
  ASSERT_EQ(::unlockpt(far.get()), 0);
  const std::string path = ::ptsname(far.get());
  ByteStream first = open_serial_device(path, 115200);
  try {
    open_serial_device(path, 115200);
    FAIL();
  } catch (const Broken& broken) {
    EXPECT_EQ(broken.what(), path + ": is in use by another program; 'rubric forward' shares it");
  }
  first.close();
  EXPECT_TRUE(open_serial_device(path, 115200).is_open());
}

}  // namespace
}  // namespace rubric::lines
