#include "conformance/test/runner/run_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>

#include "conformance/test/runner/dependence.h"
#include "conformance/test/runner/expectation.h"
#include "conformance/test/runner/node_log.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/events/parameters.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"

namespace rubric::runner {
namespace {

using trace::Line;
using trace::Op;

constexpr Ticks kLateTicks = 1500;  // How long a missing output is awaited beyond its time.

// One case while it runs.
class Run {
 public:
  Run(const trace::File& file, const trace::Case& one, const TargetFactory& make)
      : case_(one), scope_(trace::scope_of(file, one)), make_(make), place_(one.place) {}

  CaseResult finish() {
    CaseResult result;
    result.name = case_.name;
    try {
      start();
      for (const Line* line : case_.lines()) {
        place_ = line->place;
        if (!work(*line, result)) break;
      }
      judge_forbidden(result);
      if (!unseen_.empty() && result.verdict < CaseVerdict::kInconclusive) {
        result.verdict = CaseVerdict::kInconclusive;
        result.reason = unseen_;
      }
    } catch (const Unsupported& error) {
      judge_what_came(result);
      if (result.verdict < CaseVerdict::kFail) {
        result.failures.clear();
        result.verdict = CaseVerdict::kSkip;
      }
      result.reason = error.what();
    } catch (const trace::TraceError& error) {
      broken(result, error.place(), error.what());
    } catch (const std::exception& error) {
      broken(result, place_, error.what());
    }
    result.length = now_;
    write_log(result);
    return result;
  }

 private:
  struct Pending {  // Judged when the case is over.
    const Line* line;
    Window window;
  };

  void start() {
    for (const trace::NodeHeader& header : scope_.nodes) {
      if (header.iut) nodes_.emplace_back(scope_, case_, header, make_(header));
    }
    if (nodes_.empty()) throw std::runtime_error("no node of this case is under test");
    // Resets nodes when all are there: in real time the first ones would be far ahead of one whose
    // process has yet to start.
    auto node = nodes_.begin();
    for (const trace::NodeHeader& header : scope_.nodes) {
      if (header.iut) reset(*node++, header);
    }
  }

  void reset(NodeLog& node, const trace::NodeHeader& header) {
    node.target().reset(config_of(scope_, header));
    for (const Line* line : case_.lines()) {
      if (line->node == header.name && line->message.name == "linkack") ++node.link_acks_to_come;
    }
    node.target().hold_link_acks(node.link_acks_to_come > 0);
  }

  NodeLog* node_of(const Line& line) {
    const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                    [&](const NodeLog& node) { return node.name() == line.node; });
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
    const Window window{base + amount(line, line.time.from, line.time.from_terms),
                        base + amount(line, line.time.to, line.time.to_terms)};
    if (window.to < window.from) {
      throw trace::TraceError(
          line.place, fmt::format("{} is no time with what is stated: {} to {}",
                                  trace::print(line.time), window.from - base, window.to - base));
    }
    return window;
  }

  // Returns the ticks of a time, its parameters included, with the values of the line's node.
  Ticks amount(const Line& line, std::int64_t number, const std::vector<trace::Term>& terms) const {
    const Ticks size = ticks_of(scope_.tick, std::abs(number));
    std::int64_t sum = number < 0 ? -static_cast<std::int64_t>(size) : size;
    for (const trace::Term& term : terms) sum += term.factor * value(line.node, term.parameter);
    return static_cast<Ticks>(std::max<std::int64_t>(sum, 0));
  }

  // Nodes that state nothing themselves, since the trace plays them, are taken for the others'
  // like.
  std::int64_t value(std::string_view name, trace::ParameterId id) const {
    const trace::NodeHeader* const own = scope_.node(name);
    if (const std::int64_t* stated = own ? find(own->stated, id) : nullptr) return *stated;
    for (const trace::NodeHeader& node : scope_.nodes) {
      const std::int64_t* const stated = node.iut ? find(node.stated, id) : nullptr;
      if (stated) return *stated;
    }
    return events::assumed(profile_of(scope_), id);
  }

  void matched(const Line& line, Ticks time) {
    previous_ = time;
    if (!line.label.empty()) labels_[line.label] = time;
  }

  // Lets time pass to `end`, or to the first instant at which a node may emit something. A node
  // alone stops there by itself; several go on together.
  void pass(Ticks end) {
    Ticks to = std::max(end, now_);
    if (nodes_.size() == 1) {
      now_ = std::max(now_, nodes_[0].run_until(to));
      return;
    }
    for (const NodeLog& node : nodes_) {
      const auto next = node.target().next();
      if (next) to = std::min(to, std::max(*next, now_));
    }
    for (NodeLog& node : nodes_) {
      while (node.run_until(to) < to) {
      }
    }
    now_ = to;
  }
  void pass_all(Ticks end) {
    do pass(end);
    while (now_ < end);
  }

  // Runs a line. Returns false if the case cannot go on.
  bool work(const Line& line, CaseResult& result) {
    const Window window = window_of(line);
    NodeLog* node = node_of(line);
    if (!node) {  // Faults of a link, and what nodes do that are not under test: for the reader.
      if (line.op != Op::kMustNot && line.op != Op::kMay) matched(line, window.from);
      return true;
    }
    if (!is_seen(*node, line)) {
      // A visible output may break a rule about every link; a part of the links cannot show that it
      // was kept.
      if (line.op == Op::kMustNot && is_seen_in_part(*node, line)) {
        forbidden_.push_back({&line, window});
      }
      return pass_over(line);
    }
    switch (line.op) {
      case Op::kGiven: give(*node, line, window.from); return true;
      case Op::kEmits: return expect(*node, line, window, result);
      case Op::kMustNot: forbidden_.push_back({&line, window}); return true;
      case Op::kMay: allowed_.push_back({&line, window}); return true;
      default: return true;
    }
  }

  bool is_seen(const NodeLog& node, const Line& line) const {
    const Reach reach = node.target().reach();
    switch (scope_.link(line.link).value_or(trace::LinkKind::kAny)) {
      case trace::LinkKind::kRadio: return reach.radio;
      case trace::LinkKind::kSerial: return reach.serial;
      case trace::LinkKind::kPeis: return reach.peis;
      case trace::LinkKind::kApp:
      case trace::LinkKind::kPower: return reach.app;
      case trace::LinkKind::kAny: return line.op == Op::kMay || sees_all(reach);
    }
    return true;
  }
  static bool sees_all(const Reach& reach) {
    return reach.radio && reach.serial && reach.peis && reach.app;
  }

  bool is_seen_in_part(const NodeLog& node, const Line& line) const {
    const Reach reach = node.target().reach();
    return scope_.link(line.link).value_or(trace::LinkKind::kAny) == trace::LinkKind::kAny &&
           (reach.radio || reach.serial || reach.peis || reach.app);
  }

  // Passes over a line of which the target shows nothing, or not all. Returns false if the case
  // cannot go on without it.
  bool pass_over(const Line& line) {
    const bool needed =
        line.op == Op::kGiven || (line.op == Op::kEmits && is_needed_later(case_, line));
    if (unseen_.empty() || needed) {
      unseen_ = fmt::format("line {}: the target does not show {}", line.place.line,
                            line.link == "*" ? "all its links" : line.link);
    }
    return !needed;
  }

  void give(NodeLog& node, const Line& line, Ticks time) {
    pass_all(time);
    node.give(line, now_, scope_, bindings_);
    matched(line, now_);
  }

  bool expect(NodeLog& node, const Line& line, const Window& window, CaseResult& result) {
    const Tolerance tolerance = node.target().tolerance();
    const Window wide{window.from - std::min(window.from, tolerance.early),
                      window.to + tolerance.late};
    while (true) {
      if (const Output* output = node.take(line, wide, bindings_)) {
        matched(line, output->time);
        return true;
      }
      if (now_ >= wide.to) break;
      pass(wide.to);
    }
    pass_all(wide.to + kLateTicks);
    fail(result, line, window, wide.to, node.nearest_miss(line, wide, bindings_));
    return false;
  }

  // Returns the span that a `!>` line surely forbids, where the target's times are not exact.
  static Window narrowed(const Window& window, const Tolerance& tolerance) {
    return {window.from + tolerance.late, window.to - std::min(window.to, tolerance.early)};
  }

  void judge_forbidden(CaseResult& result) {
    Ticks end = now_;
    for (const Pending& one : forbidden_) end = std::max(end, one.window.to);
    pass_all(end);
    judge_outputs(result);
  }

  // Judges after the target stopped, by the outputs so far. Of the lines that were not reached,
  // those that forbid count if their window is known; the others may take outputs.
  void judge_what_came(CaseResult& result) {
    bool reached = true;
    for (const Line* line : case_.lines()) {
      if (!reached && node_of(*line)) {
        const bool known = line->time.base == trace::Time::Base::kStart ||
                           (line->time.base == trace::Time::Base::kLabel &&
                            labels_.find(line->time.label) != labels_.end());
        const Window window = known ? window_of(*line) : Window{0, now_};
        if (known && line->op == Op::kMustNot) forbidden_.push_back({line, window});
        if (line->op == Op::kEmits || line->op == Op::kMay) allowed_.push_back({line, window});
      }
      if (line->place.line == place_.line) reached = false;
    }
    judge_outputs(result);
  }

  void judge_outputs(CaseResult& result) {
    for (const Pending& one : allowed_) {
      node_of(*one.line)->allow(*one.line, one.window, bindings_);
    }
    for (const Pending& one : forbidden_) {
      NodeLog& node = *node_of(*one.line);
      const Window window = narrowed(one.window, node.target().tolerance());
      const Output* output = node.forbidden(*one.line, window, bindings_);
      if (!output) continue;
      fail(result, *one.line, one.window, output->time,
           fmt::format("at {} it emitted {}", output->time, node.text_of(*output)));
    }
    std::stable_sort(result.failures.begin(), result.failures.end(),
                     [](const Failure& a, const Failure& b) { return a.time < b.time; });
  }

  void broken(CaseResult& result, trace::Place place, const char* why) {
    result.failures.push_back({place, {}, false, now_, "", why, now_, now_, false});
    result.verdict = CaseVerdict::kError;
    result.reason = why;
  }

  void fail(CaseResult& result, const Line& line, const Window& window, Ticks time,
            std::string text) {
    Failure failure{line.place,  line.requirements,  is_weak(line),
                    time,        trace::print(line), std::move(text),
                    window.from, window.to,          line.op == Op::kMustNot};
    result.verdict =
        std::max(result.verdict, failure.weak ? CaseVerdict::kWeak : CaseVerdict::kFail);
    result.failures.push_back(std::move(failure));
  }

  void write_log(CaseResult& result) const {
    std::vector<LoggedLine> all;
    for (const NodeLog& node : nodes_) {
      all.insert(all.end(), node.log().begin(), node.log().end());
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const LoggedLine& a, const LoggedLine& b) { return a.time < b.time; });
    result.log = trace::Case(case_.name);
    for (LoggedLine& one : all) result.log.add(std::move(one.line));
  }

  const trace::Case& case_;
  const trace::Scope scope_;
  const TargetFactory& make_;
  trace::Place place_;  // Place of the current line.
  std::string unseen_;  // The first line of which the target shows nothing.
  std::vector<NodeLog> nodes_;
  std::vector<Pending> forbidden_;
  std::vector<Pending> allowed_;
  std::map<std::string, Ticks, std::less<>> labels_;
  trace::Bindings bindings_;
  Ticks previous_ = 0;
  Ticks now_ = 0;
};

}  // namespace

std::string_view verdict_text(CaseVerdict verdict) {
  switch (verdict) {
    case CaseVerdict::kPass: return "pass";
    case CaseVerdict::kWeak: return "weak";
    case CaseVerdict::kInconclusive: return "inconclusive";
    case CaseVerdict::kFail: return "fail";
    case CaseVerdict::kError: return "error";
    case CaseVerdict::kSkip: return "skip";
  }
  return "";
}

CaseResult run_case(const trace::File& file, const trace::Case& one, const TargetFactory& make) {
  return Run(file, one, make).finish();
}

std::string explain(const CaseResult& result, const std::string& file_name) {
  std::string out;
  for (const Failure& failure : result.failures) {
    out += fmt::format("{}:{}: {}: ", file_name, failure.place.line, result.name);
    out += failure.requirements.empty() ? "no rule"
                                        : fmt::format("{}", fmt::join(failure.requirements, " "));
    out += failure.weak ? " (weak)\n" : "\n";
    if (!failure.expected.empty()) out += fmt::format("  expected  {}\n", failure.expected);
    out += fmt::format("  but       {}\n", failure.text);
  }
  return out;
}

}  // namespace rubric::runner
