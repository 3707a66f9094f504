#include "conformance/trace/parse.h"

#include <algorithm>
#include <vector>

#include "conformance/trace/check.h"
#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

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
  FieldValue field;
  field.place = in.place();
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
  line.bytes.emplace();
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

// Reads nothing, or `; text`.
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
  Message message;
  message.place = in.place();
  const std::string_view name = in.until(
      [](char c) { return c == ' ' || c == '\t' || c == '(' || c == '[' || c == ';' || c == '|'; });
  if (name.empty()) in.fail("expected a message");
  if (name != "*" && !is_name(name)) {
    in.fail_at(name, "expected a message, given " + quoted(name));
  }
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

/// Parses the rest of a line after the word "case".
Case parse_case(Scanner& in) {
  Case one;
  in.skip_blanks();
  one.place = in.place();
  const std::string_view name = in.until([](char c) { return c == ' ' || c == '\t' || c == ';'; });
  if (!is_dotted_name(name)) in.fail_at(name, "expected the name of a case");
  one.name = name;
  one.comment = parse_comment(in);
  return one;
}

/// Returns a word of a header; empty at its end.
std::string_view header_word(Scanner& in) {
  in.skip_blanks();
  if (in.peek() == '%' || in.peek() == ';') return in.rest().substr(0, 0);
  return in.until([](char c) { return c == ' ' || c == '\t' || c == ';'; });
}

std::uint16_t small_number(Scanner& in, std::string_view text, const char* what) {
  std::int64_t number = 0;
  if (!read_integer(text, number) || number < 0 || number > 0xFFFF) {
    in.fail_at(text, std::string("expected ") + what + " from 0 to 65535, given " + quoted(text));
  }
  return static_cast<std::uint16_t>(number);
}

NodeHeader parse_node(Scanner& in) {
  NodeHeader node;
  std::string_view word = header_word(in);
  if (!is_dotted_name(word)) in.fail_at(word, "expected a node's name");
  node.name = word;
  word = header_word(in);
  bool known = false;
  for (const Role role : {Role::kMote, Role::kSink, Role::kBaseStation}) {
    if (word != role_text(role)) continue;
    node.role = role;
    known = true;
  }
  if (!known) in.fail_at(word, "expected mote, sink or base_station, given " + quoted(word));
  while (!(word = header_word(in)).empty()) {
    if (word == "iut" && !node.iut) {
      node.iut = true;
    } else if (word.starts_with("id=") && !node.id) {
      node.id = small_number(in, word.substr(3), "a TinyOS id");
    } else if (word.starts_with("island=") && !node.island) {
      node.island = small_number(in, word.substr(7), "an island");
    } else if (word == "iut" || word.starts_with("id=") || word.starts_with("island=") ||
               word.find('=') == std::string_view::npos) {
      in.fail_at(word,
                 "expected id=, island=, a parameter or iut, each once, given " + quoted(word));
    } else if (const std::string wrong = add_stated(word, node.stated); !wrong.empty()) {
      in.fail_at(word, wrong);
    }
  }
  return node;
}

LinkHeader parse_link(Scanner& in) {
  LinkHeader link;
  std::string_view word = header_word(in);
  if (!is_dotted_name(word)) in.fail_at(word, "expected a link's name");
  link.name = word;
  word = header_word(in);
  bool known = false;
  for (const LinkKind kind : {LinkKind::kRadio, LinkKind::kSerial, LinkKind::kPeis}) {
    if (word != link_text(kind)) continue;
    link.kind = kind;
    known = true;
  }
  if (!known) in.fail_at(word, "expected radio, serial or peis, given " + quoted(word));
  while (!(word = header_word(in)).empty()) {
    if (!is_dotted_name(word)) in.fail_at(word, "expected a node, given " + quoted(word));
    link.nodes.emplace_back(word);
  }
  return link;
}

TickHeader parse_tick(Scanner& in) {
  const std::string_view word = header_word(in);
  for (const Tick tick : {Tick::kBinaryMs, Tick::kMs, Tick::kUs}) {
    if (word == tick_text(tick)) return {tick};
  }
  in.fail_at(word, "expected binary_ms, ms or us, given " + quoted(word));
}

void parse_what(Scanner& in, Header& header) {
  const std::string_view keyword = in.word();
  if (keyword == "%rtr") {
    const std::string_view word = header_word(in);
    if (word != "1") in.fail_at(word, "expected version 1, given " + quoted(word));
    header.what = VersionHeader{1};
  } else if (keyword == "%profile") {
    const std::string_view word = header_word(in);
    if (word != "paper" && word != "deployed") {
      in.fail_at(word, "expected paper or deployed, given " + quoted(word));
    }
    header.what = ProfileHeader{std::string(word)};
  } else if (keyword == "%tick") {
    header.what = parse_tick(in);
  } else if (keyword == "%node") {
    header.what = parse_node(in);
  } else if (keyword == "%link") {
    header.what = parse_link(in);
  } else if (keyword == "%seed") {
    const std::string_view word = header_word(in);
    std::int64_t seed = 0;
    if (!read_integer(word, seed) || seed < 0) in.fail_at(word, "expected a seed, a number");
    header.what = SeedHeader{static_cast<std::uint64_t>(seed)};
  } else if (keyword == "%for") {
    ForHeader values;
    std::string_view word = header_word(in);
    do {
      if (const std::string wrong = add_range(word, values.values); !wrong.empty()) {
        in.fail_at(word, wrong);
      }
    } while (!(word = header_word(in)).empty());
    header.what = std::move(values);
  } else if (keyword == "%note") {
    const std::string_view text = in.rest();
    in.advance(text.size());
    if (trimmed(text).empty()) in.fail("expected the text of the note");
    header.what = NoteHeader{std::string(trimmed(text))};
  } else {
    in.fail_at(keyword,
               "expected %rtr, %profile, %tick, %node, %link, %seed, %for or %note, given " +
                   quoted(keyword));
  }
}

/// Parses one or more headers in a line.
void parse_headers(Scanner& in, std::vector<Item>& out) {
  do {
    Header header;
    header.place = in.place();
    parse_what(in, header);
    in.skip_blanks();
    if (in.peek() != '%') header.comment = parse_comment(in);
    out.emplace_back(std::move(header));
  } while (!in.at_end());
}

/// Returns the offset of the first byte that is no UTF-8 or a control character other than a tab.
std::size_t find_foreign(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0) == 0x80; };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned c = byte(i);
    if (c >= 0x20 && c < 0x7F) {
      ++i;
    } else if (c == '\t') {
      ++i;
    } else if (c >= 0xC2 && c <= 0xDF && follows(i + 1) && !(c == 0xC2 && byte(i + 1) < 0xA0)) {
      i += 2;
    } else if (c >= 0xE0 && c <= 0xEF && follows(i + 1) && follows(i + 2) &&
               !(c == 0xE0 && byte(i + 1) < 0xA0) && !(c == 0xED && byte(i + 1) > 0x9F)) {
      i += 3;
    } else if (c >= 0xF0 && c <= 0xF4 && follows(i + 1) && follows(i + 2) && follows(i + 3) &&
               !(c == 0xF0 && byte(i + 1) < 0x90) && !(c == 0xF4 && byte(i + 1) > 0x8F)) {
      i += 4;
    } else {
      return i;
    }
  }
  return std::string_view::npos;
}

class Parser {
 public:
  explicit Parser(Parsed& out) : out_(out) {}

  void run(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::size_t cases = 0;
    out_.file.head.reserve(items_until_case(text));
    for (std::string_view rest = text; !rest.empty();) cases += is_case(take_line(rest));
    out_.file.cases.reserve(cases);
    std::uint32_t number = 0;
    for (rest_ = text; !rest_.empty();) {
      std::string_view line = take_line(rest_);
      if (line.ends_with('\r')) line.remove_suffix(1);
      one(line, ++number);
    }
  }

 private:
  static std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
  }

  static bool is_case(std::string_view line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    return line.starts_with("case") &&
           (line.size() == 4 || line[4] == ' ' || line[4] == '\t' || line[4] == '\r');
  }

  // Returns how many lines that are not blank come before the next case: so much is needed, where
  // what a growing vector has to spare may be more than the text.
  static std::size_t items_until_case(std::string_view text) {
    std::size_t count = 0;
    while (!text.empty()) {
      const std::string_view line = take_line(text);
      if (is_case(line)) break;
      count += line.find_first_not_of(" \t\r") == std::string_view::npos ? 0 : 1;
    }
    return count;
  }

  void fail(Place place, std::string text) { add_diagnostic(out_, place, std::move(text)); }

  void one(std::string_view line, std::uint32_t number) {
    if (line.size() > Parsed::kLineBytesMax) {
      return fail({number, 1}, "a line of " + std::to_string(line.size()) + " bytes; at most " +
                                   std::to_string(Parsed::kLineBytesMax));
    }
    if (const std::size_t at = find_foreign(line); at != std::string_view::npos) {
      return fail({number, static_cast<std::uint32_t>(at + 1)},
                  "a byte that is not UTF-8 text, or a control character");
    }
    Scanner in(line, number);
    in.skip_blanks();
    try {
      content(in, line);
    } catch (const LineError& error) {
      fail(error.place, shortened(error.text));
    }
  }

  // Shortens quoted input, which may be as long as a line.
  static std::string shortened(const std::string& text) {
    constexpr std::size_t kMax = 240;
    if (text.size() <= kMax) return text;
    std::size_t end = kMax;
    while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    return text.substr(0, end) + "...";
  }

  void content(Scanner& in, std::string_view line) {
    std::vector<Item>& items =
        out_.file.cases.empty() ? out_.file.head : out_.file.cases.back().items;
    if (in.at_end()) {
      Blank* const before = items.empty() ? nullptr : items.back().as<Blank>();
      if (before != nullptr) {
        ++before->lines;
      } else {
        items.emplace_back(Blank{});
      }
    } else if (in.peek() == '#' || in.peek() == ';') {
      Comment comment;
      comment.marker = in.peek();
      comment.indented = line.data() != in.rest().data();
      std::string_view text = in.rest().substr(1);
      while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
      comment.text = text;
      items.emplace_back(std::move(comment));
    } else if (in.peek() == '%') {
      parse_headers(in, items);
    } else if (in.rest().starts_with("case ") || in.rest().starts_with("case\t") ||
               in.rest() == "case") {
      in.advance(4);
      out_.file.cases.push_back(parse_case(in));
      out_.file.cases.back().items.reserve(items_until_case(rest_));
    } else {
      Line parsed = parse_line(in);
      if (out_.file.cases.empty()) {
        return fail(parsed.place, "a line before the first case; 'case NAME' begins one");
      }
      items.emplace_back(std::move(parsed));
    }
  }

  Parsed& out_;
  std::string_view rest_;  // After the line that is read.
};

}  // namespace

std::string Parsed::errors() const {
  std::string text;
  for (const Diagnostic& one : diagnostics) {
    text += file_name + ':' + std::to_string(one.place.line) + ':' +
            std::to_string(one.place.column) + ": " + one.text + '\n';
  }
  if (dropped) text += file_name + ": and " + std::to_string(dropped) + " more\n";
  return text;
}

Parsed parse_syntax(std::string_view text, std::string_view file_name) {
  Parsed parsed;
  parsed.file_name = file_name;
  Parser(parsed).run(text);
  return parsed;
}

Parsed parse(std::string_view text, std::string_view file_name) {
  Parsed parsed = parse_syntax(text, file_name);
  check(parsed);
  std::stable_sort(parsed.diagnostics.begin(), parsed.diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) {
                     return a.place.line != b.place.line ? a.place.line < b.place.line
                                                         : a.place.column < b.place.column;
                   });
  return parsed;
}

std::string parse_message(std::string_view text, Message& out) {
  Scanner in(text, 1);
  try {
    in.skip_blanks();
    out = parse_message(in);
    in.skip_blanks();
    if (!in.at_end()) in.fail("expected the end, given '" + std::string(in.rest()) + "'");
  } catch (const LineError& error) {
    return std::to_string(error.place.column) + ": " + error.text;
  }
  return {};
}

}  // namespace rubric::trace
