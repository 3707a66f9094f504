#include "codec/reflect/frame.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/generated/rubicon/tables.h"

namespace rubric::reflect {
namespace {

using rubric::testing::from_hex;
using rubric::testing::view;

const FrameDecoder kDecoder(rubicon::tables::kProtocol);

/// A packet with its bytes, decoded.
struct Case {
  Case(Framing framing, const std::string& hex, std::int32_t kind = kAbsent)
      : bytes(from_hex(hex)) {
    packet.framing = framing;
    packet.bytes = view(bytes);
    packet.kind = kind;
  }
  const Frame& decode() {
    kDecoder.decode(packet, frame);
    return frame;
  }
  std::string bytes;
  Packet packet;
  Frame frame;
};

const std::string kSerialConfig = "00000100000300250a000c";
const std::string kJoinRequest = "c4f501004301";

TEST(Frame, RadioIFrame_AndTFrame_SameMessage) {
  for (const std::string network : {"3f", ""}) {
    Case c(Framing::kRadio,
           "4188072200"
           "01000200" +
               network + "0e" + kJoinRequest);
    const Frame& frame = c.decode();
    EXPECT_FALSE(frame.malformed());
    ASSERT_NE(frame.decoded.message(), nullptr);
    EXPECT_STREQ(frame.decoded.message()->name, "join_request");
    EXPECT_EQ(frame.mac.has_network, !network.empty());
    EXPECT_EQ(frame.mac.dsn, 7);
    EXPECT_EQ(frame.am.dest, 1);
    EXPECT_EQ(frame.am.src, 2);
    EXPECT_EQ(frame.am.group, 0x22);
    EXPECT_EQ(frame.am.length, 6);
    EXPECT_EQ(frame.am.type, 14);
  }
}

/// The serial carrier of RUBICON, with another name of what its frames begin with.
TEST(Frame, HeadersThatAreNotTinyOs_AreFieldsOfTheMessage) {
  const Type& serial = *find_carrier(rubicon::tables::kProtocol, "serial");
  ASSERT_TRUE(has_tinyos_headers(serial));
  std::vector<Field> fields(serial.fields, serial.fields + serial.field_count);
  fields[0].name = "head";
  Type type = serial;
  type.fields = fields.data();
  const Carrier carrier{"serial", &type};
  Protocol protocol = rubicon::tables::kProtocol;
  protocol.carriers = &carrier;
  protocol.carrier_count = 1;
  EXPECT_FALSE(has_tinyos_headers(type));

  const Case c(Framing::kSf, kSerialConfig);
  Frame frame;
  FrameDecoder(protocol).decode(c.packet, frame);
  EXPECT_FALSE(frame.has_error());
  EXPECT_FALSE(frame.am.present);
  EXPECT_TRUE(frame.has_payload);
  EXPECT_EQ(frame.payload_node, 0U);
  EXPECT_STREQ(frame.decoded.message()->name, "config");
  // A protocol of serial lines alone says of half a frame control field what others say.
  const Case half(Framing::kRadio, "02");
  FrameDecoder(protocol).decode(half.packet, frame);
  EXPECT_EQ(frame.error.fault, Fault::kTruncated);
  EXPECT_EQ(frame.error.offset_bytes, 1U);
}

TEST(Frame, LinkAck_IsAMessageWithoutActiveMessage) {
  Case c(Framing::kRadio, "020007");
  const Frame& frame = c.decode();
  EXPECT_FALSE(frame.malformed());
  EXPECT_FALSE(frame.am.present);
  EXPECT_STREQ(frame.decoded.message()->name, "mac_ack");
}

TEST(Frame, SerialPacketWithARadioMessage_IsReadAndNoted) {
  for (const auto& [hex, message, kind] : {std::tuple{"0000010000060"
                                                      "00e"
                                                      "c4f501004301",
                                                      "join_request", NoteKind::kRadioOnly},
                                           {"0000010000050"
                                            "00e"
                                            "c4f5010043",
                                            "", NoteKind::kDoesNotFit},
                                           {"0000010000050"
                                            "0c8"
                                            "c4f5010043",
                                            "", NoteKind::kUnknownMessage}}) {
    Case c(Framing::kSf, hex);
    const Frame& frame = c.decode();
    EXPECT_FALSE(frame.malformed());
    EXPECT_TRUE(frame.has_payload);
    const Type* type = frame.decoded.message();
    EXPECT_STREQ(type ? type->name : "", message);
    ASSERT_EQ(frame.decoded.note_count(), 1U);
    EXPECT_EQ(frame.decoded.notes()[0].kind, kind);
    EXPECT_EQ(frame.decoded.notes()[0].offset, 8U);
  }
}

struct NoteCase {
  const char* name;
  Framing framing;
  const char* hex;
  std::int32_t kind;
  std::size_t notes;
};

class FrameNote : public ::testing::TestWithParam<NoteCase> {};

TEST_P(FrameNote, FramesThatNobodyReadsAreNoted) {
  const NoteCase& row = GetParam();
  Case c(row.framing, row.hex, row.kind);
  const Frame& frame = c.decode();
  EXPECT_FALSE(frame.malformed());
  ASSERT_EQ(frame.decoded.note_count(), row.notes);
  if (row.notes) {
    EXPECT_EQ(frame.decoded.notes()[0].kind, NoteKind::kNotDecoded);
    EXPECT_FALSE(frame.am.present);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FrameNote,
    ::testing::Values(NoteCase{"Beacon", Framing::kRadio, "008007220001000200", kAbsent, 1},
                      NoteCase{"LongAddresses", Framing::kRadio, "41cc07220001000200", kAbsent, 1},
                      NoteCase{"UnknownSerialKind", Framing::kHdlc, "43", 0xff, 1},
                      NoteCase{"SerialAck", Framing::kHdlc, "", 67, 0},
                      NoteCase{"SerialPacket", Framing::kHdlc, "00000100000300250a000c", 69, 0}),
    [](const auto& row) { return row.param.name; });

TEST(Frame, FramingFault_ComesFirst_AndCountsFromTheDispatchByte) {
  Case c(Framing::kHdlc, kSerialConfig, 68);
  c.packet.serial_seq = 0;
  c.packet.error = Error{Fault::kCrc, 13, "WIRE-SERIAL-CRC"_rule};
  const Frame& frame = c.decode();
  EXPECT_EQ(frame.error, (Error{Fault::kCrc, 11, "WIRE-SERIAL-CRC"_rule}));
  EXPECT_STREQ(frame.decoded.message()->name, "config");
}

TEST(Frame, CutForwarderPacket_CountsFromTheDispatchByte) {
  Case stream(Framing::kSf, "0001");
  stream.packet.error = Error{Fault::kCut, 3, "WIRE-SF-LENGTH"_rule};  // From the length byte on.
  EXPECT_EQ(stream.decode().error, (Error{Fault::kCut, 2, "WIRE-SF-LENGTH"_rule}));
  Case record(Framing::kSf, "0001");
  record.packet.link_type = 148;  // No length byte.
  record.packet.error = Error{Fault::kTooLong, 255, "WIRE-SF-LENGTH"_rule};
  EXPECT_EQ(record.decode().error, (Error{Fault::kTooLong, 255, "WIRE-SF-LENGTH"_rule}));
}

TEST(Frame, CutInTheHeader_NamesTheHeadersRule) {
  Case serial(Framing::kSf, "00ffff");
  EXPECT_EQ(serial.decode().error, (Error{Fault::kTruncated, 3, "WIRE-AM-HEADER"_rule}));
  EXPECT_FALSE(serial.frame.has_payload);
  Case radio(Framing::kRadio, "418807220001000200");
  EXPECT_EQ(radio.decode().error, (Error{Fault::kTruncated, 9, "WIRE-RADIO-NETWORK"_rule}));
}

}  // namespace
}  // namespace rubric::reflect
