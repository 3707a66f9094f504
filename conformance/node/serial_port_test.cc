// The serial stack of a sink's firmware, byte by byte, as a UART's interrupts would call it.
#include "conformance/node/serial_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace rubric::node {
namespace {

using ByteVector = std::vector<std::uint8_t>;
using testing::ElementsAre;
using testing::IsEmpty;

class Port : public SerialPort {
 public:
  int starts = 0;

  // Returns everything that it wants to send now.
  ByteVector drain() {
    ByteVector bytes;
    std::uint8_t byte = 0;
    while (next_byte(byte)) bytes.push_back(byte);
    return bytes;
  }

 private:
  void start_sending() override { ++starts; }
};

class PortDriver : public Driver {
 public:
  explicit PortDriver(SerialPort& port) : port_(port) {}
  void transmit(Line line, Bytes packet, bool) override {
    if (line == Line::kSerial) port_.send(packet);
  }

 private:
  SerialPort& port_;
};
class Log : public Application {
 public:
  std::vector<ByteVector> data;
  void joined(Address, bool) override {}
  void mote_joined(Address, const Descriptor&) override {}
  void received(Address, std::uint8_t, Bytes bytes) override {
    data.emplace_back(bytes.begin(), bytes.end());
  }
  void ack_received(std::uint8_t, std::uint16_t, bool) override {}
  void syn_data_received(ChannelId, DataStatus) override {}
};

class SerialPortTest : public testing::Test {
 protected:
  void SetUp() override { node_.start({Role::kSink, 1, 11, 4, 0, 0}); }

  // Returns a packet of the base station with application data for the sink.
  static ByteVector packet(const ByteVector& data) {
    Message message;
    rubicon::NetMsg net;
    net.dest = wire_of({11, 1});
    net.src = wire_of({11, kNullDevid});
    std::uint8_t* const body = message.room() + 12;
    body[0] = 3;
    body[1] = 5;
    std::copy(data.begin(), data.end(), body + 2);
    net.payload = Bytes(body, 2 + data.size());
    rubicon::NetMsgLayout::store(net, message.room());
    message.set_header(1, 0, 28, 12 + net.payload.size());
    return {message.packet().begin(), message.packet().end()};
  }
  static ByteVector frame(std::uint8_t seq, const ByteVector& packet) {
    ByteVector bytes(300);
    const auto size = write_serial_packet_ack(seq, Bytes(packet.data(), packet.size()),
                                              MutableBytes(bytes.data(), bytes.size()));
    bytes.resize(*size);
    return bytes;
  }
  static ByteVector confirmation(std::uint8_t seq) {
    ByteVector bytes(12);
    bytes.resize(*write_serial_ack(seq, MutableBytes(bytes.data(), bytes.size())));
    return bytes;
  }
  void hear(const ByteVector& bytes) {
    for (const std::uint8_t byte : bytes) port_.byte_received(byte);
  }

  Port port_;
  PortDriver driver_{port_};
  Log log_;
  SizedNode<SinkSizes> node_{driver_, log_};
};

TEST_F(SerialPortTest, APacketIsConfirmedAndHandedOver) {
  const ByteVector data{0x7E, 0x00, 0x7D, 0x20};
  hear(frame(14, packet(data)));
  EXPECT_EQ(port_.drain(), confirmation(14));
  EXPECT_EQ(port_.poll(node_), 1);
  EXPECT_THAT(log_.data, ElementsAre(data));
  EXPECT_EQ(port_.poll(node_), 0);
}

TEST_F(SerialPortTest, SequenceNumbersAreEscapedToo) {
  hear(frame(0x7D, packet({1})));
  EXPECT_EQ(port_.drain(), confirmation(0x7D));
}

TEST_F(SerialPortTest, APacketWithoutSequenceNumberIsNotConfirmed) {
  ByteVector bytes(300);
  const ByteVector content = packet({7});
  bytes.resize(*write_serial_packet(Bytes(content.data(), content.size()),
                                    MutableBytes(bytes.data(), bytes.size())));
  hear(bytes);
  EXPECT_THAT(port_.drain(), IsEmpty());
  EXPECT_EQ(port_.poll(node_), 1);
  EXPECT_THAT(log_.data, ElementsAre(ByteVector{7}));
}

TEST_F(SerialPortTest, DamagedFramesAreNeitherConfirmedNorHandedOver) {
  const ByteVector good = frame(14, packet({1, 2, 3}));
  for (std::size_t i = 1; i + 1 < good.size(); ++i) {
    ByteVector damaged = good;
    damaged[i] ^= 0x01;
    hear(damaged);
    EXPECT_THAT(port_.drain(), IsEmpty()) << "byte " << i;
    EXPECT_EQ(port_.poll(node_), 0) << "byte " << i;
  }
  EXPECT_THAT(log_.data, IsEmpty());
  hear(good);
  EXPECT_EQ(port_.poll(node_), 1);
}

TEST_F(SerialPortTest, WhatFindsNoRoomIsNotConfirmed) {
  hear(frame(1, packet({1})));
  EXPECT_EQ(port_.drain(), confirmation(1));
  hear(frame(2, packet({2})));  // The first has not been handled.
  EXPECT_THAT(port_.drain(), IsEmpty());
  EXPECT_EQ(port_.poll(node_), 1);
  hear(frame(3, packet({2})));  // The host tries again.
  EXPECT_EQ(port_.drain(), confirmation(3));
  EXPECT_EQ(port_.poll(node_), 1);
  EXPECT_THAT(log_.data, ElementsAre(ByteVector{1}, ByteVector{2}));
}

TEST_F(SerialPortTest, AFrameLongerThanAnyPacketIsDropped) {
  hear(frame(1, ByteVector(200, 0x55)));
  EXPECT_THAT(port_.drain(), IsEmpty());
  hear(frame(2, packet({4})));
  EXPECT_EQ(port_.poll(node_), 1);
}

TEST_F(SerialPortTest, WhatIsSentIsAnUnconfirmedPacketBetweenFlags) {
  node_.send({11, kNullDevid}, 5, false, Bytes());
  const ByteVector bytes = port_.drain();
  ByteVector room(300);
  HdlcDeframer deframer(MutableBytes(room.data(), room.size()));
  int frames = 0;
  for (const std::uint8_t byte : bytes) {
    if (deframer.push(byte) != HdlcEvent::kFrame) continue;
    ++frames;
    EXPECT_EQ(deframer.content().size(), 1 + kAmHeaderBytes + kAmPayloadMax);
    EXPECT_EQ(deframer.content()[0], kSerialPacketNoAck);
  }
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(bytes.front(), kHdlcFlag);
  EXPECT_EQ(bytes.back(), kHdlcFlag);
}

TEST_F(SerialPortTest, TwoFlagsAreBetweenFrames) {
  node_.send({11, kNullDevid}, 5, false, Bytes());
  node_.send({11, kNullDevid}, 5, false, Bytes());
  ByteVector bytes = port_.drain();
  port_.poll(node_);  // The second leaves when the first has.
  const ByteVector second = port_.drain();
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(bytes.back(), kHdlcFlag);
  EXPECT_EQ(second.front(), kHdlcFlag);
}

TEST_F(SerialPortTest, ALineThatIsHeldStopsAfterTheByte) {
  node_.send({11, kNullDevid}, 5, false, Bytes());
  std::uint8_t byte = 0;
  EXPECT_TRUE(port_.next_byte(byte));
  port_.set_held(true);
  EXPECT_FALSE(port_.next_byte(byte));
  const int before = port_.starts;
  port_.set_held(false);
  EXPECT_EQ(port_.starts, before + 1);
  EXPECT_TRUE(port_.next_byte(byte));
}

TEST_F(SerialPortTest, ALineThatIsOffConfirmsNothing) {
  node_.set_interface(Line::kSerial, false);
  port_.poll(node_);
  hear(frame(1, packet({1})));
  EXPECT_THAT(port_.drain(), IsEmpty());
  EXPECT_EQ(port_.poll(node_), 0);
  node_.set_interface(Line::kSerial, true);
  port_.poll(node_);
  hear(frame(2, packet({2})));
  EXPECT_EQ(port_.poll(node_), 1);
}

}  // namespace
}  // namespace rubric::node
