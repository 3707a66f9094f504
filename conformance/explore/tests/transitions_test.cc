#include "conformance/explore/transitions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "conformance/generated/profiles.h"
#include "conformance/machine/flaws/flaws.h"

namespace rubric::explore {
namespace {

Diagram explored(std::string_view part, StepFunction step = machine::step) {
  return transitions_of(part, machine::kPaper, step);
}

// Returns a diagram; each is explored once for all tests.
const Diagram& paper(const std::string& part) {
  static std::map<std::string, Diagram> known;
  const auto found = known.find(part);
  return found != known.end() ? found->second : known.emplace(part, explored(part)).first->second;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

// Returns "request out --join_reply [another number]--> request out" with outputs and rules.
std::string text_of(const Diagram& diagram, const Transition& t) {
  std::string out = diagram.states[t.from] + " --" + t.trigger;
  if (!t.guards.empty()) out += " [" + joined(t.guards, "|") + "]";
  if (!t.outputs.empty()) out += " / " + joined(t.outputs, ", ");
  out += t.ignored ? " ignored" : "";
  return out + "--> " + diagram.states[t.to] + " " + joined(t.rules, " ");
}

std::set<std::string> texts_of(const Diagram& diagram) {
  std::set<std::string> out;
  for (const Transition& t : diagram.transitions) out.insert(text_of(diagram, t));
  return out;
}

// Taken from the catalogue's sentences, not from the output.
const std::set<std::string> kEssential{
    // J1, J8: requests, their repetition, and the end of a call.
    "not a member --joinIsland() / join_request--> request out J1-REQUEST",
    "request out --join timer [before 5 requests] / join_request--> request out J8-RETRY",
    "request out --join timer [after 5 requests] / joined(fail)--> not a member J8-FAIL",
    // J4: the reply that fits, and those that do not.
    "request out --join_reply [its number] / joined(success), ack_join--> "
    "member,\nack_join on the air J5-SUCCESS J4-CLOCK J4-ACK",
    "request out --join_reply [another number] ignored--> request out J4-SEQ",
    "not a member --join_reply ignored--> not a member J4-JOINED",
    "member,\nack_join confirmed --join_reply [another island's offer] ignored--> "
    "member,\nack_join confirmed J7-CHOICE",
    "member,\nack_join confirmed --reboot--> not a member ",
    // J2, J3, J6: a sink.
    "not known --join_request / join_reply--> answered J3-REPLY",
    "not known --join_request [no room in its list] ignored--> not known J3-FULL",
    "answered --ack_join [its number] / mote_joined, net_msg--> listed J6-ADD J6-REPORT",
    "answered --ack_join [another number] ignored--> answered J6-SEQ",
    "answered --ack_join [for another island] ignored--> answered J6-ISLAND",
    "listed --join_request ignored--> listed J2-LISTED",
    "listed --ack_join [its number] ignored--> listed J6-REPEAT",
    // T3: each reliable message ends once.
    "ack awaited --ack [its number] / ack_received(success)--> no ack awaited "
    "N5-DELIVER T3-SUCCESS",
    // S1 to S6: channels.
    "started --tick [reliable] / net_msg--> started S2-SEND",
    "started --tick [power-save, first or changed] / net_msg--> started S3-CHANGED",
    "started --tick [power-save, unchanged]--> started S3-UNCHANGED",
    "started --tick [data came] / syn_data(new)--> started S2-SIGNAL",
    "started --tick [no data came] / syn_data(old)--> started S3-OLD",
    "no channel --data / syn_data(unknown_channel)--> no channel N6-DELIVER S5-UNKNOWN",
    "stopped --data ignored--> stopped N6-DELIVER S6-STOPPED",
    "ack awaited --ack timer / ack_received(fail)--> no ack awaited T3-TIMEOUT",
    "ack awaited --ack [another number] ignored--> ack awaited N5-DELIVER T3-MATCH",
};

TEST(Transitions, HoldsWhatTheRulesSay) {
  std::set<std::string> all;
  for (const PartName& part : part_names()) {
    const Diagram& diagram = paper(part.name);
    EXPECT_TRUE(diagram.complete) << part.name;
    all.merge(texts_of(diagram));
  }
  for (const std::string& one : kEssential) EXPECT_TRUE(all.contains(one)) << one;
}

TEST(Transitions, NothingElseMakesAMember) {
  for (const Transition& t : paper("join").transitions) {
    const bool becomes = t.from < 2 && t.to >= 2;
    const bool right_reply =
        t.from == 1 && t.trigger == "join_reply" && t.guards.front() == "its number";
    EXPECT_EQ(becomes, right_reply) << text_of(paper("join"), t);
  }
  for (const Transition& t : paper("listing").transitions) {
    if (t.to != 2 || t.from == 2) continue;
    EXPECT_EQ(t.trigger, "ack_join");
    EXPECT_EQ(t.guards, std::vector<std::string>{"its number"});
  }
}

// The machine alone makes each transition, in a node that is given its witness.
TEST(Transitions, EachHasAWitness) {
  for (const PartName& part : part_names()) {
    const Diagram& diagram = paper(part.name);
    EXPECT_GT(diagram.transitions.size(), 8U);
    for (const Transition& t : diagram.transitions) {
      SCOPED_TRACE(text_of(diagram, t));
      const auto again = replay(part.name, t.witness);
      ASSERT_TRUE(again.has_value());
      EXPECT_EQ(again->from, t.from);
      EXPECT_EQ(again->to, t.to);
      EXPECT_EQ(again->trigger, t.trigger);
      EXPECT_EQ(again->outputs, t.outputs);
      EXPECT_EQ(again->rules, t.rules);
      EXPECT_EQ(again->ignored, t.ignored);
      const bool fits = t.guards.empty() ||
                        std::find(t.guards.begin(), t.guards.end(),
                                  again->guards.empty() ? std::string() : again->guards.front()) !=
                            t.guards.end();
      EXPECT_TRUE(fits);
    }
  }
}

TEST(Transitions, AreTheSameEachTime) {
  for (const PartName& part : part_names()) {
    const Diagram& one = paper(part.name);
    const Diagram two = explored(part.name);
    ASSERT_EQ(one.transitions.size(), two.transitions.size());
    EXPECT_EQ(one.worlds, two.worlds);
    for (std::size_t i = 0; i < one.transitions.size(); ++i) {
      EXPECT_EQ(text_of(one, one.transitions[i]), text_of(two, two.transitions[i]));
      EXPECT_EQ(one.transitions[i].witness.events.size(), two.transitions[i].witness.events.size());
    }
  }
}

TEST(Transitions, OfABrokenMachineAreOthers) {
  const std::pair<const char*, const char*> broken[] = {
      {"accepts_wrong_seq", "join"},  {"no_fail", "join"},           {"seven_requests", "join"},
      {"answers_members", "listing"}, {"no_ack_timeout", "message"}, {"misread_acks", "message"}};
  for (const auto& [flaw, part] : broken) {
    const flaws::Flaw* const found = flaws::find(flaw);
    ASSERT_NE(found, nullptr) << flaw;
    EXPECT_NE(texts_of(explored(part, found->step)), texts_of(paper(part))) << flaw;
  }
}

TEST(Transitions, OfTheDeployedProfileAreItsOwn) {
  const auto all = texts_of(transitions_of("listing", machine::kDeployed));
  EXPECT_TRUE(
      all.contains("listed --join_request / join_reply--> listed,\nanswered again "
                   "J3-REPLY"));
  for (const Transition& t : transitions_of("message", machine::kDeployed).transitions) {
    EXPECT_NE(t.trigger, "ack timer");
  }
}

}  // namespace
}  // namespace rubric::explore
