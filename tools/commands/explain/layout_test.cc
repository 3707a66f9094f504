#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "codec/generated/oscilloscope/tables.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "tools/commands/explain/explain_frame.h"
#include "tools/commands/explain/explain_rule.h"
#include "tools/commands/explain/table.h"
#include "tools/commands/explain/type_text.h"

namespace rubric::explain {
namespace {

using reflect::Type;
using testing::ElementsAre;
using testing::HasSubstr;

const reflect::Protocol& kRubicon = rubicon::tables::kProtocol;

const Type& type(const char* name) { return *reflect::find_type(kRubicon, name); }
const reflect::Field& field(const char* type_name, std::string_view name) {
  const Type& owner = type(type_name);
  for (int i = 0; i < owner.field_count; ++i) {
    if (name == owner.fields[i].name) return owner.fields[i];
  }
  ADD_FAILURE() << name;
  return owner.fields[0];
}

TEST(Table, AlignsAndLeavesOutEmptyColumns) {
  Table table({"a", "empty", "n"});
  table.align_right(2);
  table.add({"x", "", "1"});
  table.add({"long", "", "100"});
  EXPECT_EQ(table.text(1), " a       n\n x       1\n long  100\n");
}

TEST(Table, BreaksItsLastColumn) {
  Table table({"n", "what"});
  table.align_right(0);
  table.add({"1", "one two three four five six seven"});
  table.add({"22", "-"});
  EXPECT_EQ(table.text_within(80), table.text());
  EXPECT_EQ(table.text_within(28), " n  what\n 1  one two three four five\n    six seven\n22  -\n");
  // If there is no room the last column goes below.
  EXPECT_EQ(table.text_within(20, 1),
            "  n\n  1\n     one two three\n     four five six\n     seven\n 22\n     -\n");
}

TEST(Table, Wraps) {
  const std::string text = std::string("aa bb") + kFirmBlank + "cc dd";
  EXPECT_EQ(wrapped(text, 1, 8), " aa\n bb cc\n dd\n");
  EXPECT_EQ(wrapped("", 2), "");
}

TEST(TypeText, Fields) {
  const auto text = [](const char* owner, const char* name) {
    return type_text(field(owner, name), type(owner)) + " | " +
           size_text(field(owner, name), type(owner)) + " | " + valid_text(field(owner, name));
  };
  EXPECT_EQ(text("net_msg", "nbytes"), "u8 | 1 | 2 to 102");
  EXPECT_EQ(text("net_msg", "dest"), "r_addr | 4 | ");
  EXPECT_EQ(text("net_msg", "payload"), "by src.devid | nbytes | ");
  EXPECT_EQ(text("updates", "updates"), "transducer_update[output_size] | 4 * output_size | ");
  EXPECT_EQ(text("updates", "type"), "u8 | 1 | expected 35 (updates)");
  EXPECT_EQ(text("syn_create_cmd", "src_neurons"), "u16[10] | 20 | ");
  EXPECT_EQ(text("syn_create_cmd", "params"), "s8 | 1 | ");
  EXPECT_EQ(text("synaptic_data", "values"), "f32le[...] | rest | ");
  EXPECT_EQ(text("mote_desc", "transducers"), "mask16 | 2 | ");
  EXPECT_EQ(text("connless", "payload"), "bytes | nbytes | ");
  EXPECT_EQ(unit_text(field("data", "temp")), "degC = raw * 0.01 - 40");
  EXPECT_EQ(unit_text(field("join_reply", "cur_time")), "ms");
}

TEST(TypeText, Expressions) {
  const Type& app = type("app_msg");
  EXPECT_EQ(expr_text(app.interpretations[0].field.condition, app),
            "trans_id == connless and app_id == control_layer");
  EXPECT_EQ(expr_text(app.interpretations[0].field.choice->key, app), "byte 2");
  using reflect::Op;
  const reflect::ExprStep steps[] = {{Op::kLoadU8, 0}, {Op::kConst, 1}, {Op::kSub, 0},
                                     {Op::kConst, 2},  {Op::kMul, 0},   {Op::kConst, 4},
                                     {Op::kLt, 0},     {Op::kNot, 0}};
  EXPECT_EQ(expr_text({steps, 8}, app), "not ((trans_id - 1) * 2 < 4)");
}

TEST(TypeText, BitsWithoutNameAreNumbered) {
  const reflect::MaskTable& mask = *field("mote_desc", "transducers").mask;
  EXPECT_EQ(bits_text(mask, 0x2001), "light, bit13");
  EXPECT_EQ(bits_text(mask, 0), "none");
}

TEST(Reach, Ways) {
  EXPECT_THAT(reach_texts(reaches(kRubicon, type("net_msg"))),
              ElementsAre("AM 28 on serial", "AM 28 on radio"));
  EXPECT_THAT(reach_texts(reaches(kRubicon, type("app_msg_from_pc"))),
              ElementsAre("payload of net_msg if src.devid is 65533 (null)"));
  EXPECT_THAT(reach_texts(reaches(kRubicon, type("netid_cmd"))),
              ElementsAre("body of app_msg_from_pc if trans_id == connless and app_id == learning "
                          "and byte 2 is any other"));
  EXPECT_THAT(reach_texts(reaches(kRubicon, type("rubicon_ack"))),
              ElementsAre("body of app_msg if trans_id == rubicon_ack"));
  EXPECT_TRUE(reaches(kRubicon, type("complete")).empty());
  const Type& oscilloscope =
      *reflect::find_type(oscilloscope::tables::kProtocol, "oscilloscope_msg");
  EXPECT_THAT(am_types(reaches(oscilloscope::tables::kProtocol, oscilloscope)), ElementsAre(0x93));
}

TEST(Explain, EveryTypeEnumAndMask) {
  for (const reflect::Protocol* protocol : reflect::specs()) {
    for (int i = 0; i < protocol->type_count; ++i) {
      const Type& each = *protocol->types[i];
      const std::string text = explain_type(*protocol, each);
      for (int k = 0; k < each.field_count; ++k) EXPECT_THAT(text, HasSubstr(each.fields[k].name));
    }
    for (int i = 0; i < protocol->enum_count; ++i) {
      EXPECT_THAT(explain_enum(*protocol, *protocol->enums[i]),
                  HasSubstr(protocol->enums[i]->entries[0].name));
    }
    for (int i = 0; i < protocol->mask_count; ++i) {
      EXPECT_THAT(explain_mask(*protocol, *protocol->masks[i]), HasSubstr("mask of"));
    }
  }
}

TEST(Explain, Requirement) {
  EXPECT_EQ(explain_rule({&kRubicon}, "WIRE-NET-NBYTES"_rule, CaseList::kShort, {}, {}),
            "WIRE-NET-NBYTES: MUST, wire, messages\n"
            "  nbytes counts TRANSID, APPID and the application payload, so it is 2 to 102.\n"
            "  Source: paper: Memory Occupation; release 1.0\n"
            "  Used by rubicon: net_msg.nbytes, complete.nbytes\n");
}

TEST(Explain, RuleOfBehaviour) {
  const cases::CaseUse uses[] = {{"j4.accept", "a.rtr", "J4-ACK"_rule, false},
                                 {"j4.wrong_seq", "a.rtr", "J4-SEQ"_rule, true},
                                 {"j4.right_seq", "b.rtr", "J4-SEQ"_rule, false},
                                 {"j4.old_seq", "b.rtr", "J4-SEQ"_rule, true}};
  const RulePlace places[] = {
      {"J4-SEQ", "spec/requirements.yaml:7"},    {"J4-SEQ", "conformance/check/a.cc:2"},
      {"J8-FAIL", "conformance/machine/b.cc:3"}, {"J4-SEQ", "conformance/machine/flaws/c.cc:4"},
      {"J4-SEQ", "conformance/machine/d.cc:5"},  {"J4-SEQ", "conformance/machine/e.cc:6"}};
  EXPECT_EQ(explain_rule({&kRubicon}, "J4-SEQ"_rule, CaseList::kShort, uses, places),
            "J4-SEQ: MUST, join, mote\n"
            "  A mote ignores a join_reply whose sequence number is not that of its outstanding "
            "request.\n"
            "  For: mote; it says what must not happen\n"
            "  Source: paper: Component Management\n"
            "  Otherwise in release 1.0: A reply with a wrong number still ends the join, with a "
            "malformed\n"
            "  ack_join.\n"
            "  In the code:\n"
            "    sentence: spec/requirements.yaml:7\n"
            "    machine: conformance/machine/d.cc:5, conformance/machine/e.cc:6\n"
            "    flaws: conformance/machine/flaws/c.cc:4\n"
            "    checker: conformance/check/a.cc:2\n"
            "  Cases:\n"
            "    positive: j4.right_seq (b.rtr)\n"
            "    negative: j4.wrong_seq (a.rtr), j4.old_seq (b.rtr)\n");
  const std::string text = explain_rule({&kRubicon}, "J8-FAIL"_rule, CaseList::kShort, {}, places);
  EXPECT_THAT(text, HasSubstr("    machine: conformance/machine/b.cc:3\n    checker: nowhere, "));
  EXPECT_THAT(text, HasSubstr("  For: mote\n"));
  EXPECT_THAT(text, HasSubstr("  Accepted by --profile deployed: A joinIsland call without"));
  EXPECT_THAT(text, testing::EndsWith("  Cases: none\n"));
  EXPECT_THAT(explain_rule({}, "S2-PHASE"_rule),
              HasSubstr("    checker: never by this name; in its place: nothing: when a node"));
  EXPECT_THAT(explain_rule({}, "T2-LOOP"_rule, {}), HasSubstr("For: mote, sink, base station;"));
}

TEST(Explain, ManyCasesAreShortenedUnlessAskedFor) {
  const auto cases_of = [](std::size_t count, CaseList list) {
    const std::vector<cases::CaseUse> uses(count, {"j4.old", "a.rtr", "J4-SEQ"_rule, true});
    const std::string text = explain_rule({}, "J4-SEQ"_rule, list, uses);
    return text.substr(text.find("  Cases:"));
  };
  const std::string one = "j4.old (a.rtr)";
  const std::string four = one + ", " + one + ", " + one + ", " + one;
  EXPECT_EQ(cases_of(5, CaseList::kShort), "  Cases:\n    negative: " + four + ", " + one + "\n");
  EXPECT_EQ(cases_of(6, CaseList::kShort),
            "  Cases:\n    negative: " + four + ", 2 more:\n    rubric explain J4-SEQ --cases\n");
  EXPECT_EQ(cases_of(6, CaseList::kWhole),
            "  Cases:\n    negative: " + four + ", " + one + ",\n    " + one + "\n");
}

TEST(Explain, RulesByIdAndGroup) {
  EXPECT_THAT(rules_named("j4-seq"), ElementsAre("J4-SEQ"_rule));
  EXPECT_THAT(rules_named("n9"), ElementsAre("N9-SET"_rule, "N9-OTHER"_rule, "N9-MEMBERS"_rule));
  EXPECT_THAT(rules_named("WIRE-HDLC"), testing::Contains("WIRE-HDLC-TWO-FLAGS"_rule));
  EXPECT_EQ(rules_named("J1").size(), 4U);  // Not those of J10 and J11.
  EXPECT_THAT(rules_named("J"), testing::IsEmpty());
  EXPECT_THAT(rules_named(""), testing::IsEmpty());
  EXPECT_THAT(rules_named("N9-"), testing::IsEmpty());
  EXPECT_THAT(rule_groups(), testing::IsSupersetOf({"WIRE", "N1", "J4", "T3", "S6"}));
}

struct GuessRow {
  const char* name;
  const char* hex;
  const char* what;  // Null: no guess.
  const char* says;  // In the explanation.
};
void PrintTo(const GuessRow& row, std::ostream* out) { *out << row.name; }

const GuessRow kGuesses[] = {
    {"Packet", "00 0001 0000 03 00 25 0a000c", "a serial packet, from its dispatch byte on",
     "set_island_id"},
    {"PacketWithLengthByte", "0b 00 0001 0000 03 00 25 0a000c",
     "a serial forwarder packet, its length byte taken off", "set_island_id"},
    {"CutJoinReply", "00 0005 0001 01 00 0f 00", "a serial packet, from its dispatch byte on",
     "As join_reply it is malformed at its byte 1: island_addr needs 2 bytes"},
    {"WithKindByte", "45 00 0001 0000 03 00 25 0a000c 6e96",
     "a serial frame, from its kind byte to its CRC", "packet_noack"},
    {"WithFlags", "7e 45 00 0001 0000 03 00 25 0a00 7d5d 0000 7e",
     "a serial frame, from its kind byte to its CRC", "125"},
    {"Radio", "4188 07 2200 0200 0100 3f 0f 000b 0002 00000102 c4f5",
     "an 802.15.4 frame without FCS", "join_reply"},
    {"RadioAck", "0200 07", "an 802.15.4 frame without FCS", "dsn"},
    {"BadPacket", "00 0001 0000 09 00 25 0a000c", "a serial packet, from its dispatch byte on",
     "Malformed at byte"},
    {"Nothing", "99 88 77 66", nullptr, nullptr},
};

class Guesses : public testing::TestWithParam<GuessRow> {};

TEST_P(Guesses, OfTheFramingOfBytes) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(reflect::parse_hex(GetParam().hex, bytes));
  const auto frame = take_frame(bytes, "auto");
  ASSERT_EQ(frame.has_value(), GetParam().what != nullptr);
  if (!frame) return;
  EXPECT_EQ(frame->what, GetParam().what);
  reflect::Frame decoded;
  reflect::FrameDecoder(kRubicon).decode(frame->packet, decoded);
  EXPECT_THAT(explain_frame(decoded), HasSubstr(GetParam().says));
}
INSTANTIATE_TEST_SUITE_P(Rows, Guesses, testing::ValuesIn(kGuesses),
                         [](const auto& row) { return row.param.name; });

TEST(ExplainFrame, SaysWhichRuleABrokenFieldBreaks) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(reflect::parse_hex("00 0001 0000 0e 00 1c 000b0002 000bfffd 00 0007 67 030a", bytes));
  const auto given = take_frame(bytes, "sf");
  reflect::Frame frame;
  reflect::FrameDecoder(kRubicon).decode(given->packet, frame);
  const std::string text = explain_frame(frame);
  EXPECT_THAT(text, HasSubstr("19  67     ! nbytes"));
  EXPECT_THAT(text, HasSubstr("(not decoded)"));
  EXPECT_THAT(text, HasSubstr("Malformed at byte 19"));
  EXPECT_THAT(text, HasSubstr("WIRE-NET-NBYTES (MUST): nbytes counts TRANSID"));
}

}  // namespace
}  // namespace rubric::explain
