// What a node is held to.
#pragma once

#include <cstddef>
#include <cstdint>

#include "conformance/check/observation.h"
#include "conformance/machine/profile.h"
#include "conformance/trace/parameters.h"

namespace rubric::machine {
struct NamedProfile;  // Each new rule with an entry changes generated/profiles.h.
}

namespace rubric::check {

/// The user's profile with what is stated of a node.
struct Terms {
  machine::Profile profile;
  std::int64_t response_us = 0;     ///< This and the next the user may say in ms.
  std::int64_t ack_timeout_us = 0;  ///< Where the profile has none, the paper's.
  bool ack_timeout_stated = false;
  /// Messages that wait for one line at most (decision 122); unstated, what its buffers hold at
  /// least.
  std::size_t buffers = SIZE_MAX;
};

const machine::NamedProfile& profile_of(bool deployed);

/// Returns what a node is held to: what the user says of all nodes, then what it states of itself
/// (`own`), then the profile.
Terms terms_of(const Options& options, const trace::Statement& own = {});

}  // namespace rubric::check
