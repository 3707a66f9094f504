#include "conformance/runner/expectation.h"

#include <algorithm>
#include <string_view>

#include "codec/reflect/fault_text.h"

namespace rubric::runner {

Ticks ticks_of(trace::Tick unit, std::int64_t time) {
  const std::int64_t per_second = trace::ticks_per_second(unit);
  return static_cast<Ticks>(time * 1024 / per_second);
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
