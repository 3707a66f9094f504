#include "tools/transitions_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "conformance/report/text.h"

namespace rubric::tools {
namespace {

using explorer::Diagram;
using explorer::Transition;
using report::json_string;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// "join_reply, another number"
std::string trigger_of(const Transition& t) {
  std::string out = t.trigger;
  if (!t.guards.empty()) out += fmt::format(", {}", fmt::join(t.guards, " or "));
  return out;
}

std::string list_of(const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : ", ") + json_string(item);
  return "[" + out + "]";
}

std::string json_of(const Diagram& diagram) {
  std::vector<std::string> states;
  for (const std::string& state : diagram.states) states.push_back(one_line(state));
  std::string out = fmt::format(
      "  {{\"name\": {}, \"title\": {}, \"complete\": {}, \"worlds\": {},\n   \"states\": {},\n"
      "   \"transitions\": [",
      json_string(diagram.name), json_string(diagram.title), diagram.complete, diagram.worlds,
      list_of(states));
  bool first = true;
  for (const Transition& t : diagram.transitions) {
    std::vector<std::string> way;
    for (const explorer::Given& given : t.witness.events) way.push_back(given.text());
    out += fmt::format(
        "{}\n    {{\"from\": {}, \"to\": {}, \"trigger\": {}, \"guards\": {},\n"
        "     \"outputs\": {}, \"rules\": {}, \"ignored\": {},\n     \"witness\": {}}}",
        first ? "" : ",", t.from, t.to, json_string(t.trigger), list_of(t.guards),
        list_of(t.outputs), list_of(t.rules), t.ignored, list_of(way));
    first = false;
  }
  return out + "]}";
}

// HTML-like labels of Graphviz.
std::string html(std::string_view text) {
  std::string out;
  for (const char c : report::xml_text(text)) out += c == '\n' ? std::string("<BR/>") : std::string(1, c);
  return out;
}

std::string small(const std::string& text) {
  return "<FONT POINT-SIZE=\"10\">" + text + "</FONT>";
}

// A trigger in bold, what comes out, and the rules.
std::string label_of(const Transition& t) {
  std::string out = "<B>" + html(t.trigger) + "</B>";
  if (!t.guards.empty()) out += html(fmt::format(" [{}]", fmt::join(t.guards, " or ")));
  out += "<BR ALIGN=\"LEFT\"/>";
  if (!t.outputs.empty()) {
    out += html(fmt::format("  / {}", fmt::join(t.outputs, ", "))) + "<BR ALIGN=\"LEFT\"/>";
  }
  if (!t.rules.empty()) {
    out += "  " + small(html(fmt::format("{}", fmt::join(t.rules, " ")))) + "<BR ALIGN=\"LEFT\"/>";
  }
  return out;
}

// A state's name, and below it what has no effect there.
std::string node_of(const Diagram& diagram, std::size_t state) {
  std::string rows;
  for (const Transition& t : diagram.transitions) {
    if (t.from != state || !t.ignored) continue;
    rows += small(html(trigger_of(t)) + (t.rules.empty() ? "" : "  ") +
                  html(fmt::format("{}", fmt::join(t.rules, " ")))) +
            "<BR ALIGN=\"LEFT\"/>";
  }
  std::string out = fmt::format(
      "  s{} [label=<<TABLE BORDER=\"0\" CELLBORDER=\"0\" CELLPADDING=\"3\"><TR><TD><B>{}</B></TD>"
      "</TR>",
      state, html(diagram.states[state]));
  if (!rows.empty()) {
    out += fmt::format("<HR/><TR><TD ALIGN=\"LEFT\" BALIGN=\"LEFT\">{}<BR ALIGN=\"LEFT\"/>{}</TD></TR>",
                       small("ignores"), rows);
  }
  return out + "</TABLE>>];\n";
}

std::string dot_of(const Diagram& diagram) {
  std::string out = fmt::format(
      "digraph {} {{\n"
      "  graph [rankdir=TB, bgcolor=transparent, nodesep=0.6, ranksep=0.5, tooltip={}];\n"
      "  node [shape=box, style=rounded, fontname=\"Helvetica\", fontsize=13];\n"
      "  edge [fontname=\"Helvetica\", fontsize=12, arrowsize=0.8];\n"
      "  start [shape=point, width=0.12];\n  start -> s0;\n",
      diagram.name, json_string(diagram.title));
  std::vector<bool> reached(diagram.states.size());
  reached[0] = true;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::string>> edges;
  for (const Transition& t : diagram.transitions) {
    reached[t.from] = reached[t.to] = true;
    if (!t.ignored) edges[{t.from, t.to}].push_back(label_of(t));
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) out += node_of(diagram, i);
  }
  for (const auto& [ends, labels] : edges) {
    out += fmt::format("  s{} -> s{} [label=<{}>];\n", ends.first, ends.second,
                       fmt::join(labels, ""));
  }
  return out + "}\n";
}

}  // namespace

std::string transitions_text(const std::vector<Diagram>& diagrams) {
  std::string out;
  for (const Diagram& diagram : diagrams) {
    out += fmt::format("{}{}: {}\n", out.empty() ? "" : "\n", diagram.name, diagram.title);
    for (std::size_t state = 0; state < diagram.states.size(); ++state) {
      std::string rows;
      for (const Transition& t : diagram.transitions) {
        if (t.from != state) continue;
        rows += "    " + trigger_of(t);
        if (!t.outputs.empty()) rows += fmt::format(" / {}", fmt::join(t.outputs, ", "));
        if (t.ignored) {
          rows += ": ignored";
        } else if (t.to != t.from) {
          rows += " -> " + one_line(diagram.states[t.to]);
        }
        if (!t.rules.empty()) rows += fmt::format("  [{}]", fmt::join(t.rules, " "));
        rows += '\n';
      }
      if (!rows.empty()) out += "  " + one_line(diagram.states[state]) + "\n" + rows;
    }
    if (!diagram.complete) out += "  not all states of the network were tried\n";
  }
  return out;
}

std::string transitions_json(const std::vector<Diagram>& diagrams, const std::string& profile,
                             const std::string& flaw) {
  std::string all;
  for (const Diagram& diagram : diagrams) all += (all.empty() ? "\n" : ",\n") + json_of(diagram);
  return fmt::format(
      "{{\"schema\": \"rubric.transitions/1\", \"profile\": {}, \"flaw\": {},\n \"parts\": [{}]}}\n",
      json_string(profile), report::json_string_or_null(flaw), all);
}

std::string transitions_dot(const std::vector<Diagram>& diagrams) {
  std::string out;
  for (const Diagram& diagram : diagrams) out += dot_of(diagram);
  return out;
}

}  // namespace rubric::tools
