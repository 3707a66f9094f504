#include "conformance/runner/run_case.h"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "conformance/events/app_events.h"
#include "conformance/runner/expectation.h"
#include "conformance/runner/node_log.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"

namespace rubric::runner {
namespace {

using trace::Line;
using trace::Op;

constexpr Ticks kLateTicks = 1500;  // How far beyond its time a missing output is looked for.

// One case on its way.
class Run {
 public:
  Run(const trace::File& file, const trace::Case& one, const TargetFactory& make)
      : case_(one), scope_(trace::scope_of(file, one)) {
    for (const trace::NodeHeader& header : scope_.nodes) {
      if (header.iut) add_node(header, make);
    }
  }

  CaseResult finish() {
    CaseResult result;
    result.name = case_.name;
    try {
      if (nodes_.empty()) throw std::runtime_error("no node of this case is under test");
      for (const Line* line : case_.lines()) {
        if (!work(*line, result)) break;
      }
      judge_forbidden(result);
    } catch (const trace::TraceError& error) {
      result.failures.push_back({error.place(), {}, false, now_, "", error.what()});
      result.verdict = CaseVerdict::kError;
    } catch (const std::exception& error) {
      result.failures.push_back({case_.place, {}, false, now_, "", error.what()});
      result.verdict = CaseVerdict::kError;
    }
    write_log(result);
    return result;
  }

 private:
  struct Pending {  // Looked at when the case is over.
    const Line* line;
    Window window;
  };

  void add_node(const trace::NodeHeader& header, const TargetFactory& make) {
    NodeLog& node = nodes_.emplace_back(scope_, case_, header, make(header));
    node.target().reset(config_of(scope_, header));
    for (const Line* line : case_.lines()) {
      if (line->node == header.name && line->message.name == "linkack") ++node.link_acks_to_come;
    }
    node.target().hold_link_acks(node.link_acks_to_come > 0);
  }

  NodeLog* node_of(const Line& line) {
    const auto found = std::find_if(nodes_.begin(), nodes_.end(), [&](const NodeLog& node) {
      return node.name() == line.node;
    });
    return found == nodes_.end() ? nullptr : &*found;
  }

  Window window_of(const Line& line) const {
    Ticks base = 0;
    if (line.time.base == trace::Time::Base::kPrevious) base = previous_;
    if (line.time.base == trace::Time::Base::kLabel) {
      const auto found = labels_.find(line.time.label);
      if (found == labels_.end()) {
        throw trace::TraceError(line.place, "nothing was matched at label " + line.time.label);
      }
      base = found->second;
    }
    return {base + ticks_of(scope_.tick, line.time.from),
            base + ticks_of(scope_.tick, line.time.to)};
  }

  void matched(const Line& line, Ticks time) {
    previous_ = time;
    if (!line.label.empty()) labels_[line.label] = time;
  }

  void run_until(Ticks time) {
    now_ = std::max(now_, time);
    for (NodeLog& node : nodes_) node.run_until(now_);
  }

  // The next time at which a node does something by itself, if that is not after `end`.
  std::optional<Ticks> next_until(Ticks end) const {
    std::optional<Ticks> soonest;
    for (const NodeLog& node : nodes_) {
      const auto next = node.target().next();
      if (next && *next <= end) soonest = std::min(*next, soonest.value_or(*next));
    }
    return soonest;
  }

  // False when the case cannot go on.
  bool work(const Line& line, CaseResult& result) {
    const Window window = window_of(line);
    NodeLog* node = node_of(line);
    if (!node) {  // Faults of a link, and what nodes do that are not under test: for the reader.
      if (line.op != Op::kMustNot && line.op != Op::kMay) matched(line, window.from);
      return true;
    }
    switch (line.op) {
      case Op::kGiven:
        give(*node, line, window.from);
        return true;
      case Op::kEmits:
        return expect(*node, line, window, result);
      case Op::kMustNot:
        forbidden_.push_back({&line, window});
        return true;
      case Op::kMay:
        allowed_.push_back({&line, window});
        return true;
      default:
        return true;
    }
  }

  void give(NodeLog& node, const Line& line, Ticks time) {
    while (const auto next = next_until(time)) run_until(*next);
    run_until(time);
    node.give(line, now_, scope_, bindings_);
    matched(line, now_);
  }

  bool expect(NodeLog& node, const Line& line, const Window& window, CaseResult& result) {
    while (true) {
      if (const Output* output = node.take(line, window, bindings_)) {
        matched(line, output->time);
        return true;
      }
      const auto next = next_until(window.to);
      if (!next) break;
      run_until(*next);
    }
    run_until(window.to);
    if (const Output* output = node.take(line, window, bindings_)) {
      matched(line, output->time);
      return true;
    }
    while (const auto next = next_until(window.to + kLateTicks)) run_until(*next);
    fail(result, line, window.to, node.nearest_miss(line, window, bindings_));
    return false;
  }

  void judge_forbidden(CaseResult& result) {
    Ticks end = now_;
    for (const Pending& one : forbidden_) end = std::max(end, one.window.to);
    while (const auto next = next_until(end)) run_until(*next);
    run_until(end);
    for (const Pending& one : allowed_) {
      node_of(*one.line)->allow(*one.line, one.window, bindings_);
    }
    for (const Pending& one : forbidden_) {
      const Output* output = node_of(*one.line)->forbidden(*one.line, one.window, bindings_);
      if (!output) continue;
      fail(result, *one.line, output->time,
           fmt::format("at {} it emitted {}", output->time,
                       node_of(*one.line)->text_of(*output)));
    }
    std::stable_sort(result.failures.begin(), result.failures.end(),
                     [](const Failure& a, const Failure& b) { return a.time < b.time; });
  }

  void fail(CaseResult& result, const Line& line, Ticks time, std::string text) {
    Failure failure{line.place, line.requirements, is_weak(line), time, trace::print(line),
                    std::move(text)};
    result.verdict = std::max(result.verdict,
                              failure.weak ? CaseVerdict::kWeak : CaseVerdict::kFail);
    result.failures.push_back(std::move(failure));
  }

  void write_log(CaseResult& result) const {
    std::vector<LoggedLine> all;
    for (const NodeLog& node : nodes_) {
      all.insert(all.end(), node.log().begin(), node.log().end());
    }
    std::stable_sort(all.begin(), all.end(), [](const LoggedLine& a, const LoggedLine& b) {
      return a.time < b.time;
    });
    result.log = trace::Case(case_.name);
    for (LoggedLine& one : all) result.log.add(std::move(one.line));
  }

  const trace::Case& case_;
  const trace::Scope scope_;
  std::vector<NodeLog> nodes_;
  std::vector<Pending> forbidden_;
  std::vector<Pending> allowed_;
  std::map<std::string, Ticks, std::less<>> labels_;
  trace::Bindings bindings_;
  Ticks previous_ = 0;
  Ticks now_ = 0;
};

}  // namespace

CaseResult run_case(const trace::File& file, const trace::Case& one, const TargetFactory& make) {
  return Run(file, one, make).finish();
}

std::string explain(const CaseResult& result, const std::string& file_name) {
  std::string out;
  for (const Failure& failure : result.failures) {
    out += fmt::format("{}:{}: {}: ", file_name, failure.place.line, result.name);
    out += failure.requirements.empty()
               ? "no rule"
               : fmt::format("{}", fmt::join(failure.requirements, " "));
    out += failure.weak ? " (weak)\n" : "\n";
    if (!failure.expected.empty()) out += fmt::format("  expected  {}\n", failure.expected);
    out += fmt::format("  but       {}\n", failure.text);
  }
  return out;
}

}  // namespace rubric::runner
