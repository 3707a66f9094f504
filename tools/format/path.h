// Paths to facts about a frame: filters compare them and --fields selects them.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "tools/format/attributes.h"
#include "tools/format/record.h"
#include "tools/format/value.h"

namespace rubric::format {

/// A path that names nothing; the message suggests a near name.
class PathError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An attribute of every frame ("framing", "am.type"), or the tail of a path to a field ("devid",
/// "src.devid", "updates.value"). A message's name means its structure: "rubicon_ack.seq_num". The
/// prefix "fields." selects a field where an attribute has the same name. "x_name", "x_bits" and
/// "x_UNIT" lead to the values that jsonl shows beside x.
class Path {
 public:
  /// Throws PathError if no frame of the protocol can have it.
  Path(std::string_view text, const reflect::Protocol& protocol);

  const std::string& text() const { return text_; }

  /// Visits every value it leads to, elements of arrays one by one, until `visit` returns false.
  void visit(const Record& record, Visitor visit) const;
  /// The same, but stays with the first field that matches.
  void visit_first(const Record& record, Visitor visit) const;
  /// Returns whether it can lead to several values at once.
  bool is_list() const;

  /// Returns names that its values can have: enum entries, messages, faults, ...
  std::vector<std::string> names() const;
  /// Returns names of the bits of the masks that it can lead to.
  std::vector<std::string> bit_names() const;
  /// Returns whether its values are text or bytes of any kind, such as an interface's name.
  bool is_free_text() const;
  /// Returns whether all its values are bytes, which compare with hex.
  bool is_bytes() const;

 private:
  enum class Beside : std::uint8_t { kNothing, kName, kBits, kUnit };
  struct Target {  // Meanings of the last component: a field, perhaps beside it, or a message.
    const reflect::Field* field;
    const reflect::Type* type;
    Beside beside;
    bool list;  // An array, or within one.
  };

  void add_targets(const reflect::Field& field, std::string_view name, bool list);
  const Target* target(const reflect::Node& node) const;
  static bool show(const Target& target, std::int64_t raw, Visitor visit);
  static bool show_node(const Target& target, const reflect::Decoded& decoded, std::size_t index,
                        Visitor visit);
  void find(const Record& record, bool first_only, Visitor visit) const;

  std::string text_;
  const reflect::Protocol* protocol_;
  const Attribute* attribute_ = nullptr;
  std::vector<std::string> components_;
  std::vector<Target> targets_;
};

/// Splits "a,b.c" and makes a path of each.
std::vector<Path> parse_paths(std::string_view list, const reflect::Protocol& protocol);

/// Returns all attributes, fields and messages, for "did you mean".
std::vector<std::string> known_names(const reflect::Protocol& protocol);

}  // namespace rubric::format
