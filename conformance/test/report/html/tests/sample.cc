// Makes a report for the test in a browser: the kit's own cases, some of them twice, on a good
// machine, on a broken one, and on one whose every word is markup. Usage: rubric_report_sample DIR
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "conformance/selftest/mutants/mutant.h"
#include "conformance/selftest/mutants/wrapped.h"
#include "conformance/test/report/html.h"
#include "conformance/test/report/words.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/tests/testing.h"

namespace rubric::suite {
namespace {

constexpr const char* kBroken = "wrong_seq_accepted_and_acked_as_it_is";
constexpr const char* kMarkup =
    "</script><script>window.pwned = 1</script><img src=x "
    "onerror='window.pwned = 2'>";

mutants::StepMaker broken_step() {
  for (const mutants::Mutant& one : mutants::named_mutants()) {
    if (one.name == kBroken) return one.step;
  }
  throw std::runtime_error("no such mutant");
}

ImplementationRun run_plan(const std::string& name, const testing::Wrap& make, const Plan& plan) {
  return run(
      "./" + name,
      [&] {
        auto out = std::make_unique<testing::FakeAttachment>();
        out->who.name = name;
        out->make = make;
        return out;
      },
      plan);
}

// Repeats some cases under other names: the earlier run has none of these.
void repeat_some(ImplementationRun& run) {
  const std::size_t before = run.cases.size();
  for (std::size_t i = 0; i < before; ++i) {
    const std::string family = run.cases[i].name.substr(0, run.cases[i].name.find('.'));
    if (family != "j4" && family != "edges_j" && family != "n10") continue;
    CaseRun copy = run.cases[i];
    copy.name += ".again";
    run.cases.push_back(std::move(copy));
  }
}

// Returns a case of each verdict and expectation, with texts that try to break out of the page.
ImplementationRun hostile(const ImplementationRun& good) {
  ImplementationRun out{.target = std::string("javascript:alert(1)//") + kMarkup,
                        .identity = {kMarkup, "../../..", {machine::Role::kMote}, false},
                        .stderr_text = std::string("\xFF\xFE<!--<script>") + kMarkup};
  for (std::size_t i = 0; i < kVerdicts.size(); ++i) {
    CaseRun& one = out.cases.emplace_back(good.cases.at(i));
    one.result.verdict = kVerdicts[i];
    one.result.reason = kMarkup;
    one.stderr_text = std::string(kMarkup) + "\x01\xC3(";
    one.expected_reason = kMarkup;
    one.expectation = i % 2 == 0 ? Expectation::kNone : Expectation::kOtherwise;
    if (kVerdicts[i] == runner::CaseVerdict::kFail) {
      one.result.failures.push_back(
          {{12, 1}, {"J4-SEQ", "__proto__", kMarkup}, false, 3, kMarkup, kMarkup, 1, 3, true});
    }
    one.channel_access = 30;
    trace::Line line = trace::Line();
    line.time = trace::Time::at(1);
    line.node = "m5";
    line.op = trace::Op::kEmits;
    line.link = "rA";
    line.bytes = std::string("\0\xFF\xFF", 3);
    line.message = trace::Message::named("am").with("payload", trace::Value::quoted(kMarkup));
    one.result.log.add(line);
  }
  return out;
}

EarlierRun earlier_of(const ImplementationRun& run) {
  EarlierRun out;
  for (const CaseRun& one : run.cases) {
    out.verdicts[{run.identity.name, one.name}] = runner::verdict_text(one.result.verdict);
  }
  return out;
}

int write(const std::string& folder) {
  const Cases cases = Cases::own();
  Plan plan{.cases = cases.all()};
  SuiteRun all;
  all.implementations.push_back(run_plan("good", testing::machine_target, plan));
  const mutants::StepMaker step = broken_step();
  all.implementations.push_back(run_plan(
      "broken",
      [&step] {
        return std::make_unique<runner::SubjectTarget>(std::make_unique<mutants::Wrapped>(step));
      },
      plan));
  EarlierRun earlier = earlier_of(all.implementations[0]);
  for (const auto& [key, verdict] : EarlierRun(earlier).verdicts) {
    earlier.verdicts[{"broken", key.case_name}] = verdict;
  }
  earlier.verdicts[{"good", "j4.that_was"}] = "fail";
  earlier.verdicts[{"retired", "j4.accept"}] = "pass";
  for (ImplementationRun& one : all.implementations) repeat_some(one);
  all.implementations.push_back(hostile(all.implementations[0]));
  all.stale.push_back({"known.yaml:3", kMarkup});
  ReportFolder report(folder);
  write_html_report(all, &earlier, report);
  report.finish();
  return 0;
}

}  // namespace
}  // namespace rubric::suite

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: rubric_report_sample DIR\n", stderr);
    return 64;
  }
  try {
    return rubric::suite::write(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
