// Views, values and enums as firmware and tools use them, message by message.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"

namespace rubric {

std::ostream& operator<<(std::ostream& out, const Error& e) {
  return out << "{" << static_cast<int>(e.fault) << ", " << e.offset_bytes << ", "
             << static_cast<int>(e.requirement) << "}";
}

namespace rubicon {
namespace {

// From <11, 2> to <11, null>, updates of two transducers.
const std::uint8_t kUpdatesFrame[] = {0x00, 0x0b, 0xff, 0xfd, 0x00, 0x0b, 0x00, 0x02, 0x01,
                                      0x12, 0x34, 0x0c, 0x03, 0x0a, 0x23, 0x02, 0x00, 0x01,
                                      0x03, 0xe8, 0x00, 0x40, 0x0f, 0xff, 0xee, 0xee};

TEST(View, NetMsgReadsEachField) {
  const Result<NetMsgView> view = NetMsgView::parse(kUpdatesFrame);
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(static_cast<int>(view->dest().pid()), 11);
  EXPECT_EQ(view->dest().devid(), Devid::kNull);
  EXPECT_EQ(static_cast<int>(view->src().devid()), 2);
  EXPECT_EQ(view->reliable(), 1);
  EXPECT_EQ(view->seq_num(), 0x1234);
  EXPECT_EQ(view->nbytes(), 12);
  EXPECT_EQ(view->bytes().size(), 24U);
  EXPECT_EQ(view->stale().size(), 2U);
  EXPECT_EQ(view->payload_kind(), NetMsgView::PayloadKind::kAppMsg);
}

TEST(View, BodiesAreInterpretedInOrder) {
  const AppMsgView app = NetMsgView::parse(kUpdatesFrame)->payload_as_app_msg();
  ASSERT_EQ(app.body_kind(), AppMsgView::BodyKind::kUpdates);
  const UpdatesView updates = app.body_as_updates();
  ASSERT_EQ(updates.updates().size(), 2U);
  EXPECT_TRUE(updates.updates()[0].transducer().has(TransducerMask::kLight));
  EXPECT_EQ(updates.updates()[0].value(), 1000);
  EXPECT_TRUE(updates.updates()[1].transducer().has(TransducerMask::kHumid));
  std::vector<std::uint16_t> values;
  for (const TransducerUpdateView update : updates.updates()) values.push_back(update.value());
  EXPECT_EQ(values, (std::vector<std::uint16_t>{1000, 4095}));
}

TEST(View, TheSenderDecidesWhatALearningCodeMeans) {
  std::uint8_t frame[] = {0, 11, 0, 2, 0, 11, 0xff, 0xfd, 0, 0, 1, 7, 3, 6, 24, 0, 5, 0, 6};
  const NetMsgView from_pc = *NetMsgView::parse(frame);
  ASSERT_EQ(from_pc.payload_kind(), NetMsgView::PayloadKind::kAppMsgFromPc);
  const AppMsgFromPcView command = from_pc.payload_as_app_msg_from_pc();
  ASSERT_EQ(command.body_kind(), AppMsgFromPcView::BodyKind::kNetidCmd);
  EXPECT_EQ(command.body_as_netid_cmd().type(), LearningCode::kOnlineNoevent);
  EXPECT_EQ(command.body_as_netid_cmd().net_id(), 5);
  frame[7] = 0x02;
  const NetMsgView from_mote = *NetMsgView::parse(frame);
  ASSERT_EQ(from_mote.payload_kind(), NetMsgView::PayloadKind::kAppMsg);
  const AppMsgView answer = from_mote.payload_as_app_msg();
  ASSERT_EQ(answer.body_kind(), AppMsgView::BodyKind::kLearningModuleDown);
  EXPECT_EQ(answer.body_as_learning_module_down().net_id(), 5);
}

TEST(View, UnknownEnumValuesAndUnnamedBitsAreKept) {
  const std::uint8_t bytes[] = {99, 0xe0, 0x01, 0xfc};
  const MoteDescView view = *MoteDescView::parse(bytes);
  EXPECT_EQ(static_cast<int>(view.mote_type()), 99);
  EXPECT_EQ(view.transducers().raw(), 0xe001);
  EXPECT_EQ(view.actuators().raw(), 0xfc);
  EXPECT_FALSE(view.actuators().has(ActuatorMask::kLed));
  std::uint8_t out[4];
  ASSERT_TRUE(write(view.to_value(), out).has_value());
  EXPECT_EQ(0, std::memcmp(out, bytes, sizeof(bytes)));
}

TEST(View, MasksCombine) {
  const TransducerMask two = TransducerMask::kLight | TransducerMask::kRssi5;
  EXPECT_EQ(two.raw(), 0x1001);
  EXPECT_EQ(two.without(TransducerMask::kLight), TransducerMask(TransducerMask::kRssi5));
  EXPECT_EQ(TransducerMask(0x8000).with(TransducerMask::kTemp).raw(), 0x8002);
}

TEST(View, NumberArraysCopyAtOnce) {
  std::uint8_t bytes[58] = {9};
  for (int i = 0; i < 10; ++i) bytes[14 + 2 * i + 1] = static_cast<std::uint8_t>(i + 1);
  bytes[55] = 0x80;  // params, the least int8.
  const SynCreateCmdView view = *SynCreateCmdView::parse(bytes);
  std::uint16_t neurons[10] = {};
  EXPECT_EQ(view.src_neurons().copy_to(neurons, 3), 3U);
  EXPECT_EQ(neurons[2], 3);
  EXPECT_EQ(neurons[3], 0);
  EXPECT_EQ(view.src_neurons().copy_to(neurons, 10), 10U);
  EXPECT_EQ(neurons[9], 10);
  EXPECT_EQ(view.params(), -128);
}

TEST(View, EqualityIsOfMeantBytes) {
  std::uint8_t other[sizeof(kUpdatesFrame)];
  std::memcpy(other, kUpdatesFrame, sizeof(other));
  other[25] = 0x11;  // Stale.
  EXPECT_EQ(*NetMsgView::parse(kUpdatesFrame), *NetMsgView::parse(other));
  other[23] = 0x11;
  EXPECT_NE(*NetMsgView::parse(kUpdatesFrame), *NetMsgView::parse(other));
}

TEST(View, ParsesAtCompileTime) {
  static constexpr std::uint8_t kReply[] = {0, 11, 0, 2, 0, 0, 1, 0, 0xbe, 0xef};
  constexpr Result<JoinReplyView> view = JoinReplyView::parse(kReply);
  static_assert(view.has_value());
  static_assert(view->cur_time() == 256);
  static_assert(view->seq_num() == 0xbeef);
  constexpr Result<JoinReplyView> cut = JoinReplyView::parse(Bytes(kReply, 9));
  static_assert(cut.error() == Error{Fault::kTruncated, 9, "WIRE-JOIN-REPLY"_rule});
}

TEST(View, SerialFrameHasItsNumberOnlyWhereTheKindSaysSo) {
  const std::uint8_t with[] = {68, 14, 0};
  const std::uint8_t without[] = {69, 14, 0};
  EXPECT_TRUE(tinyos::SerialFrameView::parse(with)->has_seq_num());
  EXPECT_EQ(tinyos::SerialFrameView::parse(with)->packet().size(), 1U);
  EXPECT_FALSE(tinyos::SerialFrameView::parse(without)->has_seq_num());
  EXPECT_EQ(tinyos::SerialFrameView::parse(without)->packet().size(), 2U);
}

// A structure that takes all bytes ends at its greatest size.
TEST(View, TheGreatestSizeEndsAStructure) {
  std::uint8_t bytes[120] = {1, 11};
  EXPECT_EQ(AppMsgView::parse(bytes)->bytes().size(), 102U);
  EXPECT_EQ(SynapticDataView::parse(Bytes(bytes, 101))->values().size(), 25U);
}

struct WriteCase {
  const char* name;
  NetMsg value;
  std::size_t room;
  Error error;
};
TEST(Write, NamesTheRuleThatAValueBreaks) {
  static const std::uint8_t kBytes[120] = {};
  const auto with = [](std::uint8_t reliable, std::size_t payload) {
    NetMsg value{.reliable = reliable, .payload = Bytes(kBytes, payload)};
    return value;
  };
  const WriteCase kCases[] = {
      {"Reliable", with(2, 2), 114, {Fault::kOutOfRange, 8, "WIRE-NET-RELIABLE"_rule}},
      {"TooLittle", with(0, 1), 114, {Fault::kOutOfRange, 11, "WIRE-NET-NBYTES"_rule}},
      {"TooMuch", with(0, 103), 114, {Fault::kOutOfRange, 11, "WIRE-NET-NBYTES"_rule}},
      {"BeyondAByte", with(0, 114), 200, {Fault::kOutOfRange, 11, "WIRE-NET-NBYTES"_rule}},
      {"NoRoom", with(0, 2), 13, {Fault::kNoRoom, 13, "WIRE-NET-HEADER"_rule}},
  };
  for (const WriteCase& c : kCases) {
    SCOPED_TRACE(c.name);
    std::uint8_t out[200];
    const Result<MutableBytes> written = write(c.value, MutableBytes(out, c.room));
    ASSERT_FALSE(written.has_value());
    EXPECT_EQ(written.error(), c.error);
  }
}

TEST(Write, LengthsOfOtherFieldsMustAgree) {
  static const std::uint8_t kPayload[] = {1, 2, 3};
  Rubicon frame;
  frame.am.type = 99;
  frame.payload = kPayload;
  std::uint8_t out[20];
  frame.am.length = 4;
  EXPECT_EQ(write(frame, out).error(), (Error{Fault::kTruncated, 8, "WIRE-AM-LENGTH"_rule}))
      << write(frame, out).error();
  frame.am.length = 2;
  EXPECT_EQ(write(frame, out).error().fault, Fault::kTrailing);
  frame.am.length = 3;
  EXPECT_EQ(write(frame, out)->size(), 11U);
  frame.am.type = 37;  // A config, and its three bytes are fine.
  EXPECT_TRUE(write(frame, out).has_value());
  frame.am.type = 11;  // A command has five.
  EXPECT_EQ(write(frame, out).error(), (Error{Fault::kTruncated, 11, "WIRE-COMMAND"_rule}));
}

TEST(Write, ArraysAreWrittenAsFarAsTheyCount) {
  LearningOutput output{.type = AmType::kLearningOutput};
  ASSERT_TRUE(output.output.push(1.0F));
  ASSERT_TRUE(output.output.push(-2.0F));
  std::uint8_t out[98];
  const Result<MutableBytes> bytes = write(output, out);
  ASSERT_TRUE(bytes.has_value());
  const std::uint8_t kExpected[] = {25, 2, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0};
  EXPECT_TRUE(equal(*bytes, kExpected));
  output.output.count = 25;
  EXPECT_EQ(write(output, out).error(),
            (Error{Fault::kOutOfRange, 1, "WIRE-LEARNING-OUTPUT"_rule}));
}

}  // namespace
}  // namespace rubicon
}  // namespace rubric
