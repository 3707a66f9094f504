#include "conformance/suite/report/html_data.h"

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "codec/reflect/fault_text.h"
#include "conformance/suite/report/case_source.h"
#include "conformance/suite/report/frame_view.h"
#include "conformance/suite/report/log_lines.h"
#include "conformance/suite/report/words.h"
#include "conformance/trace/print.h"

namespace rubric::suite {
namespace {

using Json = nlohmann::ordered_json;
using trace::Line;

Json roles_of(const std::vector<machine::Role>& all) {
  Json out = Json::array();
  for (const machine::Role role : all) out.push_back(role_text(role));
  return out;
}

Json implementation(const SuiteRun& run, std::size_t index) {
  const ImplementationRun& one = run.implementations[index];
  const VerdictCounts counted = count(one);
  Json counts = Json::object();
  for (const runner::CaseVerdict verdict : kVerdicts) {
    const auto found = counted.find(verdict);
    counts[std::string(runner::verdict_text(verdict))] =
        found == counted.end() ? 0 : found->second;
  }
  const RuleTotals totals = rule_totals(one);
  return {{"label", implementation_name(run, index)},
          {"name", one.identity.name},
          {"version", one.identity.version},
          {"target", one.target},
          {"roles", roles_of(one.identity.roles)},
          {"real_time", one.identity.real_time},
          {"wall_ms", one.wall_ms},
          {"dishonest", one.dishonest},
          {"outside", outside_headline(one)},
          {"stderr", one.stderr_text},
          {"counts", std::move(counts)},
          {"rules", {{"all", totals.all},
                     {"kept", totals.kept},
                     {"broken", totals.broken},
                     {"undecided", totals.undecided},
                     {"untried", totals.untried}}}};
}

/// Frames of all logs, each of them once.
class Frames {
 public:
  std::size_t index_of(const Line& line, trace::LinkKind kind) {
    const auto [found, added] = known_.try_emplace({kind, *line.bytes}, frames_.size());
    if (!added) return found->second;
    const FrameView view = view_frame(*line.bytes, kind);
    Json fields = Json::array();
    for (const FrameField& field : view.fields) {
      fields.push_back({field.offset_bytes, field.size_bytes, field.path, field.value});
    }
    frames_.push_back({{"hex", view.hex},
                       {"text", trace::print(line.message)},
                       {"fields", std::move(fields)}});
    return found->second;
  }

  Json take() { return std::move(frames_); }

 private:
  std::map<std::pair<trace::LinkKind, std::string>, std::size_t> known_;
  Json frames_ = Json::array();
};

class Data {
 public:
  Data(const SuiteRun& run, const EarlierRun* earlier,
       const std::vector<std::vector<CaseLinks>>& links)
      : run_(run), earlier_(earlier), links_(links) {}

  Json take() {
    Json implementations = Json::array();
    for (std::size_t i = 0; i < run_.implementations.size(); ++i) {
      implementations.push_back(implementation(run_, i));
      for (std::size_t k = 0; k < run_.implementations[i].cases.size(); ++k) add(i, k);
    }
    Json stale = Json::array();
    for (const StaleExpectation& one : run_.stale) {
      stale.push_back({{"place", one.place}, {"text", one.text}});
    }
    return {{"profile", run_.profile},
            {"seed", std::to_string(run_.seed)},  // Beyond what numbers of a script hold.
            {"shard", run_.shard},
            {"traces", run_.traces},
            {"earlier", earlier_ != nullptr},
            {"gone", gone()},
            {"stale", std::move(stale)},
            {"rules", rules()},
            {"implementations", std::move(implementations)},
            {"frames", frames_.take()},
            {"cases", std::move(cases_)}};
  }

 private:
  void add(std::size_t implementation, std::size_t index) {
    const CaseRun& one = run_.implementations[implementation].cases[index];
    const auto [found, added] = by_name_.try_emplace(one.name, cases_.size());
    if (added) cases_.push_back(blank(one));
    for (const ReqId id : one.requirements) rules_.insert(id);
    cases_[found->second]["runs"].push_back(worked(implementation, index));
  }

  Json blank(const CaseRun& one) {
    Json ids = Json::array();
    for (const ReqId id : one.requirements) ids.push_back(trace::requirement_text(id));
    Json source = Json::array();
    for (const SourceLine& line : sources_.of(run_, one)) {
      source.push_back({line.number, line.text});
    }
    return {{"name", one.name},
            {"file", one.file},
            {"comment", one.comment},
            {"roles", roles_of(one.roles)},
            {"rules", std::move(ids)},
            {"source", std::move(source)},
            {"runs", Json::array()}};
  }

  Json worked(std::size_t i, std::size_t index) {
    const ImplementationRun& implementation = run_.implementations[i];
    const CaseRun& one = implementation.cases[index];
    const std::vector<const Line*> lines = one.result.log.lines();
    Json failures = Json::array();
    for (const runner::Failure& each : one.result.failures) {
      failures.push_back(failure(each, one.nodes, lines));
    }
    return {{"implementation", i},
            {"repeat", one.repeat},
            {"verdict", runner::verdict_text(one.result.verdict)},
            {"unexpected", one.unexpected()},
            {"expectation", expectation_text(one.expectation)},
            {"expected_reason", one.expected_reason},
            {"earlier", earlier_ ? earlier_verdict(*earlier_, run_, i, one) : std::string()},
            {"headline", headline(one)},
            {"reason", one.result.reason},
            {"profile", one.profile},
            {"seed", std::to_string(one.seed)},
            {"wall_ms", one.wall_ms},
            {"length_ticks", one.result.length},
            {"stderr", one.stderr_text},
            {"replay", replay_command(run_, implementation, one)},
            {"rtr", links_[i][index].rtr},
            {"pcapng", links_[i][index].pcapng},
            {"nodes", nodes_of(one)},
            {"failures", std::move(failures)},
            {"log", log(one, lines)}};
  }

  Json gone() const {
    Json out = Json::array();
    if (!earlier_) return out;
    for (const Change& one : compare(run_, *earlier_).gone) {
      out.push_back({{"implementation", one.implementation},
                     {"name", one.case_name},
                     {"was", one.was}});
    }
    return out;
  }

  Json failure(const runner::Failure& one, const std::vector<trace::NodeHeader>& nodes,
               const std::vector<const Line*>& lines) {
    const std::optional<Line> asked = asked_line(one);
    Json row = -1;
    for (std::size_t i = 0; i < lines.size() && row == -1; ++i) {
      if (is_broken_by(one, *lines[i])) row = i;
    }
    for (const std::string& name : one.requirements) {
      const ReqId id = trace::requirement_id(name);
      if (id != ReqId::kNone) rules_.insert(id);
    }
    return {{"rules", one.requirements},
            {"weak", one.weak},
            {"forbidden", one.forbidden},
            {"line", one.place.line},
            {"time", one.time},
            {"from", one.from},
            {"to", one.to},
            {"expected", one.expected},
            {"text", one.text},
            {"node", asked ? asked->node : ""},
            {"link", asked ? asked->link : ""},
            {"short", asked ? short_text(asked->message) : ""},
            {"peers", asked ? peers_of(nodes, *asked) : std::vector<std::size_t>()},
            {"row", row}};
  }

  static Json nodes_of(const CaseRun& one) {
    Json out = Json::array();
    for (const trace::NodeHeader& node : one.nodes) {
      Json added = {{"name", node.name},
                    {"role", trace::role_text(node.role)},
                    {"iut", node.iut}};
      if (node.id) added["id"] = *node.id;
      if (node.island) added["island"] = *node.island;
      out.push_back(std::move(added));
    }
    return out;
  }

  // Keys that would say nothing are left out: logs are most of the page.
  Json log(const CaseRun& one, const std::vector<const Line*>& lines) {
    trace::Scope scope;
    scope.nodes = one.nodes;
    scope.links = one.links;
    const std::vector<std::size_t> before = first_seen(lines);
    Json out = Json::array();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Line& line = *lines[i];
      const trace::LinkKind kind = scope.link(line.link).value_or(trace::LinkKind::kAny);
      Json row = {{"time", line.time.from},
                  {"node", line.node},
                  {"op", trace::op_text(line.op)},
                  {"link", line.link},
                  {"kind", trace::link_text(kind)},
                  {"short", short_text(line.message)}};
      if (line.bytes) {
        row["frame"] = frames_.index_of(line, kind);
      } else {
        row["text"] = trace::print(line.message);
      }
      const std::vector<std::size_t> peers = peers_of(one.nodes, line);
      if (!peers.empty()) row["peers"] = peers;
      if (before[i] != kNoLine) row["of"] = before[i];
      out.push_back(std::move(row));
    }
    return out;
  }

  Json rules() const {
    Json out = Json::object();
    for (const ReqId id : rules_) {  // ReqId counts in the catalogue's order.
      const reflect::Requirement& rule = reflect::requirement(id);
      out[rule.id] = {{"level", rule.level},
                      {"clause", rule.clause},
                      {"sentence", rule.sentence},
                      {"source", rule.source},
                      {"deployed", rule.deployed}};
    }
    return out;
  }

  const SuiteRun& run_;
  const EarlierRun* earlier_;
  const std::vector<std::vector<CaseLinks>>& links_;
  CaseSources sources_;
  Frames frames_;
  std::set<ReqId, reflect::CatalogueOrder> rules_;
  std::map<std::string, std::size_t> by_name_;
  Json cases_ = Json::array();
};

}  // namespace

std::string html_data(const SuiteRun& run, const EarlierRun* earlier,
                      const std::vector<std::vector<CaseLinks>>& links) {
  // What implementations say of themselves need not be UTF-8.
  const std::string text =
      Data(run, earlier, links).take().dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {  // "<" stands within strings only.
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace rubric::suite
