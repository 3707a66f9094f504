#include "conformance/test/runner/expectation.h"

#include <algorithm>
#include <string_view>

#include "codec/reflect/fault_text.h"

namespace rubric::runner {

Ticks ticks_of(trace::Tick unit, std::int64_t time) {
  return machine::ticks_of(time, trace::ticks_per_second(unit));
}

bool is_weak(const trace::Line& line) {
  return !line.requirements.empty() &&
         std::all_of(line.requirements.begin(), line.requirements.end(), [](const auto& name) {
           const ReqId id = trace::requirement_id(name);
           return id != ReqId::kNone &&
                  std::string_view(reflect::requirement(id).level) == "SHOULD";
         });
}

}  // namespace rubric::runner
