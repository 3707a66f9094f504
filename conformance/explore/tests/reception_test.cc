#include "conformance/explore/reception.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "conformance/generated/profiles.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/trace/trace.h"

namespace rubric::explore {
namespace {

std::string flat(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += ' ' + word;
  return out;
}

bool is_end(const Diagram& diagram, std::size_t state) {
  return std::none_of(diagram.transitions.begin(), diagram.transitions.end(),
                      [&](const Transition& t) { return t.from == state; });
}

// Returns all ways from a state to an end: "which message? join_request, nothing J10-MOTE".
void add_ways(const Diagram& diagram, std::size_t state, const std::string& way,
              std::set<std::string>& out) {
  for (const Transition& t : diagram.transitions) {
    if (t.from != state) continue;
    const std::string next = way + flat(diagram.states[state]) + ' ' + t.trigger + ", ";
    if (is_end(diagram, t.to)) {
      out.insert(next + flat(diagram.states[t.to]) + joined(t.rules));
    } else {
      add_ways(diagram, t.to, next, out);
    }
  }
}

std::set<std::string> ways_of(const Diagram& diagram) {
  std::set<std::string> out;
  add_ways(diagram, 0, "", out);
  return out;
}

// Taken from the catalogue's sentences and the paper's two figures, not from the output.
TEST(Reception, HoldsWhatTheRulesSay) {
  const auto mote = ways_of(reception_of("mote_reception", machine::kPaper));
  const auto sink = ways_of(reception_of("sink_reception", machine::kPaper));
  const std::string whole = "which message? net_msg, is nbytes right? yes, ";
  const std::string member = "which message? net_msg, is it a member? ";
  const std::pair<const std::set<std::string>&, std::string> expected[] = {
      {mote, "which message? join_request or ack_join, nothing J10-MOTE"},
      {mote,
       "which message? join_reply, is it a member? it is asking, for its request? another "
       "number, nothing J4-SEQ"},
      {mote, member + "it has not asked or it is asking, nothing J11-HEAR"},
      {mote, member + "yes, is nbytes right? yes, dest.pid? another island, nothing N5-FOREIGN"},
      {sink, "which message? join_reply, nothing J10-SINK"},
      {sink, "which message? join_request, is the mote on its list? yes, nothing J2-LISTED"},
      {sink, "which message? join_request, is the mote on its list? no, send join_reply J3-REPLY"},
      {sink, "which message? net_msg, is nbytes right? no, nothing N11-NBYTES"},
      {sink, whole + "dest.pid? another island, src.pid? another island, nothing N6-COLLISION"},
      {sink,
       whole + "dest.pid? another island, src.pid? its island, forward it by serial N6-ROUTE"},
      {sink,
       whole + "dest.pid? its island, dest.devid? NULL: the PC, forward it by serial N6-FORWARD"},
      {sink, whole + "dest.pid? its island, dest.devid? its own, TRANSID? CONNLESS, reliable? 1, "
                     "deliver it send an ack N6-DELIVER T2-DELIVER T2-ACK"}};
  for (const auto& [ways, way] : expected) EXPECT_TRUE(ways.contains(way)) << way;
}

// The machine alone goes each way, in a node that is given its witness.
TEST(Reception, EachAnswerHasAWitness) {
  for (const PartName& part : reception_names()) {
    const Diagram diagram = reception_of(part.name, machine::kPaper);
    EXPECT_GT(diagram.transitions.size(), 8U);
    for (const Transition& t : diagram.transitions) {
      if (!is_end(diagram, t.to)) continue;
      machine::State state = machine::start(t.witness.config);
      machine::Actions actions;
      machine::Actions ends;
      machine::Ticks now = 0;
      for (const Given& given : t.witness.events) {
        machine::step(state, ++now, given.event(), actions);
        for (const machine::Transmit& one : actions.transmits()) {
          if (!one.link_ack) machine::step(state, now, machine::SendDone{one.link, true}, ends);
        }
      }
      const std::string end = diagram.states[t.to];
      const bool silent = end == "nothing" || end == "keep its values";
      EXPECT_EQ(actions.transmits().empty() && actions.notices().empty(), silent) << end;
      for (const machine::Action& action : actions.all()) {
        const std::string rule(trace::requirement_text(action.requirement));
        if (action.requirement == ReqId::kNone) continue;
        EXPECT_EQ(std::count(t.rules.begin(), t.rules.end(), rule), 1) << rule;
      }
    }
  }
}

TEST(Reception, OfABrokenMachineIsAnother) {
  const auto right = ways_of(reception_of("sink_reception", machine::kPaper));
  const flaws::Flaw* const flaw = flaws::find("answers_members");
  ASSERT_NE(flaw, nullptr);
  EXPECT_NE(right, ways_of(reception_of("sink_reception", machine::kPaper, flaw->step)));
}

}  // namespace
}  // namespace rubric::explore
