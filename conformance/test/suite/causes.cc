#include "conformance/test/suite/causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/test/runner/blame.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/protocol.h"

namespace rubric::suite {
namespace {

using runner::Failure;

// A kind of output: its node, link, message and TRANSID.
using Kind = std::tuple<std::string_view, std::string_view, std::string_view, std::string_view>;
using Done = std::map<Kind, std::vector<const trace::Line*>>;

Done done_in(const trace::Case& log) {
  Done out;
  for (const trace::Line* line : log.lines()) {
    if (line->op != trace::Op::kEmits) continue;
    const trace::Value* const id = line->message.find("payload.trans_id");
    const std::string_view trans_id = id ? std::string_view(id->text) : std::string_view();
    out[{line->node, line->link, line->message.name, trans_id}].push_back(line);
  }
  for (auto& [kind, lines] : out) {
    std::ranges::stable_sort(lines, {}, [](const trace::Line* one) { return one->time.from; });
  }
  return out;
}

// Adds the rules of what the machine did before this failure, and the node less often.
void add_left_undone(const Done& right, const Done& own, Failure& failure) {
  const auto until = [](const std::vector<const trace::Line*>& lines, runner::Ticks end) {
    const auto time = [](const trace::Line* one) { return one->time.from; };
    return std::ranges::lower_bound(lines, end, {}, time) - lines.begin();
  };
  for (const auto& [kind, lines] : right) {
    if (std::get<0>(kind) != failure.node) continue;
    const auto its = own.find(kind);
    const std::ptrdiff_t done = its == own.end() ? 0 : until(its->second, failure.broken_at + 1);
    const std::ptrdiff_t due = until(lines, failure.from);
    for (std::ptrdiff_t i = done; i < due; ++i) {
      const auto& rules = lines[static_cast<std::size_t>(i)]->requirements;
      failure.left_undone.insert(rules.begin(), rules.end());
    }
  }
}

// Returns the line of the machine's log that does what the failed line asks for by a rule: that of
// its node and message whose time is nearest. Null if there is none.
const trace::Line* nearest(const trace::Case& log, const Failure& failure,
                           std::string_view message) {
  const trace::Line* out = nullptr;
  const auto distance = [&](const trace::Line& line) {
    return std::abs(line.time.from - failure.from);
  };
  for (const trace::Line* line : log.lines()) {
    const bool does = line->op == trace::Op::kEmits && !line->requirements.empty() &&
                      line->node == failure.node && line->message.name == message;
    if (does && (!out || distance(*line) < distance(*out))) out = line;
  }
  return out;
}

// Returns in what a failure is like others, which may have the same cause: its message, and what is
// wrong with it. Empty if that says nothing, as many rules let a node send data.
std::string symptom_of(const Failure& failure) {
  const runner::Evidence& seen = failure.symptom;
  const bool data = seen.contains("received") || seen.contains("net_msg");
  if (seen.empty() || (data && !seen.contains("differs"))) return {};
  return fmt::format("{} {}", failure.message, fmt::join(seen, " "));
}

// Returns whether a line proves by itself that its rule is broken. Either the node acked a message,
// but with another content; or it answered one as this rule alone forbids, which the line or the
// rule describes. What the application is told proves nothing: it reports what became of a message.
bool is_proof(const Failure& failure) {
  const std::string& rule = failure.requirements.front();
  runner::Evidence what = failure.symptom;
  const auto has = [&](std::string_view word) { return what.contains(word); };
  if (has("differs")) return has("ack") && !has("am") && !has("dest") && !has("order");
  const reflect::Requirement& known = reflect::requirement(trace::requirement_id(rule));
  if (!failure.forbidden || !known.forbids || !failure.suspected.empty()) return false;
  if (failure.prompt.empty() || has("app")) return false;
  for (const char* link : {"radio", "serial", "peis"}) what.erase(link);
  return failure.message != "*" || runner::shows(rule, what);
}

// Returns the same with the kind of message that was answered.
std::string after_prompt(const std::string& symptom, const Failure& failure) {
  return symptom.empty() ? symptom : fmt::format("{} after {}", symptom, failure.prompt);
}

// In how many cases a rule is blamed, and how many that name it pass.
struct Record {
  std::size_t broken = 0;
  std::size_t kept = 0;
  // A rule that is mostly kept, or hardly ever blamed, does not explain what another is blamed for.
  bool is_as_bad_as(const Record& other) const {
    return broken >= other.broken &&
           broken * (other.broken + other.kept) >= other.broken * (broken + kept);
  }
};

}  // namespace

void compare_with_machine(const trace::File& head, const trace::Case& one, CaseRun& out) {
  if (!trace::protocol().has_machine) return;
  const runner::CaseResult right = runner::run_case(head, one, [](const trace::NodeHeader&) {
    return std::make_unique<runner::SubjectTarget>(std::make_unique<runner::Machine>());
  });
  std::map<std::uint32_t, const trace::Line*> kept;  // By their places in the file.
  for (const trace::Line* line : one.lines()) kept.emplace(line->place.line, line);
  for (const Failure& its : right.failures) {
    kept.erase(its.place.line);
    if (out.profile != "paper") out.lines_of_profile.push_back(its.place.line);
  }
  const trace::Case its_log = right.log.read();
  const trace::Case own_log = out.result.log.read();
  const Done done = done_in(its_log);
  const Done own = done_in(own_log);
  for (Failure& failure : out.result.failures) {
    add_left_undone(done, own, failure);
    const auto line = kept.find(failure.place.line);
    if (failure.forbidden || failure.crash || line == kept.end()) continue;
    const trace::Line* const did = nearest(its_log, failure, line->second->message.name);
    if (!did) continue;
    if (failure.requirements.empty()) {
      failure.requirements.assign(1, did->requirements.front());
    } else if (failure.symptom.empty()) {
      failure.left_undone.insert(did->requirements.front());
    }
  }
}

void find_causes(ImplementationRun& run) {
  std::vector<Failure*> blamed;
  std::map<std::string, Record> records;                    // Of the rules that are blamed.
  std::map<std::string, std::set<std::string>> blamed_for;  // By symptom.
  for (CaseRun& one : run.cases) {
    std::set<std::string> here;
    for (Failure& failure : one.result.failures) {
      if (failure.implied || failure.crash || failure.requirements.empty()) continue;
      const std::string& rule = failure.requirements.front();
      here.insert(rule);
      if (const std::string symptom = symptom_of(failure); !symptom.empty()) {
        blamed_for[symptom].insert(rule);
        blamed_for[after_prompt(symptom, failure)].insert(rule);
      }
      blamed.push_back(&failure);
    }
    for (const std::string& rule : here) ++records[rule].broken;
  }
  for (const CaseRun& one : run.cases) {
    if (!one.result.failures.empty() || one.undecided()) continue;
    for (const ReqId rule : one.requirements) {
      const auto record = records.find(std::string(trace::requirement_text(rule)));
      if (record != records.end()) ++record->second.kept;
    }
  }
  const auto causes_of = [&](const Failure& failure) {
    const bool proof = is_proof(failure);
    std::set<std::string> out = failure.left_undone;
    out.insert(failure.requirements.front());
    if (!proof) out.insert(failure.suspected.begin(), failure.suspected.end());
    const std::string symptom = symptom_of(failure);
    const auto alike = blamed_for.find(proof ? after_prompt(symptom, failure) : symptom);
    if (alike != blamed_for.end()) out.insert(alike->second.begin(), alike->second.end());
    const Record& own = records.at(failure.requirements.front());
    std::erase_if(out, [&](const std::string& rule) {
      const auto other = records.find(rule);
      return other == records.end() || !other->second.is_as_bad_as(own);
    });
    return out;
  };
  std::vector<std::pair<Failure*, std::set<std::string>>> left;
  for (Failure* failure : blamed) left.emplace_back(failure, causes_of(*failure));
  while (!left.empty()) {
    // How many failures a rule explains, in how many it looks like this, and how many blame it.
    std::map<std::string, std::tuple<std::size_t, std::size_t, std::size_t>> scores;
    for (const auto& [failure, causes] : left) {
      for (const std::string& rule : causes) {
        auto& [explains, shown, broken] = scores[rule];
        ++explains;
        shown += failure->left_undone.contains(rule) || runner::shows(rule, failure->symptom);
        broken = records.at(rule).broken;
      }
    }
    const std::string best =
        std::ranges::max_element(scores, {}, [](const auto& one) { return one.second; })->first;
    std::erase_if(left, [&](const auto& one) {
      const auto& [failure, causes] = one;
      if (!causes.contains(best)) return false;
      if (failure->requirements.front() != best) {
        failure->cause = best;
        failure->implied = true;
      }
      return true;
    });
  }
}

}  // namespace rubric::suite
