// Prints expressions, loads, stores and comments as C++14 text.

#include "spec/compiler/emit/cpp/emit_cpp_text.h"

#include <algorithm>
#include <vector>

namespace rubricc::cpp {
namespace {

std::string bits(const Field& field) { return std::to_string(8 * field.width_bytes); }

std::string order(const Field& field) {
  return field.width_bytes == 1 ? "u" : field.little_endian ? "le" : "be";
}

std::string enum_class(const Field& field, const Spec& spec) {
  const Enum& e = *field.enumeration;
  return (e.spec != nullptr && e.spec != &spec ? e.spec->id + "::" : "") + pascal(e.id);
}

bool fits_32_bits(const Expr& expr) {
  const auto good = [](std::int64_t v) { return v >= INT32_MIN && v <= INT32_MAX; };
  return good(expr.range.min) && good(expr.range.max) &&
         std::all_of(expr.operands.begin(), expr.operands.end(),
                     [](const ExprPtr& e) { return fits_32_bits(*e); });
}

// Within arithmetic every number is signed and wide enough, whatever int is on the target.
std::string print_term(const Expr& expr, const Leaf& leaf, const char* wide) {
  switch (expr.op) {
    case ExprOp::kInt:
    case ExprOp::kEnumValue: return literal(expr.value);
    case ExprOp::kField:
      return wide ? "static_cast<" + std::string(wide) + ">(" + leaf(expr) + ")" : leaf(expr);
    case ExprOp::kNot: return "!(" + print_term(*expr.operands[0], leaf, wide) + ")";
    default: break;
  }
  if (!wide) {
    const bool arithmetic =
        is_arithmetic(expr.op) ||
        std::any_of(expr.operands.begin(), expr.operands.end(),
                    [](const ExprPtr& side) { return is_arithmetic(side->op); });
    if (arithmetic) wide = fits_32_bits(expr) ? "int32_t" : "int64_t";
  }
  std::string out;
  for (const ExprPtr& side : expr.operands) {
    if (!out.empty()) out += " " + std::string(infix(expr.op)) + " ";
    const std::string text = print_term(*side, leaf, wide);
    const bool atom = side->operands.empty() || side->op == ExprOp::kNot;
    const bool comparison = side->op >= ExprOp::kEq && side->op <= ExprOp::kGe;
    const bool logic = expr.op == ExprOp::kAnd || expr.op == ExprOp::kOr;
    out += atom || (logic && comparison) ? text : "(" + text + ")";
  }
  return out;
}

constexpr std::size_t kColumns = 100;

std::size_t indent_of(const std::string& line) {
  const std::size_t at = line.find_first_not_of(' ');
  return at == line.npos ? line.size() : at;
}

std::string mark_of(const std::string& line) {
  const std::string text = line.substr(indent_of(line));
  if (text.starts_with("/// ")) return "///";
  return text.starts_with("// ") ? "//" : "";
}

// Returns the last place within the columns where a line may end: the best kind of place first.
std::size_t break_of(const std::string& line, std::size_t indent) {
  for (const std::string_view text : {" && ", " || ", " ? ", ", ", " + ", "(", " = "}) {
    for (std::size_t at = line.rfind(text, kColumns - text.size());
         at != line.npos && at >= indent + 8; at = line.rfind(text, at - 1)) {
      if (text == "(" && (line[at + 1] == ')' || line.find("if (") + 3 == at)) continue;
      const bool keep_left = text != " ? " && text != " + ";
      return keep_left ? at + text.size() : at + 1;
    }
  }
  return line.npos;
}

void fold_code(const std::string& line, std::vector<std::string>& out) {
  if (line.size() <= kColumns) return out.push_back(line);
  const std::size_t indent = indent_of(line);
  const std::string pad(indent, ' ');
  const std::size_t open = line.find(") const { ");
  const std::size_t plain = line.find(") { ");
  const std::size_t body = open != line.npos ? open + 9 : plain != line.npos ? plain + 3 : open;
  if (body != line.npos && line.ends_with(" }")) {  // A function in one line becomes three.
    fold_code(line.substr(0, body), out);
    fold_code(pad + "  " + line.substr(body + 1, line.size() - body - 3), out);
    return out.push_back(pad + "}");
  }
  const std::size_t at = break_of(line, indent);
  if (at == line.npos) return out.push_back(line);
  std::string head = line.substr(0, at);
  while (head.ends_with(' ')) head.pop_back();
  out.push_back(head);
  fold_code(pad + "    " + line.substr(at), out);
}

}  // namespace

std::string class_of(const Type& type, const Spec& spec) {
  return (type.spec != &spec ? type.spec->id + "::" : "") + pascal(type.id);
}

std::string header_of(const Type& type) {
  return "codec/generated/" + type.spec->id + "/" + type.id + ".h";
}

std::string enums_header_of(const Spec& spec) { return "codec/generated/" + spec.id + "/enums.h"; }

std::string raw_type(const Field& field) { return "uint" + bits(field) + "_t"; }

std::string number_type(const Field& field, const Spec& spec) {
  if (field.kind == ValueKind::kMask) return class_of(*field.type, spec);
  if (field.enumeration) return enum_class(field, spec);
  if (field.kind == ValueKind::kFloat) return "float";
  return (field.kind == ValueKind::kSint ? "int" : "uint") + bits(field) + "_t";
}

std::string wire_number(const Field& field, const Spec& spec) {
  const bool is_signed = field.kind == ValueKind::kSint && !field.enumeration;
  std::string number = (is_signed ? "S" : "U") + bits(field);
  if (field.width_bytes > 1) number += field.little_endian ? "Le" : "Be";
  if (field.kind == ValueKind::kFloat) return field.little_endian ? "F32Le" : "F32Be";
  if (field.kind == ValueKind::kMask || field.enumeration) {
    return "As<" + number_type(field, spec) + ", " + number + ">";
  }
  return number;
}

std::string load_integer(const Field& field, const std::string& at) {
  const std::string raw = "load_" + order(field) + bits(field) + "(" + at + ")";
  return field.kind == ValueKind::kSint ? "static_cast<int" + bits(field) + "_t>(" + raw + ")"
                                        : raw;
}

std::string load(const Field& field, const Spec& spec, const std::string& at) {
  const std::string raw = load_integer(field, at);
  if (field.kind == ValueKind::kMask) return number_type(field, spec) + "(" + raw + ")";
  if (field.enumeration) return "static_cast<" + number_type(field, spec) + ">(" + raw + ")";
  if (field.kind == ValueKind::kFloat) return "float_of_bits(" + raw + ")";
  return raw;
}

std::string store(const Field& field, const std::string& at, const std::string& value) {
  std::string raw = value;
  if (field.kind == ValueKind::kMask) {
    raw = value + ".raw()";
  } else if (field.kind == ValueKind::kFloat) {
    raw = "bits_of_float(" + value + ")";
  } else if (field.enumeration || field.kind == ValueKind::kSint) {
    raw = "static_cast<" + raw_type(field) + ">(" + value + ")";
  }
  return "store_" + order(field) + bits(field) + "(" + at + ", " + raw + ");";
}

std::string plus(const std::string& pointer, const std::string& offset) {
  return offset == "0" ? pointer : pointer + " + " + offset;
}

std::string literal(std::int64_t value) {
  return std::to_string(value) + (value > INT32_MAX ? "U" : "");
}

std::string print(const Expr& expr, const Leaf& leaf) { return print_term(expr, leaf, nullptr); }

Leaf loads_from(const Source& source) {
  return [source](const Expr& expr) {
    const Field& f = *expr.field;
    const std::string load =
        load_integer(f, plus(source.pointer, std::to_string(expr.offset_bytes)));
    const std::int64_t end = expr.offset_bytes + f.width_bytes;
    if (end <= source.safe) return load;
    return "(" + source.size + " < " + std::to_string(end) + " ? 0 : " + load + ")";
  };
}

std::string print_size(const Expr& expr, const Leaf& leaf, std::uint32_t unit) {
  if (expr.op == ExprOp::kInt) return std::to_string(expr.value * unit);
  const std::string text = "static_cast<size_t>(" + print(expr, leaf) + ")";
  return unit == 1 ? text : text + " * " + std::to_string(unit);
}

const Field* plain_field(const Expr* expr) {
  const bool plain = expr != nullptr && expr->op == ExprOp::kField && expr->steps.size() <= 1 &&
                     expr->path.size() <= 1;
  return plain ? expr->field : nullptr;
}

std::string angles(const std::string& text) { return "<" + text + ">"; }

std::string guard(const std::string& condition, const std::string& statement, bool unlikely) {
  const std::string head =
      unlikely ? "if (RUBRIC_UNLIKELY(" + condition + "))" : "if (" + condition + ")";
  const std::string line = head + " " + statement;
  if (line.size() <= 94 && line.find('\n') == std::string::npos) return line + "\n";
  return head + " {\n  " + statement + "\n}\n";
}

std::string join(const std::vector<std::string>& parts, std::string_view op) {
  std::string out;
  std::size_t line = 0;
  for (const std::string& part : parts) {
    if (!out.empty()) {
      const bool full = line + part.size() + op.size() > 60;
      out.append(op == "," ? "" : " ").append(op).append(full ? "\n    " : " ");
      line = full ? 0 : line + op.size() + 2;
    }
    out += part;
    line += part.size();
  }
  return out;
}

std::string comment(std::string_view prose, std::string_view mark, std::size_t indent) {
  std::string out;
  std::string line(mark);
  for (std::size_t at = 0; at < prose.size();) {
    std::size_t end = prose.find_first_of(" \n", at);
    if (end == prose.npos) end = prose.size();
    const std::string_view word = prose.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (line.size() + 1 + word.size() > 100 - indent) {
      out += line + "\n";
      line = mark;
    }
    line.append(" ").append(word);
  }
  return out + line + "\n";
}

std::string fold(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  std::vector<std::string> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string mark = mark_of(lines[i]);
    if (mark.empty() || lines[i].size() <= kColumns) {
      fold_code(lines[i], out);
      continue;
    }
    // Fills the whole rest of the paragraph again.
    const std::size_t indent = indent_of(lines[i]);
    std::string prose;
    for (; i < lines.size() && mark_of(lines[i]) == mark; ++i) {
      prose += lines[i].substr(indent + mark.size()) + " ";
    }
    --i;
    std::string filled = comment(prose, mark, indent);
    for (std::size_t at = 0; at < filled.size();) {
      const std::size_t end = filled.find('\n', at);
      out.push_back(std::string(indent, ' ') + filled.substr(at, end - at));
      at = end + 1;
    }
  }
  std::string folded;
  for (const std::string& line : out) folded += line + "\n";
  return folded;
}

}  // namespace rubricc::cpp
