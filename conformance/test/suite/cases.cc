#include "conformance/test/suite/cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "codec/text/files.h"
#include "codec/text/text.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/trace/each_line.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;

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

std::string place_of(const SuiteCase& one) {
  return fmt::format("{}:{}: case {}", one.file->file_name, one.one->place.line, one.one->name);
}

// Returns the comment lines at the begin of a case, after the one that names it.
std::string_view beginning(std::string_view text) {
  std::size_t end = text.find('\n');
  while (end != text.npos) {
    const std::size_t word = text.find_first_not_of(" \t", end + 1);
    if (word == text.npos || (text[word] != '#' && text[word] != ';')) break;
    end = text.find('\n', word);
  }
  return text.substr(0, end);
}

}  // namespace

trace::Case SuiteCase::whole() const {
  return text.empty() ? *one : trace::case_of(text, one->place.line);
}

void SuiteCase::each_line(const std::function<void(const trace::Line&)>& take) const {
  if (!text.empty()) return trace::lines_of(text, take);
  for (const trace::Line* line : one->lines()) take(*line);
}

CaseRun SuiteCase::blank() const {
  trace::Scope scope = trace::scope_of(file->file, *one);
  CaseRun out;
  out.name = one->name;
  out.file = file->file_name;
  out.comment = comment_of(text.empty() ? *one : trace::case_of(beginning(text), one->place.line));
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
  each_line([&](const trace::Line& line) {
    for (const std::string& name : line.requirements) add_once(out, name);
  });
  return out;
}

Cases Cases::own(std::string_view file_name) {
  Cases out;
  for (const EmbeddedFile& one : embedded_files()) {
    if (!file_name.empty() && file_name != one.name) continue;
    // golden_cases_test checks names and values, which takes four times as long as reading.
    trace::Parsed file = trace::parse_syntax(one.text, one.name);
    if (!file.ok()) throw std::logic_error(file.errors());
    out.add(std::move(file), {});
  }
  out.sort_names();
  return out;
}

Cases Cases::of(const std::vector<std::string>& paths) {
  Cases out;
  for (const std::string& path : paths) {
    const bool folder = std::filesystem::is_directory(path);
    std::string errors;
    for (const auto& file : folder ? runner::case_paths(path) : std::vector{fs::path(path)}) {
      std::string text;
      if (const int code = text::read_file(file, text)) {
        errors +=
            fmt::format("{}: {}\n", text::harmless(file.generic_string()), std::strerror(code));
      } else {
        errors += out.add_text(std::move(text), file.generic_string());
      }
    }
    if (!errors.empty()) throw std::runtime_error(errors);
  }
  out.sort_names();
  return out;
}

Cases Cases::of_text(std::string_view text, const std::string& file_name) {
  Cases out;
  const std::string errors = out.add_text(std::string(text), file_name);
  if (!errors.empty()) throw std::runtime_error(errors);
  out.sort_names();
  return out;
}

// Returns what is wrong with it; nothing: it was added.
std::string Cases::add_text(std::string text, std::string_view file_name) {
  text.shrink_to_fit();
  const std::string& kept = texts_.emplace_back(std::move(text));
  trace::Parsed file = trace::each_line(kept, file_name, [](const auto&, const auto&) {});
  std::string errors = file.errors();
  if (errors.empty()) add(std::move(file), kept);
  return errors;
}

const SuiteCase* Cases::find(std::string_view name) const {
  const auto name_at = [this](std::uint32_t at) { return std::string_view(cases_[at].one->name); };
  const auto found = std::ranges::lower_bound(by_name_, name, {}, name_at);
  return found == by_name_.end() || name_at(*found) != name ? nullptr : &cases_[*found];
}

// Cases point to their part of `text`, if that is given.
void Cases::add(trace::Parsed file, std::string_view text) {
  const trace::Parsed& kept = files_.emplace_back(std::move(file));
  std::uint32_t line = 1;  // At which `text` begins.
  const auto cut_before = [&](std::uint32_t number) {
    std::size_t at = 0;
    for (; line < number; ++line) at = text.find('\n', at) + 1;
    const std::string_view before = text.substr(0, at);
    text.remove_prefix(at);
    return before;
  };
  const std::vector<trace::Case>& all = kept.file.cases;
  if (!text.empty() && !all.empty()) cut_before(all.front().place.line);
  if (cases_.empty()) cases_.reserve(all.size());
  for (const trace::Case& one : all) {
    SuiteCase added{&kept, &one};
    if (!text.empty()) added.text = &one == &all.back() ? text : cut_before((&one)[1].place.line);
    if (added.roles().empty()) {
      throw std::runtime_error(place_of(added) + " has no node under test (iut)");
    }
    by_name_.push_back(static_cast<std::uint32_t>(cases_.size()));
    cases_.push_back(added);
  }
}

// Throws if two cases have one name.
void Cases::sort_names() {
  const auto name = [this](std::uint32_t at) { return std::string_view(cases_[at].one->name); };
  std::ranges::stable_sort(by_name_, {}, name);
  const auto twin = std::ranges::adjacent_find(by_name_, {}, name);
  if (twin == by_name_.end()) return;
  const SuiteCase& other = cases_[*twin];
  throw std::runtime_error(fmt::format("{}: the name is also in {}, line {}",
                                       place_of(cases_[twin[1]]), other.file->file_name,
                                       other.one->place.line));
}

}  // namespace rubric::suite
