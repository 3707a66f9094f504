// Emits the page about the wire: its frame, specs, enums and requirements.
#include "spec/compiler/emit_doc.h"

#include <map>
#include <set>

#include <fmt/format.h>

#include "spec/compiler/cpp_text.h"
#include "spec/compiler/emit.h"
#include "spec/compiler/html.h"
#include "spec/compiler/profile_fields.h"
#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::string_view kPage = R"(<!--
<<banner>>
-->
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title><<title>></title>
<style>
:root { --ink: #1b1f24; --paper: #fff; --line: #c9d0d8; --soft: #f1f4f7; --link: #0a52b0;
        --cell: #dbe8f8; --wide: #f6e7cd; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --paper: #14171b; --line: #3c444d; --soft: #1f242a; --link: #8cbcff;
          --cell: #23405f; --wide: #4f3d1a; }
}
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
       max-width: 76rem; margin: 0 auto; padding: 1rem; }
a { color: var(--link); }
a:focus-visible { outline: 3px solid var(--link); }
.skip { position: absolute; left: -99rem; }
.skip:focus { position: static; }
nav ul { columns: 14rem; padding-left: 1.2rem; }
section { border-top: 1px solid var(--line); margin-top: 1.5rem; }
.facts { background: var(--soft); padding: .3rem .6rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .8rem 0; font-size: .9rem; }
caption { text-align: left; font-weight: 600; padding: .2rem 0; }
th, td { border: 1px solid var(--line); padding: .2rem .5rem; text-align: left;
         vertical-align: top; }
thead th { background: var(--soft); }
.layout { display: grid; grid-template-columns: 3rem 1fr; gap: 2px; margin: .8rem 0; }
.at { font-size: .8rem; text-align: right; padding-right: .4rem; }
.row { display: grid; grid-template-columns: repeat(16, minmax(0, 1fr)); gap: 2px; }
.cell, .wide { font-size: .8rem; overflow: hidden; text-overflow: ellipsis; white-space: nowrap;
               border: 1px solid var(--line); padding: .2rem; text-align: center; }
.cell { background: var(--cell); }
.more { border-left-style: dashed; }
.wide { background: var(--wide); }
</style>
</head>
<body>
<a class="skip" href="#main">Skip the index</a>
<header>
<h1><<title>></h1>
<p>Messages byte by byte: what each field is, which values are valid, and the rule behind it.</p>
</header>
<nav aria-label="Index">
<<index>>
</nav>
<main id="main">
<<specs>>
<<requirements?>>
</main>
</body>
</html>
)";

constexpr std::string_view kSpec = R"(<section id="spec-<<id>>">
<h2><<title>></h2>
<<doc?>>
<<dispatch?>>
</section>
<<types?>>
<<enums?>>
)";

std::string title_of(const Spec& spec) { return spec.title.empty() ? spec.id : spec.title; }

std::string index_of(const Spec& spec) {
  std::string items;
  for (const auto& type : spec.types) items += "<li>" + link_to(*type) + "</li>\n";
  for (const auto& one : spec.enums) items += "<li>" + link_to(*one) + " (enum)</li>\n";
  return fmt::format("<h2>{}</h2>\n<ul>\n{}</ul>\n",
                     html_link("spec-" + spec.id, title_of(spec)), items);
}

std::string doc_spec(const Spec& spec) {
  std::string doc, dispatch, types, enums;
  if (!spec.doc.empty()) doc = html_element("p", spec.doc);
  if (!spec.doc_ref.empty()) doc += "\n" + html_element("p", spec.doc_ref);
  for (const auto& type : spec.types) {
    if (!type->carrier.empty()) dispatch += doc_dispatch(*type);
    types += doc_type(*type);
  }
  if (!dispatch.empty()) dispatch = "<h3>How a frame leads to its message</h3>\n" + dispatch;
  for (const auto& one : spec.enums) enums += doc_enum(*one);
  return fill(kSpec, {{"id", spec.id}, {"title", html_escaped(title_of(spec))}, {"doc", doc},
                      {"dispatch", dispatch}, {"types", types}, {"enums", enums}});
}

/// Returns the types that name a requirement, themselves or by a field.
std::map<std::string, std::string> uses(const Model& model) {
  std::map<std::string, std::string> out;
  for (const auto& spec : model.specs) {
    for (const auto& type : spec->types) {
      std::set<std::string> named{type->requirement};
      for (const auto& field : type->fields) named.insert(field->requirement);
      for (const std::string& id : named) {
        std::string& text = out[id];
        text += (text.empty() ? "" : ", ") + link_to(*type);
      }
    }
  }
  return out;
}

std::string roles_text(const Requirement& one) {
  std::string out;
  const std::pair<int, std::string_view> roles[] = {
      {1, "mote"}, {2, "sink"}, {4, "base station"}};
  for (const auto& [bit, name] : roles) {
    if ((one.roles & bit) == 0) continue;
    out += out.empty() ? "" : ", ";
    out += name;
  }
  return out;
}

/// Prints rules that name who must follow them, with the differences that each profile accepts.
std::string doc_behaviour(const Model& model) {
  HtmlTable table{"Behaviour",
                  {"id", "level", "clause", "sentence", "for", "says what must not happen",
                   "release 1.0", "accepted", "source"},
                  {}, {}};
  for (const Requirement& one : model.requirements) {
    if (one.roles == 0) continue;
    std::string accepted;
    for (const Profile& profile : model.profiles) {
      for (const AcceptedDifference& difference : profile.accepted) {
        if (difference.requirement != one.id) continue;
        accepted += (accepted.empty() ? "" : " ") + profile.name + ": " + difference.sentence;
      }
    }
    table.anchors.push_back(anchor_of_requirement(one.id));
    table.rows.push_back({html_escaped(one.id), html_escaped(one.level),
                          html_escaped(one.clause), html_escaped(one.sentence), roles_text(one),
                          one.forbids ? "yes" : "", html_escaped(one.deployed),
                          html_escaped(accepted), html_escaped(one.source)});
  }
  return table.rows.empty() ? "" : "\n" + table.text();
}

std::string doc_profiles(const Model& model) {
  if (model.profiles.empty()) return {};
  HtmlTable table{"Profiles", {"constant or switch"}, {}, {}};
  for (const Profile& profile : model.profiles) table.columns.push_back(profile.name);
  for (std::size_t i = 0; i < profile_fields().size(); ++i) {
    const ProfileField& field = profile_fields()[i];
    std::vector<std::string> row{std::string(field.name)};
    for (const Profile& profile : model.profiles) {
      const std::int64_t value = profile.values.at(i);
      row.push_back(!field.is_switch ? std::to_string(value) : value != 0 ? "on" : "off");
    }
    table.rows.push_back(std::move(row));
  }
  return "\n" + table.text();
}

std::string doc_requirements(const Model& model) {
  if (model.requirements.empty()) return {};
  const auto used = uses(model);
  HtmlTable table{"Requirements", {"id", "level", "clause", "sentence", "source", "used by"},
                  {}, {}};
  for (const Requirement& one : model.requirements) {
    if (one.roles != 0) continue;
    const auto found = used.find(one.id);
    table.anchors.push_back(anchor_of_requirement(one.id));
    table.rows.push_back({html_escaped(one.id), html_escaped(one.level),
                          html_escaped(one.clause), html_escaped(one.sentence),
                          html_escaped(one.source),
                          found == used.end() ? "framing" : found->second});
  }
  return "<section id=\"requirements\">\n<h2>Requirements</h2>\n" + table.text() +
         doc_behaviour(model) + doc_profiles(model) + "\n</section>";
}

/// A comment of HTML ends at "--".
std::string comment_text(std::string text) {
  for (std::size_t at; (at = text.find("-->")) != text.npos;) text.replace(at, 3, "- >");
  return text;
}

}  // namespace

GeneratedFiles emit_doc(const Model& model) {
  std::string inputs, title, index, specs;
  for (const auto& spec : model.specs) {
    inputs += (inputs.empty() ? "" : ", ") + spec->file;
    index += index_of(*spec);
    specs += doc_spec(*spec);
  }
  if (model.specs.size() == 1) title = title_of(*model.specs.front());
  if (title.empty()) title = "Wire specifications";
  const std::string requirements = doc_requirements(model);
  if (!requirements.empty()) {
    index += "<p>" + html_link("requirements", "Requirements") + "</p>\n";
  }
  return {{"doc/wire.html",
           fill(kPage, {{"banner", comment_text(banner("", inputs))},
                        {"title", html_escaped(title)}, {"index", index},
                        {"specs", specs.empty() ? "<p>Nothing.</p>" : specs},
                        {"requirements", requirements}})}};
}

}  // namespace rubricc
