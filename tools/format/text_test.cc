#include "tools/format/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/format/csv.h"
#include "tools/format/testing.h"

namespace rubric::format {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

std::string printed(const Sample& sample, TextOptions options = {}) {
  TextFormatter formatter(rubicon(), std::move(options));
  return sample.print(formatter);
}

TEST(Text, is_a_line_a_frame) {
  Sample sample(kUpdates, Framing::kHdlc);
  sample.record.index = 60;
  sample.record.number = 6;
  sample.record.time_ns = 526'298'000;
  sample.record.interface_name = "serial:1";
  sample.packet.direction = Direction::kOutbound;
  EXPECT_EQ(printed(sample),
            "     6    0.526298 serial:1 -> hdlc     0>bcast net_msg/app_msg/updates "
            "dest=11:null src=11:2 reliable=0 seq_num=45267 nbytes=18 | trans_id=connless "
            "app_id=control_layer | type=updates output_size=3 "
            "updates=[light:302 temp:6402 humid:1202] +2 stale\n");
}

TEST(Text, goes_on_below_where_a_line_is_too_long) {
  TextOptions narrow{.width = 60};
  const Sample join(kJoinRequest, Framing::kBare, "join_request");
  const std::string plain = printed(join, narrow);
  EXPECT_EQ(plain,
            "     1 bare   join_request            seq_num=50421\n"
            "          mote_desc{mote_type=telosb_demo\n"
            "          transducers=light|temp|humid|bit13 actuators=led}\n");
  narrow.color = true;
  std::string colored = printed(join, narrow);
  for (std::size_t at; (at = colored.find('\033')) != std::string::npos;) {
    colored.erase(at, colored.find('m', at) + 1 - at);
  }
  EXPECT_EQ(colored, plain);
  narrow.color = false;
  narrow.width = 20;  // Words stay whole.
  EXPECT_THAT(printed(join, narrow), HasSubstr("\n          transducers=light|temp|humid|bit13\n"));
}

TEST(Text, shows_structures_masks_and_units) {
  const std::string join = printed(Sample(kJoinRequest, Framing::kBare, "join_request"));
  EXPECT_EQ(join,
            "     1 bare   join_request            seq_num=50421 mote_desc{mote_type=telosb_demo "
            "transducers=light|temp|humid|bit13 actuators=led}\n");
  TextOptions units{.units = true};
  EXPECT_THAT(printed(Sample("0001 18c4 04b2 012e 0003", Framing::kBare, "data"), units),
              HasSubstr(" temp=23.4degC "));
}

TEST(Text, marks_what_is_malformed) {
  const Sample sample("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 02 0001 02 030a");
  EXPECT_EQ(printed(sample),
            "!    1 sf   0>bcast net_msg                 dest=11:null src=11:2 "
            "!! out_of_range at 16: reliable is 2, allowed are 0 to 1\n"
            "        WIRE-NET-RELIABLE MUST: The reliable field of a network message is 0 or 1.\n");
}

TEST(Text, marks_notes_and_opaque_bytes) {
  const Sample noted("00 ffff 0000 12 00 1c 000b fffd 000b 0002 00 0001 06 0305 22aabbcc");
  EXPECT_THAT(printed(noted), EndsWith("payload=22aabbcc * does_not_fit at 22: body has the key 34 "
                                       "and does not fit demo_data\n"));
  const Sample unknown("00 ffff 0000 02 00 23 beef");
  EXPECT_THAT(printed(unknown), HasSubstr("am 35                   beef * unknown_message at 8"));
  EXPECT_THAT(printed(Sample("", Framing::kSf)), HasSubstr("bytes"));
}

TEST(Text, selects_fields) {
  TextOptions options{.fields = parse_paths("src.devid,updates.value,cur_time", rubicon())};
  EXPECT_EQ(printed(Sample(kUpdates), std::move(options)),
            "     1 src.devid=2 updates.value=302 6402 1202 cur_time=\n");
}

TEST(Text, colours_and_keeps_the_words) {
  TextOptions options{.color = true};
  const std::string line = printed(Sample(kUpdates), options);
  EXPECT_THAT(line, HasSubstr("\033[1;36mupdates\033[0m"));
  std::string plain;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\033') {
      i = line.find('m', i);
    } else {
      plain += line[i];
    }
  }
  while (plain.ends_with(" \n")) plain.erase(plain.size() - 2, 1);
  EXPECT_EQ(plain, printed(Sample(kUpdates)));
}

TEST(Text, obeys_no_control_characters_of_its_input) {
  Sample sample(kUpdates);
  sample.record.interface_name = "\033]0;evil\007\x9b";
  EXPECT_THAT(printed(sample), Not(HasSubstr("\033")));
}

TEST(Hexdump, names_the_owner_of_each_byte) {
  TextOptions options{.hex = true};
  const Sample sample("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 00 0001 02 030a beef");
  const std::string text = printed(sample, options);
  EXPECT_THAT(
      text,
      HasSubstr("        0000  00 ff ff 00 00 0e 00 1c  00 0b ff fd 00 0b 00 02  ................\n"
                "              a  b- b  c- c  d  e  f   g- g  h- h  i- i  j- j\n"));
  EXPECT_THAT(text, HasSubstr("        0010  00 00 01 02 03 0a be ef"));
  EXPECT_THAT(text, HasSubstr("\n        h dest.devid  i src.pid  j src.devid"));
}

TEST(Hexdump, marks_faults_and_stale_bytes_and_colours_fields) {
  TextOptions options{.hex = true};
  const Sample bad("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 02 0001 02 030a");
  EXPECT_THAT(printed(bad, options), HasSubstr("        0010  02 00 01 02 03 0a"));
  EXPECT_THAT(printed(bad, options), HasSubstr("\n               !\n"));
  EXPECT_THAT(printed(Sample(kUpdates), options), HasSubstr(" ~  ~\n"));
  options.color = true;
  const std::string text = printed(Sample(kUpdates), options);
  // dest.pid is the seventh leaf: the same colour in the line and in the dump.
  EXPECT_THAT(text, HasSubstr("\033[36m11\033[0m:"));
  EXPECT_THAT(text, HasSubstr("\033[36m00\033[0m \033[36m0b\033[0m"));
}

TEST(Csv, quotes_as_rfc_4180_says) {
  Buffer out(16);
  append_cell("plain", out);
  out.append(' ');
  append_cell("a,\"b\"\n", out);
  EXPECT_EQ(out.view(), "plain \"a,\"\"b\"\"\n\"");
}

TEST(Csv, has_a_header_and_a_row_a_frame) {
  CsvFormatter all(rubicon(), {});
  Buffer header(16);
  all.begin(header);
  EXPECT_EQ(header.view(), std::string(csv_columns()) + "\r\n");
  Sample sample(kUpdates);
  EXPECT_EQ(sample.print(all), "0,0,,,,sf,0,65535,28,updates,,,,\r\n");
  CsvFormatter some(rubicon(),
                    parse_paths("index, src.devid,updates.value,cur_time,devid_name", rubicon()));
  EXPECT_EQ(sample.print(some), "0,2,302 6402 1202,,null\r\n");
  const Sample bad("00 ffff 0000 0e 00 1c 000b fffd 000b 0002 02 0001 02 030a");
  EXPECT_EQ(bad.print(all),
            "0,0,,,,sf,0,65535,28,net_msg,out_of_range,16,WIRE-NET-RELIABLE,"
            "\"reliable is 2, allowed are 0 to 1\"\r\n");
}

TEST(Path, refuses_what_no_frame_can_have) {
  EXPECT_THROW(Path("src.devd", rubicon()), PathError);
  EXPECT_THROW(Path("", rubicon()), PathError);
  EXPECT_THROW(Path("nonsense.devid", rubicon()), PathError);
  EXPECT_THROW(Path(std::string(1000, '.'), rubicon()), PathError);
  EXPECT_NO_THROW(Path("net_msg.src.devid", rubicon()));
}

}  // namespace
}  // namespace rubric::format
