// Reads and runs a grammar in the notation of the XML specification, for tests that compare the
// parser with its grammar.
#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::trace::testing {

class Ebnf {
 public:
  /// Throws std::runtime_error if the text is no grammar or a rule is missing.
  explicit Ebnf(std::string_view text);

  /// Returns whether `rule` derives all of the text, which is UTF-8.
  bool derives(const std::string& rule, std::string_view text) const;

  /// Returns some text that the rule derives; repetitions are short.
  std::string generate(const std::string& rule, std::mt19937& random) const;
  std::vector<std::string> rule_names() const;

 private:
  enum class Kind : std::uint8_t { kChoice, kSequence, kLiteral, kSet, kRule, kRepeat };
  struct Node {
    Kind kind = Kind::kSequence;
    std::string text;                                   // Text of a literal or a rule's name.
    std::vector<std::pair<char32_t, char32_t>> ranges;  // kSet.
    bool at_most_once = false;                          // kRepeat: ?
    bool at_least_once = false;                         // kRepeat: +
    std::vector<Node> parts;
  };

  [[noreturn]] void fail(const std::string& what) const;
  bool skip();
  static bool is_word(char c);
  std::string word();
  void expect(std::string_view token);
  Node choice();
  Node sequence();
  Node repeated();
  Node atom();
  char32_t character();
  Node set();
  void check(const Node& node) const;
  static std::u32string decode(std::string_view text);
  using Ends = std::set<std::size_t>;
  Ends match(const Node& node, const std::u32string& text, const Ends& begins) const;
  Ends match_repeat(const Node& node, const std::u32string& text, const Ends& begins) const;

  void generate(const Node& node, std::mt19937& random, std::string& out) const;
  std::string_view text_;
  std::size_t at_ = 0;
  std::map<std::string, Node> rules_;
};

}  // namespace rubric::trace::testing
