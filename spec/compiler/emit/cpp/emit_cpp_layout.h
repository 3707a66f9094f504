// The C++ emitter's facts about a structure beyond the model, decided once: which fields form the
// front part, which lengths follow from an array, what chooses a payload.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc::cpp {

/// A leaf of the front part: a number, or bytes and arrays without a rule of their own.
struct FrontLeaf {
  const Field* field;
  std::int64_t offset = 0;
  std::int64_t end = 0;
};

/// The influence of a field's bytes on the structure's size.
enum class Shape {
  kNumber,       // One number or mask.
  kNested,       // One structure that is as large as itself.
  kNestedRange,  // Bytes that the field delimits and that hold one structure.
  kBytes,        // Opaque bytes.
  kNumbers,      // An array of numbers.
  kStructs,      // An array of structures of constant size.
  kChoice,       // Bytes that hold what a key chooses.
};

/// Alternatives of a field or of interpretations: kinds in order of their first appearance.
struct Group {
  std::string name;                  // "payload", "body".
  const Field* overlaid = nullptr;   // The sequence field whose bytes it reads.
  std::vector<const Field*> fields;  // The sequence field, or the instances in order.
  std::vector<const Type*> types;    // Without repetition.
  bool interpretation = false;
};

struct FieldLayout {
  const Field* field = nullptr;
  Shape shape = Shape::kNumber;
  bool front = false;                   // In the front part.
  std::uint32_t unit = 1;               // Bytes of an element.
  std::uint32_t capacity = 0;           // Elements; 0 where unbounded.
  bool fixed_count = false;             // kNumbers, kStructs: a constant number of elements.
  const Field* derived_from = nullptr;  // Numbers: the array or payload whose length they are.
  const Field* length = nullptr;        // Arrays and payloads: the number that is their length.
};

struct Layout {
  const Type* type = nullptr;
  std::vector<FieldLayout> fields;
  std::vector<FrontLeaf> leaves;  // In the front part.
  std::uint32_t front_size = 0;   // Bytes.
  std::size_t front_count = 0;    // Fields in the front part.
  std::vector<Group> groups;
  bool has_tail = false;  // Ends with a field that takes all bytes there are.
  bool clamps = false;    // has_tail, and there is a greatest size.
};

Layout lay_out(const Type& type);

/// Prints the offset of field `i`: a number, or a sum with the sizes of the variable fields before
/// it.
using SizeText = std::function<std::string(const FieldLayout&)>;
std::string offset_of(const Layout& layout, std::size_t i, const SizeText& size_of);
/// Prints the structure's size in the same way, for one without a tail.
std::string total_of(const Layout& layout, const SizeText& size_of);

/// Returns "bytes 8-11" for comments; "after updates" if the offset varies.
std::string range_text(const Layout& layout, std::size_t i);

/// Returns the structure's name and documentation in one line, for comments.
std::string summary(const Type& type);
/// Returns comment lines: each field's place, its type in so many columns, and its rule.
std::string field_table(const Layout& layout, int columns, const SizeText& type_of);

/// Returns whether checking the structure means only that its bytes are there.
bool is_plain(const Type& type);
/// Returns whether the structure takes all bytes that it is given.
bool has_tail(const Type& type);
bool is_unbounded(std::uint32_t size);
/// Returns whether the value has rules: not each value of its width is allowed.
bool has_rule(const Field& field);
/// Returns the comparisons of `x` of which one holds (all, if values are listed) when the field's
/// rule is broken. Leaves out bounds that the type itself keeps.
std::vector<std::string> breaches(const Field& field, const std::string& x);

}  // namespace rubricc::cpp
