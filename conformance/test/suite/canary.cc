#include "conformance/test/suite/canary.h"

#include <fmt/format.h>

#include <algorithm>

#include "conformance/test/runner/run_case.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/targets/rct_text.h"
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

}  // namespace

std::string dishonesty(targets::Attachment& attachment) {
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
  } catch (const runner::TargetBroken& broken) {
    return fmt::format("{}: {}", doing, broken.what());
  }
  return {};
}

void require_honest(targets::Attachment& attachment, const std::string& target) {
  if (const std::string wrong = dishonesty(attachment); !wrong.empty()) {
    throw runner::TargetBroken(fmt::format("{}: {}", target, wrong));
  }
}

}  // namespace rubric::suite
