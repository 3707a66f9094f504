// Printing and parsing are each other's inverse, for generated files and for the project's own.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <string>

#include "conformance/trace/check.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::trace {
namespace {

using rc::gen::inRange;

std::string pick(const std::vector<std::string>& from) { return *rc::gen::elementOf(from); }
bool coin() { return *rc::gen::arbitrary<bool>(); }

std::string name() {
  return pick(
      {"a", "b", "m5", "sA", "q", "_x", "Z9", "led", "bit13", "nanny", "x", "lost", "case"});
}
std::string raw_bytes() {
  return *rc::gen::container<std::string>(
      rc::gen::map(inRange(0, 256), [](int byte) { return static_cast<char>(byte); }));
}
/// Text of a comment: no blanks at its ends.
std::string words() {
  return pick({"", "why", "a ; b", "x | 00ff", "% # [J4]", "\xC3\xA9t\xC3\xA9 \"q", "(*)", "..."});
}

Value scalar() {
  Value value;
  switch (*inRange(0, 8)) {
    case 0: value = Value::of(*inRange<std::int64_t>(-5000000000, 5000000000)); break;
    case 1:
      value = Value::of(*inRange<std::int64_t>(0, 5000000000));
      value.hex = true;
      break;
    case 2: {
      const std::int64_t least = *inRange(-300, 300);
      value = Value::range(least, least + *inRange(0, 300));
      if (coin()) value.text = name();
      break;
    }
    case 3: value = Value::real(*rc::gen::arbitrary<float>()); break;
    case 4: value = Value::names(pick({"temp", "light|temp", "_a|b|bit7", "success"})); break;
    case 5: value = Value::bytes(raw_bytes()); break;
    case 6: value = Value::quoted(raw_bytes()); break;
    default: value = Value::variable(name());
  }
  value.negated = coin();
  return value;
}

Value half() {
  switch (*inRange(0, 4)) {
    case 0: return Value::any();
    case 1: return Value::variable(name());
    case 2: return Value::names(pick({"all", "null", "local"}));
    default: {
      Value value = Value::of(*inRange(0, 70000));
      value.hex = coin();
      return value;
    }
  }
}

Value any_value() {
  Value value;
  switch (*inRange(0, 8)) {
    case 0: return Value::any();
    case 1: value = Value::address(half(), half()); break;
    case 2: value = Value::channel(half(), half()); break;
    case 3: {
      std::vector<Value> items;
      const int count = *inRange(0, 4);
      for (int i = 0; i < count; ++i) items.push_back(coin() ? half() : scalar());
      value = Value::list(items);
      break;
    }
    default: return scalar();
  }
  value.negated = coin();
  return value;
}

Message any_message() {
  Message message;
  message.name = pick({"*", "join", "net_msg", "join_reply", "am", "busy", "nothing"});
  message.form =
      *rc::gen::element(Message::Form::kBare, Message::Form::kAny, Message::Form::kFields);
  if (message.form != Message::Form::kFields) return message;
  message.open = coin();
  const int count = *inRange(0, 5);
  for (int i = 0; i < count; ++i) {
    message.fields.push_back(
        {pick({"", "seq_num", "dest.pid", "payload.body.updates[0].value", "x", "a[17].b_c"}),
         any_value(),
         {}});
  }
  // A lone * is the form kAny.
  if (message.fields.size() == 1 && message.fields[0].path.empty() &&
      message.fields[0].value.is(Value::Kind::kAny)) {
    message.open = true;
  }
  return message;
}

std::vector<Term> any_terms() {
  std::vector<Term> terms;
  const int count = *inRange(0, 4);
  for (int i = 0; i < count; ++i) {
    const Parameter& one = parameters()[*inRange<std::size_t>(0, parameters().size())];
    terms.push_back({*inRange(-1000, 1000), one.id});
  }
  return terms;
}

// A number below 0 can only follow.
std::int64_t number_beside(const std::vector<Term>& terms) {
  return *inRange(terms.empty() || terms.front().factor < 0 ? 0 : -1000, 1000);
}

Time any_time() {
  Time time;
  time.base = *rc::gen::element(Time::Base::kPrevious, Time::Base::kLabel, Time::Base::kStart);
  time.from = *inRange<std::int64_t>(0, 1000000000000);
  time.to = coin() ? time.from : time.from + *inRange(0, 1000);
  time.from_terms = any_terms();
  time.to_terms = coin() ? time.from_terms : any_terms();
  const bool alike = time.from_terms == time.to_terms;
  if (!time.from_terms.empty()) time.from = number_beside(time.from_terms);
  if (!time.from_terms.empty() || !time.to_terms.empty()) {
    time.to = alike ? time.from + *inRange(0, 1000) : number_beside(time.to_terms);
  }
  if (time.base == Time::Base::kLabel) time.label = name();
  return time;
}

Value am_side() {
  switch (*inRange(0, 5)) {
    case 0: return Value::any();
    case 1: return Value::variable(name());
    case 2: return Value::names("all");
    case 3: return Value::but(Value::of(*inRange(0, 70000)));
    default: return Value::of(*inRange(0, 70000));
  }
}

Line any_line() {
  Line line;
  if (coin()) line.label = name();
  line.time = any_time();
  line.op = *rc::gen::element(Op::kGiven, Op::kEmits, Op::kMustNot, Op::kMay, Op::kLost, Op::kDup);
  if (!is_fault(line.op)) line.node = pick({"m5", "*", "5", "a.b-c", "power"});
  line.link = pick({"rA", "serA", "peis", "app", "*", "power"});
  if (coin()) line.am = AmAddresses{am_side(), am_side()};
  line.message = any_message();
  const int count = *inRange(0, 3);
  for (int i = 0; i < count; ++i) line.requirements.push_back(pick({"J4", "J4-SEQ", "WIRE-HEX"}));
  if (coin()) line.bytes = raw_bytes() + 'x';
  line.comment = words();
  return line;
}

Statement any_statement() {
  Statement out;
  for (const Parameter& one : parameters()) {
    if (coin()) out.push_back({one.id, *inRange(one.min, one.max + 1)});
  }
  return out;
}

Header any_header() {
  Header header;
  switch (*inRange(0, 8)) {
    case 0: header.what = VersionHeader{}; break;
    case 1: header.what = ProfileHeader{pick({"paper", "deployed"})}; break;
    case 2:
      header.what = TickHeader{*rc::gen::element(Tick::kBinaryMs, Tick::kMs, Tick::kUs)};
      break;
    case 3: {
      NodeHeader node{
          name(), *rc::gen::element(Role::kMote, Role::kSink, Role::kBaseStation), {}, {}, coin()};
      if (coin()) node.id = *rc::gen::arbitrary<std::uint16_t>();
      if (coin()) node.island = *rc::gen::arbitrary<std::uint16_t>();
      node.stated = any_statement();
      header.what = node;
      break;
    }
    case 4: {
      LinkHeader link{
          name(), *rc::gen::element(LinkKind::kRadio, LinkKind::kSerial, LinkKind::kPeis), {}};
      const int count = *inRange(0, 3);
      for (int i = 0; i < count; ++i) link.nodes.push_back(name());
      header.what = link;
      break;
    }
    case 5: header.what = SeedHeader{*inRange<std::uint64_t>(0, 1000000000000)}; break;
    case 6: {
      ForHeader wanted;
      for (const Stated& stated : any_statement()) {
        const std::int64_t most = coin() ? parameter(stated.id).max : stated.value;
        wanted.values.push_back({stated.id, stated.value, most});
      }
      if (wanted.values.empty()) wanted.values.push_back({ParameterId::kMembers, 20, 20});
      header.what = wanted;
      break;
    }
    default: header.what = NoteHeader{"note " + words()};
  }
  if (std::holds_alternative<NoteHeader>(header.what)) {
    auto& text = std::get<NoteHeader>(header.what).text;
    while (text.ends_with(' ')) text.pop_back();
  } else {
    header.comment = words();
  }
  return header;
}

Item any_item(bool in_case) {
  switch (*inRange(0, in_case ? 8 : 4)) {
    case 0: return Blank{static_cast<std::size_t>(*inRange(1, 4))};
    case 1: {
      Comment comment{coin() ? '#' : ';', coin(), ""};
      comment.text = pick({"", " ", "  "}) + words();
      while (comment.text.ends_with(' ')) comment.text.pop_back();
      return comment;
    }
    case 2:
    case 3: return any_header();
    default: return any_line();
  }
}

File any_file() {
  File file;
  const int head = *inRange(0, 6);
  // Blank lines in a row are one item.
  const auto add = [](std::vector<Item>& items, Item item) {
    const bool blanks = !items.empty() && items.back().as<Blank>() && item.as<Blank>();
    if (!blanks) items.push_back(std::move(item));
  };
  for (int i = 0; i < head; ++i) add(file.head, any_item(false));
  const int cases = *inRange(0, 4);
  for (int i = 0; i < cases; ++i) {
    Case one(pick({"a", "join.ok", "9-lives", "x_y.z"}));
    one.comment = words();
    const int items = *inRange(0, 8);
    for (int k = 0; k < items; ++k) add(one.items, any_item(true));
    file.cases.push_back(one);
  }
  return file;
}

TEST(RoundTrip, AnyFile) {
  std::size_t lines = 0;
  EXPECT_TRUE(rc::check("parse(print(f)) == f", [&lines] {
    const File file = any_file();
    for (const Case& one : file.cases) lines += one.lines().size();
    const std::string text = print(file);
    const Parsed parsed = parse_syntax(text, "f");
    RC_LOG() << text << parsed.errors();
    RC_ASSERT(parsed.ok());
    RC_ASSERT(parsed.file == file);
    RC_ASSERT(print(parsed.file) == text);
    // Whatever it contains, checking it ends.
    parse(text, "f");
  }));
  EXPECT_GT(lines, 1000u);  // The generator makes files worth printing.
}

TEST(RoundTrip, AnyText) {
  EXPECT_TRUE(rc::check("what parses from any text prints and comes back", [] {
    std::string text = print(any_file());
    const int changes = *inRange(0, 4);
    for (int i = 0; i < changes && !text.empty(); ++i) {
      const auto at = *inRange<std::size_t>(0, text.size());
      const std::string with = pick({" ", "", "(", ")", "...", "*", "\"", "0", ".", "=", "!", ";"});
      text.replace(at, coin() ? 1 : 0, with);
    }
    const Parsed parsed = parse_syntax(text, "f");
    const std::string printed = print(parsed.file);
    RC_LOG() << text << "---\n" << printed;
    const Parsed again = parse_syntax(printed, "f");
    RC_ASSERT(again.errors() == "");
    RC_ASSERT(again.file == parsed.file);
    RC_ASSERT(print(again.file) == printed);
  }));
}

}  // namespace
}  // namespace rubric::trace
