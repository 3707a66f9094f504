// Golden traces as scripts, scripts as bytes, runs of scripts as traces.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/check.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"

namespace rubric::script {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;

std::unique_ptr<runner::Target> machine_target() {
  return std::make_unique<runner::SubjectTarget>(std::make_unique<runner::Machine>());
}
Played run_on_machine(const Script& script) { return play(script, *machine_target()); }

Bytes view(const std::vector<std::uint8_t>& bytes) { return Bytes(bytes.data(), bytes.size()); }

std::vector<std::string> lines_of(const std::vector<runner::Output>& outputs) {
  std::vector<std::string> out;
  for (const runner::Output& output : outputs) out.push_back(trace::print(line_of(output, "node")));
  return out;
}

// Expects the trace of a run to be valid, and the machine to keep it.
void expect_holds(const Script& script, const std::string& name) {
  const Played run = run_on_machine(script);
  const trace::File file = to_file(script, run, {"x." + name, {"A comment."}, {"N2-ONCE"_rule}});
  const auto wrong = trace::check(file);
  ASSERT_TRUE(wrong.empty()) << name << ": " << wrong[0].text << "\n" << trace::print(file);
  const trace::Parsed again = trace::parse(trace::print(file), name);
  ASSERT_TRUE(again.ok()) << again.errors() << trace::print(file);
  const CaseResult result = runner::run_case(
      again.file, again.file.cases[0], [](const trace::NodeHeader&) { return machine_target(); });
  ASSERT_EQ(result.verdict, CaseVerdict::kPass)
      << runner::explain(result, name) << result.reason << trace::print(file);
}

TEST(Script, GoldenTracesAreScripts) {
  int scripts = 0;
  for (const CaseScript& each : golden_scripts()) {
    const std::vector<std::uint8_t> bytes = encode(each.script);
    const Script decoded = decode(view(bytes));
    // What a case states of its node, but for its channels, is not in the bytes.
    if (decoded.config.profile != each.script.config.profile) continue;
    ASSERT_EQ(encode(decoded), bytes) << each.case_name;
    // Alone and from its bytes the machine repeats its run of the case, for as long.
    Played run = run_on_machine(decoded);
    ASSERT_GE(run.outputs.size(), each.outputs.size()) << each.case_name;
    run.outputs.resize(each.outputs.size());
    ASSERT_EQ(lines_of(run.outputs), lines_of(each.outputs)) << each.case_name;
    expect_holds(decoded, each.case_name);
    ++scripts;
  }
  EXPECT_GT(scripts, 270);
}

// The runner itself may let time pass after the last line, to check for forbidden outputs.
TEST(Script, ARunHasNoMoreThanItsCase) {
  for (const CaseScript& each : golden_scripts()) {
    EXPECT_EQ(run_on_machine(each.script).outputs.size(), each.outputs.size()) << each.case_name;
  }
}

TEST(Script, AnyBytesAreAScript) {
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> bytes(random() % 400);
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(random() % 3 == 0 ? random() : random() % 32);
    }
    const Script script = decode(view(bytes));
    const std::vector<std::uint8_t> once = encode(script);
    ASSERT_EQ(encode(decode(view(once))), once);
    ASSERT_LE(script.steps.size(), kStepsMax);
    ASSERT_LE(script.length(), kLengthMax);
    const std::vector<std::size_t> offsets = step_offsets(script);
    ASSERT_EQ(offsets.size(), script.steps.size() + 1);
    ASSERT_EQ(offsets.back(), once.size());
    if (i % 10 != 0) continue;
    ASSERT_NO_FATAL_FAILURE(expect_holds(script, "random" + std::to_string(i)));
  }
}

TEST(Script, NoBytesAreAMoteToWhichNothingHappens) {
  const Script script = decode({});
  EXPECT_EQ(script.config.role, machine::Role::kMote);
  EXPECT_EQ(script.config.id, 5);
  EXPECT_TRUE(script.steps.empty());
  EXPECT_TRUE(run_on_machine(script).outputs.empty());
}

// Every kind of event survives in a script, with all its fields.
TEST(Script, EveryKindOfEvent) {
  std::vector<std::uint8_t> bytes(kHeadBytes, 0);
  std::set<std::size_t> calls;
  std::set<std::size_t> events;
  for (std::uint8_t kind = 0; kind < 32; ++kind) {
    std::vector<std::uint8_t> one = bytes;
    one.push_back(kind);
    for (std::uint8_t i = 1; i < 40; ++i) one.push_back(i);
    const Script script = decode(view(one));
    ASSERT_FALSE(script.steps.empty());
    const machine::Event& event = script.steps[0].event;
    events.insert(event.index());
    const auto* called = std::get_if<machine::Called>(&event);
    if (called) calls.insert(called->call.index());
  }
  EXPECT_EQ(calls.size(), std::variant_size_v<machine::Call>);
  EXPECT_EQ(events.size(), std::variant_size_v<machine::Event> - 1);  // Timers are the node's own.
}

}  // namespace
}  // namespace rubric::script
