#include "conformance/trace/parse.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "codec/text/text.h"
#include "conformance/trace/check.h"
#include "conformance/trace/each_line.h"
#include "conformance/trace/parse_line.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

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
  const std::optional<Role> role = find_role(word);
  if (!role) in.fail_at(word, "expected " + alternatives(role_names()) + ", given " + quoted(word));
  node.role = *role;
  while (!(word = header_word(in)).empty()) {
    if (word == "iut" && !node.iut) {
      node.iut = true;
    } else if (word == "whole" && !node.whole) {
      node.whole = true;
    } else if (word.starts_with("id=") && !node.id) {
      node.id = small_number(in, word.substr(3), "a TinyOS id");
    } else if (word.starts_with("island=") && !node.island) {
      node.island = small_number(in, word.substr(7), "an island");
    } else if (word.starts_with("id=") || word.starts_with("island=") ||
               word.find('=') == std::string_view::npos) {
      in.fail_at(word, "expected id=, island=, a parameter, iut or whole, each once, given " +
                           quoted(word));
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
    const std::vector<std::string>& known = protocol().profiles;
    if (known.empty()) in.fail_at(keyword, protocol().name + " has no profiles");
    if (!is_among(known, word)) {
      in.fail_at(word, "expected " + alternatives(known) + ", given " + quoted(word));
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
void add_headers(Scanner& in, std::vector<Item>& out) {
  do {
    Header header{.place = in.place()};
    parse_what(in, header);
    in.skip_blanks();
    if (in.peek() != '%') header.comment = parse_comment(in);
    out.emplace_back(std::move(header));
  } while (!in.at_end());
}

/// Returns the offset of the first byte that is no UTF-8 or a control character other than a tab.
std::size_t find_foreign(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const bool printed = (c >= ' ' && c < 0x7F) || c == '\t';
    const std::size_t length = printed ? 1 : text::utf8_length(text.substr(i));
    const bool control =
        length == 2 && c == '\xC2' && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (length == 0 || control || (length == 1 && !printed)) return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

class Parser {
 public:
  /// Lines are told to `listener`, if there is one; else they are kept.
  explicit Parser(Parsed& out, Listener* listener = nullptr) : out_(out), listener_(listener) {}

  /// `number`: of the line before, in the file.
  void run(std::string_view text, std::uint32_t number = 0) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::size_t cases = 0;
    if (!listener_) out_.file.head.reserve(items_until_case(text));
    for (std::string_view rest = text; !rest.empty();) cases += is_case(take_line(rest));
    out_.file.cases.reserve(cases);
    for (rest_ = text; !rest_.empty();) {
      std::string_view line = take_line(rest_);
      if (line.ends_with('\r')) line.remove_suffix(1);
      one(line, ++number);
    }
  }

 private:
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
    if (listener_ && (in.at_end() || in.peek() == '#' || in.peek() == ';')) return;
    if (in.at_end()) {
      Blank* const before = items.empty() ? nullptr : items.back().as<Blank>();
      if (before != nullptr) {
        ++before->lines;
      } else {
        items.emplace_back(Blank{});
      }
    } else if (in.peek() == '#' || in.peek() == ';') {
      Comment comment{.marker = in.peek(), .indented = line.data() != in.rest().data()};
      std::string_view text = in.rest().substr(1);
      while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
      comment.text = text;
      items.emplace_back(std::move(comment));
    } else if (in.peek() == '%') {
      const std::size_t before = items.size();
      add_headers(in, items);
      if (listener_ && !out_.file.cases.empty()) tell_headers(items, before);
    } else if (in.rest().starts_with("case ") || in.rest().starts_with("case\t") ||
               in.rest() == "case") {
      in.advance(4);
      out_.file.cases.push_back(parse_case(in));
      if (listener_) return listener_->begin(out_.file.cases.back());
      out_.file.cases.back().items.reserve(items_until_case(rest_));
    } else {
      Line parsed = parse_line(in);
      if (out_.file.cases.empty()) {
        return fail(parsed.place, "a line before the first case; 'case NAME' begins one");
      }
      if (listener_) return listener_->line(parsed);
      items.emplace_back(std::move(parsed));
    }
  }

  // Tells of the headers that were added to a case, and keeps no notes.
  void tell_headers(std::vector<Item>& items, std::size_t begin) {
    for (std::size_t i = begin; i < items.size(); ++i) listener_->header(*items[i].as<Header>());
    const auto is_note = [](const Item& item) {
      return std::holds_alternative<NoteHeader>(item.as<Header>()->what);
    };
    const auto added = items.begin() + static_cast<std::ptrdiff_t>(begin);
    items.erase(std::remove_if(added, items.end(), is_note), items.end());
  }

  Parsed& out_;
  Listener* listener_;
  std::string_view rest_;  // After the line that is read.
};

/// Has each line checked before it is taken.
class CheckedLines : public Listener {
 public:
  CheckedLines(const Parsed& parsed, Listener& checker, const TakeLine& take)
      : parsed_(parsed), checker_(checker), take_(take) {}
  void begin(const Case& one) override { checker_.begin(one); }
  void header(const Header& one) override { checker_.header(one); }
  void line(const Line& one) override {
    checker_.line(one);
    if (parsed_.ok()) take_(parsed_.file, one);
  }

 private:
  const Parsed& parsed_;
  Listener& checker_;
  const TakeLine& take_;
};

/// Passes lines on.
class LinesAlone : public Listener {
 public:
  explicit LinesAlone(const std::function<void(const Line&)>& take) : take_(take) {}
  void begin(const Case&) override {}
  void header(const Header&) override {}
  void line(const Line& one) override { take_(one); }

 private:
  const std::function<void(const Line&)>& take_;
};

void sort_diagnostics(Parsed& parsed) {
  std::stable_sort(parsed.diagnostics.begin(), parsed.diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) {
                     return a.place.line != b.place.line ? a.place.line < b.place.line
                                                         : a.place.column < b.place.column;
                   });
}

}  // namespace

std::string Parsed::errors() const {
  std::string text;
  const std::string name = text::harmless(file_name);
  for (const Diagnostic& one : diagnostics) {
    text += name + ':' + std::to_string(one.place.line) + ':' + std::to_string(one.place.column) +
            ": " + one.text + '\n';
  }
  if (dropped) text += name + ": and " + std::to_string(dropped) + " more\n";
  return text;
}

Parsed parse_syntax(std::string_view text, std::string_view file_name) {
  Parsed parsed{.file_name = std::string(file_name)};
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Parser(parsed).run(text);
  return parsed;
}

Parsed parse(std::string_view text, std::string_view file_name) {
  Parsed parsed = parse_syntax(text, file_name);
  check(parsed);
  sort_diagnostics(parsed);
  return parsed;
}

Parsed each_line(std::string_view text, std::string_view file_name, const TakeLine& take) {
  Parsed parsed{.file_name = std::string(file_name)};
  check_as_read(parsed, [&](Listener& checker) {
    CheckedLines lines(parsed, checker, take);
    Parser(parsed, &lines).run(text);
  });
  sort_diagnostics(parsed);
  return parsed;
}

Case case_of(std::string_view text, std::uint32_t number) {
  Parsed parsed;
  Parser(parsed).run(text, number - 1);
  return std::move(parsed.file.cases.front());
}

void lines_of(std::string_view text, const std::function<void(const Line&)>& take) {
  Parsed parsed;
  LinesAlone lines(take);
  Parser(parsed, &lines).run(text);
}

Case parse_lines(std::string_view text) {
  Case out;
  try {
    while (!text.empty()) {
      Scanner in(take_line(text), static_cast<std::uint32_t>(out.items.size() + 1));
      out.add(parse_line(in));
    }
  } catch (const LineError& error) {
    throw std::logic_error(error.text);
  }
  return out;
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
