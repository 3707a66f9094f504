// Each diagnostic of traces with an input that provokes it.
#include <gtest/gtest.h>

#include <string>

#include "conformance/trace/each_line.h"
#include "conformance/trace/parse.h"

namespace rubric::trace {
namespace {

/// A way to be wrong, in line 5 of a file, the first of a case; `expected` from the column on.
struct Wrong {
  const char* name;
  const char* line;
  const char* expected;
};

#define KNOWN                                                        \
  "join_requests, ack_joins, ack_timeout, channel_access, members, " \
  "channels, synaptic_period, synaptic_phase, gone_after, buffers"

constexpr const char* kAbove =
    "%rtr 1   %profile paper\n"
    "%node m5 mote id=5 iut   %node sA sink id=1 island=11   %node sB sink id=1 island=12\n"
    "%node bA base_station island=11\n"
    "case a\n";

const Wrong kWrong[] = {
    {"NoTime", "x", "1: expected a time; 'x' wants '+' and ticks as a time, or ':' as a label"},
    {"Time", "4x m5 > rA *",
     "1: expected ticks or a parameter, given '4x'; known are response, "
     "join_period, " KNOWN},
    {"TimeParameter", "0..patience m5 > rA *",
     "4: expected ticks or a parameter, given 'patience'; known are response, join_period, " KNOWN},
    {"TimeFactor", "2000*response m5 > rA *",
     "1: expected a factor from 0 to 1000, given '2000*response'"},
    {"LabelParameter", "response: 3 m5 > rA *", "1: label 'response' is the name of a parameter"},
    {"NegativeTime", "-4 m5 > rA *", "1: expected a time in ticks, given '-4'"},
    {"TimeAlone", "a:", "3: expected a time"},
    {"Window", "9..3 m5 > rA *", "1: the window '9..3' ends before it begins"},
    {"LabelBeforePlus", "7+3 m5 > rA *", "1: expected a time in ticks, given '7+3'"},
    {"Label", "7: 3 m5 > rA *", "1: expected a label before ':', given '7'"},
    {"NoNode", "3", "2: expected a node or a link"},
    {"Node", "3 m(5) > rA *", "3: expected a node or a link, given 'm(5)'"},
    {"NoOp", "3 m5", "5: expected <, >, !>, ?>, lost or dup"},
    {"Op", "3 m5 >> rA *", "6: expected <, >, !>, ?>, lost or dup, given '>>'"},
    {"NoLink", "3 m5 >", "7: expected a link"},
    {"Link", "3 m5 > r/A *", "8: expected a link, given 'r/A'"},
    {"NoMessage", "3 m5 > rA", "10: expected a message"},
    {"Message", "3 m5 > rA 7up", "11: expected a message, given '7up'"},
    {"AmArrow", "3 m5 > rA am=2 *", "14: expected am=SOURCE->DESTINATION, given '2'"},
    {"AmSide", "3 m5 > rA am=2->x01 *",
     "17: expected an AM address: a number, all, a variable or *, given 'x01'"},
    {"OpenBracket", "3 m5 > rA net_msg(dest=11:2", "18: '(' without its ')'"},
    {"BehindDots", "3 m5 > rA net_msg(... dest=11:2)", "23: expected ')' after '...'"},
    {"QuoteInside", "3 m5 > rA net_msg(dest=\"a\"b\"c\")",
     "24: a quote within text is written \\\""},
    {"Path", "3 m5 > rA net_msg(.dest=11:2)", "19: expected a field's path, given '.dest'"},
    {"PathIndex", "3 m5 > rA net_msg(updates[01].value=1 ...)",
     "19: expected a field's path, given 'updates[01].value'"},
    {"StrayBracket", "3 m5 > rA net_msg(dest=11:2])", "28: expected a blank or ')'"},
    {"NoValue", "3 m5 > rA net_msg(dest= )", "24: expected a value"},
    {"Value", "3 m5 > rA net_msg(seq_num=&)", "27: expected a value, given '&'"},
    {"Digits", "3 m5 > rA net_msg(seq_num=12a)",
     "27: expected a number of at most 15 digits, given '12a'"},
    {"ManyDigits", "3 m5 > rA net_msg(seq_num=1234567890123456)",
     "27: expected a number of at most 15 digits, given '1234567890123456'"},
    {"Range", "3 m5 > rA net_msg(seq_num=1..b)", "27: expected a range of numbers, given '1..b'"},
    {"ShiftedRange", "3 m5 > rA net_msg(seq_num=$t+1..9)",
     "27: expected a range of numbers, as $t+5..$t+9, given '$t+1..9'"},
    {"ShiftedByHex", "3 m5 > rA net_msg(seq_num=$t+0x1..$t+9)",
     "27: expected a range of numbers, as $t+5..$t+9, given '$t+0x1..$t+9'"},
    {"ShiftedOtherwise", "3 m5 > rA net_msg(seq_num=$t+1..$u+9)",
     "27: a range of numbers from one variable to another: '$t+1..$u+9'"},
    {"ShiftedEmpty", "3 m5 > rA net_msg(seq_num=$t+1..$t-1)",
     "27: the range '$t+1..$t-1' is empty"},
    {"EmptyRange", "3 m5 > rA net_msg(seq_num=2..1)", "27: the range '2..1' is empty"},
    {"Pair", "3 m5 > rA net_msg(dest=1:2:3)",
     "24: expected a number, a name, a variable or * on each side of ':'"},
    {"ChannelPair", "3 m5 > app syn_data(1->)",
     "21: expected a number, a name, a variable or * on each side of '->'"},
    {"Variable", "3 m5 > rA net_msg(seq_num=$)",
     "27: expected a variable's name after '$', given '$'"},
    {"NotAny", "3 m5 > rA net_msg(seq_num=!*)", "27: nothing is other than *"},
    {"TwiceNot", "3 m5 > rA net_msg(seq_num=!!1)", "27: '!' is given twice"},
    {"Quote", "3 m5 > app received(data=\"ab ...)", "26: text without a closing quote"},
    {"Escape", "3 m5 > app received(data=\"a\\n\" ...)",
     "26: in text a backslash comes before \", \\ or x and two hex digits"},
    {"ListEnd", "3 m5 > rA net_msg(values=[1 2 ...)", "26: a list without its closing bracket"},
    {"ListInList", "3 m5 > rA net_msg(values=[[1] ...)", "26: a list within a list"},
    {"InList", "3 m5 > rA net_msg(values=[1 )] ...)", "26: unexpected ')' in a list"},
    {"Requirements", "3 m5 > rA * [J1", "16: expected requirements and ']'"},
    {"RequirementWord", "3 m5 > rA * [J4 j1]", "17: expected a requirement, as J4-SEQ, given 'j1'"},
    {"HalfAByte", "3 m5 > rA * | 0 0", "15: expected bytes in hex after '|'"},
    {"NoBytes", "3 m5 > rA * | ; none", "15: expected bytes in hex after '|'"},
    {"Bytes", "3 m5 > rA * | 00f", "15: expected bytes in hex after '|'"},
    {"Rest", "3 m5 > rA * # no comment", "13: expected the end of the line, given '# no comment'"},
    {"Case", "case ?", "6: expected the name of a case"},
    {"CaseAlone", "case", "5: expected the name of a case"},
    {"CaseTwice", "case a", "6: case 'a' is already in line 4"},
    {"Header", "%what",
     "1: expected %rtr, %profile, %tick, %node, %link, %seed, %for or %note, given '%what'"},
    {"Version", "%rtr 2", "6: expected version 1, given '2'"},
    {"Profile", "%profile mine", "10: expected paper or deployed, given 'mine'"},
    {"Tick", "%tick s", "7: expected binary_ms, ms or us, given 's'"},
    {"Seed", "%seed x", "7: expected a seed, a number"},
    {"For", "%for",
     "5: '' is no parameter that can be stated; known are response, join_period, " KNOWN},
    {"ForRange", "%for members=13..8", "6: 'members=13..8' ends before it begins"},
    {"ForEnd", "%for members=13..21", "6: expected members from 1 to 20 motes, given '21'"},
    {"ForTwice", "%for channels=4 %for channels=4", "17: %for is given twice"},
    {"Note", "%note  ", "8: expected the text of the note"},
    {"NodeName", "%node ?", "7: expected a node's name"},
    {"NodeRole", "%node n robot", "9: expected mote, sink or base_station, given 'robot'"},
    {"NodeWord", "%node n mote id=1 id=2",
     "19: expected id=, island=, a parameter, iut or whole, each once, given 'id=2'"},
    {"NodeId", "%node n mote id=65536", "17: expected a TinyOS id from 0 to 65535, given '65536'"},
    {"NodeIsland", "%node n sink id=1 island=x",
     "26: expected an island from 0 to 65535, given 'x'"},
    {"NodeChannels", "%node n sink id=1 island=2 channels=9",
     "28: expected channels from 1 to 8 channels, given '9'"},
    {"NodeNoChannels", "%node n mote id=1 channels=0",
     "19: expected channels from 1 to 8 channels, given '0'"},
    {"NodeChannelsTwice", "%node n mote id=1 channels=5 channels=5",
     "30: channels is stated twice"},
    {"NodeParameter", "%node n mote id=1 patience=5",
     "19: 'patience' is no parameter that can be stated; known are response, join_period, " KNOWN},
    {"NodeParameterValue", "%node n mote id=1 response=0",
     "19: expected response from 1 to 1500 ticks, given '0'"},
    {"LinkName", "%link", "6: expected a link's name"},
    {"LinkKind", "%link l wire", "9: expected radio, serial or peis, given 'wire'"},
    {"LinkNode", "%link l radio m/5", "15: expected a node, given 'm/5'"},
    {"HeaderRest", "%seed 1 2", "9: expected the end of the line, given '2'"},
    // Checks of the whole.
    {"VersionInCase", "%rtr 1", "1: %rtr and %tick come before the first case"},
    {"TickInCase", "%tick ms", "1: %rtr and %tick come before the first case"},
    {"SeedTwice", "%seed 1 %seed 2", "9: %seed is given twice"},
    {"ProfileTwice", "%profile paper %profile paper", "16: %profile is given twice"},
    {"NodeTwice", "%node a mote id=1 %node a mote id=1", "19: node 'a' is given twice"},
    {"LinkTwice", "%link a radio %link a radio", "15: link 'a' is given twice"},
    {"LinkApp", "%link app radio", "1: 'app' is not a name for a link between nodes"},
    {"NeedsId", "%node a mote", "1: node 'a' needs id="},
    {"NeedsIsland", "%node a sink id=1", "1: node 'a' needs island="},
    {"MoteIsland", "%node a mote id=1 island=2",
     "1: a mote has no island of its own: 'a' joins one"},
    {"BaseStationId", "%node a base_station id=1 island=2", "1: a base station has no TinyOS id"},
    {"BaseStationChannels", "%node a base_station island=2 channels=4",
     "1: a base station has no synaptic channels"},
    {"LinkOfNobody", "%link a radio m6", "1: no %node 'm6', which %link a names"},
    {"LabelUnknown", "b+3 m5 > rA *", "1: no line above has the label 'b'"},
    {"LabelOfPerhaps", "b: 3 m5 ?> rA *", "1: label 'b' at what need not happen"},
    {"PerhapsUnbound", "3 m5 ?> rA join_request(seq_num=$q ...)", "25: no line above binds $q"},
    {"ShiftedUnbound", "3 m5 > rA join_request(seq_num=$q+1..$q+2 ...)",
     "24: no line above binds $q"},
    {"ShiftedGiven", "3 m5 < rA join_request(seq_num=$q+1..$q+2 ...)",
     "24: expected a value, given a range"},
    {"SumUnbound", "3 m5 < rA join_reply(seq_num=$q+256 ...)", "22: no line above binds $q"},
    {"LabelOfNothing", "b: 3 m5 !> rA *", "1: label 'b' at what does not happen"},
    {"WindowGiven", "0..5 m5 < app get_clock()",
     "1: a window where something is given at one time: 0..5"},
    {"Requirement", "0 m5 > rA * [J4 J99]", "1: no requirement 'J99' in the catalogue"},
    {"UnknownLink", "0 m5 > air *",
     "1: unknown link 'air': r... is a radio, ser... a serial line, else peis, app, power or what "
     "%link names"},
    {"AnyLinkGiven", "0 m5 < * busy", "1: '*' says nothing of the link by which it is given"},
    {"AnyNodeGiven", "0 * < rA busy", "1: '*' says nothing of who is given it"},
    {"UnknownNode", "0 m6 > rA *", "1: no %node 'm6'"},
    {"MoteOnSerial", "0 m5 > serA *", "1: a mote is not on 'serA', which is serial"},
    {"BaseOnRadio", "0 bA > rA *", "1: a base_station is not on 'rA', which is radio"},
    {"SinkOnPeis", "0 sA > peis *", "1: a sink is not on 'peis', which is peis"},
    {"LostOnApp", "0 app lost joined(*)", "1: nothing is lost or doubled on 'app'"},
    {"UnknownMessage", "0 m5 > rA join_reqest(*)",
     "11: unknown message 'join_reqest' (did you mean 'join_request'?)"},
    {"AnyGiven", "0 m5 < rA *", "11: expected what to give to the node, given '*'"},
    {"BytesGivenByRadio", "0 m5 < rA * | 00", "11: expected what to give to the node, given '*'"},
    {"BytesSent", "0 sA > serA * | 00",
     "1: the bytes are no packet: 00, AM destination, source, length, group, type, and as many "
     "bytes as length says"},
    {"AnyWithFields", "0 m5 > rA *(a=1)", "11: '*' is any message and has no fields"},
    {"AmOnApp", "0 m5 > app am=1->2 joined(*)", "1: there are no AM addresses on 'app'"},
    {"AmRange", "0 m5 > rA am=70000->2 *",
     "1: am: expected a number from 0 to 65535 or of null, local, broadcast, given '70000'"},
    {"AmAnyGiven", "0 m5 < rA am=*->5 am(type=1 payload=x)",
     "1: am: expected an address, given '*'"},
    {"Travels", "0 m5 > app net_msg(*)", "12: 'net_msg' does not travel on 'app'"},
    {"TravelsSerial", "0 sA > serA join_request(*)",
     "13: 'join_request' does not travel on 'serA'"},
    {"EventGiven", "0 m5 < app joined(11:5 success)",
     "12: 'joined' comes from a node: expected >, given <"},
    {"CallEmitted", "0 m5 > app join(*)", "12: 'join' is given to a node: expected <, given >"},
    {"BusyLost", "0 rA lost busy", "11: 'busy' is given to a node: expected <, given lost"},
    {"LinkAckOnSerial", "0 sA < serA linkack(1)", "13: 'linkack' does not travel on 'serA'"},
    {"GivenWithoutFields", "0 m5 < rA join_reply",
     "11: the fields of what is given are missing: join_reply(...)"},
    {"GivenWithAnyFields", "0 m5 < rA join_reply(*)",
     "11: the fields of what is given are missing: join_reply(...)"},
    {"Positional", "0 m5 > rA join_reply(5 ...)", "22: fields of join_reply need their names: '5'"},
    {"TooManyPositional", "0 m5 > app joined(11:5 success 3)", "32: joined has 2 fields"},
    {"UnknownField", "0 m5 > rA join_reply(sec_num=1 ...)",
     "22: join_reply has no field 'sec_num' (did you mean 'seq_num'?)"},
    {"AmbiguousField", "0 m5 > rA net_msg(devid=1 ...)",
     "19: 'devid' may mean dest.devid, src.devid"},
    {"FieldTwice", "0 m5 > rA join_reply(seq_num=1 seq_num=1 ...)",
     "32: field 'seq_num' is given twice"},
    {"FieldTwiceByTail", "0 m5 > rA join_request(transducers=1 mote_desc.transducers=1 ...)",
     "38: field 'mote_desc.transducers' is given twice"},
    {"FieldWithin", "0 m5 > rA ack_join(dest=11:1 dest.pid=11 ...)",
     "30: field 'dest.pid' is given twice"},
    {"TooLarge", "0 m5 > rA join_reply(seq_num=65536 ...)",
     "22: seq_num: expected a number from 0 to 65535, given '65536'"},
    {"RangeTooLarge", "0 m5 > rA join_reply(seq_num=1..65536 ...)",
     "22: seq_num: expected a number from 0 to 65535, given '1..65536'"},
    {"EnumName", "0 m5 > app joined(11:5 sucess)",
     "24: result: expected a number from 0 to 1 or of fail, success, given 'sucess'"},
    {"MaskName", "0 m5 > rA join_request(actuators=led|light ...)",
     "24: mote_desc.actuators: expected a number from 0 to 255 or of led, open, given 'led|light'"},
    {"Address", "0 m5 > app joined(5 success)", "19: address: expected an address, as 11:5"},
    {"AddressPart", "0 m5 > app joined(11:five success)",
     "19: address: expected a number from 0 to 65535 or of null, local, broadcast, given 'five'"},
    {"Channel", "0 m5 > app syn_data(5 new)", "21: channel: expected a channel, as 2->1"},
    {"Bytes2", "0 m5 > app received(11:5 control_layer 5)",
     "40: data: expected bytes (x0a0b) or text in quotes, given '5'"},
    {"Real", "0 m5 > app input_value(x01 success)", "24: value: expected a number, given 'x01'"},
    {"List", "0 m5 > rA net_msg(payload.body.values=1 ...)",
     "19: payload.body.values: expected a list, as [1 2]"},
    {"ListItem", "0 m5 > rA net_msg(payload.body.values=[x00] ...)",
     "19: payload.body.values: expected a number, given 'x00'"},
    {"Structure", "0 m5 > rA net_msg(payload=5 ...)",
     "19: payload: it has fields: expected bytes (x0a0b), or the fields one by one"},
    {"AnyValueGiven", "0 m5 < rA join_reply(seq_num=* ...)", "22: expected a value, given '*'"},
    {"RangeGiven", "0 m5 < rA join_reply(seq_num=1..2 ...)", "22: expected a value, given a range"},
    {"AnyInAddressGiven", "0 m5 < app send(dest=11:* ...)", "17: expected a value, given '*'"},
    {"UnboundGiven", "0 m5 < rA join_reply(seq_num=$q ...)", "22: no line above binds $q"},
    {"UnboundNot", "0 m5 > rA join_reply(seq_num=!$q ...)", "22: no line above binds $q"},
    {"UnboundMustNot", "0 m5 !> rA join_request(seq_num=$q ...)", "25: no line above binds $q"},
    {"MissingInCall", "0 m5 < app join(telosb_demo light)",
     "12: field 'actuators' of join is neither given nor left free by '...'"},
    {"MissingGiven", "0 m5 < rA join_reply(seq_num=1 mote_addr=5 cur_time=1)",
     "11: join_reply: island_addr: is missing: expected a number from 0 to 65535"},
    {"MissingExpected", "0 m5 > rA join_reply(seq_num=$q mote_addr=* cur_time=1)",
     "11: join_reply: island_addr: is missing: expected a number from 0 to 65535"},
    {"BodyOfAnother",
     "0 m5 < rA net_msg(dest=11:5 src=11:1 seq_num=1 trans_id=connless "
     "app_id=control_layer payload.body.net_id=3 ...)",
     "11: net_msg: payload.body.island_addr: is missing: expected a number from 0 to 65535"},
    {"BytesOnApp", "0 m5 > app joined(*) | 00", "1: there are no frames on 'app'"},
    {"BytesNoPacket", "0 m5 > rA * | 0000010002010006",
     "1: the bytes are no packet: 00, AM destination, source, length, group, type, and as many "
     "bytes as length says"},
    {"BytesDiffer", "0 m5 > rA rssi_beacon(anchor_id=4) | 0000010002010006 03",
     "11: the bytes say something else: anchor_id: expected 4, seen 3"},
    {"BytesOfAnother", "0 m5 > rA join_reply(*) | 0000010002010006 03",
     "11: the bytes say something else: message: expected join_reply, seen rssi_beacon"},
    {"BytesOfOthers", "0 m5 > rA am=2->3 rssi_beacon(anchor_id=3) | 0000010002010006 03",
     "19: the bytes say something else: am destination: expected 3, seen 1"},
};

class Diagnostics : public testing::TestWithParam<Wrong> {};

TEST_P(Diagnostics, HaveTheirPlace) {
  const std::string text = std::string(kAbove) + GetParam().line;
  const std::string expected = std::string("t.rtr:5:") + GetParam().expected + "\n";
  EXPECT_EQ(parse(text, "t.rtr").errors(), expected);
  EXPECT_EQ(each_line(text, "t.rtr", [](const File&, const Line&) {}).errors(), expected);
}

INSTANTIATE_TEST_SUITE_P(Trace, Diagnostics, testing::ValuesIn(kWrong),
                         [](const auto& row) { return std::string(row.param.name); });

/// Those of whole files.
const Wrong kWrongFiles[] = {
    {"NoVersion", "%profile paper\n%rtr 1\n", "1:1: the first header must be %rtr 1"},
    {"NoHeader", "case a\n", "1:1: expected %rtr 1 at the beginning"},
    {"VersionTwice", "%rtr 1\n%rtr 1\n", "2:1: %rtr is given twice"},
    {"TickTwice", "%rtr 1 %tick ms %tick us\n", "1:17: %tick is given twice"},
    {"LineBeforeCase", "%rtr 1\n%node m5 mote id=5\n0 m5 < app get_clock()\n",
     "3:1: a line before the first case; 'case NAME' begins one"},
    {"LateHeader",
     "%rtr 1\n%node m5 mote id=5\ncase a\n%note one\n0 m5 < app get_clock()\n%note two\n%seed 1\n",
     "7:1: the headers of a case come before its lines"},
    {"LabelTwice",
     "%rtr 1\n%node m5 mote id=5\ncase a\nb: 0 m5 < app get_clock()\nb: 0 m5 < app get_clock()\n",
     "5:1: label 'b' is already in line 4"},
    {"TimeGoesBack",
     "%rtr 1\n%node m5 mote id=5\ncase a\n@9 m5 < app get_clock()\n@8 m5 < app get_clock()\n",
     "5:1: time goes back, from @9 to @8"},
    {"NotesBeforeVersion", "%note one\n%rtr 1\n", "1:1: the first header must be %rtr 1"},
    {"NoNodeOfLink", "%rtr 1\ncase a\n%link rX radio m6\n%note one\n",
     "3:1: no %node 'm6', which %link rX names"},
    {"NodesOfTheCaseAlone",
     "%rtr 1\n%node m5 mote id=5\ncase a\n%node m6 mote id=6\n0 m5 > rA *\ncase b\n0 m5 > rA *\n",
     "5:1: no %node 'm5'"},
    {"NotOnLink",
     "%rtr 1\n%node m5 mote id=5 %node m6 mote id=6\n%link rX radio m6\ncase a\n0 m5 > rX *\n",
     "5:1: 'm5' is not on the link 'rX'"},
};

class FileDiagnostics : public testing::TestWithParam<Wrong> {};

TEST_P(FileDiagnostics, HaveTheirPlace) {
  const std::string expected = std::string("t.rtr:") + GetParam().expected + "\n";
  EXPECT_EQ(parse(GetParam().line, "t.rtr").errors(), expected);
  EXPECT_EQ(each_line(GetParam().line, "t.rtr", [](const File&, const Line&) {}).errors(),
            expected);
}

INSTANTIATE_TEST_SUITE_P(Trace, FileDiagnostics, testing::ValuesIn(kWrongFiles),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace rubric::trace
