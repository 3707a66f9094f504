#include "conformance/trace/check.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "codec/reflect/requirements.h"
#include "conformance/trace/check_message.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/print.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

/// Returns the ids and families ("J4" of "J4-SEQ") of the catalogue.
const std::unordered_set<std::string>& known_requirements() {
  static const std::unordered_set<std::string> known = [] {
    std::unordered_set<std::string> all;
    for (const reflect::Requirement& one : reflect::requirements().subspan(1)) {
      const std::string id = one.id;
      all.insert(id);
      all.insert(id.substr(0, id.find('-')));
    }
    return all;
  }();
  return known;
}

class FileCheck {
 public:
  FileCheck(const File& file, const Report& report) : file_(file), report_(report) {}

  void run() {
    head();
    std::unordered_map<std::string, Place> names;
    for (const Case& one : file_.cases) {
      const auto [at, fresh] = names.emplace(one.name, one.place);
      if (!fresh) {
        report_(one.place, "case " + quoted(one.name) + " is already in line " +
                               std::to_string(at->second.line));
      }
      check_case(one);
    }
  }

 private:
  // The headers of a file or a case.
  struct Said {
    bool version = false, profile = false, tick = false, seed = false, values = false;
    std::unordered_set<std::string> nodes, links;
  };

  void once(bool& said, const Header& header, const char* what) {
    if (std::exchange(said, true)) report_(header.place, std::string(what) + " is said twice");
  }

  void head() {
    Said said;
    for (const Item& item : file_.head) {
      const auto* header = item.as<Header>();
      if (!header) continue;
      const bool version = std::holds_alternative<VersionHeader>(header->what);
      if (!said.version && !version && !first_) {
        report_(header->place, "the first header must be %rtr 1");
      }
      first_ = true;
      check_header(*header, said);
    }
    if (!said.version && !first_) report_({1, 1}, "expected %rtr 1 at the beginning");
    link_nodes(file_.head, scope_of(file_, {}));
  }

  void check_header(const Header& header, Said& said) {
    if (std::holds_alternative<VersionHeader>(header.what)) once(said.version, header, "%rtr");
    if (std::holds_alternative<ProfileHeader>(header.what)) once(said.profile, header, "%profile");
    if (std::holds_alternative<TickHeader>(header.what)) once(said.tick, header, "%tick");
    if (std::holds_alternative<SeedHeader>(header.what)) once(said.seed, header, "%seed");
    if (std::holds_alternative<ForHeader>(header.what)) once(said.values, header, "%for");
    if (const auto* node = std::get_if<NodeHeader>(&header.what)) {
      if (!said.nodes.insert(node->name).second) {
        report_(header.place, "node " + quoted(node->name) + " is said twice");
      }
      check_node(*node, header.place);
    }
    if (const auto* link = std::get_if<LinkHeader>(&header.what)) {
      if (!said.links.insert(link->name).second) {
        report_(header.place, "link " + quoted(link->name) + " is said twice");
      }
      if (link->name == "app" || link->name == "power") {
        report_(header.place, quoted(link->name) + " is not a name for a link between nodes");
      }
    }
  }

  void check_node(const NodeHeader& node, Place place) {
    const bool base = node.role == Role::kBaseStation;
    const bool mote = node.role == Role::kMote;
    if (!node.id && !base) report_(place, "node " + quoted(node.name) + " needs id=");
    if (!node.island && !mote) report_(place, "node " + quoted(node.name) + " needs island=");
    if (node.island && mote) {
      report_(place, "a mote has no island of its own: " + quoted(node.name) + " joins one");
    }
    if (node.id && base) report_(place, "a base station has no TinyOS id");
    if (find(node.stated, ParameterId::kChannels) && base) {
      report_(place, "a base station has no synaptic channels");
    }
  }

  void link_nodes(const std::vector<Item>& items, const Scope& scope) {
    for (const Item& item : items) {
      const auto* header = item.as<Header>();
      const auto* link = header ? std::get_if<LinkHeader>(&header->what) : nullptr;
      if (!link) continue;
      for (const std::string& node : link->nodes) {
        if (!scope.node(node)) {
          report_(header->place,
                  "no %node " + quoted(node) + ", which %link " + link->name + " names");
        }
      }
    }
  }

  void check_case(const Case& one) {
    Said said;
    const Scope scope = scope_of(file_, one);
    std::unordered_map<std::string, Place> labels;
    BoundNames bound{kSeeded};
    bool lines = false;
    std::int64_t latest = 0;
    for (const Item& item : one.items) {
      if (const auto* header = item.as<Header>()) {
        case_header(*header, lines, said);
      } else if (const auto* line = item.as<Line>()) {
        lines = true;
        check_time(*line, labels, latest);
        check_line(*line, scope, bound);
      }
    }
    link_nodes(one.items, scope);
  }

  void case_header(const Header& header, bool lines, Said& said) {
    if (std::holds_alternative<VersionHeader>(header.what) ||
        std::holds_alternative<TickHeader>(header.what)) {
      report_(header.place, "%rtr and %tick come before the first case");
    } else if (lines && !std::holds_alternative<NoteHeader>(header.what)) {
      report_(header.place, "the headers of a case come before its lines");
    }
    check_header(header, said);
  }

  void check_time(const Line& line, std::unordered_map<std::string, Place>& labels,
                  std::int64_t& latest) {
    const Time& time = line.time;
    if (time.base == Time::Base::kLabel && !labels.contains(time.label)) {
      report_(line.place, "no line above has the label " + quoted(time.label));
    }
    if (time.base == Time::Base::kStart && time.exact()) {
      if (time.from_terms.empty() && time.from < latest) {
        report_(line.place,
                "time goes back, from @" + std::to_string(latest) + " to " + print(time));
      }
      if (time.from_terms.empty()) latest = std::max(latest, time.from);
    }
    if (line.op == Op::kGiven && !time.exact() && time.base != Time::Base::kStart) {
      report_(line.place, "a window where something is given at one time: " + print(time));
    }
    if (line.label.empty()) return;
    if (find_parameter(line.label)) {
      report_(line.place, "label " + quoted(line.label) + " is the name of a parameter");
    }
    if (line.op == Op::kMustNot) {
      report_(line.place, "label " + quoted(line.label) + " at what does not happen");
    }
    if (line.op == Op::kMay) {
      report_(line.place, "label " + quoted(line.label) + " at what need not happen");
    }
    const auto [at, fresh] = labels.emplace(line.label, line.place);
    if (!fresh) {
      report_(line.place, "label " + quoted(line.label) + " is already in line " +
                              std::to_string(at->second.line));
    }
  }

  void check_line(const Line& line, const Scope& scope, BoundNames& bound) {
    for (const std::string& one : line.requirements) {
      if (!known_requirements().contains(one)) {
        report_(line.place, "no requirement " + quoted(one) + " in the catalogue");
      }
    }
    const std::optional<LinkKind> link = scope.link(line.link);
    if (!link) {
      report_(line.place, "unknown link " + quoted(line.link) +
                              ": r... is a radio, ser... a serial line, else peis, app, power or "
                              "what %link names");
      return;
    }
    if (!is_fault(line.op)) check_ends(line, *link, scope);
    if (line.op == Op::kGiven && *link == LinkKind::kAny) {
      report_(line.place, "'*' says nothing of the link by which it is given");
    }
    check_message(line, *link, bound, report_);
  }

  void check_ends(const Line& line, LinkKind link, const Scope& scope) {
    if (line.node == "*") {
      if (line.op == Op::kGiven) report_(line.place, "'*' says nothing of who is given it");
      return;
    }
    const NodeHeader* node = scope.node(line.node);
    if (!node) return report_(line.place, "no %node " + quoted(line.node));
    const bool has = link == LinkKind::kApp || link == LinkKind::kPower || link == LinkKind::kAny ||
                     (link == LinkKind::kRadio && node->role != Role::kBaseStation) ||
                     (link == LinkKind::kSerial && node->role != Role::kMote) ||
                     (link == LinkKind::kPeis && node->role == Role::kBaseStation);
    if (!has) {
      report_(line.place, "a " + std::string(role_text(node->role)) + " is not on " +
                              quoted(line.link) + ", which is " + std::string(link_text(link)));
    }
    for (const LinkHeader& one : scope.links) {
      if (one.name == line.link && !one.nodes.empty() &&
          std::find(one.nodes.begin(), one.nodes.end(), line.node) == one.nodes.end()) {
        report_(line.place, quoted(line.node) + " is not on the link " + quoted(line.link));
      }
    }
  }

  const File& file_;
  const Report& report_;
  bool first_ = false;
};

}  // namespace

void add_diagnostic(Parsed& parsed, Place place, std::string text) {
  if (parsed.diagnostics.size() < Parsed::kDiagnosticsMax) {
    parsed.diagnostics.push_back({place, std::move(text)});
  } else {
    ++parsed.dropped;
  }
}

void check(Parsed& parsed) {
  const Report report = [&](Place place, std::string text) {
    add_diagnostic(parsed, place, std::move(text));
  };
  FileCheck(parsed.file, report).run();
}

std::vector<Diagnostic> check(const File& file) {
  std::vector<Diagnostic> found;
  const Report report = [&](Place place, std::string text) {
    found.push_back({place, std::move(text)});
  };
  FileCheck(file, report).run();
  return found;
}

}  // namespace rubric::trace
