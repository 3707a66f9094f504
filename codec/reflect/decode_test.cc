#include "codec/reflect/decode.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "codec/containers/tests/testing.h"
#include "codec/generated/oscilloscope/tables.h"
#include "codec/generated/rubicon/tables.h"

namespace rubric::reflect {
namespace {

using rubric::testing::from_hex;
using rubric::testing::view;

class Message {
 public:
  Message(const char* name, const std::string& hex, Tail tail = Tail::kStale)
      : bytes_(from_hex(hex)) {
    const Type* type = find_type(rubicon::tables::kProtocol, name);
    EXPECT_NE(type, nullptr) << name;
    if (type) decode(*type, view(bytes_), tail, true, decoded_);
  }
  const Decoded* operator->() const { return &decoded_; }
  const Decoded& operator*() const { return decoded_; }

  std::string path() const {
    std::string out;
    for (std::size_t i = 0; i < decoded_.path_count(); ++i) {
      if (i) out += ' ';
      out += decoded_.path()[i]->name;
    }
    return out;
  }

 private:
  std::string bytes_;
  Decoded decoded_;
};

const std::string kNetToSink = "000b fffd 000b 0002 00 b0d3 ";

TEST(Decode, JoinReply_EveryFieldInOrder) {
  const Message m("join_reply", "000b 0002 00000102 c4f5");
  ASSERT_EQ(m->error.fault, Fault::kNone);
  ASSERT_EQ(m->node_count(), 5u);
  EXPECT_EQ((*m)[m->child(0, "island_addr")].value, 11);
  EXPECT_EQ((*m)[m->child(0, "mote_addr")].value, 2);
  EXPECT_EQ((*m)[m->child(0, "cur_time")].value, 258);
  EXPECT_EQ((*m)[m->child(0, "seq_num")].value, 0xc4f5);
  EXPECT_EQ((*m)[4].offset, 8u);
  EXPECT_EQ(m->child(0, "nothing"), 0u);
}

TEST(Decode, Updates_PathNestingAndStaleBytesOnBothLevels) {
  // nbytes 16 of which the updates take 10; two bytes after the network message.
  const Message m("net_msg", kNetToSink + "10 030a 23 02 0001 012e 0040 04b2 aabbccdd eeff");
  ASSERT_EQ(m->error.fault, Fault::kNone);
  EXPECT_EQ(m.path(), "net_msg app_msg updates");
  ASSERT_EQ(m->stale_count(), 2u);
  EXPECT_EQ(m->stale()[0].offset, 24u);
  EXPECT_EQ(m->stale()[0].size, 4u);
  EXPECT_EQ(m->stale()[1].offset, 28u);
  EXPECT_EQ(m->stale()[1].size, 2u);
  const std::size_t body = m->child(m->child(0, "payload"), "body");
  const std::size_t pairs = m->child(body, "updates");
  ASSERT_NE(pairs, 0u);
  EXPECT_EQ((*m)[pairs].kind, NodeKind::kStructArray);
  EXPECT_EQ((*m)[pairs].count, 2u);
  const std::size_t second = (*m)[pairs + 1].end;
  EXPECT_EQ((*m)[m->child(second, "value")].value, 0x04b2);
}

struct BodyCase {
  const char* name;
  std::string hex;
  const char* path;
  std::optional<NoteKind> note = {};
};

const BodyCase kBodies[] = {
    {"UnknownApp_StaysOpaque", kNetToSink + "03 0304 99", "net_msg app_msg",
     NoteKind::kUnknownMessage},
    {"UnknownTypeByte_StaysOpaque", kNetToSink + "03 030a 99", "net_msg app_msg",
     NoteKind::kUnknownMessage},
    {"TooShortForItsMessage_StaysOpaque", kNetToSink + "04 030a 2401", "net_msg app_msg",
     NoteKind::kDoesNotFit},
    {"NoBody_NothingToRemark", kNetToSink + "02 030a", "net_msg app_msg"},
    {"Ack_Deployed", kNetToSink + "06 0905 17 c4f5 00", "net_msg app_msg rubicon_ack"},
    {"Ack_OtherKind_IsNoted", kNetToSink + "06 0905 18 c4f5 00", "net_msg app_msg rubicon_ack",
     NoteKind::kUnexpectedValue},
    {"Ack_OfThePaper", kNetToSink + "04 0905 c4f5", "net_msg app_msg rubicon_ack_seq_only"},
    {"Learning23_ToThePc", kNetToSink + "06 0306 17 0001 00",
     "net_msg app_msg learning_notification"},
    {"Learning23_FromThePc", "000b 0002 000b fffd 00 b0d3 07 0306 17 0001 0002",
     "net_msg app_msg netid_cmd"},
    {"JoinedCut", kNetToSink + "0a 030a 10 000b 0002 01 6f52", "net_msg app_msg",
     NoteKind::kDoesNotFit},
    {"UpdatesTooMany", kNetToSink + "08 030a 23 19 01020304", "net_msg app_msg",
     NoteKind::kDoesNotFit},
    {"UpdatesNone", kNetToSink + "04 030a 23 00", "net_msg app_msg updates"},
    {"AckTooShort", kNetToSink + "03 0906 01", "net_msg app_msg", NoteKind::kDoesNotFit},
    {"SynapticCut", kNetToSink + "05 010b 000080", "net_msg app_msg", NoteKind::kDoesNotFit},
    {"SynapticNothing", kNetToSink + "02 010b", "net_msg app_msg synaptic_data"},
    {"Synaptic", kNetToSink + "0a 010b 0000803f 00000040", "net_msg app_msg synaptic_data"},
};

class DecodeBody : public ::testing::TestWithParam<BodyCase> {};

TEST_P(DecodeBody, IsInterpretedOrOpaqueNeverMalformed) {
  const Message m("net_msg", GetParam().hex);
  EXPECT_EQ(m->error.fault, Fault::kNone);
  EXPECT_EQ(m.path(), GetParam().path);
  ASSERT_EQ(m->note_count(), GetParam().note ? 1u : 0u);
  if (GetParam().note) {
    EXPECT_EQ(m->notes()[0].kind, *GetParam().note);
  }
}

INSTANTIATE_TEST_SUITE_P(All, DecodeBody, ::testing::ValuesIn(kBodies),
                         [](const auto& row) { return row.param.name; });

TEST(Decode, BytesAfterACarrier_AreAFault) {
  const Message m("rubicon", "00 ffff 0000 03 00 25 0a000c 77", Tail::kFault);
  EXPECT_EQ(m->error.fault, Fault::kTrailing);
  EXPECT_EQ(m->error.offset_bytes, 11u);
  EXPECT_EQ(m->error.requirement, "WIRE-AM-LENGTH"_rule);
}

TEST(Decode, OneObjectForManyFrames_ForgetsTheOneBefore) {
  Decoded decoded;
  const Type* type = find_type(rubicon::tables::kProtocol, "updates");
  const auto good = from_hex("23 01 0001 012e ff");
  decode(*type, view(good), Tail::kStale, true, decoded);
  EXPECT_EQ(decoded.stale_count(), 1u);
  decode(*type, view(good).first(1), Tail::kStale, true, decoded);
  EXPECT_EQ(decoded.error.fault, Fault::kTruncated);
  EXPECT_EQ(decoded.stale_count(), 0u);
  EXPECT_EQ(decoded.node_count(), 2u);
}

TEST(Decode, AnotherProtocolIsOnlyOtherTables) {
  const Type* type = find_type(oscilloscope::tables::kProtocol, "oscilloscope_msg");
  ASSERT_NE(type, nullptr);
  const auto bytes =
      from_hex("0001 0100 0007 000a 0001 0002 0003 0004 0005 0006 0007 0008 0009 000a");
  Decoded decoded;
  decode(*type, view(bytes), Tail::kStale, true, decoded);
  EXPECT_EQ(decoded.error.fault, Fault::kNone);
  const Node& readings = decoded[decoded.child(0, "readings")];
  EXPECT_EQ(readings.count, 10u);
  EXPECT_EQ(load_number(*readings.field, view(bytes).data() + readings.offset + 18), 10);
}

TEST(Evaluate, FloorsLikeKaitai) {
  const ExprStep steps[] = {{Op::kConst, -7}, {Op::kConst, 2}, {Op::kDiv, 0}};
  EXPECT_EQ(evaluate(Expr{steps, 3}, Bytes()), -4);
  const ExprStep mod[] = {{Op::kConst, -7}, {Op::kConst, 4}, {Op::kMod, 0}};
  EXPECT_EQ(evaluate(Expr{mod, 3}, Bytes()), 1);
}

}  // namespace
}  // namespace rubric::reflect
