#include "tools/format/filter.h"

#include <gtest/gtest.h>

#include "tools/format/testing.h"

namespace rubric::format {
namespace {

bool matches(std::string_view expression, const Sample& sample) {
  return Filter(expression, rubicon()).matches(sample.record);
}

struct Case {
  const char* expression;
  bool expected;
};

class FilterOfUpdates : public testing::Test {
 protected:
  FilterOfUpdates() : sample_(kUpdates, Framing::kHdlc) {
    sample_.record.index = 12;
    sample_.record.number = 3;
    sample_.record.time_ns = 1'500'000'000;
    sample_.record.interface_name = "serial:1";
    sample_.packet.direction = Direction::kOutbound;
  }
  void expect_all(const std::vector<Case>& cases) {
    for (const Case& c : cases) {
      EXPECT_EQ(matches(c.expression, sample_), c.expected) << c.expression;
    }
  }
  Sample sample_;
};

TEST_F(FilterOfUpdates, compares_attributes) {
  expect_all({
      {"message==updates", true},
      {"message == net_msg", false},
      {"message!=net_msg", true},
      {"path==net_msg", true},
      {"path!=net_msg", false},
      {"framing==hdlc", true},
      {"direction==outbound", true},
      {"direction==inbound", false},
      {"interface==serial:1", true},
      {"interface=='serial:2'", false},
      {"interface!=\"serial:2\"", true},
      {"index==12", true},
      {"index<12", false},
      {"index<=12", true},
      {"number==3", true},
      {"number==12", false},
      {"index>11", true},
      {"index>=13", false},
      {"time==1.5", true},
      {"time>1.4999", true},
      {"am.type==28", true},
      {"am.type==0x1c", true},
      {"frame.kind==packet_noack", true},
      {"frame.kind==69", true},
      {"frame.serial_seq==0", false},
      {"stale==beef", true},
      {"stale=='BEEF'", true},
      {"stale_bytes==2", true},
      {"raw==00", false},
  });
}

TEST_F(FilterOfUpdates, compares_fields_by_the_tail_of_their_path) {
  expect_all({
      {"src.devid==2", true},
      {"dest.devid==2", false},
      {"devid==2", true},
      {"dest.devid==null", true},
      {"src.devid!=4", true},
      {"devid!=2", false},
      {"src.devid==dest.devid", false},
      {"src.pid==dest.pid", true},
      {"seq_num==0xb0d3", true},
      {"net_msg.seq_num==45267", true},
      {"payload.body.updates.value==302", true},
      {"updates.value>6000", true},
      {"updates.value>7000", false},
      {"app_id==control_layer", true},
      {"app_id==10", true},
      {"app_id_name==control_layer", true},
      {"fields.updates.value==1202", true},
      {"4==src.devid", false},
      {"2==src.devid", true},
      {"1<src.devid", true},
  });
}

TEST_F(FilterOfUpdates, tests_masks) {
  expect_all({
      {"transducer & temp", true},
      {"transducer & mic", false},
      {"transducer & mic|humid", true},
      {"transducer & 0x40", true},
      {"transducer & bit13", false},
      {"transducer & 0x43 == 0x40", true},
      {"transducer & temp == 2", true},
      {"transducer & temp != 0", false},
  });
}

TEST_F(FilterOfUpdates, joins_and_negates) {
  expect_all({
      {"message==updates && src.devid==2", true},
      {"message==updates && src.devid==4", false},
      {"message==join_reply || src.devid==2", true},
      {"!(message==join_reply) && !error", true},
      {"message==join_reply && src.devid==2 || index==12", true},
      {"message==join_reply && (src.devid==2 || index==12)", false},
      {"not error and (index==12 or index==13)", true},
      {"!!exists(time)", true},
  });
}

TEST_F(FilterOfUpdates, tests_presence) {
  expect_all({
      {"exists(src.devid)", true},
      {"src.devid", true},
      {"cur_time", false},
      {"exists(error)", false},
      {"error", false},
      {"rubicon_ack", false},
      {"updates", true},
      {"stale", true},
      {"notes", false},
      {"direction", true},
      {"cur_time==0", false},
      {"cur_time!=0", false},
      {"!(cur_time==0)", true},
  });
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
    {"index==12ms", 7, "'12ms' is not a number"},
    {"index==1.2.3", 7, "'1.2.3' is not a number"},
    {"interface=='serial", 11, "this string does not end"},
    {"index==1 # x", 9, "'#' means nothing here"},
    {"index==1 \x01", 9, "this character means nothing here"},
    {"message<updates", 8, "names and text compare by == and != alone"},
    {"transducers & tmp", 14, "unknown bit 'tmp' (did you mean 'temp'?)"},
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
