#include "codec/text/text.h"

#include <gtest/gtest.h>

#include "codec/text/json.h"

namespace rubric::text {
namespace {

TEST(Text, WrapAtBlanks) {
  EXPECT_EQ(wrapped("- ", "one two three", 9), "- one two\n  three\n");
  EXPECT_EQ(wrapped("", "one two", 3, 4), "one\n    two\n");
  EXPECT_EQ(wrapped("", "muchlongerthanthat a", 5), "muchlongerthanthat\na\n");
  EXPECT_EQ(wrapped("  ", "", 9), "\n");
}

TEST(Text, JsonStrings) {
  EXPECT_EQ(json_string("a\"b\\c\n\x01"), "\"a\\\"b\\\\c\\n\\u0001\"");
  EXPECT_EQ(json_string("\xC3\xA4"), "\"\xC3\xA4\"");
  EXPECT_EQ(json_string("\xFFx\xC3"), "\"\xEF\xBF\xBDx\xEF\xBF\xBD\"");
  EXPECT_EQ(json_string("\xED\xA0\x80"), "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"");
}

TEST(Json, ObjectsAndListsKeepTheirOrder) {
  const std::vector<int> numbers = {3, -1};
  const std::vector<std::string> none;
  const Json twice = Json::array(
      numbers, [](int i) { return 2 * i; }, "\n ", "\n");
  EXPECT_EQ(twice.text(), "[\n 6,\n -2\n]");
  EXPECT_EQ(Json::object({{"z", "a\"b"},
                          {"a", true},
                          {"time", Json::raw("0.500000")},
                          {"no_time", Json::raw("")},
                          {"name", Json::or_null("")},
                          {"list", Json::array(numbers)},
                          {"none", Json::array(none, {}, "\n", "\n")}},
                         "\n")
                .text(),
            "{\"z\":\"a\\\"b\",\n\"a\":true,\n\"time\":0.500000,\n\"no_time\":null,\n"
            "\"name\":null,\n\"list\":[3,-1],\n\"none\":[]}");
}

TEST(Text, XmlText) {
  EXPECT_EQ(xml_text("<a b=\"c\">&\n"), "&lt;a b=&quot;c&quot;&gt;&amp;\n");
  EXPECT_EQ(xml_text(std::string_view("\0\x1B", 2)), "\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(xml_text("]]>"), "]]&gt;");
}

TEST(Text, JsonStringsAreValidWhateverComes) {
  EXPECT_EQ(json_string("serial:1"), "\"serial:1\"");
  EXPECT_EQ(json_string("a\"b\\c\n\x01\x7f"), "\"a\\\"b\\\\c\\n\\u0001\\u007f\"");
  EXPECT_EQ(json_string("\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"),
            "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\"");
  constexpr std::string_view kReplaced = "\"\xef\xbf\xbd\"";
  for (const std::string_view bad : {"\xff", "\xc3", "\x80", "\xc0", "\xf5"}) {
    EXPECT_EQ(json_string(bad), kReplaced);
  }
}

TEST(Text, NotEveryByteBeginsACharacter) {
  EXPECT_EQ(utf8_length("\xc3\xa4x"), 2U);
  EXPECT_EQ(utf8_length(""), 0U);
  EXPECT_EQ(utf8_length("\xc0\xaf"), 0U);          // Longer than needed.
  EXPECT_EQ(utf8_length("\xed\xa0\x80"), 0U);      // A surrogate.
  EXPECT_EQ(utf8_length("\xf4\x90\x80\x80"), 0U);  // Beyond U+10FFFF.
  EXPECT_EQ(utf8_length("\xe2\x82"), 0U);          // Cut.
}

TEST(Text, Times) {
  EXPECT_EQ(seconds_text(3'842'100), "3.842100");
  EXPECT_EQ(seconds_text(-1), "");
}

TEST(Text, Counts) {
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(2, "reply", "replies"), "2 replies");
}

}  // namespace
}  // namespace rubric::text
