// Pieces of HTML text for emit_doc: everything that comes from a spec is escaped here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

std::string html_escaped(std::string_view text);
std::string html_code(std::string_view text);
/// Returns a link to a place of this page.
std::string html_link(std::string_view anchor, std::string_view text);
/// Returns an element with escaped text in it: html_element("p", "a < b").
std::string html_element(std::string_view tag, std::string_view text);

/// A table whose cells are HTML already; the first cell of each row is its header. `anchors` may be
/// empty, or one for each row.
struct HtmlTable {
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> anchors;

  std::string text() const;
};

std::string anchor_of(const Type& type);
std::string anchor_of(const Enum& one);
std::string anchor_of_requirement(std::string_view id);
std::string link_to(const Type& type);
std::string link_to(const Enum& one);
std::string link_to_requirement(std::string_view id);

}  // namespace rubricc
