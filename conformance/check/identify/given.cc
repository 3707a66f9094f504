#include "conformance/check/identify/given.h"

#include <algorithm>

#include "conformance/check/message.h"

namespace rubric::check {
namespace {

using machine::Role;

const char* name_of(Role role) {
  switch (role) {
    case Role::kMote: return "mote";
    case Role::kSink: return "sink";
    case Role::kBaseStation: break;
  }
  return "base station";
}

}  // namespace

std::optional<Role> Given::role(std::uint16_t am) const {
  for (const KnownNode& node : nodes_) {
    if (node.id == am) return node.role;
  }
  return std::nullopt;
}

std::uint16_t Given::only_island(std::uint16_t am) const {
  std::uint16_t island = kNoIsland;
  for (const KnownNode& node : nodes_) {
    if (node.id != am || node.island == kNoIsland) continue;
    if (island != kNoIsland) return kNoIsland;
    island = node.island;
  }
  return island;
}

std::uint16_t Given::only_island() const {
  std::uint16_t island = kNoIsland;
  for (const KnownNode& node : nodes_) {
    if (node.role != Role::kSink) continue;
    if (island != kNoIsland || node.island == kNoIsland) return kNoIsland;
    island = node.island;
  }
  return island;
}

bool Given::names(std::uint16_t am, std::uint16_t island) const {
  return std::any_of(nodes_.begin(), nodes_.end(), [&](const KnownNode& node) {
    return node.id == am &&
           (island == kNoIsland || node.island == kNoIsland || node.island == island);
  });
}

std::optional<std::uint16_t> Given::sink_am() const {
  std::optional<std::uint16_t> am;
  for (const KnownNode& node : nodes_) {
    if (node.role == Role::kSink) am = node.id;
  }
  return am;
}

Contradiction role_contradiction(std::uint16_t am, Role role, Role shown, std::uint32_t index) {
  Contradiction out{.index = index};
  if (role == Role::kMote) out.requirement = "J10-MOTE"_rule;
  if (role == Role::kSink) out.requirement = "J10-SINK"_rule;
  out.text = "AM address " + std::to_string(am) + " was given as a " + name_of(role) +
             ", but all that it does here is a " + name_of(shown) + "'s; it is judged as a " +
             name_of(shown) + ".";
  out.expected =
      std::string("What a ") + name_of(role) + " does. Either the option is wrong or the node.";
  return out;
}

void GivenRoles::look(const machine::Frame& frame, std::uint32_t index) {
  if (given_.empty() || !given_.names(frame.src, kNoIsland)) return;
  Joins& joins = joins_[frame.src];
  const bool asks = frame.type == am::kJoin || frame.type == am::kAckJoin;
  if (asks && joins.as_mote == 0) joins.as_mote = index + 1;
  if (frame.type == am::kJoinReply && joins.as_sink == 0) joins.as_sink = index + 1;
}

bool GivenRoles::overruled(const Joins& joins, Role said) {
  if (said == Role::kBaseStation) return joins.as_mote != 0 || joins.as_sink != 0;
  return said == Role::kMote ? joins.as_mote == 0 && joins.as_sink != 0
                             : joins.as_sink == 0 && joins.as_mote != 0;
}

Role GivenRoles::role_of(std::uint16_t am, Role guess) const {
  const Role said = given_.role(am).value_or(guess);
  if (said == Role::kBaseStation) return guess;
  const auto found = joins_.find(am);
  if (found == joins_.end() || !overruled(found->second, said)) return said;
  return said == Role::kSink ? Role::kMote : Role::kSink;
}

void GivenRoles::contradict(std::vector<Contradiction>& out) const {
  for (const auto& [am, joins] : joins_) {
    const std::optional<Role> said = given_.role(am);
    if (!said || !overruled(joins, *said)) continue;
    const Role shown = joins.as_mote != 0 ? Role::kMote : Role::kSink;
    out.push_back(role_contradiction(am, *said, shown,
                                     (joins.as_mote != 0 ? joins.as_mote : joins.as_sink) - 1));
  }
}

std::vector<Contradiction> island_contradictions(const Run& run, const Given& given,
                                                 const std::vector<Shown>& shown) {
  std::vector<Contradiction> out;
  for (const KnownNode& node : given.nodes()) {
    if (node.island == kNoIsland) continue;
    const auto is_it = [&](const Shown& s) { return s.am == node.id && s.island == node.island; };
    if (std::any_of(shown.begin(), shown.end(), is_it)) continue;
    const auto other = std::find_if(shown.begin(), shown.end(), [&](const Shown& s) {
      const auto said = [&](const KnownNode& n) { return n.id == s.am && n.island == s.island; };
      return s.am == node.id && std::none_of(given.nodes().begin(), given.nodes().end(), said);
    });
    if (other == shown.end()) continue;
    Contradiction one{.index = other->index};
    if (run.seen[one.index].frame.type == am::kJoinReply) one.requirement = "J3-ADDRESS"_rule;
    one.text = "The sink with AM address " + std::to_string(node.id) + " was given island " +
               std::to_string(node.island) + ", but acts for island " +
               std::to_string(other->island) + " here and never for " +
               std::to_string(node.island) + "; it is judged as the sink of island " +
               std::to_string(other->island) + ".";
    one.expected =
        "Island " + std::to_string(node.island) + ". Either the option is wrong or the sink.";
    out.push_back(one);
  }
  return out;
}

}  // namespace rubric::check
