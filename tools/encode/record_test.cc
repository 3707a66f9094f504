#include "tools/encode/record.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "codec/generated/rubicon/tables.h"
#include "tools/encode/members.h"

namespace rubric::encode {
namespace {

using reflect::Value;

// A join reply from a sink to a mote, as heard on the radio, and a packet on the serial line.
const std::string kRadio =
    R"({"schema":"rubric.decode/1","index":0,"offset":0,"time":1.5,"interface":"radio",)"
    R"("direction":"outbound","framing":"radio","frame":{"fcf":34881,"dsn":7,"destpan":34,)"
    R"("dest":2,"src":1,"network":63,"fcs":4660},)"
    R"("am":{"dest":2,"src":1,"length":10,"group":34,"type":15},)"
    R"("message":"join_reply","path":["join_reply"],"fields":{"island_addr":11,"mote_addr":2,)"
    R"("cur_time":258,"seq_num":50421},"notes":[],"stale":"","raw":)"
    R"("4188072200020001003f0f000b000200000102c4f5","error":null})";

// Returns a line with some members replaced; an empty text removes one.
using Changes = std::vector<std::pair<std::string, std::string>>;

Value changed(Value line, const Changes& changes) {
  for (const auto& [path, text] : changes) {
    Value* object = &line;
    std::string key = path;
    for (std::size_t dot; (dot = key.find('.')) != std::string::npos; key.erase(0, dot + 1)) {
      object = const_cast<Value*>(object->find(key.substr(0, dot)));
    }
    bool found = false;
    for (std::size_t i = 0; i < object->keys.size(); ++i) {
      if (object->keys[i] != key) continue;
      found = true;
      if (text.empty()) {
        object->keys.erase(object->keys.begin() + static_cast<std::ptrdiff_t>(i));
        object->items.erase(object->items.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        object->items[i] = parse_json(text);
      }
      break;
    }
    if (!found && !text.empty()) object->set(key, parse_json(text));
  }
  return line;
}

Value radio_line() {
  static const Value line = [] {
    Value parsed = parse_json(kRadio);
    // The right FCS is computed once, so that rows need not know it.
    OwnedPacket packet;
    Value open = changed(parsed, {{"frame.fcs", ""}});
    RecordReader(rubicon::tables::kProtocol).read(open, packet);
    return changed(parsed, {{"frame.fcs", std::to_string(packet.packet.fcs)}});
  }();
  return line;
}

Value serial_line() {
  static const Value line = [] {
    Value parsed =
        parse_json(R"({"schema":"rubric.decode/1","time":null,"framing":"hdlc",)"
                   R"("frame":{"kind":68,"kind_name":"packet_ack","serial_seq":9,"dispatch":0},)"
                   R"("am":{"dest":1,"src":0,"length":5,"group":0,"type":37},"path":["config"],)"
                   R"("fields":{"type":10,"type_name":"set_island_id","value":12},"stale":"aabb",)"
                   R"("error":null})");
    OwnedPacket packet;
    RecordReader(rubicon::tables::kProtocol).read(parsed, packet);
    parsed = changed(parsed, {{"frame.crc", std::to_string(packet.packet.crc)}});
    return changed(parsed, {{"raw",
                             "\"0000010000050025"
                             "0a000c"
                             "aabb\""}});
  }();
  return line;
}

std::string outcome(const Value& line) {
  OwnedPacket packet;
  try {
    RecordReader(rubicon::tables::kProtocol).read(line, packet);
  } catch (const RecordError& error) {
    return error.what();
  }
  return fmt::format("{:02x}", fmt::join(packet.bytes, ""));
}

constexpr const char* kRadioRaw = "4188072200020001003f0f000b000200000102c4f5";
constexpr const char* kSerialRaw = "00000100000500250a000caabb";

struct Row {
  const char* name;
  bool radio;
  Changes changes;
  std::string expected;
};
void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

Row radio(const char* name, Changes changes, std::string expected) {
  return {name, true, std::move(changes), std::move(expected)};
}
Row serial(const char* name, Changes changes, std::string expected) {
  return {name, false, std::move(changes), std::move(expected)};
}

const Row kRows[] = {
    radio("RadioAsItIs", {}, kRadioRaw),
    radio("RadioWithoutRaw", {{"raw", ""}}, kRadioRaw),
    radio("RadioFromFieldsAlone", {{"raw", ""}, {"am", "null"}, {"frame.fcs", ""}}, kRadioRaw),
    radio("RadioTFrame", {{"raw", ""}, {"frame.network", "null"}, {"frame.fcs", ""}},
          "4188072200020001000f000b000200000102c4f5"),
    radio("RadioAck",
          {{"raw", ""}, {"am", "null"}, {"fields", "null"}, {"frame", R"({"fcf":2,"dsn":7})"}},
          "020007"),
    serial("SerialAsItIs", {}, kSerialRaw),
    serial("SerialWithoutRaw", {{"raw", ""}}, kSerialRaw),
    serial("SerialLengthComputed", {{"raw", ""}, {"am.length", ""}}, kSerialRaw),
    serial("SerialAmTypeOfThePath", {{"raw", ""}, {"am.type", ""}}, kSerialRaw),
    serial("SerialChangedField", {{"raw", ""}, {"fields.value", "13"}, {"frame.crc", ""}},
           "00000100000500250a000daabb"),
    serial("SerialAcknowledgement",
           {{"raw", ""},
            {"am", "null"},
            {"fields", "null"},
            {"frame", R"({"kind":67,"serial_seq":9})"}},
           ""),
    serial("MalformedTakesRaw",
           {{"error", R"({"fault":"crc","requirement":"WIRE-SERIAL-CRC"})"},
            {"frame.crc", "1"},
            {"fields.value", "13"}},
           kSerialRaw),
    serial("BareMessage", {{"framing", "\"bare\""}, {"frame", "{}"}, {"am", "null"}, {"raw", ""}},
           "0a000caabb"),

    radio("NoSchema", {{"schema", ""}}, "schema: expected \"rubric.decode/1\", given none"),
    radio("OtherSchema", {{"schema", "\"x\""}},
          "schema: expected \"rubric.decode/1\", given \"x\""),
    radio("UnknownFraming", {{"framing", "\"x\""}},
          "framing: expected \"hdlc\", \"sf\", \"radio\" or \"bare\", given \"x\""),
    radio("UnknownDirection", {{"direction", "\"up\""}},
          "direction: expected \"inbound\", \"outbound\" or null, given \"up\""),
    radio("BadTime", {{"time", "\"x\""}},
          "time: expected seconds as a decimal number with at most nine digits after the point, or "
          "null, given \"x\""),
    radio("FrameNoObject", {{"frame", "3"}}, "frame: expected an object or null, given 3"),
    radio("NumberTooLarge", {{"frame.fcs", "65536"}},
          "frame.fcs: expected a number from 0 to 65535, given 65536"),
    radio("UnknownFault", {{"error", R"({"fault":"x"})"}},
          "error.fault: expected the name of a fault such as \"crc\", given \"x\""),
    radio("RawNoHex", {{"raw", "\"0g\""}}, "raw: expected hex digits, two a byte, given \"0g\""),
    radio("StaleNoHex", {{"stale", "\"0\""}},
          "stale: expected hex digits, two a byte, given \"0\""),
    radio(
        "FieldsChangedButRawKept", {{"fields.seq_num", "7"}},
        "fields.seq_num: given 7, but \"raw\" says 50421; delete \"raw\" if the fields are meant"),
    serial("AmChangedButRawKept", {{"am.dest", "3"}},
           "am.dest: given 3, but \"raw\" says 1; delete \"raw\" if the fields are meant"),
    radio("FrameChangedButRawKept", {{"frame.dsn", "8"}},
          "frame.dsn: given 8, but \"raw\" says 7; delete \"raw\" if the fields are meant"),
    serial(
        "StaleChangedButRawKept", {{"stale", "\"aabc\""}},
        "stale: given \"aabc\", but \"raw\" says \"aabb\"; delete \"raw\" if the fields are meant"),
    radio("AmAndFrameDisagree", {{"raw", ""}, {"am.dest", "3"}},
          "am.dest: expected 2 as frame.dest says, given 3"),
    radio("GroupAndPanDisagree", {{"raw", ""}, {"am.group", "3"}},
          "am.group: expected 34 as frame.destpan says, given 3"),
    radio("FieldMissing", {{"raw", ""}, {"fields.seq_num", ""}},
          "fields.seq_num: is missing: expected a number from 0 to 65535 (WIRE-JOIN-REPLY)"),
    radio("FieldTooLarge", {{"raw", ""}, {"fields.seq_num", "70000"}},
          "fields.seq_num: expected a number from 0 to 65535, given 70000 (WIRE-JOIN-REPLY)"),
    radio("FrameFieldMissing", {{"raw", ""}, {"frame.dsn", ""}},
          "frame.dsn: is missing: expected a number from 0 to 255 (WIRE-RADIO-HEADER)"),
    serial("NamesDisagree", {{"raw", ""}, {"fields.type", "9"}},
           "fields.type: is given as 9, but type_name says 10; expected one of them alone, or both "
           "the "
           "same (WIRE-CONFIG)"),
    serial("LengthDisagrees", {{"raw", ""}, {"am.length", "9"}},
           "am.length: expected 3, given 9: payload has 3 bytes and 2 stale ones are left "
           "(WIRE-AM-LENGTH)"),
    serial(
        "SequenceNumberMissing", {{"frame.serial_seq", ""}},
        "frame.serial_seq: is missing: expected a number from 0 to 255, as frames of kind 68 have "
        "one (WIRE-SERIAL-SEQ)"),
    serial("SequenceNumberTooMany", {{"frame.kind", "69"}},
           "frame.serial_seq: expected none, as frames of kind 69 have none, given 9 "
           "(WIRE-SERIAL-SEQ)"),
    radio("NothingToBuildFrom", {{"raw", ""}, {"fields", "null"}, {"am", "null"}},
          "raw: is missing, and there are neither fields nor am"),
    serial("BareWithoutMessage", {{"framing", "\"bare\""}, {"raw", ""}, {"path", "[]"}},
           "raw: is missing, and there are no fields of a known message"),
};

class RecordRows : public testing::TestWithParam<Row> {};

TEST_P(RecordRows, Outcome) {
  const Row& row = GetParam();
  EXPECT_EQ(outcome(changed(row.radio ? radio_line() : serial_line(), row.changes)), row.expected);
}
INSTANTIATE_TEST_SUITE_P(Rows, RecordRows, testing::ValuesIn(kRows),
                         [](const auto& row) { return row.param.name; });

TEST(Records, EverythingAroundTheBytes) {
  OwnedPacket packet;
  RecordReader(rubicon::tables::kProtocol).read(radio_line(), packet);
  EXPECT_EQ(packet.packet.framing, Framing::kRadio);
  EXPECT_EQ(packet.packet.direction, Direction::kOutbound);
  EXPECT_EQ(packet.packet.time_ns, 1'500'000'000);
  EXPECT_EQ(packet.interface_name, "radio");
  RecordReader(rubicon::tables::kProtocol).read(serial_line(), packet);
  EXPECT_EQ(packet.packet.kind, 68);
  EXPECT_EQ(packet.packet.serial_seq, 9);
  EXPECT_EQ(packet.packet.time_ns, kNoTime);
}

// Replaces a random value somewhere in the tree by another one.
void damage(Value& value, std::mt19937& random) {
  if (!value.items.empty() && random() % 8 != 0) {
    return damage(value.items[random() % value.items.size()], random);
  }
  switch (random() % 9) {
    case 0: value = Value{}; break;
    case 1: value = Value::of_integer(static_cast<std::int64_t>(random()) - 1000); break;
    case 2: value = Value::of_integer(static_cast<std::int64_t>(random() % 260)); break;
    case 3: value = Value::of_string("0aff"); break;
    case 4: value = Value::of_string("app_msg"); break;
    case 5: value = Value::of_real("1e39"); break;
    case 6: value = Value::of_array({Value::of_string("light"), Value::of_integer(3)}); break;
    case 7: value = Value::of_object(); break;
    default:
      if (!value.keys.empty()) {
        value.keys.pop_back();
        value.items.pop_back();
      }
  }
}

TEST(Records, DamagedLinesAreRefusedOrRead) {
  std::mt19937 random(7);
  RecordReader reader(rubicon::tables::kProtocol);
  OwnedPacket packet;
  int refused = 0;
  constexpr int kRounds = 20'000;
  for (int i = 0; i < kRounds; ++i) {
    Value line = i % 2 ? radio_line() : serial_line();
    if (i % 3) line = changed(line, {{"raw", ""}});
    const auto changes = 1 + random() % 3;
    for (unsigned k = 0; k < changes; ++k) damage(line, random);
    try {
      reader.read(line, packet);
    } catch (const RecordError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kRounds / 4);
  EXPECT_LT(refused, kRounds);
}

TEST(Times, ExactToTheNanosecond) {
  const auto time = [](const char* text) {
    const Value value = parse_json(text);
    return time_of(&value);
  };
  EXPECT_EQ(time("0"), 0);
  EXPECT_EQ(time("1717000000.123456789"), 1717000000123456789);
  EXPECT_EQ(time("0.000000001"), 1);
  EXPECT_EQ(time("-1.5"), -1'500'000'000);
  EXPECT_EQ(time("-0.5"), -500'000'000);
  EXPECT_EQ(time("2.5000000000"), 2'500'000'000);
  EXPECT_EQ(time("1e-06"), 1000);
  EXPECT_EQ(time("1.5e0"), 1'500'000'000);
  EXPECT_EQ(time("null"), kNoTime);
  for (const char* bad : {"1e30", "0.0000000001", "99999999999", "true", "[]"}) {
    EXPECT_THROW(time(bad), RecordError) << bad;
  }
}

TEST(Json, NumbersKeepWhatTheySay) {
  EXPECT_EQ(parse_json("-9223372036854775808").integer, INT64_MIN);
  EXPECT_EQ(parse_json("18446744073709551615").text, "18446744073709551615");
  EXPECT_EQ(parse_json("-0").text, "-0");
  EXPECT_EQ(parse_json("1.50").text, "1.50");
  EXPECT_EQ(parse_json("true").kind, Value::Kind::kBool);
}

TEST(Json, Mistakes) {
  const std::string deep(100, '[');
  for (const std::string& bad :
       {std::string("{"), std::string("{\"a\":1,\"a\":2}"), std::string("1 2"), std::string(""),
        std::string("{'a':1}"), deep, std::string("1e999")}) {
    EXPECT_THROW(parse_json(bad), JsonError) << bad;
  }
}

TEST(Record, HeadersThatAreNotTinyOs_AreFields) {
  const reflect::Type& serial = *reflect::find_carrier(rubicon::tables::kProtocol, "serial");
  std::vector<reflect::Field> fields(serial.fields, serial.fields + serial.field_count);
  fields[0].name = "head";
  reflect::Type type = serial;
  type.fields = fields.data();
  const reflect::Carrier carrier{"serial", &type};
  reflect::Protocol protocol = rubicon::tables::kProtocol;
  protocol.carriers = &carrier;
  protocol.carrier_count = 1;
  const Value line = parse_json(
      R"({"schema":"rubric.decode/1","framing":"sf","frame":{"dispatch":0},"am":null,)"
      R"("message":"config","path":["config"],"fields":{"head":{"dispatch":0,"dest":1,"src":0,)"
      R"("length":3,"group":0,"type":37},"payload":{"type":10,"value":12}},)"
      R"("raw":"00000100000300250a000c","error":null})");
  RecordReader reader(protocol);
  OwnedPacket packet;
  reader.read(line, packet);
  const std::vector<std::uint8_t> bytes = packet.bytes;
  reader.read(changed(line, {{"raw", ""}}), packet);
  EXPECT_EQ(packet.bytes, bytes);
  try {
    reader.read(changed(line, {{"fields.head.dest", "2"}}), packet);
    FAIL() << "a changed field beside raw";
  } catch (const RecordError& error) {
    EXPECT_STREQ(error.what(),
                 "fields.head.dest: given 2, but \"raw\" says 1; delete \"raw\" if the fields are "
                 "meant");
  }
}

}  // namespace
}  // namespace rubric::encode
