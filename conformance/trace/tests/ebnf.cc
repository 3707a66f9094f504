#include "conformance/trace/tests/ebnf.h"

#include <stdexcept>
#include <utility>

namespace rubric::trace::testing {
namespace {

std::size_t below(std::size_t count, std::mt19937& random) { return random() % count; }

}  // namespace

Ebnf::Ebnf(std::string_view text) : text_(text) {
  while (skip()) {
    const std::string name = word();
    expect("::=");
    if (!rules_.emplace(name, choice()).second) fail("a second rule for " + name);
  }
  for (const auto& [name, rule] : rules_) check(rule);
}

bool Ebnf::derives(const std::string& rule, std::string_view text) const {
  const std::u32string points = decode(text);
  const std::set<std::size_t> ends = match(rules_.at(rule), points, {0});
  return ends.contains(points.size());
}

std::string Ebnf::generate(const std::string& rule, std::mt19937& random) const {
  std::string out;
  generate(rules_.at(rule), random, out);
  return out;
}

std::vector<std::string> Ebnf::rule_names() const {
  std::vector<std::string> names;
  for (const auto& [name, rule] : rules_) names.push_back(name);
  return names;
}

void Ebnf::fail(const std::string& what) const {
  throw std::runtime_error("grammar at byte " + std::to_string(at_) + ": " + what);
}

bool Ebnf::skip() {
  while (at_ < text_.size()) {
    if (text_.substr(at_, 2) == "/*") {
      at_ = text_.find("*/", at_);
      if (at_ == std::string_view::npos) throw std::runtime_error("open comment in the grammar");
      at_ += 2;
    } else if (text_[at_] == ' ' || text_[at_] == '\n') {
      ++at_;
    } else {
      return true;
    }
  }
  return false;
}

bool Ebnf::is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
}

std::string Ebnf::word() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && is_word(text_[at_])) ++at_;
  if (at_ == begin) fail("expected a name");
  return std::string(text_.substr(begin, at_ - begin));
}

void Ebnf::expect(std::string_view token) {
  skip();
  if (text_.substr(at_, token.size()) != token) fail("expected " + std::string(token));
  at_ += token.size();
}

Ebnf::Node Ebnf::choice() {
  Node node{Kind::kChoice, {}, {}, false, false, {}};
  do {
    node.parts.push_back(sequence());
  } while (skip() && text_[at_] == '|' && ++at_);
  return node;
}

Ebnf::Node Ebnf::sequence() {
  Node node;
  while (skip() && text_[at_] != '|' && text_[at_] != ')') {
    const std::size_t before = at_;
    if (is_word(text_[at_])) {
      word();
      skip();
      const bool next_rule = text_.substr(at_, 3) == "::=";
      at_ = before;
      if (next_rule) break;
    }
    node.parts.push_back(repeated());
  }
  return node;
}

Ebnf::Node Ebnf::repeated() {
  Node inner = atom();
  const char c = at_ < text_.size() ? text_[at_] : '\0';
  if (c != '?' && c != '*' && c != '+') return inner;
  ++at_;
  return {Kind::kRepeat, {}, {}, c == '?', c == '+', {std::move(inner)}};
}

Ebnf::Node Ebnf::atom() {
  const char c = text_[at_];
  if (c == '(') {
    ++at_;
    Node inner = choice();
    expect(")");
    return inner;
  }
  if (c == '"' || c == '\'') {
    const std::size_t end = text_.find(c, at_ + 1);
    if (end == std::string_view::npos) fail("a literal without its end");
    Node node{
        Kind::kLiteral, std::string(text_.substr(at_ + 1, end - at_ - 1)), {}, false, false, {}};
    at_ = end + 1;
    return node;
  }
  if (c == '[') return set();
  if (c == '#') {
    const char32_t one = character();
    return {Kind::kSet, {}, {{one, one}}, false, false, {}};
  }
  return {Kind::kRule, word(), {}, false, false, {}};
}

char32_t Ebnf::character() {
  if (text_.substr(at_, 2) != "#x") return static_cast<unsigned char>(text_[at_++]);
  at_ += 2;
  std::size_t used = 0;
  const unsigned long value = std::stoul(std::string(text_.substr(at_, 6)), &used, 16);
  at_ += used;
  return static_cast<char32_t>(value);
}

Ebnf::Node Ebnf::set() {
  Node node{Kind::kSet, {}, {}, false, false, {}};
  ++at_;
  while (at_ < text_.size() && text_[at_] != ']') {
    const char32_t first = character();
    char32_t last = first;
    if (text_[at_] == '-' && text_[at_ + 1] != ']') {
      ++at_;
      last = character();
    }
    node.ranges.emplace_back(first, last);
  }
  ++at_;
  return node;
}

void Ebnf::check(const Node& node) const {
  if (node.kind == Kind::kRule && !rules_.contains(node.text)) fail("no rule " + node.text);
  for (const Node& part : node.parts) check(part);
}

std::u32string Ebnf::decode(std::string_view text) {
  std::u32string points;
  for (const char raw : text) {
    const auto c = static_cast<unsigned char>(raw);
    if ((c & 0xC0) != 0x80) {
      points += c < 0x80 ? c : c < 0xE0 ? c & 0x1Fu : c < 0xF0 ? c & 0x0Fu : c & 0x07u;
    } else {
      points.back() = points.back() << 6 | (c & 0x3Fu);
    }
  }
  return points;
}

Ebnf::Ends Ebnf::match(const Node& node, const std::u32string& text, const Ends& begins) const {
  Ends ends;
  switch (node.kind) {
    case Kind::kRule: return match(rules_.at(node.text), text, begins);
    case Kind::kChoice:
      for (const Node& part : node.parts) ends.merge(match(part, text, begins));
      return ends;
    case Kind::kSequence:
      ends = begins;
      for (const Node& part : node.parts) ends = match(part, text, ends);
      return ends;
    case Kind::kLiteral:
      for (const std::size_t at : begins) {
        const std::u32string literal = decode(node.text);
        if (text.compare(at, literal.size(), literal) == 0) ends.insert(at + literal.size());
      }
      return ends;
    case Kind::kSet:
      for (const std::size_t at : begins) {
        for (const auto& [first, last] : node.ranges) {
          if (at < text.size() && text[at] >= first && text[at] <= last) ends.insert(at + 1);
        }
      }
      return ends;
    case Kind::kRepeat: return match_repeat(node, text, begins);
  }
  return ends;
}

Ebnf::Ends Ebnf::match_repeat(const Node& node, const std::u32string& text,
                              const Ends& begins) const {
  Ends ends = node.at_least_once ? Ends{} : begins;
  Ends fresh = begins;
  while (!fresh.empty()) {
    Ends next;
    for (const std::size_t at : match(node.parts[0], text, fresh)) {
      if (ends.insert(at).second) next.insert(at);
    }
    if (node.at_most_once) break;
    fresh = std::move(next);
  }
  return ends;
}

void Ebnf::generate(const Node& node, std::mt19937& random, std::string& out) const {
  switch (node.kind) {
    case Kind::kRule: return generate(rules_.at(node.text), random, out);
    case Kind::kChoice: return generate(node.parts[below(node.parts.size(), random)], random, out);
    case Kind::kSequence:
      for (const Node& part : node.parts) generate(part, random, out);
      return;
    case Kind::kLiteral: out += node.text; return;
    case Kind::kSet: {
      const auto [first, last] = node.ranges[below(node.ranges.size(), random)];
      const auto point = static_cast<char32_t>(first + below(last - first + 1, random));
      if (point < 0x80) {
        out += static_cast<char>(point);
      } else {
        out += "\xC3\xA9";  // Any other will do.
      }
      return;
    }
    case Kind::kRepeat: {
      std::size_t count = below(node.at_most_once ? 2 : 4, random);
      if (node.at_least_once && count == 0) count = 1;
      while (count--) generate(node.parts[0], random, out);
    }
  }
}

}  // namespace rubric::trace::testing
