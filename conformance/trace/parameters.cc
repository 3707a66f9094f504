#include "conformance/trace/parameters.h"

#include <algorithm>

#include "conformance/trace/protocol.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {

std::span<const Parameter> parameters() { return protocol().parameters; }

const Parameter& parameter(ParameterId id) { return parameters()[static_cast<std::size_t>(id)]; }

const Parameter* find_parameter(std::string_view name) {
  for (const Parameter& one : parameters()) {
    if (name == one.name) return &one;
  }
  return nullptr;
}

std::string parameter_names() {
  std::string out;
  for (const Parameter& one : parameters()) {
    if (!out.empty()) out += ", ";
    out += one.name;
  }
  return out;
}

const std::int64_t* find(const Statement& statement, ParameterId id) {
  const auto found = std::find_if(statement.begin(), statement.end(),
                                  [&](const Stated& one) { return one.id == id; });
  return found == statement.end() ? nullptr : &found->value;
}

std::string add_stated(std::string_view word, Statement& out) {
  const std::size_t sign = word.find('=');
  const std::string_view name = word.substr(0, sign);
  const Parameter* const known = find_parameter(name);
  if (!known) {
    return quoted(name) + " is no parameter that can be stated; known are " + parameter_names();
  }
  const std::string_view text = sign == std::string_view::npos ? "" : word.substr(sign + 1);
  std::int64_t value = 0;
  if (!read_integer(text, value) || value < known->min || value > known->max) {
    return "expected " + std::string(name) + " from " + std::to_string(known->min) + " to " +
           std::to_string(known->max) + ' ' + known->unit + ", given " + quoted(text);
  }
  if (find(out, known->id)) return std::string(name) + " is stated twice";
  out.push_back({known->id, value});
  return {};
}

Statement joined(Statement first, const Statement& second) {
  for (const Stated& one : second) {
    if (!find(first, one.id)) first.push_back(one);
  }
  return first;
}

std::string statement_text(const Statement& statement) {
  std::string out;
  for (const Stated& one : statement) {
    if (!out.empty()) out += ' ';
    out += parameter(one.id).name + ('=' + std::to_string(one.value));
  }
  return out;
}

std::string add_range(std::string_view word, std::vector<StatedRange>& out) {
  const std::size_t dots = word.find("..");
  Statement ends;
  std::string wrong = add_stated(word.substr(0, dots), ends);
  if (!wrong.empty()) return wrong;
  const Stated least = ends.front();
  if (dots != std::string_view::npos) {
    ends.clear();
    wrong = add_stated(
        std::string(parameter(least.id).name) + '=' + std::string(word.substr(dots + 2)), ends);
    if (!wrong.empty()) return wrong;
  }
  const StatedRange range{least.id, least.value, ends.front().value};
  if (range.most < range.least) return quoted(word) + " ends before it begins";
  for (const StatedRange& other : out) {
    if (other.id == range.id) return parameter(range.id).name + std::string(" is stated twice");
  }
  out.push_back(range);
  return {};
}

std::string range_text(const StatedRange& range) {
  std::string out = statement_text({{range.id, range.least}});
  if (range.most != range.least) out += ".." + std::to_string(range.most);
  return out;
}

}  // namespace rubric::trace
