#include "conformance/trace/events/parameters.h"

#include <string>
#include <type_traits>

namespace rubric::events {
namespace {

using trace::ParameterId;

// Calls `call` with the member of the profile, whatever its type.
template <class AnyProfile, class Call>
void visit(AnyProfile& profile, ParameterId id, Call call) {
  switch (id) {
    case ParameterId::kResponse: return call(profile.response_ticks);
    case ParameterId::kJoinPeriod: return call(profile.join_period_ticks);
    case ParameterId::kJoinRequests: return call(profile.join_requests_max);
    case ParameterId::kAckJoins: return call(profile.ack_join_max);
    case ParameterId::kAckTimeout: return call(profile.ack_timeout_ticks);
    case ParameterId::kChannelAccess: return call(profile.early_ticks);
    case ParameterId::kMembers: return call(profile.members_max);
    case ParameterId::kChannels: return call(profile.channels_max);
    case ParameterId::kSynapticPeriod: return call(profile.synaptic_period_ticks);
    case ParameterId::kSynapticPhase: return call(profile.synaptic_phase_ticks);
  }
}

}  // namespace

std::int64_t value_of(const machine::Profile& profile, ParameterId id) {
  std::int64_t out = 0;
  visit(profile, id, [&](auto value) { out = value; });
  return out;
}

std::int64_t assumed(const machine::Profile& profile, ParameterId id) {
  if (id == ParameterId::kChannelAccess) return 0;
  const std::int64_t own = value_of(profile, id);
  return own == 0 && id == ParameterId::kAckTimeout ? value_of({}, id) : own;
}

std::string contradiction(const trace::Statement& statement) {
  constexpr std::int64_t kShortest = 150;  // From the latest ack to the timeout, in golden traces.
  machine::Profile profile;
  state(profile, statement);
  const std::int64_t timeout = assumed(profile, ParameterId::kAckTimeout);
  const std::int64_t response = value_of(profile, ParameterId::kResponse);
  if (timeout >= response + kShortest) return {};
  return "ack_timeout=" + std::to_string(timeout) +
         " leaves no time for an ack, which may take response=" + std::to_string(response) +
         ": expected at least " + std::to_string(response + kShortest);
}

void state(machine::Profile& profile, const trace::Statement& statement) {
  for (const trace::Stated& one : statement) {
    visit(profile, one.id, [&](auto& value) {
      value = static_cast<std::remove_reference_t<decltype(value)>>(one.value);
    });
  }
}

}  // namespace rubric::events
