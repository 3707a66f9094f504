#include "conformance/test/suite/canary.h"

#include <fmt/format.h>

#include <algorithm>

#include "conformance/test/runner/run_case.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/targets/rct_text.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"

namespace rubric::suite {
namespace {

// A mote that is notified that it joined though nobody replied; a sink and a base station that
// report what nobody gave them. Numbers and bytes are too odd to come up by chance.
constexpr const char* kCanaries = R"rtr(%rtr 1
%profile paper

case canary.mote
%node m5 mote id=5 iut
%node sA sink id=1 island=11
a: 0        m5 < app  join(telosb_demo light led)
   a+0..100 m5 > app  joined(10053:5 success)

case canary.sink
%node sA sink id=1 island=11 iut
   0..100   sA > serA net_msg(dest=11:null src=11:77 seq_num=0xca9a payload.payload=xca9a ...)

case canary.base_station
%node bA base_station island=11 iut
   0..100   bA > serA net_msg(dest=11:77 src=11:null seq_num=0xca9a payload.payload=xca9a ...)
)rtr";

// Returns the same for another protocol: each role has to send a frame that nobody can know.
std::string canaries() {
  if (trace::protocol().has_machine) return kCanaries;
  std::string out = "%rtr 1\n";
  for (const trace::RoleInfo& role : trace::protocol().roles) {
    const char* const link = role.radio ? "rA" : role.serial ? "serA" : "peis";
    out += fmt::format(
        "case canary.{0}\n%node n {0}{1}{2} iut\n0..100 n > {3} am=*->* am(type=202 "
        "payload=xca9a10053a ...)\n",
        role.name, role.has_id ? " id=5" : "", role.has_island ? " island=11" : "", link);
  }
  return out;
}

bool plays(const targets::Identity& identity, machine::Role role) {
  return std::find(identity.roles.begin(), identity.roles.end(), role) != identity.roles.end();
}

std::string try_canary(const SuiteCase& one, targets::Attachment& attachment) {
  using runner::CaseVerdict;
  const runner::CaseResult result = runner::run_case(
      one.file->file, one.whole(), [&](const trace::NodeHeader&) { return attachment.target(); });
  for (const runner::Failure& failure : result.failures) {
    if (!failure.crash || !failure.text.starts_with("unsupported `until")) continue;
    return fmt::format("it does not speak rct/{}, where time passes for all nodes: {}",
                       targets::kRctVersion, failure.text);
  }
  switch (result.verdict) {
    case CaseVerdict::kPass:
    case CaseVerdict::kWeak:
      return fmt::format("{} has to fail, for nothing causes what it asks for, but it passed",
                         one.one->name);
    case CaseVerdict::kError:  // Other cases show this fault too.
    case CaseVerdict::kInconclusive:
    case CaseVerdict::kSkip:
    case CaseVerdict::kFail: return {};
  }
  return {};
}

// A number for `$seeded` that no seed gives, and as hard as any: two unlike bytes, the sign bit.
constexpr std::string_view kUnseeded = "61607";

std::string with_unseeded(const SuiteCase& one) {
  trace::File file{.head = one.file->file.head};
  file.cases.push_back(one.whole());
  std::string text = trace::print(file);
  const std::string name = fmt::format("${}", trace::kSeeded);
  for (std::size_t at = 0; (at = text.find(name, at)) != text.npos;) {
    text.replace(at, name.size(), kUnseeded);
  }
  return text;
}

// Returns what is wrong if it keeps a seeded case with the number that is the same in all runs, and
// not with this run's: a recording has only the answers of its own run. A node that is wrong itself
// fails both; what is random in it hardly fails all tries.
std::string try_recording(const SuiteCase& one, targets::Attachment& attachment,
                          std::optional<std::uint64_t> seed) {
  constexpr int kTries = 3;
  using runner::CaseVerdict;
  const Cases same = Cases::of_text(with_unseeded(one), "canaries");
  const CaseRun of_all = run_one(same.all().front(), attachment, {}, {});
  if (of_all.result.verdict != CaseVerdict::kPass) return {};
  const CaseRun of_seed = run_one(one, attachment, {}, seed);
  if (of_seed.result.verdict != CaseVerdict::kFail) return {};
  const runner::Failure& first = of_seed.result.failures.front();
  if (first.crash) return {};  // A verdict of the cases that are chosen.
  for (int i = 1; i < kTries; ++i) {
    const CaseRun again = run_one(one, attachment, {}, seed);
    if (again.result.verdict == CaseVerdict::kPass) return {};
  }
  return fmt::format(
      "it keeps {} with the number {}, but not with the one of the seed {}, as a recording of "
      "another run does: {}",
      one.one->name, kUnseeded, seed.value_or(0), first.text);
}

}  // namespace

std::string dishonesty(targets::Attachment& attachment, std::optional<std::uint64_t> seed) {
  const char* doing = "it does not start";
  try {
    const targets::Identity& identity = attachment.identity();
    if (identity.roles.empty()) return "it plays no role";
    doing = "it does not refuse an unknown command";
    if (const std::string wrong = attachment.honesty(); !wrong.empty()) {
      return fmt::format("{}: {}", doing, wrong);
    }
    doing = "it breaks at a case that has to fail";
    const Cases known = Cases::of_text(canaries(), "canaries");
    for (const SuiteCase& one : known.all()) {
      if (!plays(identity, one.roles().front())) continue;
      if (std::string wrong = try_canary(one, attachment); !wrong.empty()) return wrong;
    }
    // In real time it would take as long again.
    if (identity.real_time || !trace::protocol().has_machine) return {};
    doing = "it breaks at a case with a number of the seed";
    const Cases seeded = Cases::own("conformance/cases/seeded.rtr");
    for (const SuiteCase& one : seeded.all()) {
      if (!plays(identity, one.roles().front())) continue;
      if (std::string wrong = try_recording(one, attachment, seed); !wrong.empty()) return wrong;
    }
  } catch (const runner::TargetBroken& broken) {
    return fmt::format("{}: {}", doing, broken.what());
  }
  return {};
}

void require_honest(targets::Attachment& attachment, const std::string& target,
                    std::optional<std::uint64_t> seed) {
  if (const std::string wrong = dishonesty(attachment, seed); !wrong.empty()) {
    throw runner::TargetBroken(fmt::format("{}: {}", target, wrong));
  }
}

}  // namespace rubric::suite
