// Runs the chosen golden traces on an implementation.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/expected.h"

namespace rubric::suite {

/// Nodes use 16 bits of a seed: a larger one would equal an earlier one.
inline constexpr std::uint64_t kSeedMax = 65535;

struct Plan {
  std::vector<SuiteCase> cases;
  std::string profile;                ///< Whatever the traces say; empty: as they say.
  std::optional<std::uint64_t> seed;  ///< For traces that state none; each repeat adds one,
                                      ///< up to kSeedMax.
  std::uint32_t repeats = 1;
  unsigned jobs = 1;  ///< Attachments at once; one only where time is real.
  report::KnownFailures expected;
};

/// Makes one more attachment to the same implementation. Throws nothing.
using MakeAttachment = std::function<std::unique_ptr<targets::Attachment>()>;

/// Called from one thread at a time.
struct Watcher {
  /// Called once identity and honesty are known, before any case is run.
  std::function<void(const ImplementationRun&)> started;
  /// Called in the order of cases, however many jobs there are.
  std::function<void(const CaseRun&)> case_done;
};

/// Runs the plan; runs no case of a dishonest implementation.
ImplementationRun run(const std::string& target, const MakeAttachment& make, const Plan& plan,
                      const Watcher& watcher = {});

/// Runs one case once. `seed` as in Plan; `identity` has the roles that it plays.
CaseRun run_one(const SuiteCase& one, targets::Attachment& attachment, const std::string& profile,
                std::optional<std::uint64_t> seed);

}  // namespace rubric::suite
