#include "fuzz/support/json_check.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

namespace rubric::fuzz {
namespace {

TEST(JsonCheck, MembersAsWritten) {
  std::map<std::string_view, std::string_view> members;
  EXPECT_TRUE(is_json(R"( {"a": 1, "b" : {"c": [null, -0.5e+3]}, "d":"\u00e4\""} )", &members));
  EXPECT_EQ(members.size(), 3U);
  EXPECT_EQ(members["a"], "1");
  EXPECT_EQ(members["b"], R"({"c": [null, -0.5e+3]})");
  EXPECT_EQ(members["d"], R"("\u00e4\"")");
}

// The validator and a full parser agree on JSON. (No number here can grow beyond a double, which
// that parser refuses.)
TEST(JsonCheck, AgreesWithAParser) {
  const std::string good[] = {
      R"({"schema":"rubric.decode/1","time":0.52,"interface":"s:1\n","n":[1,-2,3e-9,0.5E-7]})",
      "[\"\xc3\xa4\",\"\xe2\x82\xac\",\"\xf0\x9f\x98\x80\",\"\\ud83d\\ude00\",true,false,null,{}]",
      R"("\"\\\/\b\f\n\r\t\u0000")", "-0", "[]", " {\t\"\":\r\n0 }"};
  constexpr std::string_view kPieces = "{}[]\",:\\u0d8e9+-. tn\n\x1f\x80\xc0\xed\xf4\xff";
  std::mt19937 random(5);
  std::size_t taken = 0;
  for (int round = 0; round < 60'000; ++round) {
    std::string text = good[random() % std::size(good)];
    for (auto changes = random() % 3; changes > 0 && !text.empty(); --changes) {
      const std::size_t at = random() % text.size();
      const char piece = kPieces[random() % kPieces.size()];
      if (random() % 3 == 0) {
        text.insert(at, 1, piece);
      } else if (random() % 2 == 0) {
        text.erase(at, 1);
      } else {
        text[at] = piece;
      }
    }
    const bool wanted = nlohmann::json::accept(text);
    EXPECT_EQ(is_json(text, nullptr), wanted) << text;
    taken += wanted;
  }
  EXPECT_GT(taken, 20'000U);
  EXPECT_LT(taken, 50'000U);
}

}  // namespace
}  // namespace rubric::fuzz
