// The documentation page: well-formed, every link has its target, everything escaped.
#include <regex>
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
  load_specs(files, model, diagnostics);
  check_model(model, diagnostics);
  EXPECT_EQ(diagnostics.print(), "");
  return emit_doc(model).at(0).text;
}

std::vector<std::string> all(const std::string& text, const char* pattern) {
  std::vector<std::string> out;
  const std::regex regex(pattern);
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) {
    out.push_back((*at)[1]);
  }
  return out;
}

/// The first tag that closes what is not open; empty if all is well.
std::string first_unbalanced(const std::string& text) {
  const std::set<std::string> alone{"meta", "link", "br"};
  std::vector<std::string> open;
  for (const std::string& tag : all(text, "<(/?[a-z][a-z0-9]*)[^>]*>")) {
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
  const auto ids = all(page, " id=\"([^\"]*)\"");
  const std::set<std::string> targets(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), targets.size());
  const auto links = all(page, " href=\"([^\"]*)\"");
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
