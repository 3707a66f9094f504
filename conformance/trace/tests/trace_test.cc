// Decoding and encoding of messages, messages of applications, and the lines of logs.
#include "conformance/trace/trace.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "codec/reflect/encode.h"
#include "conformance/trace/check.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/match.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"
#include "conformance/trace/tests/testing.h"

namespace rubric::trace {
namespace {

std::string shown(const AmFrame& one, LinkKind link) { return print(decode(one, link).message); }

std::string encoded(std::string_view text, const Bindings& bindings = {}) {
  try {
    const AmFrame made = encode(message(text), bindings);
    return fmt::format("{} {:02x}", made.type, fmt::join(made.payload, ""));
  } catch (const TraceError& error) {
    return std::to_string(error.place().column) + ": " + error.what();
  }
}

// Decoding.

TEST(Decode, ShowsNamesAddressesAndLists) {
  EXPECT_EQ(shown(frame(14, "0007 01 0043 01"), LinkKind::kRadio),
            "join_request(seq_num=7 mote_desc.mote_type=telosb_demo "
            "mote_desc.transducers=light|temp|humid mote_desc.actuators=led)");
  EXPECT_EQ(shown(frame(29, "000b0001 000bfffd 0007 09 0000 80"), LinkKind::kRadio),
            "ack_join(dest=11:1 src=11:null seq_num=7 mote_desc.mote_type=9 "
            "mote_desc.transducers=0 mote_desc.actuators=bit7)");
  EXPECT_EQ(
      shown(frame(28, "000bffff 000b0001 00 0009 0a 01 0a 0000003f cdcccc3d"), LinkKind::kRadio),
      "net_msg(dest=11:all src=11:1 reliable=0 seq_num=9 nbytes=10 "
      "payload.trans_id=syn_channel payload.app_id=control_layer "
      "payload.body.values=[0.5 0.1])");
  EXPECT_EQ(shown(frame(28, "000b0001 000b0005 01 0009 0c 03 0a 23 02 0001 0102 0002 0304"),
                  LinkKind::kSerial),
            "net_msg(dest=11:1 src=11:5 reliable=1 seq_num=9 nbytes=12 payload.trans_id=connless "
            "payload.app_id=control_layer payload.body.type=updates payload.body.output_size=2 "
            "payload.body.updates[0].transducer=light payload.body.updates[0].value=258 "
            "payload.body.updates[1].transducer=temp payload.body.updates[1].value=772)");
}

TEST(Decode, OpaqueBytesAndUnknownFrames) {
  EXPECT_EQ(
      shown(frame(28, "000b0001 000b0005 00 0009 0b 03 05 4f50454e5f444f4f52"), LinkKind::kRadio),
      "net_msg(dest=11:1 src=11:5 reliable=0 seq_num=9 nbytes=11 payload.trans_id=connless "
      "payload.app_id=mockup payload.payload=\"OPEN_DOOR\")");
  EXPECT_EQ(shown(frame(77, "0102"), LinkKind::kRadio), "am(type=77 payload=x0102)");
  EXPECT_EQ(shown(frame(14, "0102"), LinkKind::kRadio), "am(type=join payload=x0102)");
  EXPECT_EQ(shown(frame(14, "000701004301"), LinkKind::kSerial),
            "am(type=join payload=x000701004301)");
  EXPECT_EQ(shown(frame(28, ""), LinkKind::kPeis), "am(type=net payload=x)");
  EXPECT_EQ(shown(frame(14, "000701004301"), LinkKind::kPeis),
            "am(type=join payload=x000701004301)");
}

TEST(Decode, NumbersAndPairsByPath) {
  const Concrete seen = decode(frame(29, "000b0001 000b0005 0007 01 0043 01"), LinkKind::kRadio);
  EXPECT_EQ(seen.number("seq_num"), 7);
  EXPECT_EQ(seen.number("mote_desc.transducers"), 0x43);
  EXPECT_EQ(seen.number("dest"), std::nullopt);
  EXPECT_EQ(seen.pair("src"), std::pair(std::uint16_t{11}, std::uint16_t{5}));
  EXPECT_EQ(seen.pair("seq_num"), std::nullopt);
  EXPECT_EQ(seen.pair("mote_desc"), std::nullopt);
}

// Encoding.

TEST(Encode, BytesThatNbytesCountsBehindTheContentAreLeftOver) {
  const std::string ack =
      "net_msg(dest=11:5 src=11:2 reliable=0 seq_num=9 nbytes=8 payload.trans_id=rubicon_ack "
      "payload.app_id=mockup payload.body.seq_num=258";
  EXPECT_EQ(encoded(ack + " ...)"), "28 000b0005000b000200000908090517010200a5a5");
  EXPECT_EQ(encoded(ack + " payload.body.ack=0)"),
            "1: net_msg: payload.body: expected 6 bytes, given 4 bytes");
}

TEST(Encode, MessagesOfTheWire) {
  EXPECT_EQ(encoded("join_reply(island_addr=11 mote_addr=5 seq_num=0x102 ...)"),
            "15 000b0005000000000102");
  EXPECT_EQ(encoded("join_request(seq_num=7 mote_type=telosb_demo transducers=light|bit15 "
                    "actuators=0)"),
            "14 000701800100");
  EXPECT_EQ(encoded("net_msg(dest=11:all src=11:1 reliable=1 seq_num=9 payload.trans_id=connless "
                    "payload.app_id=mockup payload.payload=\"OPEN_DOOR\")"),
            "28 000bffff000b00010100090b03054f50454e5f444f4f52");
  EXPECT_EQ(encoded("net_msg(dest=11:1 src=11:5 trans_id=connless app_id=control_layer "
                    "body.msg_type=serial_joined body.island_addr=11 ...)"),
            "28 000b0001000b000500000"
            "00b030a10000b000000000000");
  EXPECT_EQ(encoded("net_msg(dest=11:1 ...)"),
            "28 000b00010000000000000002"
            "0000");
  EXPECT_EQ(encoded("net_msg(dest=11:1 src=11:5 reliable=0 seq_num=3 trans_id=syn_channel "
                    "app_id=learning body.values=[0.5 -1 inf])"),
            "28 000b0001000b00050000030e01060000003f000080bf0000807f");
  EXPECT_EQ(encoded("net_msg(dest=11:1 src=11:5 trans_id=connless app_id=control_layer "
                    "body.updates[0].transducer=temp body.updates[0].value=1 "
                    "body.updates[1].transducer=light ...)"),
            "28 000b0001000b00050000000c030a2302000200010001"
            "0000");
  EXPECT_EQ(encoded("net_msg(dest=11:1 src=11:5 reliable=0 seq_num=3 trans_id=connless "
                    "app_id=control_layer body=x10)"),
            "28 000b0001000b000500000303030a10");
  EXPECT_EQ(encoded("am(type=77 payload=x0a0b)"), "77 0a0b");
  EXPECT_EQ(encoded("am(type=77 ...)"), "77 ");
}

TEST(Encode, ABodyFromThePcHasItsOwnMeaning) {
  EXPECT_EQ(encoded("net_msg(dest=11:5 src=11:null seq_num=1 trans_id=connless app_id=learning "
                    "body.type=set_clock body.clock=500 ...)"),
            "28 000b0005000bfffd000001070306"
            "0801f40000");
  EXPECT_EQ(encoded("net_msg(dest=11:5 src=11:1 seq_num=1 trans_id=connless app_id=learning "
                    "body.ack=1 ...)"),
            "28 000b0005000b000100000106"
            "030617000001");
}

TEST(Encode, VariablesAndOtherValues) {
  Bindings bindings;
  bindings.set("q", Value::of(7));
  bindings.set("a", Value::address(11, 5));
  bindings.set("b", Value::bytes("\x01"));
  EXPECT_EQ(encoded("join_reply(seq_num=$q ...)", bindings), "15 00000000000000000007");
  EXPECT_EQ(encoded("join_reply(seq_num=!$q ...)", bindings), "15 00000000000000000008");
  EXPECT_EQ(encoded("join_reply(seq_num=$q+256 ...)", bindings), "15 00000000000000000107");
  EXPECT_EQ(encoded("join_reply(seq_num=$q-8 ...)", bindings), "15 0000000000000000ffff");
  EXPECT_EQ(encoded("join_reply(seq_num=!65535 ...)"), "15 0000000000000000fffe");
  EXPECT_EQ(encoded("am(type=!join payload=!$b)", bindings), "15 00");
  EXPECT_EQ(encoded("ack_join(dest=$a src=!$a ...)", bindings), "29 000b0005000b0006000000000000");
  EXPECT_EQ(encoded("ack_join(dest=$q:$q ...)", bindings), "29 0007000700000000000000000000");
}

TEST(Encode, RefusesWhatCannotBeEncoded) {
  EXPECT_EQ(encoded("join_reply(seq_num=* ...)"), "12: expected a value, given '*'");
  EXPECT_EQ(encoded("join_reply(seq_num=1..2 ...)"), "12: expected a value, given the range 1..2");
  EXPECT_EQ(encoded("join_reply(seq_num=$q ...)"), "12: nothing has bound $q");
  EXPECT_EQ(encoded("join_reply(seq_num=$q+256 ...)"), "12: nothing has bound $q to a number");
  EXPECT_EQ(encoded("ack_join(dest=11:$q ...)"), "10: nothing has bound $q");
  EXPECT_EQ(encoded("join_reply(*)"), "1: 'join_reply' needs its fields");
  EXPECT_EQ(encoded("joined(11:5 success)"), "1: 'joined' is not a message of a frame");
  EXPECT_EQ(encoded("join_reply(seq_num=1)"),
            "1: join_reply: island_addr: is missing: expected a number from 0 to 65535");
  EXPECT_EQ(encoded("net_msg(reliable=2 ...)"), "9: expected a number from 0 to 1, given '2'");
  EXPECT_EQ(encoded("net_msg(body.updates[999].value=1 ...)"), "9: index 999 is too large");
  EXPECT_EQ(encoded("net_msg(dest.pid=1 dest=11:1 ...)"), "20: 'dest' is given twice");
  EXPECT_EQ(encoded("am(type=1 payload=\"" + std::string(115, 'a') + "\")"),
            "1: am has 115 bytes, at most 114");
}

TEST(Encode, DecodesToWhatItWasMadeOf) {
  for (const char* text :
       {"join_request(seq_num=7 mote_desc.mote_type=telosb_demo "
        "mote_desc.transducers=light|temp|humid mote_desc.actuators=led)",
        "net_msg(dest=11:all src=local:5 reliable=0 seq_num=9 nbytes=10 "
        "payload.trans_id=syn_channel payload.app_id=77 payload.body.values=[0.1 nan])",
        "am(type=200 payload=x01)"}) {
    EXPECT_EQ(shown(encode(message(text)), LinkKind::kRadio), text);
  }
}

Scope two_islands() {
  Scope scope;
  scope.nodes.push_back({"m5", Role::kMote, 5, {}, true});
  scope.nodes.push_back({"sA", Role::kSink, 1, 11, false});
  scope.nodes.push_back({"sB", Role::kSink, 1, 12, false});
  scope.nodes.push_back({"bA", Role::kBaseStation, {}, 11, false});
  scope.nodes.push_back({"bB", Role::kBaseStation, {}, 12, false});
  return scope;
}

std::string addresses(const std::string& text, const Scope& scope = two_islands()) {
  Parsed parsed = parse_syntax("%rtr 1\ncase a\n" + text, "t");
  EXPECT_EQ(parsed.errors(), "");
  try {
    const AmFrame made = frame_of(*parsed.file.cases[0].lines()[0], scope);
    return std::to_string(made.src) + "->" + std::to_string(made.dest);
  } catch (const TraceError& error) {
    return error.what();
  }
}

TEST(FrameOf, AddressesThatALineLeavesOut) {
  EXPECT_EQ(addresses("0 m5 < rA am=3->all join_reply(...)"), "3->65535");
  EXPECT_EQ(addresses("0 m5 < rA join_reply(...)"), "1->5");
  EXPECT_EQ(addresses("0 sA < rA join_request(...)"), "5->65535");
  EXPECT_EQ(addresses("0 m5 < rA net_msg(src=11:1 ...)"), "1->5");
  EXPECT_EQ(addresses("0 sA < rA net_msg(src=11:null ...)"), "5->1");
  EXPECT_EQ(addresses("0 bB < peis net_msg(src=11:5 dest=12:1 ...)"), "11->12");
  EXPECT_EQ(addresses("0 m5 < rA rssi_beacon(anchor_id=1) | 0000070009010006 03"), "9->7");
  Scope scope = two_islands();
  scope.nodes[2].id = 2;
  EXPECT_EQ(addresses("0 m5 < rA join_reply(...)", scope),
            "several nodes can have sent this: am=SOURCE->DESTINATION says who");
  scope.nodes.resize(1);
  EXPECT_EQ(addresses("0 m5 < rA join_reply(...)", scope),
            "no node can have sent this: am=SOURCE->DESTINATION says who");
}

// Messages of applications.

std::string made(std::string_view text, const Bindings& bindings = {}) {
  try {
    return print(concrete(message(text), bindings).message);
  } catch (const TraceError& error) {
    return std::to_string(error.place().column) + ": " + error.what();
  }
}

TEST(App, CallsAndEvents) {
  EXPECT_EQ(made("join(1 light|temp led)"),
            "join(type=telosb_demo transducers=light|temp actuators=led)");
  EXPECT_EQ(made("joined(11:5 fail)"), "joined(address=11:5 result=fail)");
  EXPECT_EQ(made("send(all:null data=\"OPEN_DOOR\" ...)"),
            "send(dest=all:null app_id=0 reliable=0 data=\"OPEN_DOOR\")");
  EXPECT_EQ(made("write_output(2->1 pos=3 value=0.25)"),
            "write_output(channel=2->1 pos=3 value=0.25)");
  EXPECT_EQ(made("write_output(channel=!2->1 ...)"), "write_output(channel=2->2 pos=0 value=0.0)");
  EXPECT_EQ(made("interface(radio on)"), "interface(link=radio on=on)");
  EXPECT_EQ(made("get_clock"), "get_clock");
  EXPECT_EQ(made("start_all()"), "start_all()");
  EXPECT_EQ(made("clock(4294967295)"), "clock(ms=4294967295)");
  Bindings bindings;
  bindings.set("c", Value::channel(0x00020001));
  EXPECT_EQ(made("start($c)", bindings), "start(channel=2->1)");
  EXPECT_EQ(made("start($d)", bindings), "7: nothing has bound $d");
  EXPECT_EQ(made("start(2:1)"), "7: channel: expected a channel, as 2->1");
  EXPECT_EQ(made("joined(11:5)"), "1: field result of joined is missing");
  EXPECT_EQ(made("joined(*)"), "1: 'joined' needs its fields");
  EXPECT_EQ(made("net_msg(...)"), "1: 'net_msg' is not a message of an application");
  const Concrete joined = concrete(message("joined(11:5 success)"));
  EXPECT_EQ(joined.pair("address"), std::pair(std::uint16_t{11}, std::uint16_t{5}));
  EXPECT_EQ(joined.number("result"), 1);
}

TEST(App, NamesAreThoseOfNoOtherMessage) {
  for (const auto& [name, shape] : Schema::get().shapes()) {
    EXPECT_TRUE((shape.type == nullptr) != (shape.app == nullptr)) << name;
    EXPECT_EQ(shape.name, name);
  }
  EXPECT_EQ(Schema::get().find("net_msg")->am_type, 28);
  EXPECT_TRUE(Schema::get().find("net_msg")->peis);
  EXPECT_FALSE(Schema::get().find("config")->radio);
}

// Logs.

TEST(Log, BuiltInCodeParsesToItself) {
  File file = File::begin("deployed", Tick::kUs);
  file.node({"m5", Role::kMote, 5, {}, true}).node({"sA", Role::kSink, 1, 11, false});
  file.header({SeedHeader{42}, {}, {}}).header({NoteHeader{"what; was | seen"}, {}, {}});
  file.head.emplace_back(Blank{});
  Case one("run.1");
  one.add(app_line(0, "m5", Op::kGiven, "app",
                   Message::named("join")
                       .with("type", Value::names("telosb_demo"))
                       .with("transducers", Value::of(0))
                       .with("actuators", Value::names("led"))));
  Line sent = frame_line(3, "m5", Op::kEmits, "rA", LinkKind::kRadio, frame(14, "0007 01 0043 01"));
  sent.requirements.emplace_back(requirement_text("J1-REQUEST"_rule));
  one.add(sent);
  one.add(fault_line(4, Op::kLost, "rA", LinkKind::kRadio, frame(14, "0007 01 0043 01")));
  one.add(frame_line(5, "sA", Op::kGiven, "rA", LinkKind::kRadio, frame(14, "ff")));
  one.add(
      app_line(6, "m5", Op::kGiven, "rA", Message::named("linkack").with("acked", Value::of(0))));
  one.add(app_line(7, "m5", Op::kGiven, "power", Message::named("reboot")));
  file.cases.push_back(one);
  const std::string text = print(file);
  const Parsed parsed = parse(text, "log.rtr");
  EXPECT_EQ(parsed.errors(), "");
  EXPECT_TRUE(parsed.file == file) << text << print(parsed.file);
  EXPECT_EQ(print(parsed.file), text);
  EXPECT_TRUE(check(file).empty());
  EXPECT_NE(text.find("  @3         m5  >  rA   am=5->all join_request(seq_num=7 "
                      "mote_desc.mote_type=telosb_demo mote_desc.transducers=light|temp|humid "
                      "mote_desc.actuators=led)  [J1-REQUEST]  | 00ffff000506000e000701004301"),
            std::string::npos)
      << text;
}

TEST(Log, EveryFramePrintsAndComesBack) {
  std::uint32_t random = 1;
  for (int i = 0; i < 20000; ++i) {
    const auto next = [&] {
      random = random * 1664525 + 1013904223;
      return static_cast<std::uint8_t>(random >> 24);
    };
    AmFrame one;
    one.type = next() % 40;
    one.src = next();
    one.dest = static_cast<std::uint16_t>(next() << 8 | next());
    one.payload.resize(next() % 115);
    for (std::uint8_t& byte : one.payload) {
      byte = static_cast<std::uint8_t>(next() % 3 != 0 ? next() % 12 : next());
    }
    const LinkKind link = i % 2 ? LinkKind::kRadio : LinkKind::kSerial;
    const std::string node = i % 2 ? "m5" : "sA";
    const std::string name = i % 2 ? "rA" : "serA";
    const Line line = frame_line(i, node, Op::kGiven, name, link, one);
    const Parsed parsed = parse(
        "%rtr 1\n%node m5 mote id=5\n%node sA sink id=1 island=11\ncase a\n" + print(line), "t");
    ASSERT_EQ(parsed.errors(), "") << print(line);
    ASSERT_TRUE(*parsed.file.cases[0].lines()[0] == line) << print(line);
    ASSERT_EQ(frame_of(line, {}), one);
  }
}

TEST(Requirements, TextAndId) {
  EXPECT_EQ(requirement_text("J4-SEQ"_rule), "J4-SEQ");
  EXPECT_EQ(requirement_id("J4-SEQ"), "J4-SEQ"_rule);
  EXPECT_EQ(requirement_id("J4"), ReqId::kNone);
  EXPECT_EQ(requirement_id(""), ReqId::kNone);
}

}  // namespace
}  // namespace rubric::trace
