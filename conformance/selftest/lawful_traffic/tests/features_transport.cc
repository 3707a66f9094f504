// Features that variants of transport and network must show.
#include <algorithm>
#include <map>
#include <set>

#include "conformance/selftest/lawful_traffic/tests/seen.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;
using rubicon::Component;

bool is_ack(const Seen& s) { return s.app(Component::kRubiconAck); }
bool out(const Seen& s) { return !s.radio && !s.inbound && s.net; }
bool in(const Seen& s) { return !s.radio && s.inbound && s.net; }
bool from_pid(const Seen& s, std::uint16_t pid) { return s.net && s.net->src.pid == pid; }
bool to_pid(const Seen& s, std::uint16_t pid) { return s.net && s.net->dest.pid == pid; }

bool ack_sizes(const Frames& f, bool with_paper, bool with_deployed) {
  const auto air = pick(f, [](const Seen& s) { return s.radio && is_ack(s); });
  std::set<std::size_t> sizes;
  for (const Seen& s : air) sizes.insert(s.net->payload.size());
  return sizes.size() == (with_paper ? 1u : 0u) + (with_deployed ? 1u : 0u) &&
         (sizes.count(4) == 1) == with_paper && (sizes.count(6) == 1) == with_deployed;
}

/// Returns whether an ack failed, and each failure came `wait_us` after its send.
bool fails_after(const Traffic& t, std::int64_t wait_us) {
  int fails = 0;
  for (const AppEvent& fail : t.events) {
    if (fail.name != "receive_ack" || fail.fields.find("\"success\":0") == std::string::npos) {
      continue;
    }
    ++fails;
    const bool sent = std::any_of(t.events.begin(), t.events.end(), [&](const AppEvent& send) {
      return send.name == "send" && send.node == fail.node &&
             send.time_us == fail.time_us - wait_us;
    });
    if (!sent) return false;
  }
  return fails > 0;
}

/// Returns whether some message came again from its source, later than any timeout.
bool comes_again(const Frames& f, bool same_seq) {
  const auto wanted = [](const Seen& s) {
    return s.net && s.net->reliable && s.app(Component::kConnless) && (s.radio || !s.inbound) &&
           s.net->payload.size() > 8;
  };
  const Frames sent = pick(f, wanted);
  for (const Seen& a : sent) {
    for (const Seen& b : sent) {
      if (b.time_us - a.time_us < 950'000 || b.net->payload != a.net->payload) continue;
      if (b.net->src == a.net->src && (b.net->seq == a.net->seq) == same_seq) return true;
    }
  }
  return false;
}

bool about_unknown(const Seen& s) { return s.net && s.net->payload[1] == kUnknownApp; }
bool unknown_acked(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return about_unknown(s) && is_ack(s); });
}
bool unknown_silent(const Traffic&, const Frames& f) {
  return any(f, about_unknown) &&
         !any(f, [](const Seen& s) { return about_unknown(s) && is_ack(s); });
}
bool by_tester(const Seen& s) { return s.radio && s.am_src == 66; }
bool demo_data(const Seen& s) { return s.radio && s.body_type() == 34; }
bool odd_dropped(const Traffic&, const Frames& f) {
  return count(f, by_tester) == 2 && !any(f, demo_data) && !any(f, is_ack);
}
bool odd_taken(const Traffic&, const Frames& f) {
  return count(f, by_tester) == 2 && any(f, demo_data) && !any(f, is_ack);
}
bool tester_nbytes(const Traffic&, const Frames& f) {
  return count(f, by_tester) == 6 && !any(f, [](const Seen& s) { return by_tester(s) && s.net; });
}
bool host_nbytes(const Traffic&, const Frames& f) {
  return count(f, [](const Seen& s) {
           return s.inbound && s.is(AmType::kNet) && s.sum_ok && !s.net;
         }) == 4;
}
std::vector<std::uint16_t> seqs_of(const Frames& f, std::uint16_t mote) {
  std::vector<std::uint16_t> seqs;
  for (const Seen& s : f) {
    if (s.from(AmType::kNet, mote)) seqs.push_back(s.net->seq);
  }
  return seqs;
}
bool counts_up(const Frames& f) {
  const auto seqs = seqs_of(f, 3);
  for (std::size_t i = 1; i < seqs.size(); ++i) {
    const auto step = static_cast<std::uint16_t>(seqs[i] - seqs[i - 1]);
    if (step == 0 || step > 3) return false;
  }
  return seqs.size() > 5;
}
bool seq_ffff(const Traffic&, const Frames& f) {
  const auto seqs = seqs_of(f, 3);
  return counts_up(f) && std::find(seqs.begin(), seqs.end(), kNoSeq) != seqs.end();
}
bool seq_near_end(const Traffic&, const Frames& f) {
  const auto seqs = seqs_of(f, 3);
  const auto wraps = std::adjacent_find(seqs.begin(), seqs.end(), std::greater<>());
  return counts_up(f) && wraps != seqs.end() &&
         std::find(seqs.begin(), seqs.end(), kNoSeq) == seqs.end();
}
bool answer_first(const Traffic&, const Frames& f) {
  std::map<std::uint16_t, bool> last_was_answer;
  bool found = false;
  for (const Seen& s : f) {
    if (!s.radio || !s.net || s.am_src == kSinkAm) continue;
    if (is_ack(s) && last_was_answer[s.am_src]) found = true;
    last_was_answer[s.am_src] = s.body_type() == 34;
  }
  return found;
}
bool nonmember(const Traffic&, const Frames& f) {
  const std::int64_t first = requests(f, 2).at(0).time_us;
  return any(f, [&](const Seen& s) { return s.radio && s.am_dst == 2 && s.time_us < first; }) &&
         !any(f, [&](const Seen& s) { return s.from(AmType::kNet, 2) && s.time_us < first; });
}
bool in_full(const Traffic&, const Frames& f) {
  const auto burst = [](const Seen& s) {
    return s.radio && s.net && s.net->reliable && s.net->payload.size() == 4 &&
           s.net->payload[2] == 0xA0;
  };
  const auto acks = [](const Seen& s) { return s.radio && is_ack(s) && s.am_src == kSinkAm; };
  return count(f, burst) >= 20 && 2 * count(f, acks) < count(f, burst);
}
bool out_full(const Traffic& t, const Frames& f) {
  const auto burst = [](const Seen& s) {
    return s.radio && s.net && s.net->payload.size() == 4 && s.net->payload[2] == 0xA1;
  };
  return count(f, burst) <= 8 && count(f, burst) >= 4 &&
         events(t, 2, "send", "\"seq_num\":65535").size() >= 8;
}
bool own_broadcast(const Seen& s, bool reliable) {
  return s.net && s.net->dest.devid == kAllNodes && s.net->dest.pid == s.net->src.pid &&
         s.net->reliable == reliable;
}
bool broadcasts(const Frames& f, bool reliable) {
  const auto one = [reliable](const Seen& s) { return own_broadcast(s, reliable); };
  return any(f, [&](const Seen& s) { return one(s) && in(s); }) &&
         any(f, [&](const Seen& s) { return one(s) && s.am_src == 2; }) &&
         any(f, [&](const Seen& s) { return one(s) && s.radio && s.net->src.devid == 1; }) &&
         count(f, [&](const Seen& s) { return s.radio && one(s); }) == 6;
}
bool broadcast(const Traffic&, const Frames& f) { return broadcasts(f, false); }
bool broadcast_reliable(const Traffic&, const Frames& f) {
  std::set<std::uint16_t> seqs;
  for (const Seen& s : f) {
    if (own_broadcast(s, true)) seqs.insert(s.net->seq);
  }
  return broadcasts(f, true) &&
         !any(f, [&](const Seen& s) { return is_ack(s) && seqs.count(s.acked()) != 0; });
}
bool broadcast_acked(const Traffic&, const Frames& f) {
  std::set<std::uint16_t> seqs;
  for (const Seen& s : f) {
    if (own_broadcast(s, true)) seqs.insert(s.net->seq);
  }
  return broadcasts(f, true) && count(f, [&](const Seen& s) {
                                  return s.radio && is_ack(s) && seqs.count(s.acked()) != 0;
                                }) > 5;
}
bool wide(const Seen& s) { return to_pid(s, kAllNodes); }
bool wide_ignored(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return wide(s) && s.radio && s.am_dst == kAllNodes; }) &&
         !any(f, [](const Seen& s) { return wide(s) && out(s); });
}
bool wide_refused(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return wide(s) && in(s); }) &&
         !any(f, [](const Seen& s) { return wide(s) && s.radio && s.am_src == kSinkAm; });
}
/// Returns whether each of them is on the air at most once by its source and once by each sink.
bool no_storm(const Frames& f) {
  std::map<std::pair<std::uint16_t, std::uint16_t>, int> copies;
  for (const Seen& s : f) {
    if (wide(s) && s.radio) ++copies[{s.net->src.devid, s.net->seq}];
  }
  return std::all_of(copies.begin(), copies.end(), [](const auto& c) { return c.second <= 3; });
}
bool wide_forwarded(const Traffic&, const Frames& f) {
  return no_storm(f) && any(f, [](const Seen& s) { return wide(s) && out(s); }) &&
         any(f, [](const Seen& s) { return wide(s) && in(s) && s.interface == "serial:101"; });
}
bool wide_to_sink(const Traffic& t, const Frames& f) {
  return wide_forwarded(t, f) &&
         any(f, [](const Seen& s) { return wide(s) && s.radio && s.am_dst == kSinkAm; });
}
/// Returns the most copies of one message from island 11 to a mote of 12 that a sink radiated.
int copies_by_sinks(const Frames& f) {
  std::map<std::uint16_t, int> copies;
  for (const Seen& s : f) {
    const bool crossing = s.radio && s.am_src == kSinkAm && from_pid(s, 11) && to_pid(s, 12);
    if (crossing && s.app(Component::kConnless)) ++copies[s.net->seq];
  }
  int most = 0;
  for (const auto& [seq, number] : copies) most = std::max(most, number);
  return most;
}
bool direct_to_pc(const Seen& s) {
  return out(s) && s.interface == "serial:101" && from_pid(s, 11) && to_pid(s, 12);
}
bool source_ignored(const Traffic&, const Frames& f) {
  return !any(f, direct_to_pc) && any(f, [](const Seen& s) {
    return s.radio && from_pid(s, 11) && s.net->dest == Address{12, kNull};
  });
}
bool to_foreign_sink(const Traffic&, const Frames& f) {
  std::map<std::uint16_t, int> acks;
  for (const Seen& s : f) {
    if (out(s) && is_ack(s) && s.interface == "serial:101" && to_pid(s, 11)) ++acks[s.acked()];
  }
  return std::any_of(acks.begin(), acks.end(), [](const auto& a) { return a.second == 2; });
}
bool crossing(const Seen& s) {
  return s.radio && s.net && s.am_src == kSinkAm && s.net->src.pid != s.net->dest.pid;
}
bool inter_true(const Traffic&, const Frames& f) {
  return any(f, crossing) &&
         !any(f, [](const Seen& s) { return crossing(s) && s.payload[11] == 102; });
}
bool inter_whole(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return crossing(s) && s.payload[11] == 102; });
}
bool three_islands(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return s.interface == "serial:201" && s.serial_joined(); }) &&
         any(f, crossing);
}
bool forwarded_with(const Frames& f, std::uint8_t nbytes) {
  const Frames some = pick(f, [](const Seen& s) { return out(s) && s.body_type() == 35; });
  return !some.empty() && std::all_of(some.begin(), some.end(), [&](const Seen& s) {
    return s.payload.size() == 114 && s.payload[11] == nbytes;
  });
}
bool serial_cut(const Traffic&, const Frames& f) {
  const auto cut = [](const Seen& s) {
    return !s.radio && s.is(AmType::kNet) && s.payload.size() < 114;
  };
  return any(f, [&](const Seen& s) { return cut(s) && s.inbound; }) &&
         any(f, [&](const Seen& s) { return cut(s) && !s.inbound; });
}
bool dest_zero(const Traffic&, const Frames& f) {
  return any(f, in) && !any(f, [](const Seen& s) { return in(s) && s.am_dst != 0; });
}
/// Returns whether the host sent one message in two good or, with `damaged`, one bad and one good
/// frame.
bool host_repeats(const Frames& f, bool damaged) {
  const Frames sent =
      pick(f, [](const Seen& s) { return !s.radio && s.inbound && s.is(AmType::kNet); });
  for (std::size_t i = 1; i < sent.size(); ++i) {
    const bool next = sent[i].dsn == static_cast<std::uint8_t>(sent[i - 1].dsn + 1);
    if (!next || sent[i].time_us - sent[i - 1].time_us < 990'000 || !sent[i].sum_ok) continue;
    if (damaged ? !sent[i - 1].sum_ok : sent[i - 1].payload == sent[i].payload) return true;
  }
  return false;
}
bool looped(const Seen& s) {
  return in(s) && s.interface == "serial:1" && to_pid(s, 12) && from_pid(s, 11);
}
bool loops_ignored(const Traffic&, const Frames& f) {
  return any(f, looped) && copies_by_sinks(f) == 1;
}
bool loops_radiated(const Traffic&, const Frames& f) {
  return any(f, looped) && copies_by_sinks(f) == 2;
}

}  // namespace

const std::vector<Feature>& transport_features() {
  static const std::vector<Feature> kFeatures = {
      {"ack_deployed", [](auto&, auto& f) { return ack_sizes(f, false, true); }},
      {"ack_paper", [](auto&, auto& f) { return ack_sizes(f, true, false); }},
      {"ack_per_node", [](auto&, auto& f) { return ack_sizes(f, true, true); }},
      {"ack_timeout_short", [](auto& t, auto&) { return fails_after(t, 400'000); }},
      {"ack_timeout_long", [](auto& t, auto&) { return fails_after(t, 3'000'000); }},
      {"app_resends_new_seq", [](auto&, auto& f) { return comes_again(f, false); }},
      {"app_resends_same_seq", [](auto&, auto& f) { return comes_again(f, true); }},
      {"unknown_app_acked", unknown_acked},
      {"unknown_app_silent", unknown_silent},
      {"tester_reliable_dropped", odd_dropped},
      {"tester_reliable_taken", odd_taken},
      {"tester_nbytes", tester_nbytes},
      {"host_nbytes", host_nbytes},
      {"seq_random", [](auto&, auto& f) { return !counts_up(f); }},
      {"seq_counting", [](auto&, auto& f) { return counts_up(f); }},
      {"seq_near_end", seq_near_end},
      {"seq_ffff", seq_ffff},
      {"answer_before_ack", answer_first},
      {"message_to_nonmember", nonmember},
      {"in_full", in_full},
      {"out_full", out_full},
      {"broadcast", broadcast},
      {"broadcast_reliable", broadcast_reliable},
      {"broadcast_acked", broadcast_acked},
      {"broadcast_overlap", broadcast},
      {"wide_ignored", wide_ignored},
      {"wide_refused", wide_refused},
      {"wide_forwarded", wide_forwarded},
      {"wide_to_sink", wide_to_sink},
      {"other_mote_ignored", [](auto&, auto& f) { return copies_by_sinks(f) == 1; }},
      {"other_mote_relayed", [](auto&, auto& f) { return copies_by_sinks(f) == 2; }},
      {"foreign_source_forwarded", [](auto&, auto& f) { return any(f, direct_to_pc); }},
      {"foreign_source_ignored", source_ignored},
      {"foreign_mote_to_sink", to_foreign_sink},
      {"inter_island_true", inter_true},
      {"inter_island_whole", inter_whole},
      {"three_islands", three_islands},
      {"serial_true", [](auto&, auto& f) { return forwarded_with(f, 16); }},
      {"serial_whole", [](auto&, auto& f) { return forwarded_with(f, 102); }},
      {"serial_cut", serial_cut},
      {"serial_dest_zero", dest_zero},
      {"serial_resends", [](auto&, auto& f) { return host_repeats(f, true); }},
      {"serial_ack_lost", [](auto&, auto& f) { return host_repeats(f, false); }},
      {"host_loops_ignored", loops_ignored},
      {"host_loops_radiated", loops_radiated},
  };
  return kFeatures;
}

}  // namespace rubric::lawful
