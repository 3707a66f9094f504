// What changed since an earlier run.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// One case on one implementation, whatever the versions of both.
struct EarlierKey {
  std::string implementation;   ///< Its name.
  std::string case_name;
  std::size_t which = 0;        ///< Among the implementations of this name, from 0.
  std::uint32_t repeat = 0;     ///< From 0.
  friend auto operator<=>(const EarlierKey&, const EarlierKey&) = default;
};

/// What an earlier run said, as far as a comparison needs it.
struct EarlierRun {
  std::map<EarlierKey, std::string> verdicts;
};

/// Where an implementation of this run stands among those of its name, from 0.
std::size_t which_of_name(const SuiteRun& run, std::size_t implementation);
/// What the earlier run said of it; empty: it has no such case.
std::string earlier_verdict(const EarlierRun& earlier, const SuiteRun& run,
                            std::size_t implementation, const CaseRun& one);

/// A case whose verdict is another one.
struct Change {
  std::string implementation;  ///< As implementation_name() has it, or the earlier run's name.
  std::string case_name;       ///< As case_name() has it.
  std::string was;             ///< Empty: it is new.
  std::string is;              ///< Empty: it is gone, or was not chosen this time.
};

struct Comparison {
  std::vector<Change> changed;
  std::vector<Change> added;
  std::vector<Change> gone;
};
/// In the order of this run, what is gone in alphabetical order.
Comparison compare(const SuiteRun& run, const EarlierRun& earlier);

}  // namespace rubric::suite
