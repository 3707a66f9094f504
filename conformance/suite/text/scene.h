// What happened around a line that was not kept: the log, and a chart of it.
#pragma once

#include <string>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// Lines of the log before and after the failure, those that break a rule or the place where one is
/// missing marked with ">". Each line behind `indent` blanks.
std::string log_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                       std::size_t width);
/// The same as a sequence chart with "<<<" at what is wrong.
std::string chart_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                         std::size_t width);

}  // namespace rubric::suite
