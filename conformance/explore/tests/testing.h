// Networks of the explorer's tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "conformance/explore/search.h"
#include "conformance/generated/profiles.h"

namespace rubric::explore {

/// Returns options with loss and duplication; one call each, one copy of a frame in flight.
inline Options network(int motes, int sinks) {
  Options options;
  options.profile = machine::kPaper;
  options.motes = static_cast<std::uint8_t>(motes);
  options.sinks = static_cast<std::uint8_t>(sinks);
  options.loss = options.dup = true;
  return options;
}

inline Result run(const Options& options) {
  const auto nodes = std::make_unique<Nodes>(options);
  return explore(*nodes);
}

/// Returns the names of a set of properties() or goals().
std::string names_in(Mask mask, const auto& all) {
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if ((mask >> i & 1) != 0) text += std::string(text.empty() ? "" : " ") + all[i].name;
  }
  return text;
}

/// Searches all of it, and expects that nothing breaks and that every goal is reached.
inline Result holds(const Options& options) {
  const Result result = run(options);
  EXPECT_TRUE(result.complete) << result.limit;
  EXPECT_FALSE(result.violation) << names_in(result.violation->violated, properties());
  EXPECT_EQ(names_in(expected_goals(options) & ~result.goals, goals()), "") << "never reached";
  return result;
}

}  // namespace rubric::explore
