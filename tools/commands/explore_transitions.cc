#include "tools/commands/explore_transitions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "codec/reflect/suggest.h"
#include "codec/text/json.h"
#include "conformance/explore/reception.h"
#include "conformance/explore/transitions.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"

namespace rubric::tools {
namespace {

using explore::Diagram;
using explore::Transition;
using text::Json;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// Returns "join_reply, another number".
std::string trigger_of(const Transition& t) {
  std::string out = t.trigger;
  if (!t.guards.empty()) out += fmt::format(", {}", fmt::join(t.guards, " or "));
  return out;
}

Json json_of(const Transition& t) {
  std::vector<std::string> way;
  for (const explore::Given& given : t.witness.events) way.push_back(given.text());
  return Json::object({{"from", t.from},
                       {"to", t.to},
                       {"trigger", t.trigger},
                       {"guards", Json::array(t.guards)},
                       {"outputs", Json::array(t.outputs)},
                       {"rules", Json::array(t.rules)},
                       {"ignored", t.ignored},
                       {"witness", Json::array(way)}},
                      " ");
}

Json json_of(const Diagram& diagram) {
  const auto transition = [](const Transition& t) { return json_of(t); };
  return Json::object({{"name", diagram.name},
                       {"title", diagram.title},
                       {"complete", diagram.complete},
                       {"worlds", diagram.worlds},
                       {"states", Json::array(diagram.states, one_line)},
                       {"transitions", Json::array(diagram.transitions, transition, "\n    ")}},
                      "\n   ");
}

// Escapes text for HTML-like labels of Graphviz.
std::string html(std::string_view text) {
  std::string out;
  for (const char c : text::xml_text(text)) {
    if (c == '\n') {
      out += "<BR/>";
    } else {
      out += c;
    }
  }
  return out;
}

constexpr std::string_view kBlank = "\u00a0";  // Others are lost at the ends of an SVG's texts.
constexpr std::string_view kBreak = "<BR ALIGN=\"LEFT\"/>";

std::string small(const std::string& text) { return "<FONT POINT-SIZE=\"10\">" + text + "</FONT>"; }

std::string guarded(const Transition& t) {
  std::string out = t.trigger;
  if (!t.guards.empty()) out += fmt::format(" [{}]", fmt::join(t.guards, " or "));
  return out;
}

// Returns lines: a trigger in bold with its guard, the output, the rules.
std::string lines_of(const Transition& t) {
  std::string out = "<B>" + html(t.trigger) + "</B>";
  if (!t.guards.empty()) out += html(fmt::format("{}[{}]", kBlank, fmt::join(t.guards, " or ")));
  out += kBreak;
  if (!t.outputs.empty()) {
    out += html(fmt::format("{0}{0}/ {1}", kBlank, fmt::join(t.outputs, ", ")));
    out += kBreak;
  }
  if (!t.rules.empty()) {
    out += small(html(fmt::format("{0}{0}{1}", kBlank, fmt::join(t.rules, " "))));
    out += kBreak;
  }
  return out;
}

std::string table(const std::string& rows) {
  return "<TABLE BORDER=\"0\" CELLBORDER=\"0\" CELLSPACING=\"1\" CELLPADDING=\"3\">" + rows +
         "</TABLE>";
}

std::string cell(const std::string& lines) {
  return "<TR><TD ALIGN=\"LEFT\" BALIGN=\"LEFT\">" + lines + "</TD></TR>";
}

// Returns a state's name, the steps that stay in it, and the triggers without effect there.
std::string node_of(const Diagram& diagram, std::size_t state) {
  std::string inside;
  std::string ignored;
  for (const Transition& t : diagram.transitions) {
    if (t.from != state || t.to != state) continue;
    if (t.ignored) {
      ignored +=
          small(html(fmt::format("{0}{1}{1}{2}", guarded(t), kBlank, fmt::join(t.rules, " "))));
      ignored += kBreak;
    } else {
      inside += cell(lines_of(t));
    }
  }
  std::string rows = "<TR><TD><B>" + html(diagram.states[state]) + "</B></TD></TR>";
  if (!inside.empty()) rows += "<HR/>" + inside;
  if (!ignored.empty()) rows += "<HR/>" + cell(small("ignored:") + std::string(kBreak) + ignored);
  // A question of a flowchart.
  const char* const shape =
      diagram.states[state].ends_with('?') ? ", shape=hexagon, style=solid" : "";
  return fmt::format("  s{} [label=<{}>{}];\n", state, table(rows), shape);
}

using Edges = std::map<std::pair<std::size_t, std::size_t>, std::vector<const Transition*>>;

// Removes edges present from every state to the initial one (a reboot, for example) and returns
// them as text.
std::string from_everywhere(Edges& edges, const std::vector<bool>& reached) {
  std::string out;
  const auto others = std::count(reached.begin() + 1, reached.end(), true);
  std::map<std::string, std::size_t> counts;
  for (const auto& [ends, all] : edges) {
    for (const Transition* t : all) counts[lines_of(*t)] += ends.second == 0 ? 1 : 0;
  }
  for (const auto& one : counts) {
    if (others < 2 || one.second != static_cast<std::size_t>(others)) continue;
    out += one.first;
    for (auto& [ends, all] : edges) {
      if (ends.second != 0) continue;
      std::erase_if(all, [&](const Transition* t) { return lines_of(*t) == one.first; });
    }
  }
  return out;
}

std::string dot_of(const Diagram& diagram) {
  std::string out = fmt::format(
      "digraph {} {{\n"
      "  graph [rankdir=TB, bgcolor=transparent, nodesep=0.5, ranksep=0.45, tooltip={}];\n"
      "  node [shape=box, style=rounded, fontname=\"Courier\", fontsize=12, margin=\"0.05\"];\n"
      "  edge [fontname=\"Courier\", fontsize=12, arrowsize=0.8];\n"
      "  start [shape=point, width=0.12];\n",
      diagram.name, text::json_string(diagram.title));
  std::vector<bool> reached(diagram.states.size());
  reached[0] = true;
  Edges edges;
  for (const Transition& t : diagram.transitions) {
    reached[t.from] = reached[t.to] = true;
    if (t.from != t.to) edges[{t.from, t.to}].push_back(&t);
  }
  const std::string everywhere = from_everywhere(edges, reached);
  if (everywhere.empty()) {
    out += "  start -> s0;\n";
  } else {
    const std::string lines = "from every other state:" + std::string(kBreak) + everywhere;
    out += fmt::format("  start -> s0 [label=<{}>];\n", table(cell(lines)));
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) out += node_of(diagram, i);
  }
  for (const auto& [ends, all] : edges) {
    std::string lines;
    for (const Transition* t : all) lines += cell(lines_of(*t));
    if (lines.empty()) continue;
    out += fmt::format("  s{} -> s{} [label=<{}>];\n", ends.first, ends.second, table(lines));
  }
  return out + "}\n";
}

/// Returns the diagrams as text for people, as JSON (rubric.transitions/1, explore_format.md), or
/// in the language of Graphviz. `flaw` may be empty.
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
  const auto part = [](const Diagram& diagram) { return json_of(diagram); };
  const Json out = Json::object({{"schema", "rubric.transitions/1"},
                                 {"profile", profile},
                                 {"flaw", Json::or_null(flaw)},
                                 {"parts", Json::array(diagrams, part, "\n  ")}},
                                "\n ");
  return out.text() + '\n';
}

std::string transitions_dot(const std::vector<Diagram>& diagrams) {
  std::string out;
  for (const Diagram& diagram : diagrams) out += dot_of(diagram);
  return out;
}

}  // namespace

void add_transition_options(cli::Command& sub, TransitionOptions& options) {
  cli::Option wanted =
      sub.add_flag("--transitions", options.wanted,
                   "Print the state diagrams of a node's parts instead, as the machine makes them");
  sub.exclude_all_but(wanted, {"--profile", "--flaw", "--format", "--out"});
  sub.add_option("--part", options.parts,
                 "Print transitions of this part alone: join, listing, message, output, input, "
                 "mote_reception, sink_reception")
      .needs(wanted);
}

void print_transitions(const TransitionOptions& options, const ExploredMachine& machine,
                       const std::string& format, const std::string& out) {
  std::vector<std::string> names;
  for (const explore::PartName& part : explore::part_names()) names.emplace_back(part.name);
  const std::size_t parts = names.size();
  for (const explore::PartName& part : explore::reception_names()) names.emplace_back(part.name);
  for (const std::string& part : options.parts) {
    if (std::find(names.begin(), names.end(), part) != names.end()) continue;
    throw cli::UsageError(
        fmt::format("unknown part '{}'{}", part, reflect::did_you_mean(part, names)));
  }
  std::vector<explore::Diagram> diagrams;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool wanted =
        options.parts.empty() ||
        std::find(options.parts.begin(), options.parts.end(), names[i]) != options.parts.end();
    if (!wanted) continue;
    const auto draw = i < parts ? explore::transitions_of : explore::reception_of;
    diagrams.push_back(draw(names[i], machine.values, machine.step));
  }
  std::string text;
  if (format == "json") {
    text = transitions_json(diagrams, machine.profile, machine.flaw);
  } else {
    text = format == "dot" ? transitions_dot(diagrams) : transitions_text(diagrams);
  }
  if (!cli::write_file(out.empty() ? "-" : out, text)) cli::exit_with(cli::kExitOutput);
  for (const explore::Diagram& diagram : diagrams) {
    if (!diagram.complete) cli::exit_with(cli::kExitIncomplete);
  }
}

}  // namespace rubric::tools
