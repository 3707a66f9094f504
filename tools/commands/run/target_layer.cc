#include "tools/commands/run/target_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "codec/lines/broken.h"
#include "codec/text/text.h"
#include "conformance/generated/profiles.h"
#include "conformance/trace/events/lines.h"
#include "tools/commands/run/packets.h"

namespace rubric::run {
namespace {

using machine::Notice;

}  // namespace

TargetLayer::TargetLayer(const std::string& target, std::uint16_t id, std::uint16_t first_seq,
                         LayerUser& user)
    : name_(target), user_(user), attachment_(targets::attach(target, {})) {
  guarded([&] {
    if (attachment_->identity().real_time) {
      throw std::invalid_argument(
          fmt::format("{}: a mote of an air needs a target whose clock can be turned", name_));
    }
    machine::Config config;
    config.id = id;
    config.first_seq = first_seq;
    config.profile = machine::find_profile("paper")->profile;
    target_ = attachment_->target();
    target_->reset(config);
    target_->hold_link_acks(true);
  });
}

template <class Action>
void TargetLayer::guarded(Action action) {
  try {
    action();
  } catch (const lines::Broken& broken) {
    target_.reset();  // Gives its process back, with its last words.
    text::print_harmless(stderr, attachment_->take_stderr());
    throw lines::Broken(fmt::format("{}: {}", name_, broken.what()));
  } catch (const runner::Unsupported& refusal) {
    throw std::invalid_argument(fmt::format("{}: unsupported: {}", name_, refusal.what()));
  }
}

std::optional<node::Ticks> TargetLayer::run(node::Ticks now) {
  now_ = now;
  advance();
  while (!news_.empty()) {
    runner::Output news = std::move(news_.front());
    news_.pop_front();
    if (news.is_frame) {
      frames_.push_back(news.frame);
      continue;
    }
    const trace::Concrete message = trace::concrete(news.news);  // Has the bytes of the notice.
    if (const auto notice = events::to_notice(message)) user_.happened(*notice);
  }
  send_next();
  return target_->next();
}

// Lets the target come to the present, and takes what it did.
void TargetLayer::advance() {
  guarded([&] {
    while (target_->run_until(now_) < now_) {
    }
  });
  take(nullptr);
}

// Takes what is new; the first result of a call goes to `result`, if that is wanted.
void TargetLayer::take(std::optional<Notice>* result) {
  for (const std::vector<runner::Output>& all = target_->outputs(); taken_ < all.size(); ++taken_) {
    const runner::Output& output = all[taken_];
    std::optional<Notice> notice;
    if (result != nullptr && !*result && !output.is_frame) {
      notice = events::to_notice(trace::concrete(output.news));
    }
    if (notice && machine::is_result(*notice)) {
      *result = notice;
    } else if (!output.is_frame || output.frame.link == machine::Link::kRadio) {
      news_.push_back(output);
    }
  }
}

void TargetLayer::give(const machine::Event& event) {
  guarded([&] { target_->give(now_, event); });
}

void TargetLayer::received(node::Line line, Bytes packet) {
  give(machine::Heard{frame_of(line, packet)});
}

void TargetLayer::sent(node::Line, bool acked) {
  if (!on_air_) return;
  on_air_ = false;
  const bool awaited = frames_.front().link_ack;
  frames_.pop_front();
  // Other frames end by the implementation's own measure of the air.
  if (awaited) give(machine::SendDone{machine::Link::kRadio, acked});
  send_next();
}

void TargetLayer::send_next() {
  if (on_air_ || frames_.empty()) return;
  on_air_ = true;
  const machine::Transmit& frame = frames_.front();
  const std::vector<std::uint8_t> packet = events::packet_of(frame.frame());
  user_.transmit(node::Line::kRadio, Bytes(packet.data(), packet.size()), frame.link_ack);
}

std::optional<Notice> TargetLayer::call(const machine::Call& call) {
  advance();
  give(machine::Called{call});
  std::optional<Notice> result;
  take(&result);
  const auto* const set = std::get_if<machine::SetInterface>(&call);
  const auto* const done = result ? std::get_if<machine::OperationResult>(&*result) : nullptr;
  if (set != nullptr && set->link == machine::Link::kRadio && done != nullptr && done->success) {
    listens_ = set->on;
  }
  return result;
}

}  // namespace rubric::run
