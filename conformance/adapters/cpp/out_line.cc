#include "conformance/adapters/cpp/out_line.h"

#include <algorithm>
#include <utility>

namespace rubric::cpp_node {

bool OutLine::push(Frame frame) {
  if (!has_room()) return false;
  waiting_.push_back(std::move(frame));
  send_waiting();
  return true;
}

bool OutLine::holds(AmType type) const {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [&](const Frame& one) { return one.type == type; });
}

void OutLine::drop(AmType type) {
  std::erase_if(waiting_, [&](const Frame& one) { return one.type == type; });
}

void OutLine::set_busy(bool busy) {
  busy_ = busy;
  send_waiting();
}

void OutLine::set_on(bool on) {
  on_ = on;
  send_waiting();
}

bool OutLine::confirmed() {
  if (!std::exchange(unconfirmed_, false)) return false;
  send_waiting();
  return true;
}

//= N2-ORDER: Messages leave each line in the order in which they were accepted for it.
void OutLine::send_waiting() {
  while (is_on() && !busy_ && !unconfirmed_ && !waiting_.empty()) {
    const Frame frame = std::move(waiting_.front());
    waiting_.pop_front();
    unconfirmed_ = frame.link_ack;
    transmit_(line_, frame);
  }
}

}  // namespace rubric::cpp_node
