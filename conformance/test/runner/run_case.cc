#include "conformance/test/runner/run_case.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "conformance/test/runner/blame.h"
#include "conformance/test/runner/expectation.h"
#include "conformance/test/runner/node_log.h"
#include "conformance/test/runner/refusals.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"

namespace rubric::runner {
namespace {

using trace::Line;
using trace::Op;

constexpr std::int64_t kLastTick = INT32_MAX;  // Clocks wrap after twice that.
constexpr Ticks kGrainTicks = 10;  // Of an adapter's own clock, or of its rate in a second.
constexpr std::int64_t kRealTicksMax = 600 * machine::kTicksPerSecond;  // A wait in real time.

// Returns a number that no trace uses by chance, another one for the next seed.
std::int64_t seeded_number(std::uint64_t seed) {
  constexpr std::uint64_t kMixer = 40503;  // Odd, so that 16 bits of seed give 16 bits.
  return static_cast<std::int64_t>(1000 + ((seed + 1) * kMixer & 0xFFFF) % 60'000);
}

// One case while it runs.
class Run {
 public:
  Run(const trace::File& file, const trace::Case& one, const TargetFactory& make, Ticks access)
      : case_(one),
        scope_(trace::scope_of(file, one)),
        make_(make),
        channel_access_(access),
        place_(one.place) {
    bindings_.set(trace::kSeeded, trace::Value::of(seeded_number(scope_.seed)));
  }

  CaseResult finish() {
    CaseResult result{.name = case_.name};
    try {
      start();
      begun_ = true;
      for (const Line* line : case_.lines()) {
        place_ = line->place;
        if (!run_line(*line)) break;
      }
      judge_forbidden(result);
      if ((!unseen_.empty() || unjudged_) && result.verdict < CaseVerdict::kInconclusive) {
        result.verdict = CaseVerdict::kInconclusive;
        result.reason = unseen_.empty() ? "a window is shorter than the tolerance of its times"
                                        : fmt::format("the target does not show {}",
                                                      fmt::join(unseen_, " and "));
      }
    } catch (const Unsupported& error) {
      judge_what_came(result);
      if (result.verdict < CaseVerdict::kFail) {
        result.failures.clear();
        result.verdict = CaseVerdict::kSkip;
        result.not_built = dynamic_cast<const NotBuilt*>(&error) != nullptr;
        result.refused = dynamic_cast<const Refused*>(&error) != nullptr;
      }
      result.reason = error.what();
    } catch (const TargetBroken& error) {
      if (begun_ || dynamic_cast<const BrokenAtReset*>(&error)) {
        judge_what_came(result);
        set_died(result, error.what());
      } else {
        set_error(result, place_, error.what());
        result.failures.back().crash = true;
      }
    } catch (const trace::TraceError& error) {
      set_error(result, error.place(), error.what());
    } catch (const std::bad_alloc&) {
      throw;  // Says nothing of the case.
    } catch (const std::exception& error) {
      set_error(result, place_, error.what());
    }
    mind_damage(result);
    conclude(result, nodes_, case_.place);
    result.unseen = std::move(unseen_);
    result.length = now_;
    write_log(result);
    return result;
  }

 private:
  // When a line was matched, by the clock that its window counts from.
  struct Moment {
    Ticks time = 0;
    Ticks slack = 0;  // It may have been that much later: a stimulus takes time to hand over.
  };
  struct Timed {
    const Line* line;
    Window window;  // By the trace, from the earliest time of what it counts from.
    Ticks slack;    // Of that moment.
  };
  // An output that did not come; the lines that depend on it cannot be judged.
  struct Missing {
    Timed timed;
    Window wide;
  };
  struct Lost {
    std::set<std::string, std::less<>> labels;
    std::set<std::string> names;  // Of variables.
    bool previous = false;
  };
  struct Stimulus {
    const NodeLog* node;
    Ticks asked;  // By the trace.
    Window given;
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
    expect_patience();
  }

  // Refuses to wait for an hour where the runner does not turn the clock.
  void expect_patience() const {
    const bool real = std::any_of(nodes_.begin(), nodes_.end(), [](const NodeLog& node) {
      return node.target().tolerance().late > 0;
    });
    for (const Line* line : case_.lines()) {
      if (!real || amount(*line, line->time.from, line->time.from_terms) <= kRealTicksMax) continue;
      throw NotBuilt("it takes more than ten minutes, and time is real");
    }
  }

  void reset(NodeLog& node, const trace::NodeHeader& header) {
    at_reset_ = &node;
    node.target().start(scope_, header);
    for (const Line* line : case_.lines()) {
      if (line->node == header.name && line->message.name == "linkack") ++node.link_acks_to_come;
    }
    node.target().hold_link_acks(node.link_acks_to_come > 0);
    at_reset_ = nullptr;
  }

  NodeLog* node_of(const Line& line) {
    const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                    [&](const NodeLog& node) { return node.name() == line.node; });
    return found == nodes_.end() ? nullptr : &*found;
  }

  Timed timed(const Line& line) const {
    Moment base;
    if (line.time.base == trace::Time::Base::kPrevious) base = previous_;
    if (line.time.base == trace::Time::Base::kLabel) {
      const auto found = labels_.find(line.time.label);
      if (found == labels_.end()) {
        throw trace::TraceError(line.place, "nothing was matched at label " + line.time.label);
      }
      base = found->second;
    }
    const std::int64_t from = base.time + amount(line, line.time.from, line.time.from_terms);
    const std::int64_t to = base.time + amount(line, line.time.to, line.time.to_terms);
    if (std::max(from, to) > kLastTick) {
      throw trace::TraceError(line.place,
                              fmt::format("{} is too late: a case ends by tick {} (24 days)",
                                          trace::print(line.time), kLastTick));
    }
    const Window window{static_cast<Ticks>(from), static_cast<Ticks>(to)};
    if (is_empty(window) && (line.op != Op::kMustNot || !states_anything())) {
      throw trace::TraceError(
          line.place,
          fmt::format("{} is no time with what is stated: {} to {}", trace::print(line.time),
                      window.from - base.time, window.to - base.time));
    }
    return {&line, window, base.slack};
  }

  // A line forbids nothing where what is stated leaves no time between two frames.
  static bool is_empty(const Window& window) { return window.to < window.from; }
  bool states_anything() const {
    return channel_access_ > 0 ||
           std::any_of(scope_.nodes.begin(), scope_.nodes.end(), [](const trace::NodeHeader& node) {
             return node.iut && !node.stated.empty();
           });
  }

  // Returns the ticks of a time, its parameters included, with the values of the line's node.
  std::int64_t amount(const Line& line, std::int64_t number,
                      const std::vector<trace::Term>& terms) const {
    const std::int64_t size =
        std::abs(number) * machine::kTicksPerSecond / trace::ticks_per_second(scope_.tick);
    std::int64_t sum = number < 0 ? -size : size;
    for (const trace::Term& term : terms) sum += term.factor * value(line.node, term.parameter);
    return std::max<std::int64_t>(sum, 0);
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
    if (id == trace::ParameterId::kChannelAccess && channel_access_ > 0) return channel_access_;
    return trace::protocol().has_machine ? events::assumed(profile_of(scope_), id)
                                         : trace::parameter(id).unstated;
  }

  void matched(const Line& line, Moment moment) {
    previous_ = moment;
    lost_.previous = false;
    if (!line.label.empty()) labels_[line.label] = moment;
  }

  // Counts what did not come, or was not looked for, as if it had come at the end of its window:
  // stimuli go on from there.
  void note_missing(const Line& line, Ticks end) {
    matched(line, {end, 0});
    lost_.previous = true;
    if (!line.label.empty()) lost_.labels.insert(line.label);
    for (const std::string& name : variables_of(line)) {
      if (!bindings_.find(name)) lost_.names.insert(name);
    }
  }

  bool names_lost(const Line& line) const {
    const std::set<std::string> names = variables_of(line);
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return lost_.names.contains(name); });
  }

  // Returns whether a line counts its time from an output that did not come, or compares with it.
  bool depends_on_lost(const Line& line) const {
    using Base = trace::Time::Base;
    return (line.time.base == Base::kPrevious && lost_.previous) ||
           (line.time.base == Base::kLabel && lost_.labels.contains(line.time.label)) ||
           names_lost(line);
  }

  // Advances time to `end`, or to the first instant at which a node may emit something. A node
  // alone stops there by itself; several go on together.
  void advance(Ticks end) {
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
  void advance_fully(Ticks end) {
    do advance(end);
    while (now_ < end);
  }

  // Runs a line. Returns false if the case cannot go on.
  bool run_line(const Line& line) {
    const Timed timed = this->timed(line);
    NodeLog* node = node_of(line);
    if (!node) {  // Faults of a link, and what nodes do that are not under test: for the reader.
      if (line.op != Op::kMustNot && line.op != Op::kMay) {
        matched(line, {timed.window.from, timed.slack});
      }
      return true;
    }
    if (std::set<std::string> unseen = unseen_of(*node, line); !unseen.empty()) {
      unseen_.merge(unseen);
      // A visible output may break a rule about every link; a part of the links cannot show that it
      // was kept.
      if (line.op == Op::kMustNot && is_seen_in_part(*node, line)) forbidden_.push_back(timed);
      return can_skip(line);
    }
    if (line.op == Op::kGiven && names_lost(line)) return false;
    if (line.op != Op::kGiven && depends_on_lost(line)) {
      if (line.op != Op::kMustNot) skipped_.push_back(&line);
      if (line.op == Op::kEmits) note_missing(line, timed.window.to);
      return true;
    }
    switch (line.op) {
      case Op::kGiven: give(*node, timed); return true;
      case Op::kEmits: return expect(*node, timed);
      case Op::kMustNot:
        if (!is_empty(timed.window)) forbidden_.push_back(timed);
        return true;
      case Op::kMay: allowed_.push_back(timed); return true;
      default: return true;
    }
  }

  // Returns what a line is about and the target does not show.
  std::set<std::string> unseen_of(const NodeLog& node, const Line& line) const {
    const Reach reach = node.target().reach();
    const trace::LinkKind kind = scope_.link(line.link).value_or(trace::LinkKind::kAny);
    const bool any = kind == trace::LinkKind::kAny && line.op != Op::kMay;
    const bool app = kind == trace::LinkKind::kApp || kind == trace::LinkKind::kPower;
    std::set<std::string> out;
    if (!reach.radio && (any || kind == trace::LinkKind::kRadio)) out.insert("radio");
    if (!reach.serial && (any || kind == trace::LinkKind::kSerial)) out.insert("serial");
    if (!reach.peis && (any || kind == trace::LinkKind::kPeis)) out.insert("peis");
    if (!reach.app && (any || app)) out.insert("app");
    return out;
  }

  bool is_seen_in_part(const NodeLog& node, const Line& line) const {
    const Reach reach = node.target().reach();
    return scope_.link(line.link).value_or(trace::LinkKind::kAny) == trace::LinkKind::kAny &&
           (reach.radio || reach.serial || reach.peis || reach.app);
  }

  // Returns whether the case can go on without a line of which the target shows nothing, or not
  // all.
  bool can_skip(const Line& line) const {
    return line.op != Op::kGiven && (line.op != Op::kEmits || !is_needed_later(case_, line));
  }

  void give(NodeLog& node, const Timed& timed) {
    advance_fully(timed.window.from + timed.slack);
    stimulus_ = timed.line;
    const Window given = node.give(*timed.line, now_, scope_, bindings_);
    now_ = std::max(now_, given.to);
    stimuli_.push_back({&node, timed.window.from, given});
    matched(*timed.line, {given.from, given.to - given.from});
  }

  // Returns false if the case ends here: what comes late is no failure where its line is weak.
  bool expect(NodeLog& node, const Timed& timed) {
    const Line& line = *timed.line;
    while (true) {
      const Window wide = widened(node, timed);
      if (const Output* output = node.take(line, wide, bindings_)) {
        refusals_.note(line, output->time, bindings_);
        matched(line, {output->time, 0});
        return true;
      }
      if (now_ >= wide.to) break;
      advance(wide.to);
    }
    missing_.push_back({timed, widened(node, timed)});
    note_missing(line, timed.window.to);
    return !is_weak(line);
  }

  // Times of a target whose clock is real are not exact. An output is seen some ticks late, never
  // before it happened, and a stimulus takes some ticks to hand over; so a window is widened for
  // what is asked or allowed, and narrowed for what is forbidden. Their order is exact: what is
  // seen before a stimulus was no answer to it, and nothing after it comes too early for it. A
  // window that begins with a stimulus therefore begins there, and only its end is tolerant.
  Window widened(const NodeLog& node, const Timed& timed) const {
    const Tolerance tolerance = node.target().tolerance();
    const Window& window = timed.window;
    Window wide{window.from - std::min(window.from, tolerance.early),
                window.to + tolerance.late + timed.slack};
    if (const Window* stimulus = stimulus_at(node, timed, tolerance)) {
      // Stimuli just before it may have caused the output, if a trace gives several at once.
      Ticks first = stimulus->from;
      for (const Stimulus& one : stimuli_) {
        if (one.node == &node && one.given.from >= wide.from) {
          first = std::min(first, one.given.from);
        }
      }
      wide.from = first;
    }
    return wide;
  }

  // Returns nothing if the tolerance is greater than the window.
  std::optional<Window> narrowed(const NodeLog& node, const Timed& timed) const {
    const Tolerance tolerance = node.target().tolerance();
    const Window& window = timed.window;
    Ticks from = window.from + tolerance.late + timed.slack;
    Ticks early = tolerance.early;
    if (const Window* stimulus = stimulus_at(node, timed, tolerance)) {
      from = stimulus->from;
      // What is seen by the end happened by then: nothing but the clock's grain is uncertain.
      early = std::min({early, kGrainTicks, (window.to - window.from) / 2});
    }
    if (window.to < from + early) return std::nullopt;
    return Window{from, window.to - early};
  }

  // Returns when the node was given the stimulus with which a window begins; null if none does, or
  // if times are exact.
  const Window* stimulus_at(const NodeLog& node, const Timed& timed,
                            const Tolerance& tolerance) const {
    if (tolerance.early == 0 && tolerance.late == 0) return nullptr;
    const Ticks from = timed.window.from;
    for (const Stimulus& one : stimuli_) {
      if (one.node == &node && (one.asked == from || one.given.from == from)) return &one.given;
    }
    return nullptr;
  }

  void judge_forbidden(CaseResult& result) {
    Ticks end = now_;
    for (const Timed& one : forbidden_) end = std::max(end, one.window.to);
    for (const Missing& one : missing_) end = std::max(end, one.wide.to + kLateTicks);
    advance_fully(end);
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
        const Timed one = known ? timed(*line) : Timed{line, {0, now_}, 0};
        if (known && line->op == Op::kMustNot && !is_empty(one.window)) forbidden_.push_back(one);
        if (line->op == Op::kEmits || line->op == Op::kMay) allowed_.push_back(one);
      }
      if (line->place.line == place_.line) reached = false;
    }
    judge_outputs(result);
  }

  void judge_outputs(CaseResult& result) {
    Ticks since = now_;  // Nothing that counts from what is missing comes before.
    result.failures.reserve(missing_.size());
    for (const Missing& one : missing_) {
      since = std::min(since, one.wide.from);
      const Line& line = *one.timed.line;
      NearestMiss miss = node_of(line)->nearest_miss(line, one.wide, bindings_);
      fail(result, line, one.timed.window, one.wide.to, std::move(miss.text), miss.evidence);
      // An output that differs broke the line when it came: what another line says of the same
      // output must not come first and take the blame.
      if (miss.time) result.failures.back().broken_at = *miss.time;
      result.failures.back().elsewhere = miss.elsewhere;
      refusals_.blame(line, result.failures.back());
    }
    for (const Line* l : skipped_) allowed_.push_back({l, {names_lost(*l) ? 0 : since, now_}, 0});
    for (const Timed& one : allowed_) {
      NodeLog& node = *node_of(*one.line);
      node.allow(*one.line, widened(node, one), bindings_);
    }
    for (const Timed& one : forbidden_) {
      NodeLog& node = *node_of(*one.line);
      const std::optional<Window> window = narrowed(node, one);
      unjudged_ = unjudged_ || !window;
      const Output* output = window ? node.forbidden(*one.line, *window, bindings_) : nullptr;
      if (!output) continue;
      fail(result, *one.line, one.window, output->time,
           fmt::format("at {} it emitted {}", output->time, node.text_of(*output)),
           node.evidence_of(*output));
      const trace::Parameter* const stated = trace::find_parameter("response");
      const std::int64_t response = stated ? value(node.name(), stated->id) : kLastTick;
      result.failures.back().prompt = node.prompt_of(*output, response);
    }
    std::stable_sort(
        result.failures.begin(), result.failures.end(), [](const Failure& a, const Failure& b) {
          return std::pair(a.broken_at, a.place.line) < std::pair(b.broken_at, b.place.line);
        });
  }

  // A packet that was lost or doubled on the way can cause any failure, and can hide one.
  void mind_damage(CaseResult& result) {
    const auto crashed = [](const Failure& failure) { return failure.crash; };
    if (result.verdict > CaseVerdict::kFail) return;
    if (std::any_of(result.failures.begin(), result.failures.end(), crashed)) return;
    for (NodeLog& node : nodes_) {
      const std::string damage = node.target().take_damage();
      if (damage.empty()) continue;
      result.damaged = unseen_.empty() || !result.failures.empty();
      result.failures.clear();
      result.verdict = CaseVerdict::kInconclusive;
      result.reason = "its line may have lost or doubled something: " + damage;
    }
  }

  void set_error(CaseResult& result, trace::Place place, const char* why) {
    Failure failure{.place = place};
    failure.time = failure.from = failure.to = failure.broken_at = now_;
    failure.text = why;
    result.failures.push_back(std::move(failure));
    result.verdict = CaseVerdict::kError;
    result.reason = why;
  }

  // Blames what was given last for the end of the target, or the start if that was nothing.
  void set_died(CaseResult& result, const char* why) {
    set_error(result, stimulus_ ? stimulus_->place : place_, why);
    result.verdict = CaseVerdict::kFail;
    Failure& failure = result.failures.back();
    failure.crash = true;
    const NodeLog& first = at_reset_ ? *at_reset_ : nodes_.front();
    failure.node = stimulus_ ? stimulus_->node : first.name();
    failure.requirements = rules_of_stimulus(case_, stimulus_, failure.node);
    if (failure.requirements.empty()) return;
    failure.suspected.assign(failure.requirements.begin() + 1, failure.requirements.end());
    failure.requirements.resize(1);
  }

  void fail(CaseResult& result, const Line& line, const Window& window, Ticks time,
            std::string text, const Evidence& evidence) {
    Failure failure{.place = line.place,
                    .requirements = line.requirements,
                    .weak = is_weak(line),
                    .time = time,
                    .expected = trace::print(line),
                    .text = std::move(text),
                    .from = window.from,
                    .to = window.to,
                    .forbidden = line.op == Op::kMustNot,
                    .node = line.node,
                    .broken_at = time,
                    .message = line.message.name};
    blame_one(failure, evidence);
    if (!evidence.contains("missing")) failure.symptom = evidence;
    result.verdict =
        std::max(result.verdict, failure.weak ? CaseVerdict::kWeak : CaseVerdict::kFail);
    result.failures.push_back(std::move(failure));
  }

  void write_log(CaseResult& result) const {
    std::vector<const LoggedLine*> all;
    for (const NodeLog& node : nodes_) {
      for (const LoggedLine& line : node.log()) all.push_back(&line);
    }
    std::ranges::stable_sort(all, {}, &LoggedLine::time);
    std::size_t size = 0;
    for (const LoggedLine* line : all) size += line->text.size() + 1;
    result.log.reserve(size);
    for (const LoggedLine* line : all) result.log.add(line->text);
  }

  const trace::Case& case_;
  const trace::Scope scope_;
  const TargetFactory& make_;
  const Ticks channel_access_;
  trace::Place place_;              // Place of the current line.
  const Line* stimulus_ = nullptr;  // Given last.
  bool begun_ = false;
  const NodeLog* at_reset_ = nullptr;  // Is being started.
  std::set<std::string> unseen_;
  bool unjudged_ = false;  // A line's window was too short.
  std::vector<NodeLog> nodes_;
  std::vector<Stimulus> stimuli_;
  std::vector<Missing> missing_;
  Lost lost_;
  Refusals refusals_;
  std::vector<const Line*> skipped_;  // What may come, since they depend on what is lost.
  std::vector<Timed> forbidden_;
  std::vector<Timed> allowed_;
  std::map<std::string, Moment, std::less<>> labels_;
  trace::Bindings bindings_;
  Moment previous_;
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

CaseResult run_case(const trace::File& file, const trace::Case& one, const TargetFactory& make,
                    Ticks channel_access) {
  return Run(file, one, make, channel_access).finish();
}

}  // namespace rubric::runner
