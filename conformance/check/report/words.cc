#include "conformance/check/report/words.h"

#include <fmt/format.h>

#include "codec/reflect/requirements.h"

namespace rubric::report {
std::string_view severity_name(check::Severity severity) {
  switch (severity) {
    case check::Severity::kNote: return "note";
    case check::Severity::kWeak: return "weak";
    case check::Severity::kStray: return "stray";
    case check::Severity::kInconclusive: return "inconclusive";
    case check::Severity::kFail: return "fail";
  }
  return "fail";
}

std::string_view verdict_name(check::Verdict verdict) {
  // A verdict is the severity of the gravest finding, where a note is none.
  static_assert(static_cast<int>(check::Verdict::kFail) ==
                static_cast<int>(check::Severity::kFail));
  return verdict == check::Verdict::kPass ? "pass"
                                          : severity_name(static_cast<check::Severity>(verdict));
}

std::string place_text(const check::Run& run, const check::Place& place) {
  std::string out =
      place.frame == 0 ? std::string("the end of the run") : fmt::format("frame {}", place.frame);
  if (place.frame != 0 && run.files.size() > 1 && place.file < run.files.size()) {
    out += " of " + run.files[place.file];
  }
  if (place.time_us >= 0) out += " at " + text::seconds_text(place.time_us) + " s";
  return out;
}

std::string_view rule_text(ReqId id) {
  return id == ReqId::kNone ? std::string_view("(no rule)") : reflect::requirement(id).id;
}

std::string heading_text(const check::Run& run, const check::Finding& finding) {
  return fmt::format("{}, {}{}{}", rule_text(finding.requirement), finding.node,
                     finding.node.empty() ? "" : ", ", place_text(run, finding.place));
}

}  // namespace rubric::report
