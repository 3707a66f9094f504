#include "conformance/test/runner/expectation.h"

#include <algorithm>
#include <string_view>

#include "codec/reflect/fault_text.h"

namespace rubric::runner {
namespace {

using Names = std::set<std::string>;
using trace::Line;
using trace::Op;
using trace::Time;
using trace::Value;

void add_names(const Value& value, Names& out) {
  const bool of_variable = value.is(Value::Kind::kVariable) || value.is(Value::Kind::kRange);
  if (of_variable && !value.text.empty()) out.insert(value.text);
  for (const Value& item : value.items) add_names(item, out);
}

// Returns whether later lines without another reference count their times from this one.
bool is_counted_from(const Line& line) { return line.op != Op::kMustNot && line.op != Op::kMay; }

}  // namespace

bool is_weak(const trace::Line& line) {
  return !line.requirements.empty() &&
         std::all_of(line.requirements.begin(), line.requirements.end(), [](const auto& name) {
           const ReqId id = trace::requirement_id(name);
           return id != ReqId::kNone &&
                  std::string_view(reflect::requirement(id).level) == "SHOULD";
         });
}

std::set<std::string> variables_of(const Line& line) {
  Names out;
  for (const trace::FieldValue& field : line.message.fields) add_names(field.value, out);
  if (line.am) {
    add_names(line.am->source, out);
    add_names(line.am->dest, out);
  }
  return out;
}

std::vector<std::string> rules_of_stimulus(const trace::Case& one, const Line* stimulus,
                                           std::string_view node) {
  std::vector<std::string> before;
  std::vector<std::string> others;
  bool after = !stimulus;
  for (const Line* line : one.lines()) {
    after = after || line == stimulus;
    if (line->requirements.empty()) continue;
    if (others.empty()) others = line->requirements;
    if (line->node != node) continue;
    if (after) return line->requirements;
    before = line->requirements;
  }
  return before.empty() ? others : before;
}

bool uses(const trace::Case& one, trace::ParameterId parameter) {
  const auto is_of_it = [&](const trace::Term& term) { return term.parameter == parameter; };
  return std::ranges::any_of(one.lines(), [&](const Line* line) {
    return std::ranges::any_of(line->time.from_terms, is_of_it) ||
           std::ranges::any_of(line->time.to_terms, is_of_it);
  });
}

bool is_needed_later(const trace::Case& one, const Line& line) {
  const Names names = variables_of(line);
  const std::vector<const Line*> lines = one.lines();
  bool is_previous = is_counted_from(line);
  for (auto at = std::find(lines.begin(), lines.end(), &line) + 1; at != lines.end(); ++at) {
    const Line& later = **at;
    if (is_previous && later.time.base == Time::Base::kPrevious) return true;
    is_previous = is_previous && !is_counted_from(later);
    const bool same_label = later.time.base == Time::Base::kLabel && later.time.label == line.label;
    if (same_label) return true;
    const Names others = variables_of(later);
    if (std::any_of(names.begin(), names.end(),
                    [&](const std::string& name) { return others.contains(name); })) {
      return true;
    }
  }
  return false;
}

}  // namespace rubric::runner
