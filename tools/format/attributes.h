// What is known of every frame beside its message's fields, by the names that jsonl uses.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "tools/format/record.h"
#include "tools/format/value.h"

namespace rubric::format {

/// One of them. `visit` gives its values, none where the frame lacks it.
struct Attribute {
  std::string_view name;
  bool (*visit)(const Record&, Visitor);
  /// Adds the names that its values can have; null where they are numbers or free text.
  void (*names)(const reflect::Protocol&, std::vector<std::string>&);
  bool free_text;
};

/// Null if there is none with this name.
const Attribute* find_attribute(std::string_view name);
std::vector<std::string_view> attribute_names();

}  // namespace rubric::format
