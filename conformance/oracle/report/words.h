// Words and marks that every form of a report shares.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "conformance/oracle/finding.h"
#include "conformance/oracle/observation.h"

namespace rubric::report {

/// "fail", "weak", "stray", "inconclusive", "note"; stable, as programs read them.
std::string_view severity_name(oracle::Severity severity);
/// "pass", "weak", "stray", "inconclusive", "fail".
std::string_view verdict_name(oracle::Verdict verdict);

/// "3.842100"; empty without a time.
std::string seconds_text(std::int64_t time_us);
/// "frame 12 at 3.842100 s", "frame 12 of b.pcapng at ..." in a run of several files, "the end of
/// the run" where no frame is meant.
std::string place_text(const oracle::Run& run, const oracle::Place& place);
/// "1 frame", "2 frames".
std::string counted(std::uint64_t number, std::string_view singular, std::string_view plural = {});

/// Lines of at most `width` characters, broken at blanks, each with its end: the first behind
/// `first`, the others behind `hang` blanks. A word that is longer stands alone.
std::string wrapped(std::string_view first, std::string_view text, std::size_t width,
                    std::size_t hang);
/// The others behind as many blanks as `first` has characters.
inline std::string wrapped(std::string_view first, std::string_view text, std::size_t width) {
  return wrapped(first, text, width, first.size());
}

/// With quotes; bytes that are no UTF-8 become U+FFFD.
std::string json_string(std::string_view text);
/// For attributes and content alike; what XML 1.0 cannot hold becomes U+FFFD.
std::string xml_text(std::string_view text);

}  // namespace rubric::report
