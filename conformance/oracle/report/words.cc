#include "conformance/oracle/report/words.h"

#include <fmt/format.h>

namespace rubric::report {
std::string_view severity_name(oracle::Severity severity) {
  switch (severity) {
    case oracle::Severity::kNote: return "note";
    case oracle::Severity::kWeak: return "weak";
    case oracle::Severity::kStray: return "stray";
    case oracle::Severity::kInconclusive: return "inconclusive";
    case oracle::Severity::kFail: return "fail";
  }
  return "fail";
}

std::string_view verdict_name(oracle::Verdict verdict) {
  switch (verdict) {
    case oracle::Verdict::kPass: return "pass";
    case oracle::Verdict::kWeak: return "weak";
    case oracle::Verdict::kStray: return "stray";
    case oracle::Verdict::kInconclusive: return "inconclusive";
    case oracle::Verdict::kFail: return "fail";
  }
  return "error";
}

std::string place_text(const oracle::Run& run, const oracle::Place& place) {
  std::string out = place.frame == 0 ? std::string("the end of the run")
                                     : fmt::format("frame {}", place.frame);
  if (place.frame != 0 && run.files.size() > 1 && place.file < run.files.size()) {
    out += " of " + run.files[place.file];
  }
  if (place.time_us >= 0) out += " at " + seconds_text(place.time_us) + " s";
  return out;
}

}  // namespace rubric::report
