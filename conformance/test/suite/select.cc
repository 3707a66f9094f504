#include "conformance/test/suite/select.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>

#include "codec/reflect/requirements.h"
#include "codec/reflect/suggest.h"

namespace rubric::suite {
namespace {

bool in_upper_case_equal(char a, char b) {
  return std::toupper(static_cast<unsigned char>(a)) == std::toupper(static_cast<unsigned char>(b));
}

bool fits(const SuiteCase& one, const std::string& requirement) {
  return std::ranges::any_of(one.rules(),
                             [&](const std::string& rule) { return is_of(rule, requirement); });
}

void check_glob(const Cases& cases, const std::string& glob) {
  std::vector<std::string> names;
  for (const SuiteCase& one : cases.all()) {
    if (is_like(glob, one.one->name)) return;
    names.push_back(one.one->name);
  }
  throw std::invalid_argument(fmt::format("no case is called '{}'{}; --list shows them", glob,
                                          reflect::did_you_mean(glob, names)));
}

void check_requirement(const Cases& cases, const std::string& requirement) {
  for (const SuiteCase& one : cases.all()) {
    if (fits(one, requirement)) return;
  }
  std::vector<std::string> names;
  for (const reflect::Requirement& rule : reflect::requirements()) {
    if (is_of(rule.id, requirement)) {
      throw std::invalid_argument(fmt::format("no case tries {}", requirement));
    }
    names.emplace_back(rule.id);
  }
  throw std::invalid_argument(fmt::format("no rule is called '{}'{}", requirement,
                                          reflect::did_you_mean(requirement, names)));
}

bool takes(const Selection& selection, const SuiteCase& one) {
  const auto named = [&](const std::string& glob) { return is_like(glob, one.one->name); };
  const auto& globs = selection.globs;
  const auto& rules = selection.requirements;
  if (!globs.empty() && std::none_of(globs.begin(), globs.end(), named)) return false;
  if (std::any_of(selection.excepted.begin(), selection.excepted.end(), named)) return false;
  if (!rules.empty() && std::none_of(rules.begin(), rules.end(),
                                     [&](const std::string& rule) { return fits(one, rule); })) {
    return false;
  }
  if (!selection.role) return true;
  const std::vector<machine::Role> roles = one.roles();
  return std::ranges::find(roles, *selection.role) != roles.end();
}

}  // namespace

std::optional<Shard> parse_shard(std::string_view text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '/') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, shard.count);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  if (shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

bool is_like(const std::string& glob, const std::string& name) {
  return ::fnmatch(glob.c_str(), name.c_str(), 0) == 0;
}

bool is_of(std::string_view rule, std::string_view asked) {
  if (asked.empty() || rule.size() < asked.size()) return false;
  if (!std::equal(asked.begin(), asked.end(), rule.begin(), in_upper_case_equal)) return false;
  if (rule.size() == asked.size() || rule[asked.size()] == '-') return true;
  // "J" covers all of J1 to J11, but "J1" covers nothing of J10.
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return is_digit(rule[asked.size()]) && !is_digit(asked.back());
}

std::vector<SuiteCase> select(const Cases& cases, const Selection& selection) {
  for (const std::string& glob : selection.globs) check_glob(cases, glob);
  for (const std::string& glob : selection.excepted) check_glob(cases, glob);
  for (const std::string& rule : selection.requirements) check_requirement(cases, rule);
  std::vector<SuiteCase> chosen;
  chosen.reserve(cases.all().size() / selection.shard.count + 1);
  std::size_t taken = 0;
  for (const SuiteCase& one : cases.all()) {
    if (!takes(selection, one)) continue;
    if (taken++ % selection.shard.count == selection.shard.index - 1) chosen.push_back(one);
  }
  if (taken == 0) throw std::invalid_argument("no case has all that is asked for");
  if (chosen.empty()) {
    throw std::invalid_argument(fmt::format("shard {}/{} has no case: there are only {}",
                                            selection.shard.index, selection.shard.count, taken));
  }
  return chosen;
}

}  // namespace rubric::suite
