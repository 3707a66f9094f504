// Prints a line a frame for people to read.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/format/json_nodes.h"
#include "tools/format/path.h"
#include "tools/format/record.h"
#include "tools/format/style.h"

namespace rubric::format {

struct TextOptions {
  bool color = false;
  bool hex = false;          ///< A hex dump below each line.
  bool units = false;        ///< Values with a unit are shown converted.
  std::size_t width = 0;     ///< Lines go on below after so many columns; 0: never.
  std::vector<Path> fields;  ///< Only these, where there are any.
};

/// Index, time, interface and direction, framing, AM addresses, message, fields; a malformed frame
/// begins with '!' and has the broken rule on a line of its own.
class TextFormatter final : public Formatter {
 public:
  TextFormatter(const reflect::Protocol& protocol, TextOptions options);
  void print(const Record& record, Buffer& out) override;

 private:
  TextOptions options_;
  JsonNodes nodes_;
};

}  // namespace rubric::format
