#include "conformance/explore/healing.h"

namespace rubric::explore {
namespace {

constexpr int kStepsMax = 10000;  // Far more than a call can take.

}  // namespace

void Healing::happen(World& world, std::size_t node, std::uint32_t what) {
  world.copies = 0;
  network_.apply(world, node, what, nullptr);
  for (std::size_t i = 0; i < world.copies; ++i) air_.push_back(world.copy[i]);
  world.copies = 0;
}

// Makes one thing happen. Returns false if nothing is left.
bool Healing::advance(World& world) {
  if (!air_.empty()) {
    const Copy copy = air_.front();
    air_.pop_front();
    const NodeSet hearers = network_.addressed(copy);
    for (std::size_t i = 0; i < network_.count_; ++i) {
      if ((hearers >> i & 1) != 0) happen(world, i, event::kFrame + copy.frame());
    }
    const bool confirms = network_.nodes_.frame(copy.frame()).link_ack && hearers != 0;
    if (confirms && network_.facts(world, copy.sender()).on_air == copy.frame()) {
      happen(world, copy.sender(), event::kDoneAcked);
    }
    return true;
  }
  for (std::size_t i = 0; i < network_.count_; ++i) {
    const NodeFacts f = network_.facts(world, i);
    if (f.serial_sending) return happen(world, i, event::kDoneSerial), true;
    if (f.radio_sending) {
      const bool wanted = f.on_air != 0;
      return happen(world, i, wanted ? event::kDoneUnacked : event::kDoneAcked), true;
    }
  }
  for (std::size_t i = 0; i < network_.count_; ++i) {
    if (network_.facts(world, i).join_timer) return happen(world, i, event::kJoinTimer), true;
  }
  return false;
}

bool Healing::joins(World& world, std::size_t mote) {
  air_.clear();
  happen(world, mote, event::kCall);
  for (int i = 0; i < kStepsMax && advance(world); ++i) {
  }
  const std::uint8_t view = network_.facts(world, mote).view;
  for (std::size_t s = network_.nodes_.options().motes; s < network_.count_; ++s) {
    const auto island = static_cast<std::uint8_t>(1U << (s - network_.nodes_.options().motes));
    const bool lists = (network_.facts(world, s).listed >> mote & 1) != 0;
    if (view == island && lists) return true;
  }
  return false;
}

bool Healing::succeeds(const World& world, bool& weak) {
  const Options& options = network_.nodes_.options();
  World after = world;
  bool all = true;
  for (std::size_t m = 0; m < options.motes; ++m) {
    const NodeFacts mote = network_.facts(world, m);
    if (mote.view != 0) continue;
    if (mote.open) {  // The application waits for ever, and calls no more.
      all = false;
      continue;
    }
    bool listed = false;
    for (std::size_t s = options.motes; s < network_.count_; ++s) {
      listed |= (network_.facts(world, s).listed >> m & 1) != 0;
    }
    World alone = world;
    if (joins(alone, m) && joins(after, m)) continue;
    if (mote.reboots != 0 && listed && options.profile.listed_ignored) {
      weak = true;
    } else {
      all = false;
    }
  }
  return all;
}

}  // namespace rubric::explore
