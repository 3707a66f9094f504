#include "conformance/check/judge/context.h"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "codec/reflect/requirements.h"

namespace rubric::check {
namespace {

bool is_of(ReqId requirement, std::string_view group) {
  return std::string_view(reflect::requirement(requirement).id).starts_with(group);
}

}  // namespace

void Context::look_up() {
  sink_am = profile().sink_id;
  mote_of_am.assign(65536, kNobody);
  next_of_am.assign(who.devices.size(), kNobody);
  for (std::size_t i = 0; i < who.devices.size(); ++i) {
    const Device& device = who.devices[i];
    const auto index = static_cast<std::uint16_t>(i);
    if (!device.known) continue;
    if (device.role == machine::Role::kMote) {
      next_of_am[i] = mote_of_am[device.am];
      mote_of_am[device.am] = index;
    }
    if (device.role != machine::Role::kSink) continue;
    sink_am = device.am;
    only_sink = sinks.empty() ? index : kNobody;
    sinks.push_back(index);
  }
  const Given given(options);
  const std::uint16_t said = given.sink_am().value_or(sink_am);
  if (mote_of_am[said] == kNobody) sink_am = said;
  for (const Contradiction& one : who.contradictions) {
    std::uint16_t node = who.marks[one.index].device;
    if (node != kNobody && device(node).role == machine::Role::kBaseStation) {
      node = device(node).partner;
    }
    report(one.requirement, Severity::kInconclusive, run.seen[one.index].place, node,
           {one.text, one.expected, {}});
  }
  for (const Tap& tap : run.taps) {
    hears_radio = hears_radio || tap.link == machine::Link::kRadio;
  }
  down_taps.resize(run.taps.size());
  for (const Observation& seen : run.seen) {
    if (seen.kind == Observation::Kind::kSerial && seen.to_mote) down_taps[seen.tap] = true;
  }
  untimed_taps = run.unordered_taps;
  untimed_taps.resize(run.taps.size());
  unordered = std::find(untimed_taps.begin(), untimed_taps.end(), true) != untimed_taps.end();
  if (run.has_time) return;
  std::optional<std::int64_t> order;  // A file without stamps, or all that have some.
  for (const Observation& seen : run.seen) {
    const std::int64_t its = seen.place.in_order() ? -1 : std::int64_t{seen.place.file};
    unordered = unordered || (order && *order != its);
    order = its;
    if (its >= 0) untimed_taps[seen.tap] = true;
  }
}

bool Context::rests_on_order(ReqId requirement, const Place& at, std::uint16_t node) const {
  // A frame that breaks a rule of the format breaks it at any time.
  if (!unordered || is_of(requirement, "WIRE-")) return false;
  if (!at.in_order()) return true;
  if (node == kNobody) return false;
  // Replies to requests are on the air alone; reports of joins on a line are not.
  const bool air = is_of(requirement, "J3-") || is_of(requirement, "J10-");
  if (air && (run.unordered_taps.empty() || requirement == "J3-TIME"_rule)) return false;
  const Device& d = device(node);
  const Device& lines =
      d.role == machine::Role::kBaseStation && d.partner != kNobody ? device(d.partner) : d;
  for (const std::uint32_t tap : lines.taps) {
    if (untimed_taps[tap]) return true;
  }
  return false;
}

bool Context::half_heard(std::uint16_t node) const {
  const Device& d = device(node);
  const bool down = std::any_of(d.taps.begin(), d.taps.end(),
                                [this](std::uint32_t tap) { return down_taps[tap]; });
  return !d.hearing && !d.taps.empty() && !down;
}

std::int64_t Context::ack_timeout_us() const {
  if (options.ack_timeout_us) return *options.ack_timeout_us;
  // A profile without a timeout describes its nodes, not how long others wait (decision 110).
  const std::uint16_t own = profile().ack_timeout_ticks;
  return machine::us_of(own != 0 ? own : machine::Profile{}.ack_timeout_ticks);
}

bool Context::ack_timeout_stated() const {
  constexpr auto kAckTimeout = trace::ParameterId::kAckTimeout;
  return options.ack_timeout_us.has_value() || find(options.stated, kAckTimeout) ||
         find(run.stated, kAckTimeout);
}

Severity Context::without(std::uint16_t cause, std::int64_t from_us, std::int64_t to_us) const {
  return who.maybe_unseen(cause, from_us, to_us, options) ? Severity::kInconclusive
                                                          : Severity::kFail;
}

Severity Context::without_ever(std::uint16_t cause, std::int64_t to_us) const {
  if (!options.start_cold) return Severity::kInconclusive;
  return without(cause, run.start_us, to_us);
}

void Context::report(ReqId requirement, Severity severity, const Place& at, std::uint16_t node,
                     Said said) {
  Finding finding;
  finding.requirement = requirement;
  finding.severity = severity;
  finding.place = at;
  finding.text = std::move(said.text);
  finding.expected = std::move(said.expected);
  finding.hypotheses = std::move(said.hypotheses);
  if (node != kNobody) {
    const Device& d = device(node);
    if (!d.judged) return;
    finding.node = d.name;
    if (!d.known && severity > Severity::kNote) finding.severity = Severity::kStray;
  }
  const bool blames = finding.severity == Severity::kFail || finding.severity == Severity::kWeak;
  if (blames && rests_on_order(requirement, at, node)) {
    finding.severity = Severity::kInconclusive;
  }
  findings.add(std::move(finding));
}

void Context::report_stranger(const Observation& seen, std::uint16_t node) {
  report(ReqId::kNone, Severity::kStray, seen.place, node,
         {"A frame from AM address " + number(seen.frame.src) +
              " whose DSN follows none of that address's.",
          "Frames of nodes that the run shows.",
          {}});
}

std::string text_of(machine::Address address) {
  const auto part = [](std::uint16_t n, bool pid) -> std::string {
    if (n == 0xFFFF) return "all";
    if (pid && n == machine::kLocalPid) return "local";
    if (!pid && n == machine::kNullDevid) return "null";
    return std::to_string(n);
  };
  return "<" + part(address.pid, true) + ", " + part(address.devid, false) + ">";
}

std::string name_of(const Net& net) {
  return "the message " + text_of(net.src) + " to " + text_of(net.dest) + " with number " +
         number(net.seq_num);
}

std::string ms_text(std::int64_t us) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f ms", static_cast<double>(us) / 1000);
  return text;
}

std::string number(std::uint64_t n) { return std::to_string(n); }

}  // namespace rubric::check
