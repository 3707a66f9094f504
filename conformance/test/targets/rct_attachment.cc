#include "conformance/test/targets/rct_attachment.h"

#include <utility>

namespace rubric::targets {

const Identity& RctAttachment::identity() {
  if (identity_.name.empty()) give_back(take());
  return identity_;
}

std::unique_ptr<runner::Target> RctAttachment::target() {
  std::unique_ptr<RctClient> client = take();
  return std::make_unique<RctTarget>(
      std::move(client), identity_.stated,
      [this](std::unique_ptr<RctClient> used) { give_back(std::move(used)); });
}

std::string RctAttachment::honesty() {
  std::unique_ptr<RctClient> client = take();
  std::string wrong = client->honesty();
  give_back(std::move(client));
  return wrong;
}

std::string RctAttachment::take_stderr() {
  for (const auto& client : idle_) keep_stderr(*client);
  return std::exchange(stderr_, {});
}

std::unique_ptr<RctClient> RctAttachment::take() {
  while (!idle_.empty()) {
    std::unique_ptr<RctClient> client = std::move(idle_.back());
    idle_.pop_back();
    if (waits(*client)) return client;
  }
  auto client = std::make_unique<RctClient>(start_(), options_);
  try {
    identity_ = client->hello();
    identity_.stated = trace::joined(options_.stated, identity_.stated);
  } catch (const runner::TargetBroken&) {
    keep_stderr(*client);
    throw;
  }
  return client;
}

void RctAttachment::give_back(std::unique_ptr<RctClient> client) {
  keep_stderr(*client);
  if (!client->broken()) idle_.push_back(std::move(client));
}

// Returns whether it waits. If it did something since its last answer, notes a mishap.
bool RctAttachment::waits(RctClient& client) {
  std::string what = client.unasked();
  if (!what.empty()) mishaps_.push_back({std::move(what), true, client.take_stderr()});
  return !client.broken();
}

void RctAttachment::finish() {
  std::erase_if(idle_, [this](const auto& client) { return !waits(*client); });
  for (const auto& client : idle_) client->say_bye();  // To all, so that they end at once.
  for (const auto& client : idle_) {
    std::string what = client->end(options_.step_timeout);
    std::string words = client->take_stderr();
    if (!what.empty()) mishaps_.push_back({std::move(what), false, std::move(words)});
  }
  idle_.clear();
}

void RctAttachment::keep_stderr(RctClient& client) {
  stderr_ += client.take_stderr();
  if (stderr_.size() > Process::kStderrBytesMax) {
    stderr_.erase(0, stderr_.size() - Process::kStderrBytesMax);
  }
}

}  // namespace rubric::targets
