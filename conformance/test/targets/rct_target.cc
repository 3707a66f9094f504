#include "conformance/test/targets/rct_target.h"

#include <fmt/format.h>

#include <algorithm>

#include "conformance/generated/profiles.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/trace.h"

namespace rubric::targets {
namespace {

using machine::Link;
using runner::TargetBroken;
using runner::Unsupported;

constexpr trace::ParameterId kBuffers = trace::ParameterId::kBuffers;
constexpr std::size_t kOutputsAtOnceMax = 1000;  // At one instant.
constexpr Ticks kClockSlackTicks = 50;
constexpr Ticks kUntilTicksMax = 1U << 16;  // A minute.

// 257 has an inverse: returns the seed that makes this first number, as runner::config_of takes it.
constexpr std::uint16_t seed_of(std::uint16_t first_seq) {
  return static_cast<std::uint16_t>((first_seq - 1000U) * 65281U);
}
static_assert(seed_of(static_cast<std::uint16_t>(1000 + 257 * 12345)) == 12345);

const machine::NamedProfile& profile_of(const machine::Profile& profile) {
  for (const machine::NamedProfile& named : machine::kProfiles) {
    machine::Profile same = named.profile;
    for (const trace::Parameter& one : trace::parameters()) {
      events::state(same, {{one.id, events::value_of(profile, one.id)}});
    }
    if (same == profile) return named;
  }
  throw Unsupported("the profile of the case has no name");
}

/// Builds the command that makes an event happen.
struct CommandOf {
  Ticks now;

  std::string operator()(const machine::Heard& e) const {
    return fmt::format("rx {} {} {}", now, link_word(e.frame.link), hex_of(e.frame));
  }
  std::string operator()(const machine::Called& e) const {
    return fmt::format("call {} {}", now, plain(events::from_call(e.call)));
  }
  std::string operator()(const machine::SendDone& e) const {
    if (e.link != Link::kRadio) throw Unsupported("only the radio has link acks");
    return fmt::format("linkack {} {}", now, e.acked ? 1 : 0);
  }
  std::string operator()(const machine::LinkBusy& e) const {
    return fmt::format("line {} {} {}", now, link_word(e.link), e.busy ? "busy" : "idle");
  }
  std::string operator()(const machine::AppBusy& e) const {
    return fmt::format("line {} app {}", now, e.busy ? "busy" : "idle");
  }
  std::string operator()(const machine::Reboot&) const {
    return fmt::format("power {} reboot", now);
  }
  std::string operator()(const machine::PowerOff&) const {
    return fmt::format("power {} off", now);
  }
  std::string operator()(const machine::TimerDue&) const {
    throw Unsupported("timers of an implementation are its own");
  }
};

lines::Milliseconds ms_of(Ticks ticks) { return lines::Milliseconds(machine::us_of(ticks) / 1000); }

}  // namespace

std::string command_of(const machine::Event& event, Ticks now) {
  return std::visit(CommandOf{now}, event);
}

trace::Statement asked_for(const machine::Config& config, const trace::Statement& own) {
  const machine::Profile& usual = profile_of(config.profile).profile;
  trace::Statement out;
  for (const trace::Parameter& one : trace::parameters()) {
    const std::int64_t value = events::value_of(config.profile, one.id);
    const std::int64_t* const stated = find(own, one.id);
    const bool as_it_is = value == (stated ? *stated : events::value_of(usual, one.id));
    // `reset` always names the channels; of buffers a configuration says nothing.
    if (one.id == trace::ParameterId::kChannels || one.id == kBuffers) continue;
    if (!as_it_is) out.push_back({one.id, value});
  }
  return out;
}

std::string reset_command(const machine::Config& config, const trace::Statement& own) {
  const trace::Statement asked = asked_for(config, own);
  return fmt::format("reset {} id={} island={} channels={} seed={} profile={}{}{}",
                     role_word(config.role), config.id, config.island, config.profile.channels_max,
                     seed_of(config.first_seq), profile_of(config.profile).name,
                     asked.empty() ? "" : " ", trace::statement_text(asked));
}

// An adapter that takes a parameter which does not exist does not know those that do.
void RctTarget::start_node(machine::Role role, const std::string& command,
                           const trace::Statement& wanted) {
  const std::vector<machine::Role>& roles = client_->identity().roles;
  if (std::find(roles.begin(), roles.end(), role) == roles.end()) {
    throw Unsupported(fmt::format("{} plays no {}", client_->identity().name, role_word(role)));
  }
  outputs_.clear();
  link_acks_.clear();
  given_.reset();
  now_ = 0;
  settled_ = knows_next_ = false;
  next_.reset();
  at_instant_ = 0;
  clock_.start();
  Asked asked{.command = command, .closing = "ready"};
  if (wanted.empty()) {
    client_->ask(asked);
    return;
  }
  const std::string text = trace::statement_text(wanted);
  try {
    Asked nonsense = asked;
    nonsense.command += " no_such_parameter=1";
    client_->ask(nonsense);
  } catch (const Unsupported&) {
    try {
      client_->ask(asked);
      return;
    } catch (const Unsupported& error) {
      throw runner::NotBuilt(fmt::format("it is not built with {}: {}", text, error.what()));
    }
  }
  throw runner::NotBuilt(
      fmt::format("it is not built with {}: `reset` takes whatever it is told", text));
}

// Buffers are not in the machine's configuration: what a case says of them goes past it.
void RctTarget::start(const trace::Scope& scope, const trace::NodeHeader& node) {
  trace::Statement wanted;
  for (const trace::Stated& one : node.stated) {
    const std::int64_t* const own = find(own_, one.id);
    if (one.value != (own ? *own : trace::parameter(one.id).unstated)) wanted.push_back(one);
  }
  if (trace::protocol().has_machine) {
    std::erase_if(wanted, [](const trace::Stated& one) { return one.id != kBuffers; });
    buffers_ = std::move(wanted);
    return Target::start(scope, node);
  }
  std::string command = fmt::format("reset {}", trace::role_text(node.role));
  if (node.id) command += fmt::format(" id={}", *node.id);
  if (node.island) command += fmt::format(" island={}", *node.island);
  command += fmt::format(" seed={}", scope.seed & 0xFFFF);
  if (!scope.profile.empty()) command += " profile=" + scope.profile;
  if (!wanted.empty()) command += ' ' + trace::statement_text(wanted);
  start_node(static_cast<machine::Role>(node.role), command, wanted);
}

void RctTarget::reset(const machine::Config& config) {
  std::string command = reset_command(config, own_);
  trace::Statement wanted = asked_for(config, own_);
  for (const trace::Stated& one : buffers_) {
    command += ' ' + trace::statement_text({one});
    wanted.push_back(one);
  }
  start_node(config.role, command, wanted);
}

void RctTarget::give(Ticks now, const machine::Event& event) {
  while (run_until(now) < now) {
  }
  if (std::holds_alternative<machine::SendDone>(event) ||
      std::holds_alternative<machine::Reboot>(event) ||
      std::holds_alternative<machine::PowerOff>(event)) {
    link_acks_.clear();
  }
  give_command(now, command_of(event, now));
}

void RctTarget::call(Ticks now, const trace::Concrete& message) {
  while (run_until(now) < now) {
  }
  give_command(now, fmt::format("call {} {}", now, plain(message.message)));
}

void RctTarget::give_command(Ticks now, std::string command) {
  if (!client_->identity().real_time) {
    ask(std::move(command), now, false);
    return;
  }
  const bool just_emitted = !outputs_.empty() && outputs_.back().time == now;
  const Ticks from = just_emitted ? now + 1 : now;
  given_ = {from, from};
  ask(std::move(command), now, false);
  given_->to = std::max(now_, from);
}

std::optional<Ticks> RctTarget::next() const {
  std::optional<Ticks> soonest = knows_next_ ? next_ : now_ + kUnknownNextTicks;
  if (link_acks_.empty()) return soonest;
  return std::min(link_acks_.front(), soonest.value_or(link_acks_.front()));
}

Ticks RctTarget::run_until(Ticks time) {
  const std::size_t before = outputs_.size();
  while (!link_acks_.empty() && link_acks_.front() <= time) {
    const Ticks due = std::max(link_acks_.front(), now_);
    if (due > now_) {
      // A real clock has to get there before anything can happen then.
      const Ticks reached = let_pass(client_->identity().real_time ? due : due - 1);
      if (outputs_.size() > before) return reached;
    }
    link_acks_.pop_front();
    ask(fmt::format("linkack {} 1", due), due, false);
    if (outputs_.size() > before) {
      let_pass(now_);
      return now_;
    }
  }
  return let_pass(time);
}

// Does the work of run_until, but for link acks. No answer is to take long: a simulated
// microcontroller needs its time for an hour, too.
Ticks RctTarget::let_pass(Ticks time) {
  time = std::max(time, now_);
  if (settled_ && time <= now_) return now_;
  const std::size_t before = outputs_.size();
  do ask_until(std::min(time, now_ + kUntilTicksMax));
  while (now_ < time && outputs_.size() == before);
  return now_;
}

// Does not trust `next`: asks with `until` anyway, and then holds the adapter to its `next`.
void RctTarget::ask_until(Ticks time) {
  const bool foretold = knows_next_;
  const std::optional<Ticks> next = next_;
  const std::size_t before = outputs_.size();
  ask(fmt::format("until {}", time), time, true);
  const bool sooner = outputs_.size() > before && (!next || outputs_[before].time < *next);
  if (foretold && sooner && !client_->identity().real_time) {  // Real clocks are never so exact.
    client_->give_up();
    throw TargetBroken(fmt::format("it wrote something at {} after `next {}`",
                                   outputs_[before].time, next ? std::to_string(*next) : "-"));
  }
}

Ticks RctTarget::ask(std::string command, Ticks time, bool passes_time) {
  Asked asked{.command = std::move(command),
              .from = passes_time ? now_ : time,
              .to = time,
              .passes_time = passes_time,
              .real_time = client_->identity().real_time};
  const bool waits = asked.real_time && time > now_;
  const Answer answer = answer_to(asked, ms_of(waits ? time - now_ : 0));
  for (const Output& output : answer.outputs) {
    const bool same = !outputs_.empty() && outputs_.back().time == output.time;
    at_instant_ = same ? at_instant_ + 1 : 1;
    if (at_instant_ > kOutputsAtOnceMax) {
      client_->give_up();
      throw TargetBroken(fmt::format("`{}`: more than {} frames and events at the instant {}",
                                     asked.command, kOutputsAtOnceMax, output.time));
    }
    outputs_.push_back(output);
    if (given_) outputs_.back().time = std::max(output.time, given_->from);
    const machine::Transmit& frame = output.frame;
    if (!output.is_frame || !frame.link_ack || hold_link_acks_) continue;
    link_acks_.push_back(output.time + runner::transmission_ticks(frame.link, frame.size_bytes));
  }
  now_ = answer.done;
  if (asked.real_time) compare_clocks(asked.command);
  settled_ = passes_time;
  knows_next_ = answer.has_next;
  next_ = answer.next;
  return now_;
}

Answer RctTarget::answer_to(const Asked& asked, lines::Milliseconds more) {
  try {
    return client_->ask(asked, more);
  } catch (const Unsupported& error) {
    if (!asked.passes_time) throw;
    client_->give_up();  // A started node lets time pass.
    throw TargetBroken(std::string("unsupported ") + error.what());
  }
}

// Compares clocks: with a clock that is ahead, silence would be reported that nobody observed.
void RctTarget::compare_clocks(const std::string& command) {
  const Ticks passed = clock_.now();
  if (now_ <= passed + passed / 4 + tolerance().late + kClockSlackTicks) return;
  client_->give_up();
  throw TargetBroken(fmt::format("`{}`: it says that {} ticks have passed since `reset`, not {}",
                                 command, now_, passed));
}

}  // namespace rubric::targets
