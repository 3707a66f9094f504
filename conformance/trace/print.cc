#include "conformance/trace/print.h"

#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

constexpr std::size_t kLabelColumns = 3;
constexpr std::size_t kTimeColumns = 10;
constexpr std::size_t kNodeColumns = 3;
constexpr std::size_t kOpColumns = 2;
constexpr std::size_t kLinkColumns = 4;

// Prints a word and at least one blank after it, in columns.
void put_padded(std::string_view word, std::size_t columns, std::string& out) {
  out += word;
  out.append(word.size() < columns ? columns - word.size() + 1 : 1, ' ');
}

void put_comment(const std::string& comment, std::string& out) {
  if (!comment.empty()) out += "  ; " + comment;
}

void put_amount(std::int64_t ticks, const std::vector<Term>& terms, std::string& out) {
  const bool number_first = terms.empty() || terms.front().factor < 0;
  if (number_first) out += std::to_string(ticks);
  for (const Term& term : terms) {
    if (term.factor < 0) {
      out += '-';
    } else if (number_first || &term != &terms.front()) {
      out += '+';
    }
    const std::int64_t times = term.factor < 0 ? -term.factor : term.factor;
    if (times != 1) out += std::to_string(times) + '*';
    out += parameter(term.parameter).name;
  }
  if (number_first || ticks == 0) return;
  if (ticks > 0) out += '+';
  out += std::to_string(ticks);
}

void put_time(const Time& time, std::string& out) {
  if (time.base == Time::Base::kStart) out += '@';
  if (time.base == Time::Base::kLabel) out += time.label + '+';
  put_amount(time.from, time.from_terms, out);
  if (time.exact()) return;
  out += "..";
  put_amount(time.to, time.to_terms, out);
}

struct HeaderText {
  std::string& out;

  void operator()(const VersionHeader& h) const { out += "%rtr " + std::to_string(h.version); }
  void operator()(const ProfileHeader& h) const { out += "%profile " + h.name; }
  void operator()(const TickHeader& h) const { out += "%tick " + std::string(tick_text(h.tick)); }
  void operator()(const SeedHeader& h) const { out += "%seed " + std::to_string(h.seed); }
  void operator()(const ForHeader& h) const {
    out += "%for";
    for (const StatedRange& range : h.values) out += ' ' + range_text(range);
  }
  void operator()(const NoteHeader& h) const { out += "%note " + h.text; }
  void operator()(const NodeHeader& h) const {
    out += "%node " + h.name + ' ' + std::string(role_text(h.role));
    if (h.id) out += " id=" + std::to_string(*h.id);
    if (h.island) out += " island=" + std::to_string(*h.island);
    if (!h.stated.empty()) out += ' ' + statement_text(h.stated);
    if (h.iut) out += " iut";
    if (h.whole) out += " whole";
  }
  void operator()(const LinkHeader& h) const {
    out += "%link " + h.name + ' ' + std::string(link_text(h.kind));
    for (const std::string& node : h.nodes) out += ' ' + node;
  }
};

void put_item(const Item& item, std::string& out) {
  if (const auto* line = item.as<Line>()) {
    put_line(*line, out);
  } else if (const auto* header = item.as<Header>()) {
    put_header(*header, out);
  } else if (const auto* comment = item.as<Comment>()) {
    if (comment->indented) out += "  ";
    out += comment->marker + comment->text;
  }
  const auto* const blank = item.as<Blank>();
  out.append(blank == nullptr ? 1 : blank->lines, '\n');
}

}  // namespace

void put_header(const Header& header, std::string& out) {
  std::visit(HeaderText{out}, header.what);
  put_comment(header.comment, out);
}

void put_message(const Message& message, std::string& out) {
  out += message.name;
  if (message.form == Message::Form::kBare) return;
  if (message.form == Message::Form::kAny) {
    out += "(*)";
    return;
  }
  out += '(';
  const char* between = "";
  for (const FieldValue& field : message.fields) {
    out += between;
    between = " ";
    if (!field.path.empty()) out += field.path + '=';
    put_value(field.value, out);
  }
  if (message.open) {
    out += between;
    out += "...";
  }
  out += ')';
}

void put_line(const Line& line, std::string& out) {
  out += "  ";
  put_padded(line.label.empty() ? "" : line.label + ':', kLabelColumns, out);
  std::string time;
  put_time(line.time, time);
  put_padded(time, kTimeColumns, out);
  if (is_fault(line.op)) {
    put_padded(line.link, kNodeColumns, out);
    put_padded(op_text(line.op), kOpColumns, out);
  } else {
    put_padded(line.node, kNodeColumns, out);
    put_padded(op_text(line.op), kOpColumns, out);
    put_padded(line.link, kLinkColumns, out);
  }
  if (line.am) {
    out += "am=";
    put_value(line.am->source, out);
    out += "->";
    put_value(line.am->dest, out);
    out += ' ';
  }
  put_message(line.message, out);
  if (!line.requirements.empty()) {
    out += "  [";
    for (std::size_t i = 0; i < line.requirements.size(); ++i) {
      if (i) out += ' ';
      out += line.requirements[i];
    }
    out += ']';
  }
  if (line.bytes) {
    out += "  | ";
    put_hex(*line.bytes, out);
  }
  put_comment(line.comment, out);
}

std::string print(const File& file) {
  std::string out;
  for (const Item& item : file.head) put_item(item, out);
  for (const Case& one : file.cases) {
    out += "case " + one.name;
    put_comment(one.comment, out);
    out += '\n';
    for (const Item& item : one.items) put_item(item, out);
  }
  return out;
}

std::string print(const Line& line) {
  std::string out;
  put_line(line, out);
  return out;
}

std::string print(const Message& message) {
  std::string out;
  put_message(message, out);
  return out;
}

std::string print(const Time& time) {
  std::string out;
  put_time(time, out);
  return out;
}

}  // namespace rubric::trace
