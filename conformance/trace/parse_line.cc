// Parses one line of a case: label, time, node, link, message, rules, bytes and comment.
#include "conformance/trace/parse_line.h"

#include <algorithm>
#include <vector>

#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

std::int64_t ticks(Scanner& in, std::string_view text) {
  std::int64_t number = 0;
  if (text.starts_with('-') || text.starts_with("0x") || !read_integer(text, number)) {
    in.fail_at(text, "expected a time in ticks, given " + quoted(text));
  }
  return number;
}

constexpr std::int64_t kFactorMax = 1000;

// Reads `response` or `4*join_period`.
Term term(Scanner& in, std::string_view text) {
  Term out;
  std::string_view name = text;
  if (const std::size_t star = text.find('*'); star != std::string_view::npos) {
    out.factor = ticks(in, text.substr(0, star));
    if (out.factor > kFactorMax) {
      in.fail_at(text, "expected a factor from 0 to " + std::to_string(kFactorMax) + ", given " +
                           quoted(text));
    }
    name = text.substr(star + 1);
  }
  const Parameter* const known = find_parameter(name);
  if (!known) {
    in.fail_at(text, "expected ticks or a parameter, given " + quoted(name) + "; known are " +
                         parameter_names());
  }
  out.parameter = known->id;
  return out;
}

// Reads `12`, or parameters with a number before or after them: `join_period+response-1`. Returns
// the number.
std::int64_t amount(Scanner& in, const std::string_view text, std::vector<Term>& terms) {
  std::int64_t number = 0;
  bool numbered = false;
  for (std::size_t at = 0; at <= text.size();) {
    const std::int64_t sign = at > 0 && text[at - 1] == '-' ? -1 : 1;
    const std::size_t end = std::min(text.find_first_of("+-", at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (word.find_first_not_of("0123456789") != word.npos) {
      terms.push_back(term(in, word));
      terms.back().factor *= sign;
    } else if (numbered || word.empty() || (at > 0 && end < text.size())) {
      in.fail_at(text, "expected a time in ticks, given " + quoted(text));
    } else {
      number = sign * ticks(in, word);
      numbered = true;
    }
    at = end + 1;
  }
  return number;
}

// Reads `12`, `0..50` or `0..response+50`.
void window(Scanner& in, std::string_view text, Time& time) {
  const std::size_t dots = text.find("..");
  time.from = time.to = amount(in, text.substr(0, dots), time.from_terms);
  time.to_terms = time.from_terms;
  if (dots == std::string_view::npos) return;
  time.to_terms.clear();
  time.to = amount(in, text.substr(dots + 2), time.to_terms);
  if (time.from_terms == time.to_terms && time.to < time.from) {
    in.fail_at(text, "the window " + quoted(text) + " ends before it begins");
  }
}

Time parse_time(Scanner& in) {
  Time time;
  std::string_view text = in.word();
  if (text.empty()) in.fail("expected a time");
  if (text[0] == '@') {
    time.base = Time::Base::kStart;
    text.remove_prefix(1);
  } else if (const std::string_view word = text.substr(0, text.find_first_of("+-.*"));
             is_name(word) && !find_parameter(word) && text.substr(word.size()).starts_with('+')) {
    time.base = Time::Base::kLabel;
    time.label = word;
    text.remove_prefix(word.size() + 1);
  } else if (is_name(text) && !find_parameter(text)) {
    in.fail_at(text, "expected a time; " + quoted(text) +
                         " wants '+' and ticks as a time, or "
                         "':' as a label");
  }
  window(in, text, time);
  return time;
}

std::string take_name(Scanner& in, const char* what, bool star) {
  in.skip_blanks();
  const std::string_view word = in.word();
  if (word.empty()) in.fail(std::string("expected ") + what);
  if (!(star && word == "*") && !is_dotted_name(word)) {
    in.fail_at(word, std::string("expected ") + what + ", given " + quoted(word));
  }
  return std::string(word);
}

void parse_op(Scanner& in, Line& line) {
  const std::string who = take_name(in, "a node or a link", true);
  in.skip_blanks();
  const std::string_view op = in.word();
  for (const Op known : {Op::kGiven, Op::kEmits, Op::kMustNot, Op::kMay, Op::kLost, Op::kDup}) {
    if (op != op_text(known)) continue;
    line.op = known;
    if (is_fault(known)) {
      line.link = who;
    } else {
      line.node = who;
      line.link = take_name(in, "a link", true);
    }
    return;
  }
  if (op.empty()) in.fail("expected <, >, !>, ?>, lost or dup");
  in.fail_at(op, "expected <, >, !>, ?>, lost or dup, given " + quoted(op));
}

Value am_side(Scanner& in, std::string_view text) {
  Value value;
  const std::string problem = read_value(text, value);
  const bool number = value.is(Value::Kind::kNumber) && text.find('-') == std::string_view::npos;
  const bool fits = number || value.is(Value::Kind::kAny) || value.is(Value::Kind::kVariable) ||
                    (value.is(Value::Kind::kNames) && value.text == "all");
  if (!problem.empty() || !fits) {
    in.fail_at(text,
               "expected an AM address: a number, all, a variable or *, given " + quoted(text));
  }
  return value;
}

void parse_am(Scanner& in, Line& line) {
  constexpr std::string_view kAm = "am=";
  if (!in.rest().starts_with(kAm)) return;
  in.advance(kAm.size());
  const std::string_view word = in.word();
  const std::size_t arrow = word.find("->");
  if (arrow == std::string_view::npos) {
    in.fail_at(word, "expected am=SOURCE->DESTINATION, given " + quoted(word));
  }
  line.am = AmAddresses{am_side(in, word.substr(0, arrow)), am_side(in, word.substr(arrow + 2))};
  in.skip_blanks();
}

// Reads a field with its path, or a value alone.
FieldValue parse_field(Scanner& in) {
  FieldValue field{.place = in.place()};
  const std::string_view rest = in.rest();
  std::size_t size = 0;
  const auto in_path = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '[' || c == ']';
  };
  while (size < rest.size() && in_path(rest[size])) ++size;
  if (size < rest.size() && rest[size] == '=') {
    field.path = rest.substr(0, size);
    if (!is_path(field.path)) in.fail("expected a field's path, given " + quoted(field.path));
    in.advance(size + 1);
  }
  const std::string_view text = in.rest().substr(0, value_size(in.rest()));
  const std::string problem = read_value(text, field.value);
  if (!problem.empty()) in.fail(problem);
  in.advance(text.size());
  return field;
}

void parse_fields(Scanner& in, Message& message) {
  message.form = Message::Form::kFields;
  const Place open = in.place();
  in.advance(1);
  message.fields.reserve(static_cast<std::size_t>(std::ranges::count(in.rest(), '=')));
  while (true) {
    in.skip_blanks();
    if (in.at_end()) throw LineError{open, "'(' without its ')'"};
    if (in.take(')')) break;
    if (message.open) in.fail("expected ')' after '...'");
    if (in.rest().starts_with("...")) {
      message.open = true;
      in.advance(3);
    } else {
      message.fields.push_back(parse_field(in));
    }
    if (in.peek() != ' ' && in.peek() != '\t' && in.peek() != ')' && !in.at_end()) {
      in.fail("expected a blank or ')'");
    }
  }
  const bool star = message.fields.size() == 1 && message.fields[0].path.empty() &&
                    message.fields[0].value.is(Value::Kind::kAny);
  if (star && !message.open) {
    message.form = Message::Form::kAny;
    message.fields.clear();
  }
  message.fields.shrink_to_fit();  // A case keeps all its lines.
}

void parse_requirements(Scanner& in, Line& line) {
  in.advance(1);
  while (true) {
    in.skip_blanks();
    if (in.take(']')) return;
    const std::string_view word =
        in.until([](char c) { return c == ' ' || c == '\t' || c == ']' || c == '['; });
    if (word.empty()) in.fail("expected requirements and ']'");
    const auto fits = [](char c) {
      return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    };
    if (word[0] < 'A' || !std::all_of(word.begin(), word.end(), fits)) {
      in.fail_at(word, "expected a requirement, as J4-SEQ, given " + quoted(word));
    }
    line.requirements.emplace_back(word);
  }
}

void parse_bytes(Scanner& in, Line& line) {
  in.advance(1);
  const std::string_view text = trimmed(in.until([](char c) { return c == ';'; }));
  // Blanks come between bytes, not within one.
  line.bytes = std::string();
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == ' ' || text[at] == '\t') {
      ++at;
    } else if (read_hex_bytes(text.substr(at, 2), *line.bytes)) {
      at += 2;
    } else {
      in.fail_at(text, "expected bytes in hex after '|'");
    }
  }
  if (line.bytes->empty()) in.fail_at(text, "expected bytes in hex after '|'");
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string parse_comment(Scanner& in) {
  in.skip_blanks();
  if (in.at_end()) return {};
  if (!in.take(';')) {
    in.fail("expected the end of the line, given " + quoted(in.rest().substr(0, 20)));
  }
  const std::string_view text = in.rest();
  in.advance(text.size());
  return std::string(trimmed(text));
}

Message parse_message(Scanner& in) {
  Message message{.place = in.place()};
  const std::string_view name = in.until(
      [](char c) { return c == ' ' || c == '\t' || c == '(' || c == '[' || c == ';' || c == '|'; });
  if (name.empty()) in.fail("expected a message");
  if (name != "*" && !is_name(name)) in.fail_at(name, "expected a message, given " + quoted(name));
  message.name = name;
  if (in.peek() == '(') parse_fields(in, message);
  return message;
}

Line parse_line(Scanner& in) {
  Line line;
  in.skip_blanks();
  line.place = in.place();
  const std::string_view rest = in.rest();
  const std::size_t colon = rest.find_first_of(": \t");
  if (colon != std::string_view::npos && rest[colon] == ':') {
    line.label = rest.substr(0, colon);
    if (!is_name(line.label)) in.fail("expected a label before ':', given " + quoted(line.label));
    in.advance(colon + 1);
    in.skip_blanks();
  }
  line.time = parse_time(in);
  in.skip_blanks();
  parse_op(in, line);
  in.skip_blanks();
  parse_am(in, line);
  line.message = parse_message(in);
  while (in.skip_blanks(), in.peek() == '[') parse_requirements(in, line);
  if (in.peek() == '|') parse_bytes(in, line);
  line.comment = parse_comment(in);
  return line;
}

}  // namespace rubric::trace
