// The firmware on its processor: facts that the golden traces do not see.
#include "conformance/adapters/firmware/host/avr_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "conformance/adapters/firmware/host/bridge.h"

namespace rubric::firmware {
namespace {

constexpr Tick kSecond = 1024;

// Returns a radio or serial packet with a net_msg of `data_bytes` bytes for Connectionless.
ByteVector net_packet(std::uint16_t am_dest, const std::string& dest, const std::string& src,
                      bool reliable, std::size_t data_bytes) {
  const auto size = static_cast<std::uint8_t>(14 + data_bytes);
  ByteVector bytes(8);
  store_be16(bytes.data() + 1, am_dest);
  store_be16(bytes.data() + 3, 9);
  bytes[5] = size;
  bytes[7] = 28;
  for (const std::string& part : {dest, src}) {
    const ByteVector address = bytes_of_hex(part);
    bytes.insert(bytes.end(), address.begin(), address.end());
  }
  const std::uint8_t rest[] = {reliable, 0x12, 0x34, static_cast<std::uint8_t>(2 + data_bytes),
                               3,        5};
  bytes.insert(bytes.end(), std::begin(rest), std::end(rest));
  bytes.resize(8 + size, 0x7E);
  return bytes;
}

class AvrBoardTest : public testing::Test {
 protected:
  void start(const char* elf_file) {
    board_ = std::make_unique<AvrBoard>(elf_file);
    bridge_ = std::make_unique<Bridge>(*board_);
    firmware_ = bridge_->greet();
    bridge_->start({1, 11, 4, 999});
  }
  std::vector<std::string> lines_until(Tick end) {
    std::vector<std::string> all;
    for (bool more = true; more;) {
      const Tick reached = bridge_->run(end);
      const auto lines = bridge_->take_lines();
      all.insert(all.end(), lines.begin(), lines.end());
      more = reached < end || !lines.empty();
    }
    return all;
  }
  void call(const std::string& text) {
    const ByteVector record = call_record(text);
    bridge_->call(Bytes(record.data(), record.size()));
  }

  std::unique_ptr<AvrBoard> board_;
  std::unique_ptr<Bridge> bridge_;
  Firmware firmware_;
};

TEST_F(AvrBoardTest, SaysWhatItIs) {
  start(RUBRIC_FIRMWARE_SINK_ELF);
  EXPECT_TRUE(firmware_.is_sink);
  EXPECT_EQ(firmware_.channels, 4U);
  EXPECT_LE(firmware_.node_bytes, 2362U);
  start(RUBRIC_FIRMWARE_MOTE_ELF);
  EXPECT_FALSE(firmware_.is_sink);
  std::printf("a mote's node takes %u bytes of RAM\n", firmware_.node_bytes);
}

// Fills all buffers, with everything that can be on its way at once; then reads the stack's deepest
// mark.
TEST_F(AvrBoardTest, ItsStackHasRoom) {
  start(RUBRIC_FIRMWARE_SINK_ELF);
  const ByteVector up = net_packet(1, "000b0001", "000b0005", true, 100);
  const ByteVector through = net_packet(1, "000bfffd", "000b0005", false, 100);
  const ByteVector down = net_packet(1, "000b0005", "000bfffd", false, 100);
  const std::string hundred(200, '7');
  for (Tick now = 0; now < 4 * kSecond; now += kSecond / 4) {
    for (std::uint8_t line = 0; line < 3; ++line) bridge_->busy(line, now % kSecond != 0);
    call("create_out(dest=11:5 size=10 mode=0)");
    call("start_all()");
    for (int i = 0; i < 3; ++i) {
      bridge_->hear_radio(Bytes(up.data(), up.size()));
      bridge_->hear_radio(Bytes(through.data(), through.size()));
      bridge_->hear_serial(Bytes(down.data(), down.size()));
      call("send(dest=11:5 app_id=5 reliable=1 data=x" + hundred + ")");
    }
    lines_until(now + kSecond / 4);
  }
  std::printf("%zu bytes of RAM were never used\n", board_->untouched_ram_bytes());
  EXPECT_GE(board_->untouched_ram_bytes(), 512U);
}

TEST_F(AvrBoardTest, ASerialPacketIsForwardedByteForByte) {
  start(RUBRIC_FIRMWARE_SINK_ELF);
  const ByteVector down = net_packet(1, "000b0005", "000bfffd", false, 100);
  bridge_->hear_serial(Bytes(down.data(), down.size()));
  const auto lines = lines_until(200);
  ASSERT_EQ(lines.size(), 1U);
  const ByteVector payload(down.begin() + 8, down.end());
  EXPECT_THAT(lines[0], testing::EndsWith(hex_of_bytes(Bytes(payload.data(), payload.size()))));
}

TEST_F(AvrBoardTest, NumbersGoOnAfterAReset) {
  start(RUBRIC_FIRMWARE_SINK_ELF);
  call("send(dest=11:5 app_id=5 reliable=0 data=x01)");
  EXPECT_THAT(lines_until(100), testing::Contains(testing::EndsWith("send_result(1000)")));
  bridge_->reboot();
  call("send(dest=11:5 app_id=5 reliable=0 data=x01)");
  EXPECT_THAT(lines_until(200), testing::Contains(testing::EndsWith("send_result(1001)")));
}

TEST_F(AvrBoardTest, NothingHappensWithoutPower) {
  start(RUBRIC_FIRMWARE_SINK_ELF);
  bridge_->power_off();
  call("send(dest=11:5 app_id=5 reliable=0 data=x01)");
  EXPECT_THAT(lines_until(5 * kSecond), testing::IsEmpty());
  EXPECT_EQ(bridge_->next(), std::nullopt);
  bridge_->reboot();
  call("get_clock()");
  const auto lines = lines_until(6 * kSecond);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], testing::AnyOf(testing::EndsWith("clock(0)"), testing::EndsWith("clock(1)"),
                                       testing::EndsWith("clock(2)")));
}

TEST_F(AvrBoardTest, TheSameCommandsGiveTheSameLines) {
  std::vector<std::string> first;
  for (int i = 0; i < 2; ++i) {
    start(RUBRIC_FIRMWARE_MOTE_ELF);
    call("join(type=1 transducers=7 actuators=1)");
    const auto lines = lines_until(4 * kSecond);
    EXPECT_EQ(lines.size(), 6U);  // Five requests and joined(FAIL).
    if (i == 0) first = lines;
    EXPECT_EQ(lines, first);
  }
}

TEST(AvrBoard, AFileThatIsNoFirmwareIsRefused) {
  AvrBoard board("README.md");
  EXPECT_THROW(board.power_on(), BoardBroken);
  AvrBoard none("no_such_file.elf");
  EXPECT_THROW(none.power_on(), BoardBroken);
}

TEST(Words, CallsThatMakeNoSenseAreRefused) {
  for (const char* text :
       {"fly()", "join", "join(type=1)", "join(type=1 transducers=70000 actuators=1)",
        "send(dest=11 app_id=5 reliable=0 data=x)", "send(dest=11:5 app_id=5 reliable=0 data=01)",
        "send(dest=11:5 app_id=5 reliable=0 data=x0)", "start(channel=5)",
        "write_output(channel=5->1 pos=0 value=zero)"}) {
    EXPECT_THROW(call_record(text), BadWord) << text;
  }
}

}  // namespace
}  // namespace rubric::firmware
