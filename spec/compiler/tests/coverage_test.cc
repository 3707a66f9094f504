// Every text that a diagnostic can have is expected by some test: a new one without a test fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "spec/compiler/tests/bad_files.h"

namespace rubricc {
namespace {

const std::string kCompiler = "spec/compiler/";

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Returns the reports that the bad inputs expect, and the test that makes its own.
std::string expectations() {
  std::string out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kBadFolder)) {
    if (!entry.is_regular_file()) continue;
    for (const std::string& expected : expected_in(entry.path())) out += "\n" + expected;
  }
  EXPECT_GE(std::ranges::count(out, '\n'), 270);  // Else the scan is broken.
  return out + read(kCompiler + "tests/bad_test.cc");
}

/// Returns the string that begins with the quote at `at`, and the index after it.
std::string literal_at(const std::string& text, std::size_t& at) {
  std::string out;
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
    out += text[at];
  }
  ++at;
  return out;
}

/// Returns the strings among the arguments of the call whose bracket opens before `at`, except
/// those of the first argument, the place, if `skip_first`.
std::vector<std::string> literals_of_call(const std::string& text, std::size_t at,
                                          bool skip_first) {
  std::vector<std::string> out;
  bool skip = skip_first;
  for (int depth = 1; depth > 0 && at < text.size();) {
    const char c = text[at];
    if (c == '"') {
      const std::string literal = literal_at(text, at);
      if (!skip) out.push_back(literal);
      continue;
    }
    depth += (c == '(' || c == '{') - (c == ')' || c == '}');
    if (c == ',' && depth == 1) skip = false;
    ++at;
  }
  return out;
}

/// Returns the longest text between the holes of a format string.
std::string longest_constant_part(const std::string& format) {
  std::string best, part;
  bool hole = false;
  for (const char c : format + "{") {
    if (c == '{') {
      if (part.size() > best.size()) best = part;
      part.clear();
    } else if (!hole && c != '}') {
      part += c;
    }
    hole = c == '{' || (hole && c != '}');
  }
  return best;
}

std::vector<std::string> texts_in(const std::string& source) {
  std::vector<std::string> out;
  for (const std::string call :
       {"error(", "error_in_code(", "error_elsewhere(", "unproved(", "fail("}) {
    for (std::size_t at = source.find(call); at != source.npos; at = source.find(call, at + 1)) {
      const char before = at == 0 ? ' ' : source[at - 1];
      if (std::isalnum(static_cast<unsigned char>(before)) != 0 || before == '_') continue;
      for (const auto& text : literals_of_call(source, at + call.size(), call != "fail(")) {
        out.push_back(text);
      }
    }
  }
  return out;
}

TEST(Diagnostics, HaveATestEach) {
  const std::string expected = expectations();
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kCompiler)) {
    const std::string name = entry.path().filename().string();
    const bool reports = name.ends_with(".cc") && !name.ends_with("_test.cc") &&
                         !name.starts_with("emit_") && name != "main.cc";
    if (!reports) continue;
    for (const std::string& text : texts_in(read(entry.path()))) {
      ++found;
      const std::string part = longest_constant_part(text);
      EXPECT_NE(expected.find(part), expected.npos) << name << ": nobody expects: " << text;
    }
  }
  EXPECT_GT(found, 250U);  // Else the scan is broken.
}

TEST(Diagnostics, AreFoundInSources) {
  const std::string source =
      "check.error(place_of(places, \"size\", at), fmt::format(\"a {} too {}\", quote(x), 2),\n"
      "            \"b \\\"c\\\"\");\nif (is_error(\"no\")) fail(\"d\", \"\");";
  EXPECT_EQ(texts_in(source), (std::vector<std::string>{"a {} too {}", "b \"c\"", "d", ""}));
  EXPECT_EQ(longest_constant_part("a {} too {}"), " too ");
  EXPECT_EQ(longest_constant_part("0x{:02x} is"), " is");
}

}  // namespace
}  // namespace rubricc
