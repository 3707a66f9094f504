#include "conformance/check/terms.h"

#include <cassert>

#include "conformance/generated/profiles.h"
#include "conformance/machine/ticks.h"
#include "conformance/trace/events/lines.h"

namespace rubric::check {

const machine::NamedProfile& profile_of(bool deployed) {
  const machine::NamedProfile* const profile =
      machine::find_profile(deployed ? "deployed" : "paper");
  assert(profile != nullptr);  // A static_assert is too much for sanitized builds.
  return *profile;
}

Terms terms_of(const Options& options, const trace::Statement& own) {
  const trace::Statement stated = joined(options.stated, own);
  Terms out{.profile = profile_of(options.deployed).profile};
  events::state(out.profile, stated);
  out.response_us = options.response_us.value_or(machine::us_of(out.profile.response_ticks));
  // A profile without a timeout describes its nodes, not how long others wait (decision 110).
  const std::uint16_t timeout = out.profile.ack_timeout_ticks;
  out.ack_timeout_us = options.ack_timeout_us.value_or(
      machine::us_of(timeout != 0 ? timeout : machine::Profile{}.ack_timeout_ticks));
  out.ack_timeout_stated = options.ack_timeout_us.has_value() ||
                           find(stated, trace::ParameterId::kAckTimeout) != nullptr;
  const std::int64_t* const buffers = find(stated, trace::ParameterId::kBuffers);
  if (buffers != nullptr) out.buffers = static_cast<std::size_t>(*buffers);
  return out;
}

}  // namespace rubric::check
