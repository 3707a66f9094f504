// The page about the wire: the picture of the bytes of a structure.
#include <algorithm>

#include <fmt/format.h>

#include "spec/compiler/emit_doc.h"
#include "spec/compiler/html.h"
#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::uint32_t kRowBytes = 16;
constexpr std::string_view kCell =
    R"(<span class="<<class>>" style="grid-column:<<column>>/span <<span>>"
  title="<<title>>"><<text>></span>
)";
constexpr std::string_view kRow = R"(<span class="at"><<offset>></span><div class="row">
<<cells>>
</div>
)";
constexpr std::string_view kLayout = R"(<div class="layout" role="img" aria-label="<<label>>">
<<rows?>>
</div>)";

class Rows {
 public:
  void add(const Field& field) {
    const bool fixed = field.min_size == field.max_size;
    if (!fixed || field.max_size > kRowBytes) {
      finish();
      put(field, "wide", kRowBytes);
      finish();
      offset_ += field.max_size;
      known_ = known_ && fixed;
      return;
    }
    bool first = true;
    for (std::uint32_t left = field.max_size; left > 0;) {
      const std::uint32_t part = std::min(left, kRowBytes - column_);
      put(field, first ? "cell" : "cell more", part);
      first = false;
      left -= part;
      offset_ += part;
      if (column_ == kRowBytes) finish();
    }
  }

  std::string text() {
    finish();
    return text_;
  }

 private:
  void put(const Field& field, std::string_view css, std::uint32_t span) {
    if (cells_.empty()) row_ = known_ ? std::to_string(offset_) : "…";
    const std::string size = doc_range(field.min_size, field.max_size);
    cells_ += fill(kCell, {{"class", std::string(css)},
                           {"column", std::to_string(column_ + 1)},
                           {"span", std::to_string(span)},
                           {"title", html_escaped(field.id + ", bytes: " + size)},
                           {"text", html_escaped(css == "wide" ? field.id + " (" + size + ")"
                                                               : field.id)}});
    column_ += span;
  }

  void finish() {
    if (!cells_.empty()) text_ += fill(kRow, {{"offset", row_}, {"cells", cells_}});
    cells_.clear();
    column_ = 0;
  }

  std::string text_, cells_, row_;
  std::uint32_t column_ = 0;
  std::uint64_t offset_ = 0;
  bool known_ = true;
};

}  // namespace

std::string doc_layout(const Type& type) {
  Rows rows;
  for (const auto& field : type.fields) rows.add(*field);
  const std::string label =
      fmt::format("Bytes of {}, in rows of {}; the table below says the same.", type.id, kRowBytes);
  return fill(kLayout, {{"label", html_escaped(label)}, {"rows", rows.text()}});
}

std::string doc_range(std::uint64_t min, std::uint64_t max) {
  if (min == max) return std::to_string(min);
  if (max >= UINT32_MAX) return fmt::format("{} and more", min);
  return fmt::format("{} to {}", min, max);
}

}  // namespace rubricc
