// The parser, the grammar in spec/trace and the examples beside it agree.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"
#include "conformance/trace/tests/ebnf.h"

namespace rubric::trace {
namespace {

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

const std::string& grammar_text() {
  static const std::string text = read("spec/trace/rtr.ebnf");
  return text;
}
const testing::Ebnf& grammar() {
  static const testing::Ebnf grammar(grammar_text());
  return grammar;
}

/// Returns the examples of the document that are marked as rtr.
std::vector<std::string> examples() {
  const std::string text = read("spec/trace/README.md");
  const std::string open = "```rtr\n";
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    const std::size_t end = text.find("```", at);
    found.push_back(text.substr(at, end - at));
    at = end;
  }
  return found;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Grammar, ExamplesOfTheDocument) {
  const std::vector<std::string> all = examples();
  ASSERT_EQ(all.size(), 2u);
  for (const std::string& example : all) {
    const Parsed parsed = parse(example, "README.md");
    EXPECT_EQ(parsed.errors(), "");
    for (const std::string& line : lines_of(example + print(parsed.file))) {
      EXPECT_TRUE(grammar().derives("line", line)) << line;
    }
    const Parsed again = parse(print(parsed.file), "printed");
    EXPECT_EQ(again.errors(), "");
    EXPECT_TRUE(again.file == parsed.file);
  }
  EXPECT_TRUE(grammar().derives("file", all[1]));
}

// Returns whether the errors are limits that the parser adds to the grammar: orders of numbers and
// sizes.
bool is_limit(const std::string& errors) {
  for (const char* limit :
       {"is empty", "ends before it begins", "digits, given", "a range of numbers", "from 0 to ",
        "from 1 to ", "from 200 to ", "is stated twice"}) {
    if (errors.find(limit) != std::string::npos) return true;
  }
  return false;
}

TEST(Grammar, WhatItDerivesParses) {
  std::mt19937 random(1);
  int parsed_lines = 0;
  for (int i = 0; i < 30000; ++i) {
    const std::string line = grammar().generate("line", random);
    ASSERT_TRUE(grammar().derives("line", line)) << line;
    const Parsed parsed = parse_syntax("%rtr 1\ncase a\n" + line + "\n", "t");
    ASSERT_TRUE(parsed.ok() || is_limit(parsed.errors())) << line << "\n" << parsed.errors();
    if (!parsed.ok()) continue;
    ++parsed_lines;
    // The grammar derives what the parser makes of it.
    for (const std::string& printed : lines_of(print(parsed.file))) {
      ASSERT_TRUE(grammar().derives("line", printed)) << line << "\n" << printed;
    }
  }
  EXPECT_GT(parsed_lines, 25000);
}

// Changes characters: neither accepts a text that the other refuses.
TEST(Grammar, RefusesWhatTheParserRefuses) {
  std::mt19937 random(2);
  const std::string characters = " ()[]!?*.=:;|%$@+-<>\"x0aJ_\\";
  const std::vector<std::string> lines = lines_of(examples()[0] + examples()[1]);
  int refused = 0;
  for (int i = 0; i < 30000; ++i) {
    std::string line = lines[random() % lines.size()];
    if (line.empty()) continue;
    line.replace(random() % line.size(), random() % 2, 1, characters[random() % characters.size()]);
    const Parsed parsed = parse_syntax("%rtr 1\ncase a\n" + line + "\n", "t");
    if (is_limit(parsed.errors())) continue;
    ASSERT_EQ(grammar().derives("line", line), parsed.ok()) << line << "\n" << parsed.errors();
    refused += !parsed.ok();
  }
  EXPECT_GT(refused, 3000);
}

TEST(Grammar, EveryRuleIsUsed) {
  for (const std::string& name : grammar().rule_names()) {
    if (name == "file") continue;
    std::size_t uses = 0;
    for (std::size_t at = grammar_text().find(name); at != std::string::npos;
         at = grammar_text().find(name, at + 1)) {
      ++uses;
    }
    EXPECT_GE(uses, 2u) << name;
  }
}

}  // namespace
}  // namespace rubric::trace
