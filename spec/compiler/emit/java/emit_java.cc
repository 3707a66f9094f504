// Emits the Java messages: the files, and the head of each.
#include <fmt/core.h>

#include <array>

#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/emit/java/emit_java_text.h"

namespace rubricc::java {
namespace {

const char kFile[] = R"(<<banner>>
package <<package>>;

<<imports?>>

<<body>>
)";

const char kClass[] = R"(<<about>>
public final class <<class>> extends WireView {
  public static final int MIN_SIZE_BYTES = <<min>>;
  <<max_doc?>>
  public static final int MAX_SIZE_BYTES = <<max>>;

  /** Of bytes that were checked; see parse(). */
  public <<class>>(CheckedBytes bytes) {
    super(bytes, <<most>>);
  }

  <<parse_doc>>
  public static <<class>> parse(ByteBuffer bytes) throws WireException {
    final WireReader in = new WireReader(bytes);
    check(in);
    return new <<class>>(in.checked());
  }

  /** Takes the structure from `in`; throws at the first rule that the bytes break. */
  public static void check(WireReader in) throws WireException {
    <<check>>
  }

  <<getters>>

  <<writer>>
})";

const char kConstants[] = R"(<<doc>>
public final class <<class>> {
  <<constants?>>

  private <<class>>() {}
})";

const char kMessages[] = R"(/** Every structure of the spec by its name there. */
public final class Messages {
  public static final Map<String, WireParser<?>> PARSERS = Map.ofEntries(
      <<entries>>);

  private Messages() {}
})";

// Classes that are imported where they are used.
constexpr std::array<std::string_view, 13> kImports{
    "java.nio.ByteBuffer",    "java.util.ArrayList",           "java.util.List",
    "java.util.Map",          "java.util.function.BiConsumer", "rubric.wire.CheckedBytes",
    "rubric.wire.Wire",       "rubric.wire.WireException",     "rubric.wire.WireOutput",
    "rubric.wire.WireParser", "rubric.wire.WireReader",        "rubric.wire.WireView",
    "rubric.wire.WireWriter",
};

bool is_word(const std::string& text, std::size_t at, std::size_t size) {
  const auto part_of_name = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 ||
                               text[i] == '_' || text[i] == '.');
  };
  const bool before = at > 0 && part_of_name(at - 1);
  const std::size_t end = at + size;
  return !before && (!part_of_name(end) || text[end] == '.');
}

bool uses(const std::string& text, std::string_view name) {
  for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
    if (is_word(text, at, name.size())) return true;
  }
  return false;
}

GeneratedFile file(const Spec& spec, const std::string& class_id, const std::string& body) {
  std::string imports;
  for (const std::string_view import : kImports) {
    const std::string_view name = import.substr(import.rfind('.') + 1);
    if (uses(body, name)) imports += "import " + std::string(import) + ";\n";
  }
  std::string text = fill(kFile, {{"banner", banner("// ", spec.file)},
                                  {"package", package_of(spec)},
                                  {"imports", imports},
                                  {"body", body}});
  const std::string folder = "conformance/adapters/java/generated/rubric/wire/";
  return {folder + member(spec.id) + "/" + class_id + ".java", cpp::fold(text)};
}

std::string type_text(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  std::string out = "bytes";
  if (l.shape == Shape::kNumber || l.shape == Shape::kNumbers) out = wire_name(f);
  if (f.kind == ValueKind::kMask || l.shape == Shape::kNested || l.shape == Shape::kStructs) {
    out = class_of(*f.type, spec);
  } else if (f.enumeration) {
    out += " " + class_of(*f.enumeration, spec);
  }
  return f.repeat != RepeatKind::kOnce ? out + "[]" : out;
}

// Describes the structure, and where its fields are.
std::string about(const Layout& layout, const Spec& spec) {
  const auto type = [&](const FieldLayout& l) { return type_text(l, spec); };
  return cpp::field_table(layout, 24, type) + javadoc(cpp::summary(*layout.type), 0);
}

std::string parse_doc(const Layout& layout) {
  const char* const end = !layout.has_tail ? "Bytes after the structure are stale()."
                          : layout.clamps  ? "Bytes after the greatest size are left out."
                                           : "All bytes are part of it.";
  return javadoc(std::string("Checks everything once. ") + end, 2);
}

GeneratedFile structure(const Type& type, const Spec& spec) {
  const Layout layout = cpp::lay_out(type);
  const bool unbounded = cpp::is_unbounded(type.max_size);
  std::string body =
      fill(kClass, {{"about", about(layout, spec)},
                    {"class", class_name(type.id)},
                    {"min", std::to_string(type.min_size)},
                    {"max_doc", unbounded ? "/** There is none. */" : ""},
                    {"most", layout.clamps ? "MAX_SIZE_BYTES" : "Integer.MAX_VALUE"},
                    {"max", unbounded ? "Integer.MAX_VALUE" : std::to_string(type.max_size)},
                    {"parse_doc", parse_doc(layout)},
                    {"check", java::emit_check(layout, spec)},
                    {"getters", emit_getters(layout, spec)},
                    {"writer", emit_writer(layout, spec)}});
  return file(spec, class_name(type.id), body);
}

// Names of numbers.
GeneratedFile constants(const Spec& spec, const std::string& id, const std::string& doc,
                        const std::vector<std::pair<std::string, std::int64_t>>& values, bool hex) {
  std::string list;
  for (const auto& [name, value] : values) {
    const bool wide = value > INT32_MAX;
    const std::string number =
        hex ? fmt::format("0x{:0{}x}", value, value > 0xff ? 4 : 2) : literal(value);
    list += std::string("public static final ") + (wide ? "long " : "int ") + constant(name) +
            " = " + number + ";\n";
  }
  return file(
      spec, class_name(id),
      fill(kConstants, {{"doc", javadoc(doc, 0)}, {"class", class_name(id)}, {"constants", list}}));
}

GeneratedFile mask(const Type& type, const Spec& spec) {
  std::vector<std::pair<std::string, std::int64_t>> bits;
  for (std::size_t i = type.bits.size(); i-- > 0;) {
    if (type.bits[i].unnamed) continue;
    bits.emplace_back(type.bits[i].name, std::int64_t{1} << (type.bits.size() - 1 - i));
  }
  return constants(spec, type.id, type.name + ". " + type.doc, bits, true);
}

GeneratedFile enumeration(const Enum& e, const Spec& spec) {
  std::vector<std::pair<std::string, std::int64_t>> values;
  for (const EnumEntry& entry : e.entries) values.emplace_back(entry.name, entry.value);
  return constants(spec, e.id, e.id + ". A value without a name is kept as it is.", values, false);
}

}  // namespace
}  // namespace rubricc::java

namespace rubricc {

GeneratedFiles emit_java(const Spec& spec) {
  using namespace java;
  GeneratedFiles out;
  std::string entries;
  for (const auto& e : spec.enums) out.push_back(enumeration(*e, spec));
  for (const auto& type : spec.types) {
    out.push_back(type->is_mask ? mask(*type, spec) : structure(*type, spec));
    if (type->is_mask) continue;
    entries += (entries.empty() ? "" : ",\n") + std::string("Map.entry(") + java::quote(type->id) +
               ", " + class_name(type->id) + "::parse)";
  }
  if (!entries.empty()) {
    out.push_back(file(spec, "Messages", fill(kMessages, {{"entries", entries}})));
  }
  return out;
}

}  // namespace rubricc
