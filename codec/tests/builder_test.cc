// Builders make frames in place, and refuse what does not fit.
#include <gtest/gtest.h>

#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"

namespace rubric::rubicon {
namespace {

TEST(Builder, NestsFromTheOutsideIn) {
  std::uint8_t out[114] = {};
  NetMsgBuilder net = *NetMsgBuilder::create(out);
  net.dest().set_pid(Pid(11));
  net.dest().set_devid(Devid::kNull);
  net.set_src({Pid(11), Devid(2)});
  ASSERT_TRUE(net.set_reliable(1));
  net.set_seq_num(0x1234);
  AppMsgBuilder app = *AppMsgBuilder::create(net.payload_room());
  app.set_trans_id(Component::kConnless);
  app.set_app_id(Component::kControlLayer);
  UpdatesBuilder updates = *UpdatesBuilder::create(app.payload_room());
  updates.set_type(AmType::kUpdates);
  ASSERT_TRUE(updates.set_output_size(2));
  updates.updates(0).set_transducer(TransducerMask::kLight);
  updates.updates(0).set_value(1000);
  updates.updates(1).set_transducer(TransducerMask::kHumid);
  updates.updates(1).set_value(4095);
  const Result<UpdatesView> body = updates.finish();
  ASSERT_TRUE(body.has_value());
  ASSERT_TRUE(app.set_payload_size(body->size_bytes()));
  const Result<AppMsgView> message = app.finish();
  ASSERT_TRUE(message.has_value());
  ASSERT_TRUE(net.set_nbytes(static_cast<std::uint8_t>(message->size_bytes())));
  const Result<NetMsgView> frame = net.finish();
  ASSERT_TRUE(frame.has_value());
  const std::uint8_t kExpected[] = {0x00, 0x0b, 0xff, 0xfd, 0x00, 0x0b, 0x00, 0x02,
                                    0x01, 0x12, 0x34, 0x0c, 0x03, 0x0a, 0x23, 0x02,
                                    0x00, 0x01, 0x03, 0xe8, 0x00, 0x40, 0x0f, 0xff};
  EXPECT_TRUE(equal(frame->bytes(), kExpected));
  EXPECT_TRUE(frame->stale().empty());
}

TEST(Builder, RefusesWhatIsOutOfRangeAndKeepsWhatWasThere) {
  std::uint8_t out[20] = {};
  NetMsgBuilder net = *NetMsgBuilder::create(out);
  ASSERT_TRUE(net.set_reliable(1));
  EXPECT_FALSE(net.set_reliable(2));
  EXPECT_FALSE(net.set_nbytes(1));
  EXPECT_FALSE(net.set_nbytes(9));  // Only eight bytes of room.
  EXPECT_EQ(net.finish().error(), (Error{Fault::kOutOfRange, 11, "WIRE-NET-NBYTES"_rule}));
  ASSERT_TRUE(net.set_nbytes(8));
  EXPECT_FALSE(net.set_nbytes(103));
  EXPECT_EQ(net.finish()->reliable(), 1);
  EXPECT_EQ(net.finish()->nbytes(), 8);
}

TEST(Builder, NeedsRoomForTheSmallest) {
  std::uint8_t out[13];
  EXPECT_EQ(NetMsgBuilder::create(out).error(),
            (Error{Fault::kNoRoom, 13, "WIRE-NET-HEADER"_rule}));
}

TEST(Builder, CopiesPayloadsAndArrays) {
  std::uint8_t out[114] = {};
  NetMsgBuilder net = *NetMsgBuilder::create(out);
  const std::uint8_t kPayload[] = {2, 2, 7};
  ASSERT_TRUE(net.set_payload(kPayload));
  EXPECT_EQ(net.finish()->nbytes(), 3);
  std::uint8_t large[103] = {};
  EXPECT_FALSE(net.set_payload(large));
  EXPECT_EQ(net.finish()->nbytes(), 3);

  SynapticDataBuilder synaptic = *SynapticDataBuilder::create(net.payload_room());
  const float kValues[] = {0.5F, -1.0F};
  ASSERT_TRUE(synaptic.set_values(kValues, 2));
  EXPECT_EQ(synaptic.finish()->size_bytes(), 8U);
  EXPECT_EQ(synaptic.finish()->values()[1], -1.0F);
  const float kMany[26] = {};
  EXPECT_FALSE(synaptic.set_values(kMany, 26));
}

TEST(Builder, AnOptionalFieldNeedsItsRoom) {
  std::uint8_t out[3] = {};
  tinyos::SerialFrameBuilder small = *tinyos::SerialFrameBuilder::create(MutableBytes(out, 1));
  small.set_kind(tinyos::SerialKind::kPacketAck);
  EXPECT_FALSE(small.set_seq_num(1));
  EXPECT_EQ(small.packet_room().size(), 0U);
  EXPECT_EQ(small.finish().error().fault, Fault::kNoRoom);
  tinyos::SerialFrameBuilder frame = *tinyos::SerialFrameBuilder::create(out);
  frame.set_kind(tinyos::SerialKind::kPacketAck);
  ASSERT_TRUE(frame.set_seq_num(14));
  const std::uint8_t kPacket[] = {0x00};
  ASSERT_TRUE(frame.set_packet(kPacket));
  EXPECT_EQ(frame.finish()->size_bytes(), 3U);
  EXPECT_EQ(frame.finish()->packet()[0], 0);
}

}  // namespace
}  // namespace rubric::rubicon
