#include "tools/format/filter.h"

#include <gtest/gtest.h>

#include "tools/format/testing.h"

namespace rubric::format {
namespace {

bool matches(std::string_view expression, const Sample& sample) {
  return Filter(expression, rubicon()).matches(sample.record);
}

class FilterOfUpdates : public testing::Test {
 protected:
  FilterOfUpdates() : sample_(kUpdates, Framing::kHdlc) {
    sample_.record.index = 12;
    sample_.record.number = 3;
    sample_.record.time_ns = 1'500'000'000;
    sample_.record.interface_name = "serial:1";
    sample_.packet.direction = Direction::kOutbound;
  }
  using Expressions = std::initializer_list<const char*>;

  void expect(Expressions to_hold, Expressions to_fail) {
    for (const char* one : to_hold) EXPECT_TRUE(matches(one, sample_)) << one;
    for (const char* one : to_fail) EXPECT_FALSE(matches(one, sample_)) << one;
  }
  Sample sample_;
};

TEST_F(FilterOfUpdates, compares_attributes) {
  expect({"message==updates", "message!=net_msg", "path==net_msg", "framing==hdlc",
          "direction==outbound", "interface==serial:1", "interface!=\"serial:2\""},
         {"message == net_msg", "path!=net_msg", "direction==inbound", "interface=='serial:2'"});
  expect({"index==12", "index<=12", "index>11", "number==3", "time==1.5", "time>1.4999"},
         {"index<12", "index>=13", "number==12"});
  expect({"am.type==28", "am.type==0x1c", "frame.kind==packet_noack", "frame.kind==69",
          "stale==beef", "stale=='BEEF'", "stale_bytes==2"},
         {"frame.serial_seq==0", "raw==00"});
}

TEST_F(FilterOfUpdates, compares_fields_by_the_tail_of_their_path) {
  expect(
      {"src.devid==2", "devid==2", "dest.devid==null", "src.devid!=4", "src.pid==dest.pid",
       "seq_num==0xb0d3", "net_msg.seq_num==45267", "payload.body.updates.value==302",
       "updates.value>6000", "app_id==control_layer", "app_id==10", "app_id_name==control_layer",
       "fields.updates.value==1202", "2==src.devid", "1<src.devid"},
      {"dest.devid==2", "devid!=2", "src.devid==dest.devid", "updates.value>7000", "4==src.devid"});
}

TEST_F(FilterOfUpdates, tests_masks) {
  expect({"transducer & temp", "transducer & mic|humid", "transducer & 0x40",
          "transducer & 0x43 == 0x40", "transducer & temp == 2"},
         {"transducer & mic", "transducer & bit13", "transducer & temp != 0"});
}

TEST_F(FilterOfUpdates, joins_and_negates) {
  expect(
      {"message==updates && src.devid==2", "message==join_reply || src.devid==2",
       "!(message==join_reply) && !error", "message==join_reply && src.devid==2 || index==12",
       "not error and (index==12 or index==13)", "!!exists(time)"},
      {"message==updates && src.devid==4", "message==join_reply && (src.devid==2 || index==12)"});
}

TEST_F(FilterOfUpdates, tests_presence) {
  expect(
      {"exists(src.devid)", "src.devid", "updates", "stale", "direction", "!(cur_time==0)"},
      {"cur_time", "exists(error)", "error", "rubicon_ack", "notes", "cur_time==0", "cur_time!=0"});
}

TEST(Filter, compares_errors_and_notes) {
  const Sample bad("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 02 0001 02 030a");
  EXPECT_TRUE(matches("error", bad));
  EXPECT_TRUE(matches("error==out_of_range", bad));
  EXPECT_TRUE(matches("error.fault==out_of_range && error.offset==16", bad));
  EXPECT_TRUE(matches("error.requirement==WIRE-NET-RELIABLE", bad));
  EXPECT_FALSE(matches("error==crc", bad));
  const Sample noted("00 ffff 0000 12 00 1c 000b fffd 000b 0002 00 0001 06 0305 22aabbcc");
  EXPECT_TRUE(matches("notes==does_not_fit", noted));
  EXPECT_TRUE(matches("payload==22aabbcc", noted));
}

TEST(Filter, compares_floats_as_binary32) {
  const Sample sample("cdcccc3d 0000c03f 0000c07f", Framing::kBare, "synaptic_data");
  EXPECT_TRUE(matches("values==0.1", sample));
  EXPECT_TRUE(matches("values>1 && values<1.6", sample));
  EXPECT_FALSE(matches("values>2", sample));  // NaN is above nothing.
}

TEST(Filter, compares_converted_values) {
  const Sample sample("0001 18c4 04b2 012e 0003", Framing::kBare, "data");
  EXPECT_TRUE(matches("temp_degC==23.4", sample));
  EXPECT_TRUE(matches("temp_degC>23 && temp==6340", sample));
}

struct BadCase {
  const char* expression;
  std::size_t position;
  const char* message;
};

const BadCase kBad[] = {
    {"", 0, "expected a name here, the expression ends"},
    {"message==", 9, "expected a number, a name or a string"},
    {"message=updates", 7, "'=' is not a comparison, '==' is"},
    {"message==updates &&", 19, "expected a name here, the expression ends"},
    {"message!=ack", 9, "message is never 'ack' (did you mean 'ack_join'?)"},
    {"message==updats", 9, "message is never 'updats' (did you mean 'updates'?)"},
    {"mesage==updates", 0, "unknown name 'mesage' (did you mean 'message'?)"},
    {"lqi>0", 0, "unknown name 'lqi' (did you mean 'frame.lqi'?)"},
    {"index>0 && src.devd==4", 11, "unknown name 'src.devd'"},
    {"scr.devid==4", 0, "unknown name 'scr' (did you mean 'src'?)"},
    {"(index==1", 9, "expected ')'"},
    {"index==1)", 8, "there is no '(' for this ')'"},
    {"index==1 index==2", 9, "expected '&&', '||' or the end"},
    {"index==0x", 7, "'0x' is not a number"},
    {"index==0xfffffffffffffffff", 7, "'0xfffffffffffffffff' is not a number"},
    {"index==18446744073709551616", 7, "'18446744073709551616' is beyond 64 bits"},
    {"index==-9223372036854775809", 7, "'-9223372036854775809' is beyond 64 bits"},
    {"index==12ms", 7, "'12ms' is not a number"},
    {"index==1.2.3", 7, "'1.2.3' is not a number"},
    {"interface=='serial", 11, "this string does not end"},
    {"index==1 # x", 9, "'#' means nothing here"},
    {"index==1 \x01", 9, "this character means nothing here"},
    {"message<updates", 8, "names and text compare by == and != alone"},
    {"transducers & tmp", 14, "unknown bit 'tmp' (did you mean 'temp'?)"},
    {"transducers==light", 13,
     "'light' is a bit of transducers: 'transducers & light' asks for it"},
    {"transducers & 1.5", 14, "a mask is a whole number"},
    {"transducers & ==", 14, "expected a bit's name or a number"},
    {"seq_num & light", 10, "seq_num is not a mask, its bits have no names"},
    {"index==1 | index==2", 9, "'|' joins the bits of a mask; '||' is or"},
    {"4", 1, "expected a comparison"},
    {"4==5", 3, "expected a name"},
    {"exists(4)", 7, "expected a name"},
    {"exists(index", 12, "expected ')'"},
    {"index==index==1", 12, "expected '&&', '||' or the end"},
    {"raw==zz", 5, "bytes compare with hex digits, two a byte"},
    {"stale!=abc", 7, "bytes compare with hex digits, two a byte"},
};

TEST(Filter, explains_mistakes) {
  for (const BadCase& bad : kBad) {
    try {
      const Filter filter(bad.expression, rubicon());
      ADD_FAILURE() << bad.expression;
    } catch (const FilterError& error) {
      EXPECT_EQ(std::string(error.what()).find(bad.message), 0U)
          << bad.expression << ": " << error.what();
      EXPECT_EQ(error.position(), bad.position) << bad.expression << ": " << error.what();
    }
  }
}

TEST(Filter, points_at_the_mistake) {
  const FilterError error("unknown name 'b'", 5);
  EXPECT_EQ(error.explain("a && b"), "unknown name 'b'\n  a && b\n       ^");
}

TEST(Filter, shows_no_expression_that_is_too_long_for_a_caret) {
  const FilterError error("unknown name 'b'", 5);
  EXPECT_EQ(error.explain(std::string(100'000, 'a')), "unknown name 'b' (character 6)");
}

TEST(Filter, bounds_its_depth) {
  const std::string fine = std::string(60, '(') + "index==0" + std::string(60, ')');
  EXPECT_TRUE(matches(fine, Sample(kUpdates)));
  for (const char* deep : {"(", "!"}) {
    std::string expression;
    for (int i = 0; i < 10'000; ++i) expression += deep;
    EXPECT_THROW(Filter(expression + "index", rubicon()), FilterError);
  }
  std::string chain = "index==0";
  for (int i = 0; i < 3'000; ++i) chain += " && index==0";
  EXPECT_TRUE(matches(chain, Sample(kUpdates)));
  EXPECT_THROW(Filter(std::string(100'000, ' '), rubicon()), FilterError);
}

}  // namespace
}  // namespace rubric::format
