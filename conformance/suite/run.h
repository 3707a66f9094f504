// Works the chosen golden traces on an implementation.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/suite/cases.h"
#include "conformance/suite/expected.h"

namespace rubric::suite {

/// What nodes get of a seed has 16 bits: one more would be an earlier one again.
inline constexpr std::uint64_t kSeedMax = 65535;

struct Plan {
  std::vector<SuiteCase> cases;
  std::string profile;                ///< Whatever the traces say; empty: as they say.
  std::optional<std::uint64_t> seed;  ///< Of traces that state none; each repeat has one more,
                                      ///< up to kSeedMax.
  std::uint32_t repeats = 1;
  unsigned jobs = 1;                  ///< Attachments at once; one only where time is real.
  report::KnownFailures expected;
};

/// Makes one more attachment to the same implementation. Throws nothing.
using MakeAttachment = std::function<std::unique_ptr<attach::Attachment>()>;

/// Called from one thread at a time.
struct Watcher {
  /// Identity is known, and it is honest or not; nothing was worked yet.
  std::function<void(const ImplementationRun&)> started;
  /// In the order of cases, however many jobs there are.
  std::function<void(const CaseRun&)> worked;
};

/// Of a dishonest implementation no case is worked.
ImplementationRun run(const std::string& target, const MakeAttachment& make, const Plan& plan,
                      const Watcher& watcher = {});

/// One case, once. `seed` as in Plan; `identity` says which roles it plays.
CaseRun run_one(const SuiteCase& one, attach::Attachment& attachment, const std::string& profile,
                std::optional<std::uint64_t> seed);

}  // namespace rubric::suite
