#include "conformance/check/identify/streams.h"

#include <algorithm>

#include "conformance/check/links.h"
#include "conformance/check/message.h"

namespace rubric::check {
namespace {

constexpr std::size_t kHolesMax = 256;
constexpr std::size_t kStreamsMax = 4096;
constexpr int kLookMax = 16;  // Streams of one address that may go on, newest first.

// Points that speak for a frame being of a stream. Island agreement ranks above the DSN.
constexpr int kNoMatch = -1000;
constexpr int kStrongIsland = 20;
constexpr int kNextDsn = 6;
constexpr int kNearDsn = 3;
constexpr int kDestIsland = 3;  // The sink of that island should send it on.
constexpr int kSrcIsland = 1;
constexpr int kMoteIsland = 4;
constexpr int kAsked = 8;   // An ack_join has the number that the stream asked with.
constexpr int kStray = -4;  // One frame, and then many of another stream: perhaps an old one again.
constexpr std::uint32_t kStrayAfter = 16;
constexpr std::uint64_t kLifeFrames = 3;  // So many that follow each other are no stray ones.
constexpr std::uint16_t kBothLines = 0xFFFF;

// Notes that frames between the stream's last one and that time were missed; `dsn`: only that one.
void add_hole(Stream& stream, std::int64_t until_us, std::optional<std::uint8_t> dsn = {}) {
  if (stream.holes.size() < kHolesMax) {
    stream.holes.push_back({stream.last_us, until_us, dsn});
  } else {
    stream.holes.back().to_us = until_us;
    stream.holes.back().dsn.reset();
  }
}

}  // namespace

bool Stream::lacks(const Stream& other) const {
  return other.frames == 1 && other.am == am && std::ranges::any_of(holes, [&](const Hole& hole) {
           return hole.dsn == other.dsn && hole.from_us <= other.first_us &&
                  other.first_us <= hole.to_us;
         });
}

bool Stream::renews(const Stream& other, bool even, bool request) const {
  if (sink != other.sink || other.last >= first) return false;
  if (request && asks != other.asks) return asks;  // A member asks no more.
  const bool same = island == other.island && (island != kNoIsland || !request);
  return same && (even || joins || frames >= kLifeFrames);
}

bool Stream::asked_for(const Observation& seen, const IslandHint& hint) const {
  return seen.frame.type == am::kAckJoin && hint.join == join;
}

Streams::Streams(const Run& run, const Options& options)
    : run_(run),
      given_(options),
      sink_am_(given_.sink_am().value_or(machine::Profile{}.sink_id)),
      first_of_(65536, kLast),
      frames_of_(65536, 0) {}

IslandHint Streams::hint_of(const machine::Frame& frame) const {
  IslandHint hint;
  Reply reply;
  Net net;
  if (Request request; frame.type == am::kJoin && parse_request(frame.payload, request)) {
    hint.join = request.seq_num;
  } else if (frame.type == am::kJoinReply && parse_reply(frame.payload, reply)) {
    if (!machine::is_reserved(reply.island)) hint.strong = reply.island;
  } else if (AckJoin ack; frame.type == am::kAckJoin && parse_ack_join(frame.payload, ack)) {
    hint.mote = ack.src.pid;
    hint.join = ack.seq_num;
  } else if (frame.type == am::kNet && parse_net(frame.payload, net)) {
    hint.mote = net.src.pid;
    // A message of another island's sink may be passed on; it looks like the sink's own.
    if (net.src.devid == frame.src && net.src.pid == net.dest.pid) {
      hint.strong = net.src.pid;
    } else if (net.src.devid == frame.src) {
      hint.src = net.src.pid;
      hint.dest = net.dest.pid;
    } else {
      if (net.src.devid == machine::kNullDevid) hint.src = net.src.pid;
      hint.dest = net.dest.pid;
    }
    if (net.dest.pid == machine::kBroadcastPid) hint.src = hint.dest = kNoIsland;  // Any sink's.
    for (const Down& down : downs_) {
      if (down.addresses != net.addresses() || down.seq_num != net.seq_num) continue;
      hint.line = hint.line == kNoIsland || hint.line == down.island ? down.island : kBothLines;
    }
  }
  return hint;
}

int Streams::score(const Stream& stream, const Observation& seen, const IslandHint& hint) const {
  const auto ahead = static_cast<std::uint8_t>(seen.dsn - stream.dsn);
  if (ahead == 0 || ahead > kGapMax) return kNoMatch;
  int points = ahead == 1 ? kNextDsn : kNearDsn;
  if (stream.asked_for(seen, hint)) points += kAsked;
  if (stream.island == kNoIsland) return points;
  // Motes of two islands may have the same id; but one mote may also change its island.
  if (!stream.sink) {
    if (hint.mote == kNoIsland) return points;
    points += hint.mote == stream.island ? kMoteIsland : -kMoteIsland;
    return points > 0 ? points : kNoMatch;
  }
  const bool stale = hint.strong != kNoIsland && hint.strong == stream.last_island;
  const bool other = hint.strong != kNoIsland && hint.strong != stream.island && !stale;
  if (other) return stream.given ? points : kNoMatch;  // Rather than two sinks, one given wrongly.
  if (hint.strong != kNoIsland && !stale) points += kStrongIsland;
  // A message from another island's base station to that island is the other sink's.
  if (hint.src != kNoIsland && hint.src == hint.dest && hint.src != stream.island) return kNoMatch;
  if (hint.src == stream.island) points += kSrcIsland;
  if (hint.dest == stream.island) points += kDestIsland;
  if (hint.line == stream.island && hint.line != kNoIsland) points += kStrongIsland;
  return points;
}

bool Streams::takes_back(Stream& stream, const Observation& seen, const IslandHint& hint) const {
  if (!stream.sink || stream.loose == 0 || stream.dsn != seen.dsn || hint.strong == kNoIsland ||
      hint.strong != stream.island) {
    return false;
  }
  bool follows = false;  // The loose frame may be of another stream.
  for (std::uint16_t i = first_of_[stream.am]; i != kLast && !follows; i = next_[i]) {
    const auto ahead = static_cast<std::uint8_t>(seen.dsn - streams_[i].dsn);
    follows = streams_[i].sink && ahead >= 1 && ahead <= kGapMax;
  }
  if (!follows) return false;
  stream.dsn = static_cast<std::uint8_t>(seen.dsn - stream.loose);
  stream.loose = 0;
  --stream.frames;
  return true;
}

std::uint16_t Streams::assign(std::uint32_t index, std::vector<Mark>& marks) {
  const Observation& seen = run_.seen[index];
  const std::int64_t now = seen.place.time_us;
  const IslandHint hint = hint_of(seen.frame);
  ++frames_of_[seen.frame.src];
  if (run_.past.holds(index)) return assign_past(index, hint);
  std::uint16_t best = kLast;
  int best_score = kNoMatch;
  bool even = false;
  int candidates = 0;
  int looked_at = 0;
  for (std::uint16_t i = first_of_[seen.frame.src]; i != kLast && looked_at < kLookMax;
       i = next_[i], ++looked_at) {
    Stream& stream = streams_[i];
    const machine::Frame& before = run_.seen[stream.last].frame;
    // Only a request may be of a new life that begins with this number. Of all else a copy of the
    // last frame is one, however late: the recorder's clock may have stepped between the two.
    const bool copy = now - stream.last_us <= kLinkRepeatUs || seen.frame.type != am::kJoin;
    if (stream.dsn == seen.dsn && before.dest == seen.frame.dest &&
        before.type == seen.frame.type && equal(before.payload, seen.frame.payload) && copy) {
      marks[index].repeat = true;
      marks[index].late =
          now - stream.last_us > kLinkRepeatUs && !stepped(run_.steps, stream.last_us, now);
      stream.last_us = now;
      return i;
    }
    if (takes_back(stream, seen, hint)) marks[stream.last].device = kNobody;
    int points = score(stream, seen, hint);
    if (points == kNoMatch) continue;
    const bool request = seen.frame.type == am::kJoin;
    // What was asked for shows that it is alive, and that the newer one is its namesake.
    if (best != kLast && !stream.asked_for(seen, hint) &&
        streams_[best].renews(stream, points == best_score, request)) {
      continue;
    }
    const bool stray =
        stream.frames == 1 && frames_of_[seen.frame.src] - stream.last_of_am > kStrayAfter;
    if (!stray) ++candidates;
    if (stray) points += kStray;
    if (points >= best_score) even = points == best_score;
    if (points <= best_score) continue;
    best = i;
    best_score = points;
  }
  if (even) return kNobody;
  // With several sinks a frame that shows no island belongs to none for certain: a DSN alone does
  // not decide.
  const bool told = hint.strong != kNoIsland || hint.src != kNoIsland || hint.dest != kNoIsland ||
                    hint.mote != kNoIsland || (hint.line != kNoIsland && hint.line != kBothLines);
  if (candidates > 1 &&
      (!told || (streams_[best].sink && hint.strong == kNoIsland && hint.src == kNoIsland &&
                 hint.dest == kNoIsland && hint.line == kNoIsland))) {
    return kNobody;
  }
  if (best == kLast) return open(index, hint);
  Stream& stream = streams_[best];
  const auto ahead = static_cast<std::uint8_t>(seen.dsn - stream.dsn);
  const auto before = static_cast<std::uint8_t>(seen.dsn - 1);
  if (ahead != 1) add_hole(stream, now, ahead == 2 ? std::optional(before) : std::nullopt);
  ++stream.frames;
  go_on(stream, index, hint);
  stream.loose = candidates > 1 && hint.strong == kNoIsland ? ahead : 0;
  return best;
}

// Takes what the next frame of a stream shows.
void Streams::go_on(Stream& stream, std::uint32_t index, const IslandHint& hint) {
  const Observation& seen = run_.seen[index];
  stream.dsn = seen.dsn;
  stream.last = index;
  stream.last_us = seen.place.time_us;
  stream.last_of_am = frames_of_[seen.frame.src];
  stream.asks = seen.frame.type == am::kJoin;
  stream.asked = stream.asked || stream.asks;
  if (stream.asks) stream.join = hint.join;
  if (seen.frame.type == am::kNet) stream.join = -1;
  if (!stream.sink && hint.mote != kNoIsland) stream.island = hint.mote;
  if (seen.frame.type == am::kJoinReply && !stream.asked) stream.sink = true;
  if (stream.sink) guess_island(stream, index, hint);
}

std::uint16_t Streams::assign_past(std::uint32_t index, const IslandHint& hint) {
  const std::uint16_t sender = run_.past.senders[index];
  if (sender == kNobody) return kNobody;
  if (of_sender_.size() <= sender) of_sender_.resize(sender + std::size_t{1}, kNobody);
  std::uint16_t& its = of_sender_[sender];
  if (its == kNobody) {
    its = open(index, hint);
    if (its != kNobody) streams_[its].frames = run_.past.frames_of[sender];
  } else {
    add_hole(streams_[its], run_.seen[index].place.time_us);
    go_on(streams_[its], index, hint);
  }
  return its;
}

// Sets the stream's island. A frame's plain statement ranks above the user's, and that above a
// frame's suggestion.
void Streams::guess_island(Stream& stream, std::uint32_t index, const IslandHint& hint) const {
  if (hint.strong != kNoIsland && hint.strong != stream.last_island && stream.plain == 0) {
    stream.plain = index + 1;
    stream.plain_island = hint.strong;
    if (stream.given) stream.island = kNoIsland;
    stream.given = false;
  }
  if (stream.island != kNoIsland) return;
  const std::uint16_t said = given_.only_island(stream.am);
  const bool taken = std::any_of(streams_.begin(), streams_.end(), [&](const Stream& other) {
    return other.am == stream.am && other.island == said;
  });
  stream.given = hint.strong == kNoIsland && said != kNoIsland && !taken;
  stream.island = hint.strong != kNoIsland ? hint.strong : stream.given ? said : hint.dest;
  stream.first_island = stream.island;
}

std::uint16_t Streams::open(std::uint32_t index, const IslandHint& hint) {
  const Observation& seen = run_.seen[index];
  if (streams_.size() >= kStreamsMax) {  // Bounded, whatever the capture holds.
    ++left_out_;
    return kNobody;
  }
  Stream stream{.am = seen.frame.src, .dsn = seen.dsn};
  const std::optional<machine::Role> said = given_.role(stream.am);
  const bool usual = stream.am == sink_am_ || stream.am == machine::Profile{}.sink_id;
  const bool named = said ? *said == machine::Role::kSink : usual;
  stream.sink = seen.frame.type == am::kJoinReply || (named && seen.frame.type != am::kJoin);
  stream.joins = stream.asked = stream.asks = seen.frame.type == am::kJoin;
  if (stream.joins) stream.join = hint.join;
  if (stream.sink) {
    guess_island(stream, index, hint);
  } else {
    stream.island = hint.mote;
  }
  stream.last_of_am = frames_of_[stream.am];
  stream.first = stream.last = index;
  stream.first_us = stream.last_us = seen.place.time_us;
  stream.frames = 1;
  const auto made = static_cast<std::uint16_t>(streams_.size());
  streams_.push_back(stream);
  next_.push_back(first_of_[stream.am]);
  first_of_[stream.am] = made;
  return made;
}

bool Streams::has_sink() const {
  return std::any_of(streams_.begin(), streams_.end(), [](const Stream& s) { return s.sink; });
}

bool Streams::has_sink(std::uint16_t island) const {
  return std::any_of(streams_.begin(), streams_.end(),
                     [&](const Stream& s) { return s.sink && s.island == island; });
}

void Streams::heard_on_serial(const Net& net, std::uint16_t island) {
  if (island != kNoIsland)
    downs_[down_next_++ % downs_.size()] = {net.addresses(), net.seq_num, island};
}

void Streams::rename_island(std::uint16_t from, std::uint16_t to) {
  if (from == kNoIsland) return;
  for (Stream& stream : streams_) {
    if (!stream.sink || stream.island != from || from == to) continue;
    stream.last_island = from;
    stream.island = to;
    stream.given = false;
  }
}

}  // namespace rubric::check
