// Features that variants of joining must show.
#include <algorithm>
#include <set>

#include "conformance/selftest/lawful_traffic/tests/seen.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;

constexpr std::int64_t kShortestPeriodUs = 458'000;

bool periods_hold(const Frames& some) {
  const auto all = gaps(some);
  return std::all_of(all.begin(), all.end(),
                     [](std::int64_t gap) { return gap >= kShortestPeriodUs; });
}
bool failed(const Traffic& traffic, int node) {
  return !events(traffic, node, "joined", "\"error\":1").empty();
}
bool joined(const Traffic& traffic, int node) {
  return !events(traffic, node, "joined", "\"error\":0").empty();
}
std::size_t reports_of(const Frames& frames, std::uint16_t mote) {
  return count(frames,
               [&](const Seen& s) { return s.serial_joined() && s.net->src.devid == mote; });
}
bool has_net_from(const Frames& frames, std::uint16_t mote) {
  return count(frames, [&](const Seen& s) { return s.from(AmType::kNet, mote); }) > 0;
}
Frames after(const Frames& frames, std::int64_t time_us) {
  return pick(frames, [&](const Seen& s) { return s.time_us >= time_us; });
}
std::size_t distinct_dsns(const Frames& frames) {
  std::set<std::uint8_t> dsns;
  for (const Seen& frame : frames) dsns.insert(frame.dsn);
  return dsns.size();
}
/// Returns whether that many requests of mote 2 went unanswered.
bool in_vain(const Traffic& t, const Frames& f, std::size_t number, std::size_t seqs) {
  const Frames sent = requests(f, 2);
  return sent.size() == number && distinct_seqs(sent) == seqs && periods_hold(sent) &&
         failed(t, 2) && !joined(t, 2) && replies(f, 2).empty() && !has_net_from(f, 2);
}

bool request_same(const Traffic& t, const Frames& f) {
  return requests(f, 2).size() >= 2 && distinct_seqs(requests(f, 2)) == 1 && joined(t, 2) &&
         replies(f, 2).size() == 1;
}
bool request_new(const Traffic& t, const Frames& f) {
  return distinct_seqs(requests(f, 2)) >= 2 && joined(t, 2) && replies(f, 2).size() == 1;
}
bool reply_same(const Traffic& t, const Frames& f) {
  return replies(f, 2).size() >= 2 && distinct_seqs(replies(f, 2)) == 1 && joined(t, 2);
}
bool reply_new(const Traffic& t, const Frames& f) {
  return replies(f, 2).size() >= 2 && distinct_seqs(replies(f, 2)) >= 2 && joined(t, 2);
}
bool again_after_fail(const Traffic& t, const Frames& f) {
  const Frames sent = requests(f, 2);
  return sent.size() > 5 && distinct_seqs(sent) == 2 && periods_hold(sent) && failed(t, 2) &&
         joined(t, 2);
}
bool again_at_once(const Traffic& t, const Frames& f) {
  const Frames sent = requests(f, 2);
  return sent.size() == 10 && distinct_seqs(sent) == 2 && periods_hold(sent) &&
         events(t, 2, "joined", "\"error\":1").size() == 2;
}
bool at_acceptance(const Traffic& t, const Frames& f) {
  const Frames acks = ack_joins(f, 2);
  const auto event = events(t, 2, "joined", "\"error\":0");
  return !acks.empty() && !event.empty() && event[0].time_us < acks[0].time_us;
}
bool at_link_ack(const Traffic& t, const Frames& f) {
  const Frames acks = ack_joins(f, 2);
  const auto event = events(t, 2, "joined", "\"error\":0");
  return !acks.empty() && !event.empty() && event[0].time_us > acks.back().time_us;
}
bool five_ack_joins(const Frames& f, std::size_t dsns) {
  const Frames acks = ack_joins(f, 2);
  const auto same = [&](const Seen& s) { return s.payload == acks[0].payload; };
  return acks.size() == 5 && distinct_dsns(acks) == dsns &&
         std::all_of(acks.begin(), acks.end(), same) && reports_of(f, 2) == 1 &&
         acks[4].time_us - acks[0].time_us < kShortestPeriodUs;
}
bool thrice(const Traffic&, const Frames& f) {
  return ack_joins(f, 2).size() == 3 && ack_joins(f, 3).size() == 3 && reports_of(f, 2) == 1;
}
bool often(const Traffic&, const Frames& f) {
  return ack_joins(f, 2).size() >= 6 && ack_joins(f, 2).size() <= 20 && reports_of(f, 2) == 1;
}
bool unconfirmed_fails(const Traffic& t, const Frames& f) {
  const auto fails = events(t, 2, "joined", "\"error\":1");
  return fails.size() == 1 && fails[0].time_us > 2'600'000 && joined(t, 2) &&
         ack_joins(f, 2)[0].time_us < fails[0].time_us && distinct_seqs(requests(f, 2)) == 2;
}
bool requests_again(const Traffic& t, const Frames& f) {
  const Frames later = after(f, ack_joins(f, 2)[0].time_us);
  return !failed(t, 2) && joined(t, 2) && !requests(later, 2).empty();
}
bool ghost(const Traffic& t, const Frames& f) {
  return joined(t, 2) && has_net_from(f, 2) && reports_of(f, 2) == 0;
}
bool orphan(const Traffic& t, const Frames& f) {
  return !joined(t, 2) && reports_of(f, 2) == 1 && requests(f, 2).size() == 6 &&
         replies(f, 2).size() == 1 && !has_net_from(f, 2);
}
bool listed_reboots(const Traffic& t, const Frames& f) {
  const Frames later = after(f, 4'000'000);
  return joined(t, 2) && failed(t, 2) && requests(later, 2).size() >= 5 &&
         replies(later, 2).empty();
}
bool interleaved(const Traffic&, const Frames& f) {
  const Frames first = pick(f, [](const Seen& s) { return s.is(AmType::kJoinReply); });
  const Frames before = pick(
      f, [&](const Seen& s) { return s.is(AmType::kJoin) && s.time_us < first.at(0).time_us; });
  return before.size() >= 3 && count(f, [](const Seen& s) { return s.serial_joined(); }) == 5;
}
bool full_list(const Traffic& t, const Frames& f) {
  return count(f, [](const Seen& s) { return s.serial_joined(); }) == 20 && failed(t, 22) &&
         failed(t, 23) && replies(f, 23).empty() && requests(f, 23).size() == 5;
}
bool full_list_answers(const Traffic&, const Frames& f) {
  return count(f, [](const Seen& s) { return s.serial_joined(); }) == 20 &&
         !replies(f, 23).empty() && reports_of(f, 23) == 0;
}
/// Returns the place of the reply that each mote took among those to its request: 1 or 2; 0 for
/// both.
std::multiset<int> choices(const Frames& f) {
  std::multiset<int> out;
  for (std::uint16_t mote = 2; mote <= 5; ++mote) {
    const Frames some = replies(f, mote);
    const Frames acks = ack_joins(f, mote);
    if (some.size() < 2 || acks.empty()) continue;
    for (const Seen& ack : acks) {
      if (ack.join_island() != acks[0].join_island()) return {0};
    }
    out.insert(some[0].join_island() == acks[0].join_island() ? 1 : 2);
  }
  return out;
}
bool takes_preferred(const Traffic&, const Frames& f) {
  const auto got = choices(f);
  return got.size() == 4 && got.count(0) == 0 && ack_joins(f, 2)[0].join_island() == 11 &&
         ack_joins(f, 3)[0].join_island() == 12;
}
bool wrong_sink(const Traffic& t, const Frames& f) {
  const Frames acks = ack_joins(f, 2);
  const Frames link = pick(f, [](const Seen& s) { return s.radio && s.link_ack; });
  const bool confirmed = std::any_of(link.begin(), link.end(), [&](const Seen& s) {
    return s.dsn == acks[0].dsn && s.time_us - acks[0].time_us < 3'000;
  });
  return joined(t, 2) && confirmed && reports_of(f, 2) == 0;
}
bool same_devid(const Traffic&, const Frames& f) {
  std::set<std::string> lines;
  for (const Seen& s : f) {
    if (s.serial_joined() && s.net->src.devid == 5) lines.insert(s.interface);
  }
  return lines.size() == 2;
}
bool set_first(const Traffic& t, const Frames& f) {
  return f[0].inbound && f[0].is(AmType::kConfig) && joined(t, 2) &&
         replies(f, 2)[0].join_island() == 12;
}
bool change_forgets(const Traffic&, const Frames& f) {
  const Frames later = replies(after(f, 6'000'000), 2);
  return replies(f, 2)[0].join_island() == 11 && !later.empty() && later[0].join_island() == 13;
}
bool change_keeps(const Traffic&, const Frames& f) {
  const Frames later = after(f, 6'000'000);
  return replies(later, 2).empty() && requests(later, 2).size() == 5;
}
bool home(const Traffic&, const Frames& f) {
  return count(f, [](const Seen& s) { return s.serial_joined(); }) == 12;
}
bool leaves(const Traffic&, const Frames& f) {
  const auto by_mote = [](const Seen& s) { return s.from(AmType::kNet, 3); };
  return count(f, by_mote) > 0 && count(after(f, 6'050'000), by_mote) == 0;
}

}  // namespace

const std::vector<Feature>& join_features() {
  static const std::vector<Feature> kFeatures = {
      {"four_requests", [](auto& t, auto& f) { return in_vain(t, f, 4, 1); }},
      {"five_requests", [](auto& t, auto& f) { return in_vain(t, f, 5, 1); }},
      {"five_requests_new_seq", [](auto& t, auto& f) { return in_vain(t, f, 5, 5); }},
      {"request_lost_same_seq", request_same},
      {"request_lost_new_seq", request_new},
      {"reply_lost_same_seq", reply_same},
      {"reply_lost_new_seq", reply_new},
      {"joins_again_after_fail", again_after_fail},
      {"joins_again_at_once", again_at_once},
      {"joined_at_acceptance", at_acceptance},
      {"joined_at_link_ack", at_link_ack},
      {"link_ack_lost", [](auto&, auto& f) { return five_ack_joins(f, 5); }},
      {"link_ack_lost_same_dsn", [](auto&, auto& f) { return five_ack_joins(f, 1); }},
      {"ack_join_thrice", thrice},
      {"ack_join_often", often},
      {"unconfirmed_fails", unconfirmed_fails},
      {"unconfirmed_requests_again", requests_again},
      {"ghost", ghost},
      {"orphan", orphan},
      {"listed_mote_reboots", listed_reboots},
      {"interleaved_joins", interleaved},
      {"full_list", full_list},
      {"full_list_answers", full_list_answers},
      {"two_sinks_first", [](auto&, auto& f) { return choices(f).count(1) == 4; }},
      {"two_sinks_preferred", takes_preferred},
      {"wrong_sink_link_acks", wrong_sink},
      {"same_devid", same_devid},
      {"set_island_first", set_first},
      {"island_change_forgets", change_forgets},
      {"island_change_keeps", change_keeps},
      {"home", home},
      {"mote_leaves", leaves},
  };
  return kFeatures;
}

}  // namespace rubric::lawful
