#include "conformance/selftest/scripts/script.h"

#include <algorithm>

#include "conformance/generated/profiles.h"

namespace rubric::script {
namespace {

bool is_link_ack(const Step& step) { return std::holds_alternative<machine::SendDone>(step.event); }

}  // namespace

machine::Event Step::event_with_bytes() const {
  machine::Event out = event;
  const Bytes own(bytes.data(), bytes.size());
  if (auto* heard = std::get_if<machine::Heard>(&out)) {
    heard->frame.payload = own;
  } else if (auto* called = std::get_if<machine::Called>(&out)) {
    if (auto* send = std::get_if<machine::Send>(&called->call)) send->data = own;
  }
  return out;
}

Ticks Script::length() const {
  Ticks all = rest;
  for (const Step& step : steps) all += step.delay;
  return all;
}

Played play(const Script& script, runner::Target& target) {
  Played run;
  target.reset(script.config);
  auto link_acks = std::count_if(script.steps.begin(), script.steps.end(), is_link_ack);
  target.hold_link_acks(link_acks > 0);
  Ticks now = 0;
  const auto pass = [&](Ticks delay) {
    now += delay;
    while (target.run_until(now) < now) {
    }
  };
  for (const Step& step : script.steps) {
    pass(step.delay);
    if (is_link_ack(step)) target.hold_link_acks(--link_acks > 0);
    run.before.push_back(target.outputs().size());
    target.give(now, step.event_with_bytes());
  }
  pass(script.rest);
  run.outputs = target.outputs();
  return run;
}

bool is_deployed(const machine::Profile& profile) {
  machine::Profile same = machine::kDeployed;
  same.channels_max = profile.channels_max;
  return same == profile;
}

}  // namespace rubric::script
