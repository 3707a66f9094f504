// RUBICON's app.yaml, mistakes in others, and traces of a protocol that is not RUBICON.
#include "conformance/trace/protocol.h"

#include <gtest/gtest.h>

#include <string>

#include "codec/generated/oscilloscope/tables.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/schema.h"

namespace rubric::trace {
namespace {

constexpr const char* kHead =
    "protocol: sensors\n"
    "wire: oscilloscope\n"
    "roles:\n"
    "  sensor: {links: [radio, serial]}\n"
    "  display: {links: [serial], has: []}\n"
    "frames: {broadcast: [oscilloscope_msg]}\n"
    "enums:\n"
    "  speed: {0: slow, 7: fast}\n";
constexpr const char* kRest =
    "parameters:\n"
    "  patience: {unit: ticks, min: 1, max: 500, unstated: 40, doc: How long it waits.}\n"
    "calls:\n"
    "  measure: {speed: speed, times: {type: u1, max: 9}, tag: bytes}\n"
    "events:\n"
    "  measured: {value: u2}\n";

Protocol read(const std::string& text) {
  return read_protocol(text, "app.yaml", [](const std::string&) -> const reflect::Protocol& {
    return oscilloscope::tables::kProtocol;
  });
}

std::string mistake(const std::string& text) {
  try {
    read(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Protocol, RubiconIsTheOneInUse) {
  const Protocol& rubicon = protocol();
  EXPECT_EQ(rubicon.name, "rubicon");
  EXPECT_TRUE(rubicon.has_machine);
  EXPECT_EQ(role_text(Role::kMote), "mote");
  EXPECT_EQ(role_text(Role::kSink), "sink");
  EXPECT_EQ(role_text(Role::kBaseStation), "base_station");
  EXPECT_EQ(parameter(ParameterId::kResponse).name, "response");
  EXPECT_EQ(parameter(ParameterId::kAckTimeout).name, "ack_timeout");
  EXPECT_EQ(parameter(ParameterId::kChannels).name, "channels");
  EXPECT_EQ(parameter(ParameterId::kGoneAfter).name, "gone_after");
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(parameters()[i].id), i);
  }
}

TEST(Protocol, MistakesHaveTheirPlaces) {
  const std::string head = kHead;
  const struct {
    std::string text;
    const char* expected;
  } wrong[] = {
      {"", "app.yaml:1:1: expected the keys of a protocol"},
      {"a: [", "app.yaml:1:1: end of sequence flow not found"},
      {head + "---\na: 1\n",
       "app.yaml:9:1: what is here belongs to nothing; one document was expected"},
      {"protocol: 7up\n", "app.yaml:1:11: expected a name of letters, digits and _, given '7up'"},
      {"protocol: p\n", "app.yaml:1:1: a protocol without 'wire'"},
      {"protocol: p\nwire: w\nrules: x\n",
       "app.yaml:3:1: 'rules' is no key of a protocol; known are protocol, wire, roles, profiles, "
       "frames, enums, parameters, calls, events"},
      {"protocol: p\nwire: w\nroles: {}\n", "app.yaml:1:1: a protocol without a role"},
      {"protocol: p\nwire: w\nroles: {a: {links: [wire]}}\n",
       "app.yaml:3:20: expected radio, serial or peis, given 'wire'"},
      {"protocol: p\nwire: w\nroles: {a: {has: [id]}}\n", "app.yaml:3:12: a role without 'links'"},
      {head + "frames: {}\n", "app.yaml:9:1: 'frames' is given twice"},
      {"protocol: p\nwire: w\nroles: {a: {links: []}}\nframes: {broadcast: [hello]}\n",
       "app.yaml:4:22: 'hello' is no message of oscilloscope"},
      {head + "parameters: {p: {unit: ticks, min: 1, max: 2, doc: D}}\n",
       "app.yaml:9:17: a parameter without 'unstated'"},
      {head + "parameters: {p: {unit: ticks, min: 3, max: 2, unstated: 2, doc: D}}\n",
       "app.yaml:9:17: max is less than min"},
      {head + "parameters: {p: {unit: ticks, min: 3, max: 9, unstated: 2, doc: D}}\n",
       "app.yaml:9:57: unstated is less than min"},
      {head + "parameters: {seed: {unit: ticks, min: 3, max: 9, unstated: 2, doc: D}}\n",
       "app.yaml:9:14: 'seed' has a meaning in all protocols"},
      {"protocol: p\nwire: w\nroles: {a: {links: []}}\nenums: {e: {0: ok, 2: ok}}\n",
       "app.yaml:4:23: a name is given twice"},
      {head + "calls: {c: {a: sped}}\n",
       "app.yaml:9:16: unknown type 'sped' (did you mean 'speed'?); known are u1, u2, u4, f4, "
       "bytes, address, channel, enums of this file, masks of oscilloscope"},
      {head + "calls: {c: {a: {type: u1, enum: pace}}}\n", "app.yaml:9:33: no enum 'pace'"},
      {head + "calls: {c: {a: {type: u1, max: 256}}}\n",
       "app.yaml:9:32: expected a number from 0 to 255"},
      {head + "calls: {c: {}}\nevents: {c: {}}\n", "app.yaml:10:10: 'c' is given twice"},
      {head + "calls: {busy: {}}\n", "app.yaml:9:9: 'busy' has a meaning in all protocols"},
      {head + "calls: {oscilloscope_msg: {}}\n",
       "app.yaml:9:9: 'oscilloscope_msg' is a message of oscilloscope, too"},
  };
  for (const auto& one : wrong) EXPECT_EQ(mistake(one.text), one.expected) << one.text;
  EXPECT_EQ(mistake(head + kRest), "none");
}

std::string errors(const std::string& lines) {
  return parse("%rtr 1\n%node s sensor id=5 iut\n%node d display\n" + lines, "t.rtr").errors();
}

// The last test, for it changes the protocol of this process.
TEST(Protocol, TracesOfAnotherHaveItsNames) {
  use(read(std::string(kHead) + kRest));
  EXPECT_EQ(role_names(), (std::vector<std::string>{"sensor", "display"}));
  EXPECT_EQ(errors("case a\n0 s < app measure(fast 3 x01)\n"
                   "0..patience s > app measured(*)\n"
                   "0 s < rA am=7->all oscilloscope_msg(version=1 ...)\n"
                   "0 s < rA linkack(acked=1)\n"),
            "");
  const struct {
    const char* lines;
    const char* expected;
  } wrong[] = {
      {"%node m mote id=1\n", "t.rtr:4:9: expected sensor or display, given 'mote'\n"},
      {"%node e display id=1\n", "t.rtr:4:1: a display has no TinyOS id\n"},
      {"%profile paper\n", "t.rtr:4:1: sensors has no profiles\n"},
      {"%for members=20\n",
       "t.rtr:4:6: 'members' is no parameter that can be stated; known are patience\n"},
      {"case a\n0..join_period s > app measured(*)\n",
       "t.rtr:5:4: expected ticks or a parameter, given 'join_period'; known are patience\n"},
      {"case a\n0 s < app join(1)\n", "t.rtr:5:11: unknown message 'join'\n"},
      {"case a\n0 s < app masure(1)\n",
       "t.rtr:5:11: unknown message 'masure' (did you mean 'measure'?)\n"},
      {"case a\n0 s < app measure(speed=medium ...)\n",
       "t.rtr:5:19: speed: expected a number from 0 to 7 or of slow, fast, given 'medium'\n"},
      {"case a\n0 s < app measure(times=10 ...)\n",
       "t.rtr:5:19: times: expected a number from 0 to 9, given '10'\n"},
      {"case a\n0 s > rA oscilloscope_msg(versoin=1 ...)\n",
       "t.rtr:5:27: oscilloscope_msg has no field 'versoin' (did you mean 'version'?)\n"},
      {"case a\n0 d > rA oscilloscope_msg(*)\n",
       "t.rtr:5:1: a display is not on 'rA', which is radio\n"},
  };
  for (const auto& one : wrong) EXPECT_EQ(errors(one.lines), one.expected) << one.lines;

  const Parsed parsed = parse(
      "%rtr 1\n%node s sensor id=5 iut\n%node t sensor id=6\ncase a\n"
      "0 s < rA oscilloscope_msg(interval=9 ...)\n0 s < serA am(type=1 payload=x)\n",
      "t.rtr");
  const Scope scope = scope_of(parsed.file, parsed.file.cases[0]);
  EXPECT_EQ(scope.profile, "");
  const AmFrame frame = frame_of(*parsed.file.cases[0].lines()[0], scope);
  EXPECT_EQ(frame.dest, kAmAll);
  EXPECT_EQ(frame.src, 6);
  EXPECT_EQ(frame.type, 0x93);
  EXPECT_EQ(decode(frame, LinkKind::kRadio).number("interval"), 9);
}

}  // namespace
}  // namespace rubric::trace
