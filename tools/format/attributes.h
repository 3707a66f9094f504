// Facts about every frame besides its message's fields, by the names in jsonl.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "tools/format/record.h"
#include "tools/format/value.h"

namespace rubric::format {

/// One fact. `visit` passes its values, none if the frame lacks it.
struct Attribute {
  std::string_view name;
  bool (*visit)(const Record&, Visitor);
  /// Adds the possible names of its values; null if they are numbers or free text.
  void (*names)(const reflect::Protocol&, std::vector<std::string>&) = nullptr;
  bool free_text = false;
};

/// Returns the attribute of this name, or null.
const Attribute* find_attribute(std::string_view name);
std::vector<std::string_view> attribute_names();

}  // namespace rubric::format
