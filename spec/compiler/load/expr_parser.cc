// Parses expressions by precedence, and prints them again.
#include <fmt/format.h>

#include <array>

#include "spec/compiler/load/read_spec.h"
#include "spec/compiler/load/yaml_input.h"

namespace rubricc {
namespace {

constexpr std::size_t kTextMax = 1000;
constexpr int kDepthMax = 40;

struct Operator {
  std::string_view text;
  ExprOp op;
  int level;  // Binds tighter the higher it is.
};
constexpr std::array<Operator, 18> kOperators{{
    {"or", ExprOp::kOr, 1},
    {"and", ExprOp::kAnd, 2},
    {"==", ExprOp::kEq, 4},
    {"!=", ExprOp::kNe, 4},
    {"<=", ExprOp::kLe, 4},
    {">=", ExprOp::kGe, 4},
    {"<", ExprOp::kLt, 4},
    {">", ExprOp::kGt, 4},
    {"|", ExprOp::kBitOr, 5},
    {"^", ExprOp::kBitXor, 6},
    {"&", ExprOp::kBitAnd, 7},
    {"<<", ExprOp::kShiftLeft, 8},
    {">>", ExprOp::kShiftRight, 8},
    {"+", ExprOp::kAdd, 9},
    {"-", ExprOp::kSub, 9},
    {"*", ExprOp::kMul, 10},
    {"/", ExprOp::kDiv, 10},
    {"%", ExprOp::kMod, 10},
}};
constexpr int kNotLevel = 3;
constexpr int kComparisonLevel = 4;
constexpr int kTightest = 10;

bool is_word_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(char c) { return is_word_start(c) || is_digit(c); }

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Returns the place of the character `offset` of a YAML scalar. A scalar of several lines has lost
/// its line ends and indents: its words are looked up in the `source`, which begins with the line
/// of `begin`. If it is not written as it reads (escapes), that leads to `begin`.
SourcePlace place_in_scalar(const SourcePlace& begin, std::string_view text, std::size_t offset,
                            std::string_view source) {
  SourcePlace at = begin;
  auto i = static_cast<std::size_t>(begin.column - 1);
  const auto go_on = [&] {
    ++at.column;
    if (source[i++] != '\n') return;
    ++at.line;
    at.column = 1;
  };
  if (i < source.size() && (source[i] == '|' || source[i] == '>')) {
    const int header = at.line;
    while (i < source.size() && at.line == header) go_on();
  }
  SourcePlace last = at;
  for (std::size_t k = 0; k < text.size() && k <= offset; ++k) {
    if (is_blank(text[k])) continue;
    while (i < source.size() && is_blank(source[i])) go_on();
    if (i >= source.size() || source[i] != text[k]) return begin;
    if (k == offset) return at;
    go_on();
    last = at;
  }
  return last;  // After the end.
}

struct Fault {};  // Thrown within the parser after the diagnostic, caught in parse_expr.

class Parser {
 public:
  Parser(std::string_view text, const SourcePlace& place, Diagnostics& diagnostics)
      : text_(text), place_(place), diagnostics_(diagnostics) {
    next();
  }

  ExprPtr parse() {
    ExprPtr expr = choice(0);
    if (!token_.empty())
      fail(fmt::format("unexpected {}", quote(token_)),
           "an operator or the end of the expression was expected");
    return expr;
  }

 private:
  [[noreturn]] void fail(std::string what, std::string_view expected) {
    diagnostics_.error(here(), std::move(what), expected);
    throw Fault{};
  }

  SourcePlace here() const {
    const std::string_view source = diagnostics_.source_from(place_.file, place_.line);
    if (!source.empty()) return place_in_scalar(place_, text_, token_start_, source);
    SourcePlace at = place_;
    at.column += static_cast<int>(token_start_);
    return at;
  }

  void next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) {
      ++at_;
    }
    token_start_ = at_;
    token_ = {};
    operator_ = nullptr;
    if (at_ == text_.size()) return;
    std::size_t end = at_ + 1;
    const std::string_view two = text_.substr(at_, 2);
    if (is_word(text_[at_])) {
      while (end < text_.size() && is_word(text_[end])) ++end;
    } else if (two == "==" || two == "!=" || two == "<=" || two == ">=" || two == "::" ||
               two == "<<" || two == ">>") {
      end = at_ + 2;
    }
    token_ = text_.substr(at_, end - at_);
    at_ = end;
    for (const Operator& candidate : kOperators) {
      if (candidate.text == token_) operator_ = &candidate;
    }
  }

  ExprPtr node(ExprOp op, const SourcePlace& place) {
    auto out = std::make_unique<Expr>();
    out->op = op;
    out->place = place;
    return out;
  }

  void only_at_run_time(std::string_view what) {
    diagnostics_.error_in_code(here(), fmt::format("{} is outside the profile", quote(what)),
                               "+ - * / %, comparisons, and, or, not were expected");
  }

  ExprPtr choice(int depth) {
    ExprPtr condition = binary(1, depth);
    if (token_ != "?") return condition;
    only_at_run_time("? :");
    ExprPtr out = node(ExprOp::kSelect, here());
    next();
    out->operands.push_back(std::move(condition));
    out->operands.push_back(choice(depth + 1));
    if (token_ != ":") fail("a choice without ':'", "a ? b : c was expected");
    next();
    out->operands.push_back(choice(depth + 1));
    return out;
  }

  ExprPtr binary(int level, int depth) {
    if (depth > kDepthMax) fail("the expression nests too deep", "write it simpler");
    if (level == kNotLevel && token_ == "not") {
      ExprPtr out = node(ExprOp::kNot, here());
      next();
      out->operands.push_back(binary(kNotLevel, depth + 1));
      return out;
    }
    ExprPtr left = level == kTightest + 1 ? unary(depth) : binary(level + 1, depth);
    while (operator_ != nullptr && operator_->level == level) {
      if (operator_->op >= ExprOp::kBitAnd) only_at_run_time(operator_->text);
      ExprPtr out = node(operator_->op, here());
      next();
      out->operands.push_back(std::move(left));
      out->operands.push_back(binary(level + 1, depth));
      left = std::move(out);
      if (level == kComparisonLevel) break;
    }
    return left;
  }

  ExprPtr unary(int depth) {
    if (token_ == "(") {
      next();
      ExprPtr inner = choice(depth + 1);
      if (token_ != ")") fail("a bracket is not closed", "')' was expected");
      next();
      return inner;
    }
    if (token_ == "-") {
      const SourcePlace place = here();
      next();
      if (depth > kDepthMax) fail("the expression nests too deep", "write it simpler");
      ExprPtr inner = unary(depth + 1);
      if (inner->op == ExprOp::kInt) {
        inner->value = -inner->value;
        inner->place = place;
        return inner;
      }
      ExprPtr out = node(ExprOp::kSub, place);
      out->operands.push_back(node(ExprOp::kInt, place));
      out->operands.push_back(std::move(inner));
      return out;
    }
    if (!token_.empty() && is_digit(token_[0])) return number();
    if (!token_.empty() && is_word_start(token_[0]) && operator_ == nullptr && token_ != "not") {
      return name();
    }
    fail(token_.empty() ? "the expression ends early" : fmt::format("unexpected {}", quote(token_)),
         "a number, a field or an enum::value was expected");
  }

  ExprPtr number() {
    ExprPtr out = node(ExprOp::kInt, here());
    std::string digits(token_);
    std::erase(digits, '_');
    const auto value = parse_integer(digits);
    if (!value) {
      const bool hex = digits.starts_with("0x") && digits.size() > 2;
      const char* const all = hex ? "0123456789abcdefABCDEF" : "0123456789";
      const bool large = digits.find_first_not_of(all, hex ? 2 : 0) == digits.npos;
      fail(fmt::format("{} is {}", quote(token_), large ? "too large" : "not a number"),
           large ? "at most 9007199254740991 was expected, which rules of a u8 can name"
                 : "decimal, 0x or 0b digits were expected");
    }
    out->value = *value;
    next();
    return out;
  }

  std::string word() {
    if (token_.empty() || !is_word_start(token_[0])) {
      fail("a name is missing", "a word was expected after '.' or '::'");
    }
    std::string out(token_);
    next();
    return out;
  }

  ExprPtr name() {
    ExprPtr out = node(ExprOp::kField, here());
    if (token_[0] == '_' && token_ != "_") {
      fail(fmt::format("{} is outside the profile", quote(token_)),
           "fields of the same structure can be read");
    }
    out->path.push_back(word());
    if (out->path[0] == "true" || out->path[0] == "false") {
      out->op = ExprOp::kInt;
      out->is_bool = true;
      out->value = out->path[0] == "true" ? 1 : 0;
      return out;
    }
    while (token_ == "::") {
      out->op = ExprOp::kEnumValue;
      next();
      out->path.push_back(word());
    }
    if (out->path.size() > 3) {
      diagnostics_.error(out->place, "too many '::'", "enum::value or spec::enum::value");
      throw Fault{};
    }
    while (token_ == ".") {
      next();
      std::string part = word();
      if (part == "to_i") {
        out->to_i = true;
        break;
      }
      if (out->op == ExprOp::kEnumValue || out->path.size() >= 16) {
        fail("unexpected path", "only '.to_i' can follow here");
      }
      out->path.push_back(std::move(part));
    }
    return out;
  }

  std::string_view text_;
  SourcePlace place_;
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  std::size_t token_start_ = 0;
  std::string_view token_;
  const Operator* operator_ = nullptr;  // What the token is, if it is one.
};

int level_of(ExprOp op) {
  if (op == ExprOp::kNot) return kNotLevel;
  if (op == ExprOp::kSelect) return 0;
  for (const Operator& candidate : kOperators) {
    if (candidate.op == op) return candidate.level;
  }
  return kTightest + 1;
}

std::string text_at(const Expr& expr, int level) {
  std::string out;
  const int own = level_of(expr.op);
  const char* const to_i = expr.to_i ? ".to_i" : "";
  switch (expr.op) {
    case ExprOp::kInt: return expr.is_bool ? expr.path[0] : std::to_string(expr.value);
    case ExprOp::kField: return fmt::format("{}{}", fmt::join(expr.path, "."), to_i);
    case ExprOp::kEnumValue: return fmt::format("{}{}", fmt::join(expr.path, "::"), to_i);
    case ExprOp::kNot: out = "not " + text_at(*expr.operands[0], own); break;
    case ExprOp::kSelect:
      out = fmt::format("{} ? {} : {}", text_at(*expr.operands[0], 1),
                        text_at(*expr.operands[1], own), text_at(*expr.operands[2], own));
      break;
    default:
      for (const Operator& candidate : kOperators) {
        if (candidate.op != expr.op) continue;
        out = fmt::format("{} {} {}", text_at(*expr.operands[0], own), candidate.text,
                          text_at(*expr.operands[1], own + 1));
      }
  }
  return own < level ? "(" + out + ")" : out;
}

}  // namespace

ExprPtr parse_expr(std::string_view text, const SourcePlace& place, Diagnostics& diagnostics) {
  if (text.size() > kTextMax) {
    diagnostics.error(place, "the expression is too long",
                      fmt::format("at most {} characters are read", kTextMax));
    return nullptr;
  }
  try {
    return Parser(text, place, diagnostics).parse();
  } catch (const Fault&) {
    return nullptr;
  }
}

std::string to_text(const Expr& expr) { return text_at(expr, 0); }

}  // namespace rubricc
