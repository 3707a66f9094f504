#include "conformance/trace/parameters.h"

#include <algorithm>
#include <array>

#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

constexpr std::int64_t kTicksMax = 0xFFFF;
constexpr std::int64_t kDayTicks = 24 * 60 * 60 * 1024;

// Decisions of spec/decisions, less their 0.
constexpr std::array<Parameter, 11> kParameters{{
    {ParameterId::kResponse, "response", "ticks", 1, 1500, 125,
     "How long a reply, an ack or a forward may take."},
    {ParameterId::kJoinPeriod, "join_period", "ticks", 1, kTicksMax, 133,
     "From one join_request to the next."},
    {ParameterId::kJoinRequests, "join_requests", "requests", 1, 255, 101,
     "join_requests of one joinIsland call, at most."},
    {ParameterId::kAckJoins, "ack_joins", "frames", 1, 20, 102,
     "ack_joins at most, while the link layer confirms none."},
    {ParameterId::kAckTimeout, "ack_timeout", "ticks", 1, kTicksMax, 110,
     "How long a reliable message awaits its ack."},
    {ParameterId::kChannelAccess, "channel_access", "ticks", 0, 100, 128,
     "How long the radio may wait for the channel, so how much shorter a timer may look."},
    {ParameterId::kMembers, "members", "motes", 1, 20, 107, "Members that a sink lists."},
    {ParameterId::kChannels, "channels", "channels", 1, 8, 129,
     "Synaptic channels of each direction."},
    {ParameterId::kSynapticPeriod, "synaptic_period", "ticks", 1, kTicksMax, 133,
     "Period of the synaptic clock until set_time_step."},
    {ParameterId::kSynapticPhase, "synaptic_phase", "ticks", 0, 255, 121,
     "A mote's synaptic clock starts (devid - 1) times this late."},
    {ParameterId::kGoneAfter, "gone_after", "ticks", 1, kDayTicks, 124,
     "Silence after which a sink or base station calls a mote gone; unstated: never."},
}};

}  // namespace

std::span<const Parameter> parameters() { return kParameters; }

const Parameter& parameter(ParameterId id) { return kParameters[static_cast<std::size_t>(id)]; }

const Parameter* find_parameter(std::string_view name) {
  for (const Parameter& one : kParameters) {
    if (name == one.name) return &one;
  }
  return nullptr;
}

std::string parameter_names() {
  std::string out;
  for (const Parameter& one : kParameters) {
    if (!out.empty()) out += ", ";
    out += one.name;
  }
  return out;
}

const std::int64_t* find(const Statement& statement, ParameterId id) {
  const auto found = std::find_if(statement.begin(), statement.end(),
                                  [&](const Stated& one) { return one.id == id; });
  return found == statement.end() ? nullptr : &found->value;
}

std::string add_stated(std::string_view word, Statement& out) {
  const std::size_t sign = word.find('=');
  const std::string_view name = word.substr(0, sign);
  const Parameter* const known = find_parameter(name);
  if (!known) {
    return quoted(name) + " is no parameter that can be stated; known are " + parameter_names();
  }
  const std::string_view text = sign == std::string_view::npos ? "" : word.substr(sign + 1);
  std::int64_t value = 0;
  if (!read_integer(text, value) || value < known->min || value > known->max) {
    return "expected " + std::string(name) + " from " + std::to_string(known->min) + " to " +
           std::to_string(known->max) + ' ' + known->unit + ", given " + quoted(text);
  }
  if (find(out, known->id)) return std::string(name) + " is stated twice";
  out.push_back({known->id, value});
  return {};
}

Statement joined(Statement first, const Statement& second) {
  for (const Stated& one : second) {
    if (!find(first, one.id)) first.push_back(one);
  }
  return first;
}

std::string statement_text(const Statement& statement) {
  std::string out;
  for (const Stated& one : statement) {
    if (!out.empty()) out += ' ';
    out += parameter(one.id).name + ('=' + std::to_string(one.value));
  }
  return out;
}

std::string add_range(std::string_view word, std::vector<StatedRange>& out) {
  const std::size_t dots = word.find("..");
  Statement ends;
  std::string wrong = add_stated(word.substr(0, dots), ends);
  if (!wrong.empty()) return wrong;
  const Stated least = ends.front();
  if (dots != std::string_view::npos) {
    ends.clear();
    wrong = add_stated(
        std::string(parameter(least.id).name) + '=' + std::string(word.substr(dots + 2)), ends);
    if (!wrong.empty()) return wrong;
  }
  const StatedRange range{least.id, least.value, ends.front().value};
  if (range.most < range.least) return quoted(word) + " ends before it begins";
  for (const StatedRange& other : out) {
    if (other.id == range.id) return parameter(range.id).name + std::string(" is stated twice");
  }
  out.push_back(range);
  return {};
}

std::string range_text(const StatedRange& range) {
  std::string out = statement_text({{range.id, range.least}});
  if (range.most != range.least) out += ".." + std::to_string(range.most);
  return out;
}

}  // namespace rubric::trace
