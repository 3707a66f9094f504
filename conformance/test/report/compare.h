// Compares a run with an earlier one.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Identifies one case on one implementation, whatever the versions of both.
struct EarlierKey {
  std::string implementation;  ///< Its name.
  std::string case_name;
  std::size_t which = 0;     ///< Among the implementations of this name, from 0.
  std::uint32_t repeat = 0;  ///< From 0.
  friend auto operator<=>(const EarlierKey&, const EarlierKey&) = default;
};

/// The results of an earlier run, as far as a comparison needs them.
struct EarlierRun {
  std::map<EarlierKey, std::string> verdicts;
};

/// Returns the index of an implementation of this run among those of its name, from 0.
std::size_t which_of_name(const SuiteRun& run, std::size_t implementation);
/// Returns its verdict in the earlier run; empty if that has no such case.
std::string earlier_verdict(const EarlierRun& earlier, const SuiteRun& run,
                            std::size_t implementation, const CaseRun& one);

/// A case whose verdict has changed.
struct Change {
  std::string implementation;  ///< As in implementation_name(), or the earlier run's name.
  std::string case_name;       ///< As in case_name().
  std::string was;             ///< Empty: it is new.
  std::string is;              ///< Empty: it is gone, or was not chosen this time.
};

struct Comparison {
  std::vector<Change> changed;
  std::vector<Change> added;
  std::vector<Change> gone;
};
/// Compares in the order of this run; cases that are gone come in alphabetical order.
Comparison compare(const SuiteRun& run, const EarlierRun& earlier);

}  // namespace rubric::suite
