// HTML text: escaping and tags.
#include "spec/compiler/html.h"

#include <fmt/format.h>

#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::string_view kTable = R"(<div class="scroll"><table>
<caption><<caption>></caption>
<thead><tr><<columns>></tr></thead>
<tbody>
<<rows?>>
</tbody>
</table></div>)";

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string html_code(std::string_view text) { return html_element("code", text); }

std::string html_link(std::string_view anchor, std::string_view text) {
  return fmt::format("<a href=\"#{}\">{}</a>", html_escaped(anchor), html_escaped(text));
}

std::string html_element(std::string_view tag, std::string_view text) {
  return fmt::format("<{0}>{1}</{0}>", tag, html_escaped(text));
}

std::string HtmlTable::text() const {
  std::string head, body;
  for (const std::string& column : columns) {
    head += fmt::format("<th scope=\"col\">{}</th>", html_escaped(column));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string id =
        i < anchors.size() ? fmt::format(" id=\"{}\"", html_escaped(anchors[i])) : "";
    body += fmt::format("<tr{}>", id);
    for (std::size_t j = 0; j < rows[i].size(); ++j) {
      body += j == 0 ? fmt::format("<th scope=\"row\">{}</th>", rows[i][j])
                     : fmt::format("<td>{}</td>", rows[i][j]);
    }
    body += "</tr>\n";
  }
  return fill(kTable, {{"caption", html_escaped(caption)}, {"columns", head}, {"rows", body}});
}

std::string anchor_of(const Type& type) {
  return fmt::format("{}-{}", type.spec->id, type.id);
}
std::string anchor_of(const Enum& one) {
  return fmt::format("{}-enum-{}", one.spec->id, one.id);
}
std::string anchor_of_requirement(std::string_view id) { return fmt::format("req-{}", id); }

std::string link_to(const Type& type) { return html_link(anchor_of(type), type.id); }
std::string link_to(const Enum& one) { return html_link(anchor_of(one), one.id); }
std::string link_to_requirement(std::string_view id) {
  return id.empty() ? "" : html_link(anchor_of_requirement(id), id);
}

}  // namespace rubricc
