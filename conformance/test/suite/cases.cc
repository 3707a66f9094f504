#include "conformance/test/suite/cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "codec/text/files.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"

namespace rubric::suite {
namespace {

template <class T>
void add_once(std::vector<T>& all, const T& one) {
  if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
}

// Returns the comment lines at the begin of a case as one text.
std::string comment_of(const trace::Case& one) {
  std::string out = one.comment;
  for (const trace::Item& item : one.items) {
    const auto* comment = item.as<trace::Comment>();
    if (!comment) break;
    std::string_view text = comment->text;
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (!out.empty() && !text.empty()) out += ' ';
    out += text;
  }
  return out;
}

std::vector<machine::Role> roles_of(const std::vector<trace::NodeHeader>& nodes) {
  std::vector<machine::Role> out;
  for (const trace::NodeHeader& node : nodes) {
    if (node.iut) add_once(out, static_cast<machine::Role>(node.role));
  }
  return out;
}

trace::Parsed read_file(const std::filesystem::path& path) {
  std::string text;
  if (const int code = text::read_file(path, text)) {
    throw std::runtime_error(path.string() + ": " + std::strerror(code));
  }
  trace::Parsed file = trace::parse(text, path.generic_string());
  if (!file.ok()) throw std::runtime_error(file.errors());
  return file;
}

}  // namespace

CaseRun SuiteCase::blank() const {
  trace::Scope scope = trace::scope_of(file->file, *one);
  CaseRun out;
  out.name = one->name;
  out.file = file->file_name;
  out.comment = comment_of(*one);
  out.roles = roles_of(scope.nodes);
  out.nodes = std::move(scope.nodes);
  out.links = std::move(scope.links);
  out.seed = scope.seed;
  out.profile = std::move(scope.profile);
  for (const std::string& name : rules()) {
    const ReqId id = trace::requirement_id(name);
    if (id != ReqId::kNone) add_once(out.requirements, id);
  }
  return out;
}

std::vector<machine::Role> SuiteCase::roles() const {
  return roles_of(trace::scope_of(file->file, *one).nodes);
}

std::vector<std::string> SuiteCase::rules() const {
  std::vector<std::string> out;
  for (const trace::Line* line : one->lines()) {
    for (const std::string& name : line->requirements) add_once(out, name);
  }
  return out;
}

Cases Cases::own() {
  Cases out;
  for (const EmbeddedFile& one : embedded_files()) {
    // golden_cases_test checks names and values, which takes four times as long as reading.
    trace::Parsed file = trace::parse_syntax(one.text, one.name);
    if (!file.ok()) throw std::logic_error(file.errors());
    out.add(std::move(file));
  }
  return out;
}

Cases Cases::of(const std::vector<std::string>& paths) {
  Cases out;
  for (const std::string& path : paths) {
    if (std::filesystem::is_directory(path)) {
      for (trace::Parsed& file : runner::load_cases(path)) out.add(std::move(file));
    } else {
      out.add(read_file(path));
    }
  }
  return out;
}

Cases Cases::of_text(std::string_view text, const std::string& file_name) {
  Cases out;
  trace::Parsed file = trace::parse(text, file_name);
  if (!file.ok()) throw std::runtime_error(file.errors());
  out.add(std::move(file));
  return out;
}

const SuiteCase* Cases::find(std::string_view name) const {
  const auto found = places_.find(name);
  return found == places_.end() ? nullptr : &cases_[found->second];
}

void Cases::add(trace::Parsed file) {
  const trace::Parsed& kept = files_.emplace_back(std::move(file));
  for (const trace::Case& one : kept.file.cases) {
    const SuiteCase added{&kept, &one};
    const std::string place =
        fmt::format("{}:{}: case {}", kept.file_name, one.place.line, one.name);
    if (const SuiteCase* other = find(one.name)) {
      throw std::runtime_error(fmt::format("{}: the name is also in {}, line {}", place,
                                           other->file->file_name, other->one->place.line));
    }
    if (added.roles().empty()) throw std::runtime_error(place + " has no node under test (iut)");
    places_[one.name] = cases_.size();
    cases_.push_back(added);
  }
}

}  // namespace rubric::suite
