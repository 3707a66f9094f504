#include "conformance/test/targets/app_channel.h"

#include <fmt/format.h>

#include <utility>

namespace rubric::targets {

runner::Reach AppChannel::shown() const {
  return client_->identity().shown.value_or(runner::Reach{false, false, false, true});
}

void AppChannel::reset(const machine::Config& config, const trace::Statement& own) {
  Asked asked;
  asked.command = reset_command(config, own);
  asked.closing = "ready";
  client_->ask(asked);
  now_ = 0;
}

std::vector<Output> AppChannel::give(const machine::Event& event) {
  const auto* const heard = std::get_if<machine::Heard>(&event);
  if (heard && !(heard->frame.link == machine::Link::kPeis && shown().peis)) {
    throw runner::Unsupported("neither the line nor the app can make that happen");
  }
  return ask(command_of(event, now_), false);
}

// `until` a time that has passed is answered at once.
std::vector<Output> AppChannel::poll() { return ask(fmt::format("until {}", now_), true); }

std::vector<Output> AppChannel::ask(std::string command, bool passes_time) {
  Asked asked;
  asked.command = std::move(command);
  asked.from = asked.to = now_;
  asked.passes_time = passes_time;
  asked.real_time = true;
  Answer answer = client_->ask(asked);
  now_ = answer.done;
  for (const Output& output : answer.outputs) {
    const bool is_shown =
        output.is_frame ? output.frame.link == machine::Link::kPeis && shown().peis : shown().app;
    if (is_shown) continue;
    client_->give_up();
    throw runner::TargetBroken(fmt::format("`{}`: the app shows {}, a link that is not its own",
                                           asked.command, output_line(output)));
  }
  return std::move(answer.outputs);
}

}  // namespace rubric::targets
