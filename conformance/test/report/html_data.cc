#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "codec/reflect/fault_text.h"
#include "codec/text/text.h"
#include "conformance/report/sequence_svg.h"
#include "conformance/test/report/case_source.h"
#include "conformance/test/report/chart.h"
#include "conformance/test/report/frame_view.h"
#include "conformance/test/report/html.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/report/words.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"

namespace rubric::suite {
namespace {

using Json = nlohmann::ordered_json;
using trace::Line;

Json implementation(const SuiteRun& run, std::size_t index) {
  const ImplementationRun& one = run.implementations[index];
  const RuleTotals totals = rule_totals(one);
  Json out = implementation_json(one);
  out["label"] = implementation_name(run, index);
  out["outside"] = outside_headline(one);
  out["incomplete"] = one.dishonest.empty() ? incomplete(run, one) : std::string();
  out["stderr"] = one.stderr_text;
  out["rules"] = {{"all", totals.all},
                  {"kept", totals.kept},
                  {"broken", totals.broken},
                  {"suspected", totals.suspected},
                  {"undecided", totals.undecided},
                  {"untried", totals.untried}};
  return out;
}

/// Collects the frames of all logs, each once.
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
    frames_.push_back(
        {{"hex", view.hex}, {"text", trace::print(line.message)}, {"fields", std::move(fields)}});
    return found->second;
  }

  Json take() { return std::move(frames_); }

 private:
  std::map<std::pair<trace::LinkKind, std::string>, std::size_t> known_;
  Json frames_ = Json::array();
};

/// Charts of all cases, each of them once.
class Charts {
 public:
  /// Null where there is nothing to draw. Of many rows only those around the first that is marked.
  Json index_of(report::Sequence sequence) {
    std::vector<report::SequenceRow>& rows = sequence.rows;
    if (rows.empty()) return nullptr;
    std::string title = text::counted(rows.size(), "event");
    if (rows.size() > kRowsMax) {
      title = fmt::format("{} of {}", kRowsMax, title);
      const auto marked =
          std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.marked; });
      const auto at = marked == rows.end() ? 0 : marked - rows.begin();
      const auto half = static_cast<std::ptrdiff_t>(kRowsMax / 2);
      const auto last = static_cast<std::ptrdiff_t>(rows.size() - kRowsMax);
      const auto from = std::clamp<std::ptrdiff_t>(at - half, 0, last);
      rows.erase(rows.begin(), rows.begin() + from);
      rows.resize(kRowsMax);
    }
    const std::string svg =
        report::sequence_svg(sequence, {"chart", "Sequence chart: " + title, true});
    const auto [found, added] = known_.try_emplace(svg, charts_.size());
    if (added) charts_.push_back(svg);
    return found->second;
  }

  Json take() { return std::move(charts_); }

 private:
  static constexpr std::size_t kRowsMax = 400;

  std::map<std::string, std::size_t> known_;
  Json charts_ = Json::array();
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
      implementations.back()["join"] = join(i);
      for (std::size_t k = 0; k < run_.implementations[i].cases.size(); ++k) add(i, k);
    }
    return {{"profile", run_.profile},
            {"seed", std::to_string(run_.seed)},  // Beyond what numbers of a script hold.
            {"shard", run_.shard},
            {"traces", run_.traces},
            {"earlier", earlier_ != nullptr},
            {"gone", gone()},
            {"stale", stale_json(run_)},
            {"rules", rules()},
            {"roles", trace::role_names()},
            {"implementations", std::move(implementations)},
            {"frames", frames_.take()},
            {"charts", charts_.take()},
            {"cases", std::move(cases_)}};
  }

 private:
  void add(std::size_t implementation, std::size_t index) {
    const CaseRun& one = run_.implementations[implementation].cases[index];
    const auto [found, added] = by_name_.try_emplace(one.name, cases_.size());
    rules_.insert(one.requirements.begin(), one.requirements.end());
    Json run = case_json(one);
    Json blank = Json::object();  // What all its runs have in common.
    for (const char* key : {"name", "file", "comment", "roles", "requirements"}) {
      blank[key] = std::move(run[key]);
      run.erase(key);
    }
    if (added) {
      blank["source"] = source(one);
      blank["runs"] = Json::array();
      cases_.push_back(std::move(blank));
    }
    add_to(run, implementation, index);
    cases_[found->second]["runs"].push_back(std::move(run));
  }

  Json source(const CaseRun& one) {
    Json out = Json::array();
    for (const SourceLine& line : sources_.of(run_, one)) out.push_back({line.number, line.text});
    return out;
  }

  void add_to(Json& out, std::size_t i, std::size_t index) {
    const CaseRun& one = run_.implementations[i].cases[index];
    const trace::Case its_log = one.result.log.read();
    const std::vector<const Line*> lines = its_log.lines();
    for (std::size_t k = 0; k < one.result.failures.size(); ++k) {
      add_to(out["failures"][k], one.result.failures[k], lines);
    }
    out["implementation"] = i;
    out["earlier"] = earlier_ ? earlier_verdict(*earlier_, run_, i, one) : std::string();
    out["headline"] = headline(one);
    out["profile"] = one.profile;
    out["seed"] = std::to_string(one.seed);
    out["replay"] = replay_command(run_, run_.implementations[i], one);
    out["rtr"] = links_[i][index].rtr;
    out["pcapng"] = links_[i][index].pcapng;
    out["nodes"] = nodes_of(one);
    out["chart"] = charts_.index_of(failure_chart(one));
    out["log"] = log(one, lines);
  }

  // The paper's figure, of the best run for it: one that passed, of a case that was made for it.
  Json join(std::size_t implementation) {
    static constexpr std::array kCases = {"timeline", "j4.accept", "home.network"};
    const CaseRun* best = nullptr;
    std::pair<bool, std::ptrdiff_t> best_rank;
    for (const CaseRun& one : run_.implementations[implementation].cases) {
      const std::pair rank(one.result.verdict > runner::CaseVerdict::kWeak,
                           std::find(kCases.begin(), kCases.end(), one.name) - kCases.begin());
      if ((best && best_rank <= rank) || !join_chart(one)) continue;
      best = &one;
      best_rank = rank;
    }
    if (!best) return nullptr;
    return {{"name", best->name},
            {"repeat", best->repeat},
            {"chart", charts_.index_of(*join_chart(*best))}};
  }

  Json gone() const {
    Json out = Json::array();
    if (!earlier_) return out;
    for (const Change& one : compare(run_, *earlier_).gone) {
      out.push_back(
          {{"implementation", one.implementation}, {"name", one.case_name}, {"was", one.was}});
    }
    return out;
  }

  void add_to(Json& out, const runner::Failure& one, const std::vector<const Line*>& lines) {
    const auto row = std::find_if(lines.begin(), lines.end(),
                                  [&](const Line* line) { return is_broken_by(one, *line); });
    for (const std::string& name : one.rules()) {
      const ReqId id = trace::requirement_id(name);
      if (id != ReqId::kNone) rules_.insert(id);
    }
    out["forbidden"] = one.forbidden;
    out["from"] = one.from;
    out["to"] = one.to;
    out["row"] = row == lines.end() ? -1 : row - lines.begin();
  }

  static Json nodes_of(const CaseRun& one) {
    Json out = Json::array();
    for (const trace::NodeHeader& node : one.nodes) {
      Json added = {{"name", node.name}, {"role", trace::role_text(node.role)}, {"iut", node.iut}};
      if (node.id) added["id"] = *node.id;
      if (node.island) added["island"] = *node.island;
      out.push_back(std::move(added));
    }
    return out;
  }

  // Returns the log without empty keys: logs are most of the page.
  Json log(const CaseRun& one, const std::vector<const Line*>& lines) {
    trace::Scope scope{.nodes = one.nodes, .links = one.links};
    Json out = Json::array();
    for (const Line* each : lines) {
      const Line& line = *each;
      const trace::LinkKind kind = scope.link(line.link).value_or(trace::LinkKind::kAny);
      Json row = {{"time", line.time.from},         {"node", line.node},
                  {"op", trace::op_text(line.op)},  {"link", line.link},
                  {"kind", trace::link_text(kind)}, {"short", short_text(line.message)}};
      if (line.bytes) {
        row["frame"] = frames_.index_of(line, kind);
      } else {
        row["text"] = trace::print(line.message);
      }
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
  Charts charts_;
  std::set<ReqId, reflect::CatalogueOrder> rules_;
  std::map<std::string, std::size_t> by_name_;
  Json cases_ = Json::array();
};

}  // namespace

std::string html_data(const SuiteRun& run, const EarlierRun* earlier,
                      const std::vector<std::vector<CaseLinks>>& links) {
  // Text from implementations need not be UTF-8.
  const std::string text =
      Data(run, earlier, links).take().dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {  // "<" occurs within strings only.
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace rubric::suite
