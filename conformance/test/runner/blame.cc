#include "conformance/test/runner/blame.h"

#include <algorithm>
#include <array>
#include <span>

namespace rubric::runner {
namespace {

// What breaks a rule shows all of these words; empty ones ask for nothing.
struct Trait {
  std::string_view rule;
  std::array<std::string_view, 2> words;
};

constexpr Trait kTraits[] = {
    {"J1-CALLED", {"join_request"}},
    {"J1-REQUEST", {"join_request"}},
    {"J4-ACK", {"ack_join"}},
    {"J4-JOINED", {"ack_join"}},
    {"J4-JOINED", {"joined"}},
    {"J4-REPEAT", {"ack_join"}},
    {"J4-SEQ", {"ack_join"}},
    {"J4-SEQ", {"joined"}},
    {"J5-ACCEPT", {"joined", "success"}},
    {"J5-ONCE", {"joined"}},
    {"J6-REPEAT", {"serial_joined"}},
    {"J6-REPEAT", {"mote_joined"}},
    {"J7-CHOICE", {"ack_join"}},
    {"J7-ONE", {"joined"}},
    {"J8-PERIOD", {"join_request"}},
    {"N2-ONCE", {"net_msg", "again"}},
    {"N5-FOREIGN", {"received"}},
    {"N5-FOREIGN", {"ack"}},
    {"N5-FOREIGN", {"ack_received"}},
    {"N6-ONCE", {"net_msg", "again"}},
    {"N6-ONCE", {"ack", "again"}},
    {"N7-CONTENT", {"radio", "new"}},
    {"N7-RADIO", {"radio"}},
    {"N8-INCOMING", {"serial"}},
    {"N8-PEIS", {"peis"}},
    {"S2-SIGNAL", {"syn_data"}},
    {"S2-TICK", {"radio"}},
    {"T2-LOOP", {"ack"}},
    {"T2-ONCE", {"ack"}},
    {"T3-MATCH", {"success"}},
    {"T3-ONCE", {"ack_received"}},
    {"T3-RESEND", {"net_msg", "again"}},
    {"T3-TIMEOUT", {"fail"}},
};

// What a message that came differs in, where it breaks one of these rules.
constexpr Trait kDiffers[] = {
    {"J1-DEST", {"am"}},           {"J3-ADDRESS", {"island_addr"}},
    {"J3-ADDRESS", {"mote_addr"}}, {"J3-DEST", {"am"}},
    {"J3-SEQ", {"seq_num"}},       {"N1-SEQ", {"seq_num"}},
    {"N1-SRC", {"src"}},           {"N2-ORDER", {"order"}},
    {"N4-MOTE", {"am"}},           {"N4-SINK", {"am"}},
    {"N7-RADIO", {"am"}},          {"T1-WRAP", {"payload"}},
    {"T3-SUCCESS", {"seq_num"}},   {"J4-CONTENT", {"differs"}},
    {"J6-CONTENT", {"differs"}},   {"N6-CONTENT", {"differs"}},
    {"N7-CONTENT", {"differs"}},   {"S2-CONTENT", {"differs"}},
    {"T2-CONTENT", {"differs"}},
};

// Ends of rules about what a message holds, where it goes, or that it is accepted, which no missing
// message breaks.
constexpr std::string_view kOfContent[] = {"-CONTENT", "-ADDRESS", "-DEST",  "-SEQ",
                                           "-SRC",     "-WRAP",    "-ORDER", "-ROOM"};

enum Fit { kNo, kPerhaps, kWell };

Fit fit(std::string_view rule, const Evidence& evidence) {
  if (evidence.contains("missing")) {
    const bool of_content = std::any_of(std::begin(kOfContent), std::end(kOfContent),
                                        [&](std::string_view end) { return rule.ends_with(end); });
    // A started channel signals at each tick, and a base station sends to PEIS, whatever else the
    // line tries.
    if (rule == "S2-SIGNAL" || rule == "N8-PEIS") return kWell;
    return of_content ? kNo : kPerhaps;
  }
  const auto shown = [&](std::string_view word) { return word.empty() || evidence.contains(word); };
  const bool differs = evidence.contains("differs");
  bool known = false;
  for (const Trait& trait : differs ? std::span<const Trait>(kDiffers) : std::span(kTraits)) {
    if (trait.rule != rule) continue;
    known = true;
    if (std::all_of(trait.words.begin(), trait.words.end(), shown)) return kWell;
  }
  return known ? kNo : kPerhaps;
}

}  // namespace

void blame_one(Failure& failure, const Evidence& evidence) {
  std::vector<std::string>& rules = failure.requirements;
  if (rules.size() < 2) return;
  const auto blamed = std::max_element(
      rules.begin(), rules.end(),
      [&](const auto& a, const auto& b) { return fit(a, evidence) < fit(b, evidence); });
  std::rotate(rules.begin(), blamed, blamed + 1);
  failure.suspected.assign(rules.begin() + 1, rules.end());
  rules.resize(1);
}

void mark_implied(std::vector<Failure>& failures) {
  std::set<std::string, std::less<>> failed;  // Nodes.
  for (Failure& failure : failures) {
    failure.implied = failed.contains(failure.node);
    if (!failure.weak) failed.insert(failure.node);
  }
}

}  // namespace rubric::runner
