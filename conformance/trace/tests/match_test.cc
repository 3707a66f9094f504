#include "conformance/trace/match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "conformance/trace/encode.h"
#include "conformance/trace/tests/testing.h"

namespace rubric::trace {
namespace {

const char* kReading = "000b0001 000b0005 01 0009 0c 03 0a 23 02 0001 0102 0002 0304";

std::string differences(std::string_view pattern, const Concrete& seen, Bindings& bindings) {
  return match(message(pattern), seen, bindings).text();
}
std::string differences(std::string_view pattern, const Concrete& seen) {
  Bindings bindings;
  return differences(pattern, seen, bindings);
}

TEST(Match, Values) {
  const Concrete seen = decode(frame(28, kReading), LinkKind::kRadio);
  for (const char* good :
       {"*",
        "net_msg",
        "net_msg(*)",
        "net_msg(...)",
        "net_msg(dest=11:1 ...)",
        "net_msg(dest=*:1 ...)",
        "net_msg(dest=$i:1 src=$i:5 ...)",
        "net_msg(dest.pid=11 ...)",
        "net_msg(seq_num=5..9 ...)",
        "net_msg(seq_num=!8 ...)",
        "net_msg(seq_num=!5..8 ...)",
        "net_msg(payload.app_id=control_layer app_id=10 ...)",
        "net_msg(dest=!11:2 ...)",
        "net_msg(trans_id=!mockup ...)",
        "net_msg(payload.body.updates[1].value=0x304 ...)",
        "net_msg(body.updates[0].transducer=light ...)",
        "net_msg(payload=* ...)",
        "net_msg(payload.body=x23020001010200020304 ...)",
        "net_msg(payload.payload=x23020001010200020304 ...)",
        "net_msg(dest=$d src=!$d ...)",
        "net_msg(payload.body=$b payload.payload=$b ...)",
        "net_msg(dest=11:1 src=11:5 reliable=1 seq_num=* trans_id=connless app_id=* body=*)",
        "am",
        "am(type=net ...)",
        "am(type=28 payload=*)"}) {
    EXPECT_EQ(differences(good, seen), "") << good;
  }
}

TEST(Match, Differences) {
  const Concrete seen = decode(frame(28, kReading), LinkKind::kRadio);
  EXPECT_EQ(differences("join_request(*)", seen), "message: expected join_request, seen net_msg");
  EXPECT_EQ(differences("net_msg(dest=11:2 seq_num=8 reliable=1 ...)", seen),
            "dest: expected 11:2, seen 11:1; seq_num: expected 8, seen 9");
  EXPECT_EQ(differences("net_msg(dest=$i:1 src=!$i:5 ...)", seen).substr(0, 4), "src:");
  EXPECT_EQ(differences("net_msg(app_id=mockup ...)", seen),
            "payload.app_id: expected mockup, seen control_layer");
  EXPECT_EQ(differences("net_msg(body.ack=0 ...)", seen),
            "payload.body.ack: expected 0, seen no such field");
  EXPECT_EQ(differences("net_msg(dest=11:1 src=11:5 seq_num=9 payload=*)", seen),
            "reliable: expected a value, or '...' in the pattern, seen 1");
  EXPECT_EQ(differences("net_msg(body=x00 ...)", seen),
            "payload.body: expected x00, seen x23020001010200020304");
  EXPECT_EQ(differences("net_msg(seq_num=!$q ...)", seen),
            "seq_num: expected !$q ($q is not bound), seen 9");
  EXPECT_EQ(differences("am(type=15 ...)", seen), "type: expected 15, seen net");
  Bindings ignored;
  EXPECT_GT(match(message("join_request(*)"), seen, ignored).distance(),
            match(message("net_msg(dest=1:1 src=1:1 seq_num=1 ...)"), seen, ignored).distance());
}

TEST(Match, AnUnknownBodyIsItsBytes) {
  const Concrete seen =
      decode(frame(28, "000b0001 000b0005 00 0009 03 03 05 41"), LinkKind::kRadio);
  EXPECT_EQ(differences("net_msg(payload.body=x41 ...)", seen), "");
  EXPECT_EQ(differences("net_msg(payload.payload=\"A\" ...)", seen), "");
  EXPECT_EQ(differences("net_msg(payload.payload=\"B\" ...)", seen),
            "payload.payload: expected \"B\", seen x41");
}

TEST(Match, ClosedPatternsTakeTheExpectedValue) {
  const std::string net = "000b0001 000b0005 00 0009 06 09 0a ";
  const char* pattern =
      "net_msg(dest=* src=* reliable=0 seq_num=9 trans_id=rubicon_ack app_id=* body.seq_num=7 "
      "body.ack=0)";
  EXPECT_EQ(differences(pattern, decode(frame(28, net + "17 0007 00"), LinkKind::kRadio)), "");
  EXPECT_EQ(differences(pattern, decode(frame(28, net + "18 0007 00"), LinkKind::kRadio)),
            "payload.body.type: expected learning_notification, seen learning_module_down");
}

TEST(Match, BindsOnFirstUseOnlyWhereAllMatches) {
  const Concrete seen = decode(frame(14, "0007 01 0043 01"), LinkKind::kRadio);
  Bindings bindings;
  EXPECT_NE(differences("join_request(seq_num=$q actuators=open ...)", seen, bindings), "");
  EXPECT_EQ(bindings.find("q"), nullptr);
  EXPECT_EQ(differences("join_request(seq_num=$q actuators=$a ...)", seen, bindings), "");
  ASSERT_NE(bindings.find("q"), nullptr);
  EXPECT_EQ(*bindings.find("q"), Value::of(7));
  EXPECT_EQ(differences("join_request(seq_num=$q ...)", seen, bindings), "");
  EXPECT_EQ(differences("join_request(seq_num=!$a ...)", seen, bindings), "");
  bindings.set("q", Value::of(8));
  EXPECT_EQ(differences("join_request(seq_num=$q ...)", seen, bindings),
            "seq_num: expected $q ($q = 8), seen 7");
}

TEST(Match, ComparesWithoutBinding) {
  const Concrete seen = decode(frame(14, "0007 01 0043 01"), LinkKind::kRadio);
  Bindings bindings;
  bindings.set("q", Value::of(7));
  Line line{.op = Op::kEmits, .message = message("join_request(seq_num=$q mote_type=$t ...)")};
  EXPECT_TRUE(compare(line, seen, bindings));
  EXPECT_EQ(bindings.find("t"), nullptr);
  line.message = message("join_request(seq_num=$q mote_type=!$q ...)");
  EXPECT_TRUE(compare(line, seen, bindings));
  line.message = message("join_request(mote_type=$t seq_num=!$t ...)");
  EXPECT_TRUE(compare(line, seen, bindings));  // Within a line a variable is bound, too.
  line.message = message("join_request(mote_type=$t seq_num=$t ...)");
  EXPECT_EQ(compare(line, seen, bindings).differences.size(), 1U);
  for (const char* able : {"*", "join_request(seq_num=8 ...)", "am(type=14 ...)"}) {
    EXPECT_TRUE(may_match(message(able), seen.name)) << able;
  }
  EXPECT_FALSE(may_match(message("join_reply"), seen.name));
}

TEST(Match, NumbersGoRound) {
  const auto seen = [](const char* seq_num) {
    return decode(frame(14, std::string(seq_num) + " 01 0043 01"), LinkKind::kRadio);
  };
  Bindings bindings;
  const auto fits = [&](std::int64_t q, const std::string& want, const char* seq_num) {
    bindings.set("q", Value::of(q));
    return differences("join_request(seq_num=" + want + " ...)", seen(seq_num), bindings).empty();
  };
  EXPECT_TRUE(fits(0xFFFF, "$q+1", "0000"));
  EXPECT_FALSE(fits(0xFFFF, "$q+1", "0001"));
  EXPECT_FALSE(fits(0xFFFF, "$q+1", "ffff"));
  EXPECT_TRUE(fits(0xFFFE, "$q+1..$q+3", "ffff"));
  EXPECT_TRUE(fits(0xFFFE, "$q+1..$q+3", "0001"));
  EXPECT_FALSE(fits(0xFFFE, "$q+1..$q+3", "0002"));
  EXPECT_FALSE(fits(0xFFFE, "$q+1..$q+3", "fffe"));
  EXPECT_FALSE(fits(0xFFFF, "!$q+1", "0000"));
  EXPECT_TRUE(fits(0xFFFF, "!$q+1", "0001"));
  // In what is sent, too.
  bindings.set("q", Value::of(0xFFFF));
  const Message sent = message("join_request(seq_num=$q+256 ...)");
  EXPECT_EQ(substituted(sent.fields.front().value, bindings, {}), Value::of(255));
}

TEST(Match, Reals) {
  const auto seen = [](float value) {
    return concrete(Message::named("input_value")
                        .with("value", Value::real(value))
                        .with("result", Value::names("success")));
  };
  EXPECT_EQ(differences("input_value(0.1 success)", seen(0.1f)), "");
  EXPECT_EQ(differences("input_value(2 success)", seen(2.0f)), "");
  EXPECT_EQ(differences("input_value(nan success)", seen(std::nanf(""))), "");
  EXPECT_EQ(differences("input_value(-0.0 success)", seen(0.0f)), "");
  EXPECT_EQ(differences("input_value(0.1 success)", seen(std::nanf(""))),
            "value: expected 0.1, seen nan");
  EXPECT_EQ(differences("input_value(-inf *)", seen(std::numeric_limits<float>::infinity())),
            "value: expected -inf, seen inf");
}

TEST(Match, LineWithAddressesAndBytes) {
  const AmFrame one = frame(6, "03");
  const Concrete seen = decode(one, LinkKind::kRadio);
  Bindings bindings;
  Line line = frame_line(7, "m5", Op::kEmits, "rA", LinkKind::kRadio, one);
  EXPECT_TRUE(match(line, seen, bindings));
  line.am->dest = Value::of(1);
  line.bytes->back() = 4;
  EXPECT_EQ(match(line, seen, bindings).text(),
            "am destination: expected 1, seen all; bytes: expected 00ffff000501000604, seen "
            "00ffff000501000603");
}

TEST(Match, FaultsLookAtWhatTheyNameOnly) {
  const Concrete seen = decode(frame(14, "0007 01 0043 01"), LinkKind::kRadio);
  Line line{.op = Op::kLost, .message = message("join_request(seq_num=7)")};
  Bindings bindings;
  EXPECT_TRUE(match(line, seen, bindings));
  line.op = Op::kEmits;
  EXPECT_FALSE(match(line, seen, bindings));
}

}  // namespace
}  // namespace rubric::trace
