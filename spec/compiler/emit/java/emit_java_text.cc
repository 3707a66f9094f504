#include "spec/compiler/emit/java/emit_java_text.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::java {
namespace {

// Words of Java that are none of C++, which the checks refuse; and members of every view and
// writer.
constexpr std::array<std::string_view, 44> kTaken{
    "abstract",  "assert",       "boolean", "byte",       "bytes",     "check",    "clone",
    "equals",    "extends",      "fields",  "final",      "finalize",  "finally",  "getClass",
    "hashCode",  "implements",   "import",  "instanceof", "interface", "native",   "notify",
    "notifyAll", "null",         "orNull",  "package",    "parse",     "part",     "peek",
    "range",     "rest",         "rules",   "sizeBytes",  "stale",     "store",    "strictfp",
    "super",     "synchronized", "throws",  "toBytes",    "toString",  "toWriter", "transient",
    "wait",      "writeTo",
};
constexpr std::array<std::string_view, 19> kClasses{
    "ArrayList",  "BiConsumer", "ByteBuffer",    "CheckedBytes", "List",
    "Map",        "Messages",   "Object",        "Override",     "String",
    "Wire",       "WireCheck",  "WireException", "WireOutput",   "WireParser",
    "WireReader", "WireView",   "WireWriter",    "Writer",
};

template <std::size_t kCount>
bool is_among(const std::array<std::string_view, kCount>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string print_term(const Expr& expr, const Leaf& leaf, bool wide) {
  if (expr.op == ExprOp::kInt || expr.op == ExprOp::kEnumValue) {
    return literal(expr.value) + (wide && expr.value <= INT32_MAX ? "L" : "");
  }
  if (expr.op == ExprOp::kField) return leaf(expr);
  if (expr.op == ExprOp::kNot) return "!(" + print_term(*expr.operands[0], leaf, wide) + ")";
  const Expr& left = *expr.operands[0];
  const Expr& right = *expr.operands[1];
  const bool is_wide = wide || is_arithmetic(expr.op);
  // If one side of an operation is long, the other becomes it.
  const auto side = [&](const Expr& e) {
    const std::string text = print_term(e, leaf, is_wide);
    return e.operands.empty() || e.op == ExprOp::kNot ? text : "(" + text + ")";
  };
  const std::string cast = is_arithmetic(expr.op) && left.op == ExprOp::kField ? "(long) " : "";
  if (expr.op == ExprOp::kDiv || expr.op == ExprOp::kMod) {  // They round down.
    return std::string(expr.op == ExprOp::kDiv ? "Math.floorDiv(" : "Math.floorMod(") + cast +
           print_term(left, leaf, true) + ", " + side(right) + ")";
  }
  return cast + side(left) + " " + std::string(infix(expr.op)) + " " + side(right);
}

}  // namespace

std::string class_name(std::string_view id) {
  const std::string name = pascal(id);
  return is_among(kClasses, name) ? name + "_" : name;
}

std::string member(std::string_view id) {
  std::string name = pascal(id);
  name[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(name[0])));
  return is_among(kTaken, name) ? name + "_" : name;
}

std::string member_with(std::string_view prefix, std::string_view id) {
  return std::string(prefix) + pascal(id);
}

std::string constant(std::string_view id) {
  std::string out(id);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

std::string package_of(const Spec& spec) { return "rubric.wire." + member(spec.id); }

std::string class_of(const Type& type, const Spec& spec) {
  return (type.spec != &spec ? package_of(*type.spec) + "." : "") + class_name(type.id);
}

std::string class_of(const Enum& e, const Spec& spec) {
  return (e.spec != &spec ? package_of(*e.spec) + "." : "") + class_name(e.id);
}

std::string quote(std::string_view text) { return "\"" + std::string(text) + "\""; }

std::string literal(std::int64_t value) {
  const bool fits = value >= INT32_MIN && value <= INT32_MAX;
  return std::to_string(value) + (fits ? "" : "L");
}

std::string key_literal(std::int64_t value) {
  const std::string text = literal(value);
  return text.ends_with('L') ? "(int) " + text : text;
}

std::string javadoc(std::string_view prose, std::size_t indent) {
  std::string text;
  for (std::size_t i = 0; i < prose.size(); ++i) {
    // Neither the end of the comment nor an escape of the language.
    const bool ends = prose[i] == '/' && i > 0 && prose[i - 1] == '*';
    text += ends ? "&#47;" : prose[i] == '\\' ? "&#92;" : std::string(1, prose[i]);
  }
  std::string out = "/**";
  std::string line;
  bool several = false;
  const std::size_t columns = 100 - indent;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (line.size() + word.size() + 7 > columns) {
      out += "\n *" + line;
      line.clear();
      several = true;
    }
    line += " " + word;
  }
  return several ? out + "\n *" + line + "\n */" : out + line + " */";
}

std::string wire_name(const Field& f) {
  const char* const kind = f.kind == ValueKind::kFloat  ? "f"
                           : f.kind == ValueKind::kSint ? "s"
                                                        : "u";
  const std::string order = f.width_bytes == 1 ? "" : f.little_endian ? "le" : "be";
  return kind + std::to_string(f.width_bytes) + order;
}

std::string number_type(const Field& f) {
  if (f.kind == ValueKind::kFloat) return "float";
  return f.width_bytes == 4 && f.kind != ValueKind::kSint ? "long" : "int";
}

std::string print(const Expr& expr, const Leaf& leaf) { return print_term(expr, leaf, false); }

std::string print_size(const Expr& expr, const Leaf& leaf, std::uint32_t unit) {
  if (expr.op == ExprOp::kInt) return std::to_string(expr.value * unit);
  std::string text = print(expr, leaf);
  const bool plain = expr.op == ExprOp::kField;
  if (!plain) text = "(int) (" + text + ")";
  if (plain && expr.field->width_bytes == 4) text = "(int) " + text;
  return unit == 1 ? text : text + " * " + std::to_string(unit);
}

Leaf loads_from(const std::string& bytes, const std::string& base) {
  return [bytes, base](const Expr& expr) {
    const Field& f = *expr.field;
    const std::string offset = std::to_string(expr.offset_bytes);
    const std::string at = base.empty() ? offset : base + (offset == "0" ? "" : " + " + offset);
    if (f.is_instance) {
      const std::string little = f.little_endian ? "true" : "false";
      return "peek(" + bytes + ", " + at + ", " + std::to_string(f.width_bytes) + ", " + little +
             ")";
    }
    return "Wire." + wire_name(f) + "(" + bytes + ", " + at + ")";
  };
}

std::string in_if(const std::string& condition, const std::string& statements) {
  return fill("if (<<if>>) {\n  <<then>>\n}\n", {{"if", condition}, {"then", statements}});
}

std::string field_text(const Layout& layout, std::size_t i) {
  const Field& f = *layout.fields[i].field;
  std::string text = cpp::range_text(layout, i) + ". " + f.doc;
  if (f.unit) text += (text.ends_with('.') ? " Unit: " : ". Unit: ") + f.unit->symbol + ".";
  if (cpp::has_rule(f) && f.valid->one_of.empty()) {
    text += " From " + std::to_string(f.range.min) + " to " + std::to_string(f.range.max) + ".";
  }
  if (f.enumeration) text += " See {@link " + class_of(*f.enumeration, *layout.type->spec) + "}.";
  if (f.kind == ValueKind::kMask) {
    text += " Bits of {@link " + class_of(*f.type, *layout.type->spec) + "}.";
  }
  if (!f.requirement.empty() && f.requirement != layout.type->requirement) {
    text += " " + f.requirement + ".";
  }
  return text;
}

}  // namespace rubricc::java
