#include "conformance/test/report/json.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "conformance/test/report/words.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "rubric.test/1";
constexpr const char* kListSchema = "rubric.test.list/1";

Json ids(const std::vector<ReqId>& requirements) {
  Json out = Json::array();
  for (const ReqId id : requirements) out.push_back(trace::requirement_text(id));
  return out;
}

Json roles(const std::vector<machine::Role>& all) {
  Json out = Json::array();
  for (const machine::Role role : all) out.push_back(role_text(role));
  return out;
}

Json counts(const VerdictCounts& counted) {
  Json out = Json::object();
  for (const runner::CaseVerdict verdict : kVerdicts) {
    const auto found = counted.find(verdict);
    out[std::string(runner::verdict_text(verdict))] = found == counted.end() ? 0 : found->second;
  }
  return out;
}

Json failure(const runner::Failure& one) {
  return {{"requirements", one.requirements},
          {"suspected", one.suspected},
          {"weak", one.weak},
          {"implied", one.implied},
          {"cause", one.cause},
          {"crash", one.crash},
          {"line", one.place.line},
          {"time_ticks", one.time},
          {"expected", one.expected},
          {"text", one.text}};
}

Json requirement(const RequirementSummary& one) {
  return {{"id", trace::requirement_text(one.requirement)},
          {"cases", counts(one.cases)},
          {"broken", one.broken},
          {"suspected", one.suspected}};
}

Json implementation(const ImplementationRun& run) {
  Json out = implementation_json(run);
  for (const char* list : {"cases", "requirements"}) out[list] = Json::array();
  for (const CaseRun& one : run.cases) {
    Json& added = out["cases"].emplace_back(case_json(one));
    added["log"] = Json::array();
    std::istringstream log(one.result.log.text());
    for (std::string line; std::getline(log, line);) added["log"] += line;
  }
  for (const RequirementSummary& one : by_requirement(run)) {
    out["requirements"].push_back(requirement(one));
  }
  return out;
}

const Json& member(const Json& object, const char* key, const std::string& place) {
  if (!object.is_object() || !object.contains(key)) {
    throw std::runtime_error(fmt::format("{}: there is no \"{}\"", place, key));
  }
  return object[key];
}

std::string text_of(const Json& object, const char* key, const std::string& place) {
  const Json& value = member(object, key, place);
  if (!value.is_string()) throw std::runtime_error(fmt::format("{}: {} is not text", place, key));
  return value.get<std::string>();
}

const Json& list_of(const Json& object, const char* key, const std::string& place) {
  const Json& value = member(object, key, place);
  if (!value.is_array()) throw std::runtime_error(fmt::format("{}: {} is not a list", place, key));
  return value;
}

}  // namespace

Json case_json(const CaseRun& one) {
  Json failures = Json::array();
  for (const runner::Failure& each : one.result.failures) failures.push_back(failure(each));
  return {{"name", one.name},
          {"file", one.file},
          {"comment", one.comment},
          {"roles", roles(one.roles)},
          {"requirements", ids(one.requirements)},
          {"repeat", one.repeat},
          {"seed", one.seed},
          {"verdict", runner::verdict_text(one.result.verdict)},
          {"unexpected", one.unexpected()},
          {"owed", one.owed},
          {"expectation", expectation_text(one.expectation)},
          {"expected_reason", one.expected_reason},
          {"reason", one.result.reason},
          {"length_ticks", one.result.length},
          {"wall_ms", one.wall_ms},
          {"failures", std::move(failures)},
          {"stderr", one.stderr_text}};
}

Json implementation_json(const ImplementationRun& run) {
  Json outside = Json::array();
  for (const OutsideFault& one : run.outside) {
    outside.push_back({{"when", one.when},
                       {"text", one.text},
                       {"broke", one.broke},
                       {"stderr", one.stderr_text}});
  }
  return {{"target", run.target},
          {"name", run.identity.name},
          {"version", run.identity.version},
          {"roles", roles(run.identity.roles)},
          {"real_time", run.identity.real_time},
          {"stated", trace::statement_text(run.identity.stated)},
          {"dishonest", run.dishonest},
          {"outside", std::move(outside)},
          {"own_line", run.identity.own_line},
          {"wall_ms", run.wall_ms},
          {"advice", advice(run)},
          {"counts", counts(count(run))}};
}

Json stale_json(const SuiteRun& run) {
  Json out = Json::array();
  for (const StaleExpectation& one : run.stale) {
    out.push_back({{"place", one.place}, {"text", one.text}});
  }
  return out;
}

std::string json_report(const SuiteRun& run) {
  Json implementations = Json::array();
  for (const ImplementationRun& one : run.implementations) {
    implementations.push_back(implementation(one));
  }
  Json out = {{"schema", kSchema},
              {"profile", run.profile},
              {"seed", run.seed},
              {"shard", run.shard},
              {"traces", run.traces},
              {"rules_required", run.rules_required},
              {"exit_code", exit_code(run)},
              {"implementations", std::move(implementations)},
              {"stale", stale_json(run)}};
  if (!run.protocol.empty()) out["protocol"] = run.protocol;
  // What an implementation wrote to its standard error need not be UTF-8.
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string json_list(const std::vector<SuiteCase>& cases) {
  Json list = Json::array();
  for (const SuiteCase& one : cases) {
    const CaseRun blank = one.blank();
    list.push_back({{"name", blank.name},
                    {"file", blank.file},
                    {"comment", blank.comment},
                    {"roles", roles(blank.roles)},
                    {"rules", one.rules()}});
  }
  const Json out = {{"schema", kListSchema}, {"cases", std::move(list)}};
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

EarlierRun read_json_report(std::string_view text) {
  Json all;
  try {
    all = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(fmt::format("byte {}: this is not JSON", error.byte));
  }
  const std::string schema = text_of(all, "schema", "the report");
  if (schema != kSchema) {
    throw std::runtime_error(fmt::format("schema is \"{}\"; this reads {}", schema, kSchema));
  }
  EarlierRun earlier;
  std::map<std::string, std::size_t> of_name;
  std::size_t i = 0;
  for (const Json& one : list_of(all, "implementations", "the report")) {
    const std::string place = fmt::format("implementations[{}]", i++);
    const std::string name = text_of(one, "name", place);
    const std::size_t which = of_name[name]++;
    std::size_t k = 0;
    for (const Json& each : list_of(one, "cases", place)) {
      const std::string where = fmt::format("{}.cases[{}]", place, k++);
      const std::string case_name = text_of(each, "name", where);
      const std::string verdict = text_of(each, "verdict", where);
      const Json& repeat = member(each, "repeat", where);
      if (!repeat.is_number_unsigned()) {
        throw std::runtime_error(fmt::format("{}: repeat is not a number", where));
      }
      earlier.verdicts[{name, case_name, which, repeat.get<std::uint32_t>()}] = verdict;
    }
  }
  return earlier;
}

}  // namespace rubric::suite
