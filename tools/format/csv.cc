#include "tools/format/csv.h"

#include "tools/format/plain_value.h"

namespace rubric::format {

std::string_view csv_columns() {
  return "index,offset,time,interface,direction,framing,am.src,am.dest,am.type,message,"
         "error,error.offset,error.requirement,error.text";
}

void append_cell(std::string_view text, Buffer& out) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return out.append(text);
  out.append('"');
  for (const char c : text) {
    if (c == '"') out.append('"');
    out.append(c);
  }
  out.append('"');
}

CsvFormatter::CsvFormatter(const reflect::Protocol& protocol, std::vector<Path> columns)
    : nodes_(protocol, false),
      columns_(columns.empty() ? parse_paths(csv_columns(), protocol) : std::move(columns)) {}

void CsvFormatter::begin(Buffer& out) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (i) out.append(',');
    append_cell(columns_[i].text(), out);
  }
  out.append("\r\n");
}

void CsvFormatter::print(const Record& record, Buffer& out) {
  Buffer cell(256);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (i) out.append(',');
    cell.clear();
    append_plain_values(columns_[i], record, nodes_, cell);
    append_cell(cell.view(), out);
  }
  out.append("\r\n");
}

}  // namespace rubric::format
