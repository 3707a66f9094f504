// JSON lines, schema "rubric.decode/1"; tools/commands/decode_format.md describes it.
#pragma once

#include <string>
#include <vector>

#include "tools/format/json_nodes.h"
#include "tools/format/path.h"
#include "tools/format/record.h"

namespace rubric::format {

/// Prints a frame as one object a line. With `fields` an object has schema, index and these alone,
/// each under its path as it was written.
class JsonlFormatter final : public Formatter {
 public:
  JsonlFormatter(const reflect::Protocol& protocol, bool units, std::vector<Path> fields = {});
  void print(const Record& record, Buffer& out) override;

 private:
  /// The members "message" and "path" of a path; a protocol has few different ones.
  struct PathText {
    std::size_t count = 0;
    const reflect::Type* path[reflect::Decoded::kMaxPath] = {};
    std::string text;
  };

  void print_selected(const Record& record, Buffer& out) const;
  const std::string& path_text(const reflect::Decoded& decoded);

  JsonNodes nodes_;
  std::vector<PathText> path_texts_;
  std::vector<Path> fields_;
};

/// Appends the value of a path as JSON: null if the frame has none, an array if the path can lead
/// to several.
void append_json_value(const Path& path, const Record& record, const JsonNodes& nodes, Buffer& out);

}  // namespace rubric::format
