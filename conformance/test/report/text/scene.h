// Shows the events around a line that was not kept: the log, and a chart of it.
#pragma once

#include <string>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns lines of the log before and after the failure; those that break a rule, or the place of
/// a missing one, are marked with ">". Each line begins with `indent` blanks.
std::string log_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                       std::size_t width);
/// Returns the same as a sequence chart with "<<<" at the fault.
std::string chart_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                         std::size_t width);

}  // namespace rubric::suite
