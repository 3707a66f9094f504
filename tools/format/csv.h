// Comma-separated values, RFC 4180: a header, then a row a frame.
#pragma once

#include <vector>

#include "tools/format/json_nodes.h"
#include "tools/format/path.h"
#include "tools/format/record.h"

namespace rubric::format {

/// Columns are paths. A cell of several values has them separated by spaces, one without a value is
/// empty, structures are JSON.
class CsvFormatter final : public Formatter {
 public:
  /// Without `columns` those of csv_columns().
  CsvFormatter(const reflect::Protocol& protocol, std::vector<Path> columns);
  void begin(Buffer& out) override;
  void print(const Record& record, Buffer& out) override;

 private:
  JsonNodes nodes_;
  std::vector<Path> columns_;
};

/// Returns the default columns.
std::string_view csv_columns();

/// Appends `text` as a cell: quoted where it has a comma, a quote or a line break.
void append_cell(std::string_view text, Buffer& out);

}  // namespace rubric::format
