#include "conformance/trace/parse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "conformance/trace/each_line.h"
#include "conformance/trace/print.h"

namespace rubric::trace {
namespace {

constexpr const char* kHead =
    "%rtr 1   %profile paper\n"
    "%node m5 mote id=5 iut   %node sA sink id=1 island=11   %node sB sink id=1 island=12\n"
    "%node bA base_station island=11\n";

std::string errors(const std::string& text) { return parse(text, "t.rtr").errors(); }
/// Returns the errors of lines in a case after the usual head: they begin in line 5.
std::string line_errors(const std::string& lines) {
  return errors(std::string(kHead) + "case a\n" + lines);
}

constexpr const char* kJoin = R"(%rtr 1   %profile paper
%node m5 mote id=5 iut   %node sA sink id=1 island=11   %node sB sink id=1 island=12

case join.ok
a: 0          m5 <  app join(type=1 transducers=light|temp|humid actuators=led)
b: a+0..50    m5 >  rA  join_request(seq_num=$q transducers=light|temp|humid ...)   [J1]
   b+2        m5 <  rA  join_reply(island_addr=11 mote_addr=5 seq_num=$q ...)
   0..50      m5 >  rA  ack_join(dest=11:1 src=11:5 seq_num=$q ...)                 [J4]
   0..50      m5 >  app joined(11:5 success)                                        [J5]
   0..2000    m5 !> rA  join_request(*)

case join.reply_lost
a: 0          m5 <  app join(type=1 transducers=light|temp|humid actuators=led)
b: a+0..50    m5 >  rA  join_request(seq_num=$q ...)                                [J1]
   b+2        rA lost   join_reply(seq_num=$q)
   b+0..480   m5 !> *   *
   b+486..520 m5 >  rA  join_request(seq_num=* ...)                                 [J8]

case join.wrong_seq
a: 0          m5 <  app join(type=1 transducers=light|temp|humid actuators=led)
b: a+0..50    m5 >  rA  join_request(seq_num=$q ...)
   b+2        m5 <  rA  join_reply(island_addr=12 mote_addr=5 seq_num=!$q ...)
   0..480     m5 !> rA  ack_join(*)                                                 [J4]
)";

TEST(Parse, JoinExample) {
  const Parsed parsed = parse(kJoin, "join.rtr");
  EXPECT_EQ(parsed.errors(), "");
  ASSERT_EQ(parsed.file.cases.size(), 3u);
  const Case& first = parsed.file.cases[0];
  EXPECT_EQ(first.name, "join.ok");
  const auto lines = first.lines();
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[1]->label, "b");
  EXPECT_EQ(lines[1]->time, Time::after("a", 0, 50));
  EXPECT_EQ(lines[1]->op, Op::kEmits);
  EXPECT_EQ(lines[1]->requirements, std::vector<std::string>{"J1"});
  EXPECT_EQ(lines[1]->place.line, 6u);
  EXPECT_EQ(lines[4]->message.fields[0].value, Value::address(11, 5));
  EXPECT_EQ(lines[5]->message.form, Message::Form::kAny);
  EXPECT_EQ(parsed.file.cases[1].lines()[2]->op, Op::kLost);
  EXPECT_EQ(parsed.file.cases[1].lines()[2]->link, "rA");
  const Scope scope = scope_of(parsed.file, first);
  ASSERT_EQ(scope.nodes.size(), 3u);
  EXPECT_TRUE(scope.nodes[0].iut);
}

TEST(Parse, LineByLineAsInWhole) {
  const std::string text = std::string("\xEF\xBB\xBF%rtr 1 ; all\n%seed 3\n%node m5 mote id=5\n") +
                           "case a\n\n; why\n%node m7 mote id=7 iut\n%note what\n" +
                           "0 m7 < app get_clock()\n%note then\n1 m7 > rB * ; it\ncase b\n" +
                           "2 m5 > rA *";
  Parsed whole = parse(text, "t");
  EXPECT_EQ(whole.errors(), "");
  std::vector<Line> expected;
  for (Case& one : whole.file.cases) {
    for (const Line* line : one.lines()) expected.push_back(*line);
    std::erase_if(one.items, [](const Item& item) {
      const auto* header = item.as<Header>();
      return !header || std::holds_alternative<NoteHeader>(header->what);
    });
  }
  std::vector<Line> lines;
  std::string of_case;
  const Parsed headers = each_line(text, "t", [&](const File& so_far, const Line& line) {
    lines.push_back(line);
    of_case += so_far.cases.back().name;
  });
  EXPECT_EQ(lines, expected);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(of_case, "aab");
  EXPECT_EQ(headers.errors(), "");
  EXPECT_EQ(headers.file, whole.file);
}

TEST(Parse, LinesAreTakenUpToTheFirstMistake) {
  std::vector<std::uint32_t> taken;
  const Parsed parsed =
      each_line("%rtr 1\n%node m5 mote id=5\ncase a\n0 m5 > rA *\n1 m9 > rA *\n2 m5 > rA *\n", "t",
                [&](const File&, const Line& line) { taken.push_back(line.place.line); });
  EXPECT_FALSE(parsed.ok());
  EXPECT_EQ(taken, std::vector<std::uint32_t>{4});
}

TEST(Parse, PrintsInOneLayout) {
  const Parsed parsed = parse(
      "%rtr 1 %node m5 mote id=5 iut ; the mote\n\n# above\ncase a ; why\n ;  inside  \n"
      "a:0 m5 < app join(1 light|temp led) [J1-REQUEST][ J1 ] ; go\n"
      "@0..9 m5 > rA am=$me->all join_request( seq_num=$q  ... ) | 00FFFF0005 06 000E 0007 01"
      " 0003 01;x\n",
      "t");
  EXPECT_EQ(parsed.errors(), "");
  EXPECT_EQ(print(parsed.file),
            "%rtr 1\n%node m5 mote id=5 iut  ; the mote\n\n# above\ncase a  ; why\n  ;  inside\n"
            "  a:  0          m5  <  app  join(1 light|temp led)  [J1-REQUEST J1]  ; go\n"
            "      @0..9      m5  >  rA   am=$me->all join_request(seq_num=$q ...)"
            "  | 00ffff000506000e000701000301  ; x\n");
}

TEST(Parse, OwnNodesOfACaseReplaceThoseOfTheFile) {
  const Parsed parsed = parse(std::string(kHead) +
                                  "%seed 3\n%link rA radio m5 sA\n"
                                  "case a\n%node m7 mote id=7 iut\n%seed 9\n%profile deployed\n"
                                  "  0 m7 < app get_clock()\n  0 m7 > rB net_msg\ncase b\n",
                              "t");
  EXPECT_EQ(parsed.errors(), "");
  const Scope own = scope_of(parsed.file, parsed.file.cases[0]);
  EXPECT_EQ(own.nodes.size(), 1u);
  EXPECT_EQ(own.nodes[0].name, "m7");
  EXPECT_EQ(own.seed, 9u);
  EXPECT_EQ(own.profile, "deployed");
  EXPECT_EQ(own.links.size(), 1u);
  const Scope file = scope_of(parsed.file, parsed.file.cases[1]);
  EXPECT_EQ(file.nodes.size(), 4u);
  EXPECT_EQ(file.seed, 3u);
  EXPECT_EQ(file.profile, "paper");
}

TEST(Parse, LinksByTheirNames) {
  Scope scope;
  scope.links.push_back({"mesh", LinkKind::kRadio, {}});
  EXPECT_EQ(scope.link("rA"), LinkKind::kRadio);
  EXPECT_EQ(scope.link("serA"), LinkKind::kSerial);
  EXPECT_EQ(scope.link("peis"), LinkKind::kPeis);
  EXPECT_EQ(scope.link("app"), LinkKind::kApp);
  EXPECT_EQ(scope.link("power"), LinkKind::kPower);
  EXPECT_EQ(scope.link("*"), LinkKind::kAny);
  EXPECT_EQ(scope.link("mesh"), LinkKind::kRadio);
  EXPECT_EQ(scope.link("x"), std::nullopt);
}

TEST(Parse, AllMistakesAtOnceInOrderOfPlace) {
  EXPECT_EQ(line_errors("0 m5 < app jion()\n\n  5 m9 ? rA\n1 m5 > rA *\n2 m9 !> rA *\n"),
            "t.rtr:5:12: unknown message 'jion' (did you mean 'join'?)\n"
            "t.rtr:7:8: expected <, >, !>, ?>, lost or dup, given '?'\n"
            "t.rtr:9:1: no %node 'm9'\n");
}

TEST(Parse, ManyMistakesAreCounted) {
  std::string text = "%rtr 1\ncase a\n";
  for (int i = 0; i < 250; ++i) text += "?\n";
  const Parsed parsed = parse(text, "t");
  EXPECT_EQ(parsed.diagnostics.size(), Parsed::kDiagnosticsMax);
  EXPECT_EQ(parsed.dropped, 150u);
  EXPECT_THAT(parsed.errors(), testing::EndsWith("t: and 150 more\n"));
}

// Hostile input is reported, whatever it is.

TEST(Hostile, LongLine) {
  const std::string line(10 << 20, 'a');
  EXPECT_EQ(errors("%rtr 1\n" + line + "\n"),
            "t.rtr:2:1: a line of 10485760 bytes; at most 65536\n");
}

TEST(Hostile, LongestLine) {
  std::string line = "%rtr 1\ncase a\n0 m5 > rA join_request(";
  while (line.size() < Parsed::kLineBytesMax) line += "!!!!";
  EXPECT_THAT(errors(line), testing::StartsWith("t.rtr:3:24: '!' is given twice"));
  std::string word = "%rtr 1\ncase a\n";
  word.append(Parsed::kLineBytesMax, 'a');
  EXPECT_LT(errors(word).size(), 400u);
  std::string brackets = "%rtr 1\ncase a\n0 m5 > rA net_msg(payload.body.values=";
  brackets.append(60000, '[');
  EXPECT_THAT(errors(brackets), testing::HasSubstr("t.rtr:3:"));
  std::string path = "%rtr 1\n%node m5 mote id=5\ncase a\n0 m5 > rA net_msg(a";
  for (int i = 0; i < 20000; ++i) path += ".a";
  EXPECT_THAT(errors(path + "=1)"), testing::HasSubstr("has no field"));
}

TEST(Hostile, Bytes) {
  const std::string where = "t.rtr:2:3: a byte that is not UTF-8 text, or a control character\n";
  for (const std::string& bytes :
       {std::string("\0", 1), std::string("\x01"), std::string("\xFF"), std::string("\xC0\x80"),
        std::string("\xED\xA0\x80"), std::string("\xF4\x90\x80\x80"), std::string("\xE2\x82"),
        std::string("\x7F"), std::string("\x80"), std::string("\r\r")}) {
    EXPECT_EQ(errors("%rtr 1\n# " + bytes + "\n"), where);
  }
  EXPECT_EQ(errors("%rtr 1\n# \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80\r\n"), "");
}

TEST(Hostile, AnyPrefixOfAFile) {
  const std::string text = kJoin;
  for (std::size_t i = 0; i < text.size(); ++i) errors(text.substr(0, i));
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    for (const char c : {'\0', '(', ')', '"', '!', '.', '[', '=', ' ', '9'}) {
      changed[i] = c;
      errors(changed);
    }
  }
}

TEST(Parse, EmptyFile) { EXPECT_EQ(errors(""), "t.rtr:1:1: expected %rtr 1 at the beginning\n"); }

TEST(Parse, MessageAlone) {
  Message message;
  EXPECT_EQ(parse_message(" joined(11:5 success) ", message), "");
  EXPECT_EQ(print(message), "joined(11:5 success)");
  EXPECT_EQ(parse_message("joined(11:5", message), "7: '(' without its ')'");
  EXPECT_EQ(parse_message("joined(11:5) x", message), "14: expected the end, given 'x'");
}

}  // namespace
}  // namespace rubric::trace
