// The documentation page: well-formed, every link has its target, everything escaped.
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "spec/compiler/emit.h"
#include "spec/compiler/html.h"
#include "spec/compiler/load.h"

namespace rubricc {
namespace {

std::string page_of(const std::vector<std::string>& files) {
  Model model;
  Diagnostics diagnostics;
  load_requirements("spec/requirements.yaml", model, diagnostics);
  load_profiles("spec/profiles", model, diagnostics);
  load_specs(files, model, diagnostics);
  check_model(model, diagnostics);
  EXPECT_EQ(diagnostics.print(), "");
  return emit_doc(model).at(0).text;
}

/// Returns the texts between each `before` and the next of `ends`.
std::vector<std::string> all(const std::string& text, const std::string& before,
                             const char* ends) {
  std::vector<std::string> out;
  for (std::size_t at = text.find(before); at != text.npos; at = text.find(before, at)) {
    at += before.size();
    out.push_back(text.substr(at, text.find_first_of(ends, at) - at));
  }
  return out;
}

/// Returns the first tag that closes nothing open; empty if all is well.
std::string first_unbalanced(const std::string& text) {
  const std::set<std::string> alone{"meta", "!DOCTYPE", "!--"};
  std::vector<std::string> open;
  for (const std::string& tag : all(text, "<", " >\n")) {
    if (alone.contains(tag)) continue;
    if (tag[0] != '/') {
      open.push_back(tag);
    } else if (open.empty() || "/" + open.back() != tag) {
      return tag;
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back();
}

TEST(Doc, LinksLeadSomewhereAndTagsBalance) {
  const std::string page =
      page_of({"spec/wire/rubicon.ksy", "spec/wire/tinyos.ksy", "spec/wire/oscilloscope.ksy"});
  EXPECT_EQ(first_unbalanced(page), "");
  const auto ids = all(page, " id=\"", "\"");
  const std::set<std::string> targets(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), targets.size());
  const auto links = all(page, " href=\"", "\"");
  EXPECT_GT(links.size(), 300U);
  for (const std::string& link : links) {
    ASSERT_EQ(link[0], '#') << "the page needs no network: " << link;
    EXPECT_TRUE(targets.contains(link.substr(1))) << link;
  }
  for (const char* id : {"rubicon-net_msg", "rubicon-enum-devid", "req-WIRE-NET-NBYTES"}) {
    EXPECT_TRUE(targets.contains(id)) << id;
  }
  EXPECT_EQ(page.find("<script"), page.npos);
}

TEST(Doc, HasRolesDifferencesAndProfiles) {
  const std::string page = page_of({"spec/wire/tinyos.ksy"});
  const std::size_t row = page.find("<tr id=\"req-J8-FAIL\">");
  ASSERT_NE(row, page.npos);
  const std::string cells = page.substr(row, page.find("</tr>", row) - row);
  for (const char* cell : {"<td>mote</td>", "<td>No joined(FAIL) exists.</td>",
                           "<td>deployed: A joinIsland call without success ends"}) {
    EXPECT_NE(cells.find(cell), cells.npos) << cell;
  }
  EXPECT_NE(page.find("<td>mote, sink, base station</td><td>yes</td>"), page.npos);
  EXPECT_NE(page.find("<th scope=\"row\">join_requests_max</th><td>7</td><td>5</td>"), page.npos);
  EXPECT_NE(page.find("<th scope=\"row\">listed_ignored</th><td>off</td><td>on</td>"), page.npos);
  EXPECT_EQ(page.find("id=\"req-J8-FAIL\"", row + 20), page.npos);
}

TEST(Doc, TextOfTheSpecIsEscaped) {
  Model model;
  Diagnostics diagnostics;
  load_spec_text("a-->b.ksy",
                 "meta: {id: test, title: '<b>&', endian: be}\n"
                 "doc: '<script>alert(1)</script>'\n"
                 "types:\n  one:\n    -requirement: '\"><i>'\n    doc: \"a < b & 'c'\"\n"
                 "    doc-ref: '<u>'\n    seq:\n"
                 "      - {id: x, type: u1, doc: '<s>', -unit: {symbol: '<q>'}}\n",
                 model, diagnostics);
  check_model(model, diagnostics);
  ASSERT_EQ(diagnostics.print(), "");
  const std::string page = emit_doc(model).at(0).text;
  EXPECT_EQ(first_unbalanced(page), "");
  for (const char* tag : {"<b>", "<script>", "<i>", "<u>", "<s>", "<q>"}) {
    EXPECT_EQ(page.find(tag), page.npos) << tag;
  }
  EXPECT_NE(page.find("a &lt; b &amp; &#39;c&#39;"), page.npos);
  EXPECT_EQ(page.find("-->"), page.rfind("-->"));  // The comment at the top ends once.
}

TEST(Doc, ATableHasHeadersAndEscapesItsCaption) {
  const HtmlTable table{"a<b", {"x&y"}, {{"1"}}, {"here"}};
  EXPECT_EQ(table.text(),
            "<div class=\"scroll\"><table>\n<caption>a&lt;b</caption>\n"
            "<thead><tr><th scope=\"col\">x&amp;y</th></tr></thead>\n<tbody>\n"
            "<tr id=\"here\"><th scope=\"row\">1</th></tr>\n</tbody>\n</table></div>");
}

}  // namespace
}  // namespace rubricc
