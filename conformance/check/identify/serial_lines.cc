#include "conformance/check/identify/serial_lines.h"

#include <algorithm>
#include <utility>

#include "conformance/check/message.h"
#include "conformance/check/terms.h"

namespace rubric::check {
namespace {

// No parameter says how long a host waits; those of TinyOS wait 1000 ms (ACK_TIMEOUT of
// Packetizer.java and serialsource.c).
constexpr std::int64_t kSerialRepeatUs = 1'500'000;
constexpr std::int64_t kFrameOnLineUs = 100'000;  // A report that waited for the line.
constexpr std::size_t kShownMax = 256;

// Returns the island that a report or the source of a passing message shows, never its destination
// alone; kNoIsland if neither does. A base station hands on what other islands' PCs sent. Of a
// report that names two islands the one counts that the air shows, else that of its source.
std::uint16_t island_of(const Observation& seen, const Net& net, const Streams& streams) {
  const bool own = seen.to_mote
                       ? net.src == machine::Address{net.dest.pid, machine::kNullDevid}
                       : net.src.devid == streams.sink_am() ||
                             net.dest == machine::Address{net.src.pid, machine::kNullDevid};
  SerialJoined joined;
  const bool report = !seen.to_mote && parse_serial_joined(net, joined);
  if (report && (!own || streams.has_sink(joined.address.pid))) return joined.address.pid;
  return own ? net.src.pid : kNoIsland;
}

// Returns the island in which the sink itself says that a mote joined; kNoIsland if it does not.
std::uint16_t reported_island(const Observation& seen, const Net& net) {
  SerialJoined joined;
  const bool report = !seen.to_mote && parse_serial_joined(net, joined);
  return report && joined.address.pid == net.src.pid ? net.src.pid : kNoIsland;
}

}  // namespace

SerialLines::SerialLines(const Run& run, const Options& options, const Given& given,
                         Streams& streams)
    : run_(run),
      streams_(streams),
      under_way_us_(terms_of(options).response_us + run.slack_us + kFrameOnLineUs),
      lines_(run.taps.size()) {
  join_taps();
  // The one line belongs to the one sink that is given.
  SerialLine* only = nullptr;
  for (std::size_t tap = 0; tap < lines_.size(); ++tap) {
    if (run.taps[tap].link != machine::Link::kSerial) continue;
    if (only != nullptr) return;
    only = &lines_[tap];
  }
  if (only == nullptr || given.only_island() == kNoIsland) return;
  only->given = true;
  only->island = only->first = given.only_island();
}

// A recorder that begins a new file goes on with the same lines, by their names: a tap goes on with
// that of another that had its last frame before.
void SerialLines::join_taps() {
  std::vector<std::size_t> last(lines_.size());
  for (std::size_t i = 0; i < run_.seen.size(); ++i) last[run_.seen[i].tap] = i;
  std::vector<bool> seen(lines_.size());
  for (std::uint32_t tap = 0; tap < lines_.size(); ++tap) line_of_.push_back(tap);
  for (std::size_t i = 0; i < run_.seen.size(); ++i) {
    const std::uint32_t tap = run_.seen[i].tap;
    if (seen[tap]) continue;
    seen[tap] = true;
    for (std::uint32_t other = 0; other < lines_.size(); ++other) {
      const bool same = run_.taps[other].name == run_.taps[tap].name;
      if (same && other != tap && seen[other] && last[other] < i) line_of_[tap] = line_of_[other];
    }
  }
}

void SerialLines::look(std::uint32_t index) {
  const Observation& seen = run_.seen[index];
  SerialLine& line = lines_[line_of_[seen.tap]];
  const auto show = [&](std::uint16_t island) {
    line.island = island;
    line.given = false;
    if (shown_.size() < kShownMax) shown_.push_back({streams_.sink_am(), island, index});
  };
  if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
    const auto island = static_cast<std::uint16_t>(id);
    // It had its given island before, if it was there before.
    if (line.given && (line.used || streams_.has_sink())) show(line.island);
    streams_.rename_island(line.back != kNoIsland ? line.back : line.island, island);
    line.back = kNoIsland;
    if (line.first == kNoIsland) {  // What it was before is not known.
      line.first = island;
      line.set_later = line.used;
      line.first_told = !line.used;
      line.set_us = seen.place.time_us;
    }
    line.by_host = false;
    line.told = true;
    show(island);
    return;
  }
  Net net;
  if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
  const std::uint16_t reported = reported_island(seen, net);
  const bool own = !seen.to_mote && net.src.devid == streams_.sink_am();
  const std::uint16_t its = own ? net.src.pid : reported;
  const bool known = std::ranges::find(line.its, its) != line.its.end();
  if (its != kNoIsland && !known && line.its.size() < kShownMax) line.its.push_back(its);
  if (line.told && its != kNoIsland) line.back = its != line.island ? its : kNoIsland;
  // A report that was under way when the host set the island is the first to show the former one.
  const bool under_way = std::exchange(line.first_told, false) && seen.place.timed() &&
                         seen.place.time_us - line.set_us <= under_way_us_;
  if (under_way && reported != kNoIsland && reported != line.island) {
    line.first = reported;
    line.back = kNoIsland;
    streams_.rename_island(reported, line.island);
  }
  // A host may write under a name that is not its island's; a sink's own reports outrank it.
  const bool reports = line.by_host && reported != kNoIsland;
  if (line.island == kNoIsland || line.given || reports) {
    if (const std::uint16_t island = island_of(seen, net, streams_); island != kNoIsland) {
      line.first = island;
      line.by_host = seen.to_mote;
      show(island);
    }
  }
  line.used = true;
  if (seen.to_mote) streams_.heard_on_serial(net, line.island);
}

bool SerialLines::alone_reports(std::uint16_t before, std::uint16_t now, bool told) const {
  const auto is_of = [&](const SerialLine& line, std::uint16_t island) {
    return line.island == island || line.first == island;
  };
  const auto reports = [&](const SerialLine& line) {
    return (line.told || told) && is_of(line, before) &&
           std::ranges::find(line.its, now) != line.its.end();
  };
  return std::ranges::any_of(lines_, reports) &&
         std::ranges::none_of(lines_, [&](const SerialLine& line) { return is_of(line, now); });
}

bool SerialLines::repeats(std::uint32_t index) {
  const Observation& seen = run_.seen[index];
  if (!seen.to_mote || !seen.ack_request) return false;
  SerialLine& line = lines_[line_of_[seen.tap]];
  const std::uint32_t before = line.last_down;
  line.last_down = index + 1;
  if (before == 0) return false;
  const Observation& last = run_.seen[before - 1];
  return last.frame.type == seen.frame.type && equal(last.frame.payload, seen.frame.payload) &&
         seen.place.time_us - last.place.time_us <= kSerialRepeatUs;
}

}  // namespace rubric::check
