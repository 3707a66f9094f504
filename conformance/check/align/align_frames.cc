#include "conformance/check/align/align_frames.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include "conformance/check/align/align.h"
#include "conformance/check/links.h"
#include "conformance/check/message.h"
#include "conformance/machine/profile.h"

namespace rubric::check {
namespace {

using Kind = Observation::Kind;

constexpr std::int64_t kRepeatUs = 500'000;  // The link repeats a frame within it.
constexpr std::uint32_t kRepeatFrames = 8;   // The same without stamps.
constexpr std::int64_t kOnWayUs = 10;        // A frame that passed is given after it was sent.
constexpr std::size_t kGroupMax = 32;        // Frames of one key that are told apart by content.

// Frames with equal keys are compared byte by byte.
std::uint64_t key_of(machine::Address mote, const machine::Descriptor& what) {
  return Hash().add(mote).add(what).value();
}

// Leaves out nbytes and the bytes after the payload, which differ on a serial line.
std::uint64_t key_of(const Net& net) {
  return Hash()
      .add(net.addresses(), 8)
      .add(net.reliable, 1)
      .add(net.seq_num, 2)
      .add(net.trans_id, 1)
      .add(net.app_id, 1)
      .value();
}

std::uint64_t key_of(const Observation& seen) {
  Hash hash;
  hash.add(static_cast<std::uint64_t>(seen.kind), 1).add(seen.frame.type, 1);
  hash.add(seen.frame.dest, 2).add(seen.frame.src, 2);
  if (seen.kind == Kind::kRadio) hash.add(seen.dsn, 1);
  return hash.add(seen.frame.payload).value();
}

// Fills `out` with the part of a frame that may pass between the air and a line. Returns false if
// nothing may.
bool passes(const Observation& seen, Sighting& out) {
  const bool radio = seen.kind == Kind::kRadio;
  out.cause = radio;
  AckJoin ack;
  if (radio && seen.frame.type == am::kAckJoin && parse_ack_join(seen.frame.payload, ack)) {
    out.how = Common::kJoined;
    out.key = key_of(ack.src, ack.descriptor);
    return true;
  }
  Net net;
  if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net) || !net.sound) {
    return false;
  }
  out.key = key_of(net);
  if (radio) {
    // A node that sends another one's message has it from a line.
    out.how = seen.frame.src == net.src.devid ? Common::kUp : Common::kDown;
    out.cause = out.how == Common::kUp;
    // A sink's own message to its motes comes from no line and goes to none.
    return net.src.devid != machine::Profile{}.sink_id;
  }
  SerialJoined joined;
  if (!seen.to_mote && parse_serial_joined(net, joined)) {
    out.how = Common::kJoined;
    out.key = key_of(joined.address, joined.descriptor);
    return true;
  }
  out.how = seen.to_mote ? Common::kDown : Common::kUp;
  out.cause = seen.to_mote;
  return seen.to_mote || net.src.devid != machine::Profile{}.sink_id;
}

bool whole(const Observation& a, const Observation& b) {
  return a.kind == b.kind && a.frame.dest == b.frame.dest && a.frame.src == b.frame.src &&
         a.frame.type == b.frame.type && (a.kind != Kind::kRadio || a.dsn == b.dsn) &&
         equal(a.frame.payload, b.frame.payload);
}

// Returns whether two frames with one key may be one message.
bool fits(const Run& run, Common how, const Sighting& cause, const Sighting& effect) {
  const Observation& from = run.seen[cause.index];
  const Observation& to = run.seen[effect.index];
  if (how == Common::kSame || how == Common::kPassed) return whole(from, to);
  // The key is all that they have in common.
  if (how == Common::kJoined || how == Common::kLogged) return true;
  Net on_air;
  Net on_line;
  const bool up = how == Common::kUp;
  if (!parse_net((up ? from : to).frame.payload, on_air)) return false;
  if (!parse_net((up ? to : from).frame.payload, on_line)) return false;
  const std::size_t size = on_air.payload.size();
  return same_message(on_air, on_line) && on_line.payload.size() >= size &&
         equal(on_line.payload.first(size), on_air.payload);
}

// Returns whether `after` is the link's own repetition of `before`.
bool repeats(const Run& run, const Sighting& before, const Sighting& after) {
  const Observation& a = run.seen[before.index];
  const Observation& b = run.seen[after.index];
  const bool frame = a.kind == Kind::kRadio || a.kind == Kind::kSerial;
  if (!frame || a.tap != b.tap || !whole(a, b)) return false;
  const std::int64_t none = std::min(a.place.time_us, b.place.time_us);
  return none == kNoStamp ? after.index - before.index <= kRepeatFrames
                          : b.place.time_us - a.place.time_us <= kRepeatUs;
}

using Group = std::span<const Sighting>;

std::vector<Sighting> once(const Run& run, Group group) {
  std::vector<Sighting> out;
  const Sighting* before = nullptr;
  for (const Sighting& one : group) {
    if (before == nullptr || !repeats(run, *before, one)) out.push_back(one);
    before = &one;
  }
  return out;
}

class Pairing {
 public:
  Pairing(const Run& run, Group a, Group b, CommonFrames& out)
      : run_(run), of_a_(kinds(a)), of_b_(kinds(b)), out_(out) {}

  // Matches frames of one key; `sign` is Pair::lag_sign.
  void match(Common how, Group of_a, Group of_b, int sign) {
    const std::vector<Sighting> a = once(run_, of_a);
    const std::vector<Sighting> b = once(run_, of_b);
    if (!a.empty() && !b.empty() && std::max(a.size(), b.size()) > kGroupMax) {
      return guess(how, a, b, sign);
    }
    std::vector<std::size_t> fit_a(a.size(), 0);
    std::vector<std::size_t> fit_b(b.size(), 0);
    std::vector<std::pair<std::size_t, std::size_t>> fitting;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        if (!(sign < 0 ? fits(run_, how, b[j], a[i]) : fits(run_, how, a[i], b[j]))) continue;
        fitting.emplace_back(i, j);
        ++fit_a[i];
        ++fit_b[j];
      }
    }
    for (const auto& [i, j] : fitting) {
      const Pair pair = pair_of(how, a[i], b[j], sign);
      (fit_a[i] == 1 && fit_b[j] == 1 ? out_.pairs : out_.guesses).push_back(pair);
    }
    // Another place hears other frames, and a log is of some nodes.
    if (how == Common::kSame || how == Common::kLogged || how == Common::kPassed) return;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (fit_a[i] == 0 && goes_on(a[i], of_b_)) out_.only_a.push_back(a[i].index);
    }
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (fit_b[j] == 0 && goes_on(b[j], of_a_)) out_.only_b.push_back(b[j].index);
    }
  }

 private:
  // Pairs neighbours by their stamps where there are too many to compare each with each.
  void guess(Common how, Group a, Group b, int sign) {
    const auto at = [&](const Sighting& one) { return run_.seen[one.index].place.time_us; };
    std::size_t i = 0;
    for (const Sighting& one : b) {
      while (i + 1 < a.size() && at(a[i + 1]) <= at(one)) ++i;
      out_.guesses.push_back(pair_of(how, a[i], one, sign));
      if (i + 1 < a.size()) out_.guesses.push_back(pair_of(how, a[i + 1], one, sign));
    }
  }

  std::set<Kind> kinds(Group all) const {
    std::set<Kind> out;
    for (const Sighting& one : all) out.insert(run_.seen[one.index].kind);
    return out;
  }

  // Returns whether a frame of the air may go on to a line of the other file, or back: one that has
  // frames of these kinds.
  bool goes_on(const Sighting& one, const std::set<Kind>& kinds) const {
    const bool radio = run_.seen[one.index].kind == Kind::kRadio;
    return kinds.contains(radio ? Kind::kSerial : Kind::kRadio);
  }

  Pair pair_of(Common how, const Sighting& a, const Sighting& b, int sign) const {
    // Radio stamps mark the start of a frame, serial stamps its end.
    const Observation& cause = run_.seen[sign < 0 ? b.index : a.index];
    const std::int64_t lag_us = how == Common::kPassed ? kOnWayUs : air_us(cause);
    return {a.index, b.index, how, sign, sign == 0 ? 0 : lag_us};
  }

  const Run& run_;
  std::set<Kind> of_a_;
  std::set<Kind> of_b_;
  CommonFrames& out_;
};

auto order_of(const Sighting& one) { return std::tuple(one.how, one.key, one.cause, one.index); }

// Returns the part of `all`, which is sorted, with this name; `at` moves past it.
Group take(const std::vector<Sighting>& all, std::size_t& at, Common how, std::uint64_t key,
           bool cause) {
  const std::size_t from = at;
  const auto named = [&](const Sighting& one) {
    return one.how == how && one.key == key && one.cause == cause;
  };
  while (at < all.size() && named(all[at])) ++at;
  return Group(all).subspan(from, at - from);
}

}  // namespace

std::vector<std::vector<Sighting>> sightings_of(const Run& run) {
  std::vector<std::vector<Sighting>> out(run.files.size());
  for (std::uint32_t i = 0; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    const bool frame = seen.kind == Kind::kRadio || seen.kind == Kind::kSerial;
    if (!frame) continue;
    Sighting one{.index = i};
    if (passes(seen, one)) out[seen.place.file].push_back(one);
    if (!seen.node.empty()) continue;
    out[seen.place.file].push_back({key_of(seen), i, Common::kSame, false});
  }
  return out;
}

CommonFrames common_frames(const Run& run, std::vector<Sighting>& a, std::vector<Sighting>& b) {
  const auto before = [](const Sighting& x, const Sighting& y) {
    return order_of(x) < order_of(y);
  };
  for (std::vector<Sighting>* const all : {&a, &b}) {
    if (!std::is_sorted(all->begin(), all->end(), before)) {
      std::sort(all->begin(), all->end(), before);
    }
  }
  CommonFrames out;
  Pairing pairing(run, a, b, out);
  std::size_t at_a = 0;
  std::size_t at_b = 0;
  while (at_a < a.size() || at_b < b.size()) {
    const bool of_b = at_a == a.size() ||
                      (at_b < b.size() &&
                       std::tuple(b[at_b].how, b[at_b].key) < std::tuple(a[at_a].how, a[at_a].key));
    const Common how = (of_b ? b[at_b] : a[at_a]).how;
    const std::uint64_t key = (of_b ? b[at_b] : a[at_a]).key;
    const Group effects_a = take(a, at_a, how, key, false);
    const Group causes_a = take(a, at_a, how, key, true);
    const Group effects_b = take(b, at_b, how, key, false);
    const Group causes_b = take(b, at_b, how, key, true);
    if (how == Common::kSame) {
      pairing.match(how, effects_a, effects_b, 0);
    } else {
      pairing.match(how, causes_a, effects_b, 1);
      pairing.match(how, effects_a, causes_b, -1);
    }
  }
  std::sort(out.pairs.begin(), out.pairs.end(),
            [](const Pair& x, const Pair& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
  return out;
}

std::vector<Sighting> each_once(const Run& run,
                                const std::vector<const std::vector<Sighting>*>& files,
                                std::int64_t skew_us) {
  std::vector<const std::vector<Sighting>*> by_size = files;
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto* a, const auto* b) { return a->size() > b->size(); });
  // A frame that counts, and the last file that has it: two frames of one file are two.
  struct Heard {
    std::uint32_t index;
    std::uint32_t file;
  };
  std::multimap<std::pair<std::uint64_t, std::int64_t>, Heard> heard;  // By key and stamp.
  std::set<std::uint32_t> again;
  for (const std::vector<Sighting>* const file : by_size) {
    for (const Sighting& one : *file) {
      const Place& place = run.seen[one.index].place;
      if (one.how != Common::kSame || place.time_us == kNoStamp) continue;
      const auto end = heard.upper_bound({one.key, place.time_us + skew_us});
      auto same = heard.lower_bound({one.key, place.time_us - skew_us});
      const auto may_be = [&](const Heard& other) {
        return other.file != place.file && whole(run.seen[other.index], run.seen[one.index]);
      };
      std::size_t tries = kGroupMax;  // More frames of one key at one time look alike.
      while (same != end && !may_be(same->second)) {
        if (--tries == 0) {
          same = end;
        } else {
          ++same;
        }
      }
      if (same == end) {
        heard.insert({{one.key, place.time_us}, {one.index, place.file}});
      } else {
        same->second.file = place.file;
        again.insert(one.index);
      }
    }
  }
  std::vector<Sighting> out;
  for (const std::vector<Sighting>* const file : files) {
    std::copy_if(file->begin(), file->end(), std::back_inserter(out), [&](const Sighting& one) {
      return one.how != Common::kSame && !again.contains(one.index);
    });
  }
  return out;
}

}  // namespace rubric::check
