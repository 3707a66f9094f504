#include "conformance/check/input/read.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <system_error>

#include "codec/text/files.h"
#include "conformance/check/align/align_logs.h"
#include "conformance/check/align/steps.h"
#include "conformance/check/input/directions.h"
#include "conformance/check/input/read_packet.h"
#include "conformance/check/input/read_trace.h"
#include "conformance/check/message.h"
#include "conformance/check/storage.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::size_t kLookBytes = 4096;  // Enough to recognize a format.

}  // namespace

Bytes RunStorage::keep(Bytes bytes) {
  if (bytes.empty()) return {};  // The first of all: there is no block yet.
  if (bytes.size() > kBlockBytes - used_) {
    blocks_.push_back(std::make_unique<std::uint8_t[]>(std::max(kBlockBytes, bytes.size())));
    used_ = 0;
  }
  std::uint8_t* const to = blocks_.back().get() + used_;
  std::memcpy(to, bytes.data(), bytes.size());
  used_ = std::min(kBlockBytes, used_ + bytes.size());
  return {to, bytes.size()};
}

std::string_view RunStorage::keep(std::string_view text) {
  for (const std::string& known : texts_) {
    if (known == text) return known;
  }
  return texts_.emplace_back(text);
}

namespace {

// A file that is being read.
struct ReadSource {
  std::uint32_t file = 0;
  std::vector<std::uint32_t> taps;  // For its interfaces.
  std::uint64_t frames = 0;
  std::int64_t later_us = 0;  // Its clock was put right by this, by frames that are forgotten.
};

std::uint32_t tap_of(const Packet& packet, std::string_view interface_name, ReadSource& source,
                     Run& run) {
  constexpr std::uint32_t kNone = UINT32_MAX;
  if (source.taps.size() <= packet.interface_id) source.taps.resize(packet.interface_id + 1, kNone);
  std::uint32_t& index = source.taps[packet.interface_id];
  if (index == kNone) {
    index = static_cast<std::uint32_t>(run.taps.size());
    Tap tap;
    tap.name = interface_name.empty() ? std::string_view(run.files[source.file]) : interface_name;
    run.taps.push_back(tap);
  }
  Tap& tap = run.taps[index];
  if (packet.framing == Framing::kHdlc || packet.framing == Framing::kSf) {
    tap.link = machine::Link::kSerial;
  }
  if (packet.direction != Direction::kUnknown) tap.has_direction = true;
  return index;
}

void observe(const Packet& packet, std::string_view interface_name, ReadSource& source, Run& run) {
  ++source.frames;
  Observation seen;
  if (!observe_packet(packet, *run.storage, seen)) return;
  seen.tap = tap_of(packet, interface_name, source, run);
  seen.place.file = source.file;
  seen.place.frame = source.frames;
  seen.place.offset_bytes = packet.offset_bytes;
  seen.place.time_us =
      packet.time_ns == kNoTime ? kNoStamp : packet.time_ns / kNsPerUs + source.later_us;
  if (seen.kind == Observation::Kind::kSerial) {
    seen.to_mote = packet.direction == Direction::kUnknown
                       ? looks_towards_sink(seen.frame)
                       : packet.direction == Direction::kInbound;
  } else if (packet.framing == Framing::kHdlc || packet.framing == Framing::kSf) {
    seen.to_mote = packet.direction == Direction::kInbound;
  }
  Tap& tap = run.taps[seen.tap];
  const bool stated = packet.direction != Direction::kUnknown;
  if (tap.link == machine::Link::kSerial && seen.kind != Observation::Kind::kDamaged) {
    count_direction(seen, stated, tap);
  }
  run.seen.push_back(seen);
}

// A damaged place of a capture has no stamp: it gets that of the frame before it in its file, else
// of the one after it.
void stamp_damaged(Run& run) {
  const auto from_the_one_before = [](auto begin, auto end) {
    for (auto at = begin; at != end; ++at) {
      if (at == begin || at->kind != Observation::Kind::kDamaged) continue;
      const Place& before = at[-1].place;
      if (at->place.time_us == kNoStamp && before.file == at->place.file) {
        at->place.time_us = before.time_us;
      }
    }
  };
  from_the_one_before(run.seen.begin(), run.seen.end());
  from_the_one_before(run.seen.rbegin(), run.seen.rend());
}

constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

// Returns the first stamp of those observations; kNone if there is none.
template <class Its>
std::int64_t first_stamp(const std::vector<Observation>& seen, Its its) {
  std::int64_t first_us = kNone;
  for (const Observation& one : seen) {
    if (one.place.time_us != kNoStamp && its(one)) first_us = std::min(first_us, one.place.time_us);
  }
  return first_us;
}

// A log counts from the start of its run. Captures of simulated networks do, too; those of real
// ones have stamps of this century, and then the log is taken to begin with the capture. Returns
// whether that is so.
bool begin_logs(Run& run) {
  constexpr std::int64_t kTenYearsUs = 315'360'000'000'000;
  if (run.nodes.empty()) return false;
  const std::int64_t first_us =
      first_stamp(run.seen, [](const Observation& seen) { return seen.node.empty(); });
  if (first_us == kNone) return false;
  const std::int64_t begin_us = first_us > kTenYearsUs ? first_us : 0;
  for (Observation& seen : run.seen) {
    if (seen.node.empty()) continue;
    seen.place.time_us += begin_us;
    // A log counts whole ticks: an event happened within the tick that is written.
    if (seen.kind == Observation::Kind::kNotice) seen.place.time_us += machine::us_of(1);
  }
  move_nodes(run, std::nullopt, [&](std::int64_t time_us) { return time_us + begin_us; });
  return begin_us != 0;
}

// Leaves out what networks with another PAN radiate (TinyOS's AM group): nodes of this one, that
// with most messages, neither take nor acknowledge it.
void leave_out_networks(Run& run) {
  constexpr std::uint16_t kEveryPan = 0xFFFF;
  std::map<std::uint16_t, std::size_t> frames;
  const auto radio = [](const Observation& seen) {
    return seen.kind == Observation::Kind::kRadio && seen.node.empty() && seen.pan != kEveryPan;
  };
  std::map<std::uint16_t, std::size_t> messages;
  for (const Observation& seen : run.seen) {
    if (!radio(seen)) continue;
    ++frames[seen.pan];
    const std::uint8_t type = seen.frame.type;
    const bool ours =
        type == am::kJoin || type == am::kJoinReply || type == am::kAckJoin || type == am::kNet;
    messages[seen.pan] += ours ? 1 : 0;
  }
  if (frames.size() < 2) return;
  const auto most =
      std::ranges::max_element(messages, {}, [](const auto& one) { return one.second; });
  for (const auto& [pan, count] : frames) {
    if (pan == most->first) continue;
    char text[128];
    std::snprintf(text, sizeof text,
                  "%zu frame%s of PAN 0x%04x %s another network's, which is not judged", count,
                  count == 1 ? "" : "s", pan, count == 1 ? "is" : "are");
    run.facts.push_back(text);
  }
  for (Observation& seen : run.seen) {
    if (radio(seen) && seen.pan != most->first) seen.kind = Observation::Kind::kForeign;
  }
}

// Returns whether a capture's recorder stamped the frame.
bool is_stamped(const Observation& seen) {
  return seen.node.empty() && seen.place.time_us != kNoStamp;
}

// Notes how wide the grid of the stamps is, where frames share them and all of them are whole steps
// apart.
void find_grid(Run& run) {
  constexpr std::int64_t kFineUs = 1'000;  // A finer grid is within what timers may be off.
  constexpr std::size_t kManyStamps = 8;   // Fewer may be whole steps apart by chance.
  struct Stamps {
    std::int64_t last_us = kNoStamp;
    std::int64_t grid_us = 0;  // 0: all are the same; no more than kFineUs: fine.
    std::size_t several = 0;   // Other ones than before.
    bool shared = false;
  };
  std::vector<Stamps> taps(run.taps.size());
  for (const Observation& seen : run.seen) {
    if (!is_stamped(seen)) continue;
    Stamps& of = taps[seen.tap];
    const std::int64_t time_us = seen.place.time_us;
    const bool fine = of.grid_us != 0 && of.grid_us <= kFineUs;
    if (of.several != 0 && !fine) of.grid_us = std::gcd(of.grid_us, time_us - of.last_us);
    of.shared = of.shared || time_us == of.last_us;
    of.several += time_us == of.last_us ? 0 : 1;
    of.last_us = time_us;
  }
  for (const Stamps& tap : taps) {
    if (!tap.shared || tap.several < kManyStamps || tap.grid_us <= kFineUs) continue;
    run.grid_us = std::max(run.grid_us, tap.grid_us);
  }
  if (run.grid_us == 0) return;
  run.facts.push_back("stamps are whole steps of " + std::to_string(run.grid_us) +
                      " us apart; what passed between two frames may differ by one");
}

// Takes the stamps of a capture that only tell the second, or its tenth, for none: most frames
// share theirs with the one before, and what lies between two is not known.
void leave_out_coarse_stamps(Run& run) {
  constexpr std::int64_t kCoarseUs = 100'000;
  struct Stamps {
    std::int64_t last_us = kNoStamp;
    std::size_t frames = 0;
    std::size_t same = 0;
    bool whole = true;
    bool coarse() const { return whole && 2 * same > frames; }
  };
  std::vector<Stamps> files(run.files.size());
  for (const Observation& seen : run.seen) {
    if (!is_stamped(seen)) continue;
    Stamps& of = files[seen.place.file];
    of.whole = of.whole && seen.place.time_us % kCoarseUs == 0;
    ++of.frames;
    of.same += seen.place.time_us == of.last_us ? 1 : 0;
    of.last_us = seen.place.time_us;
  }
  for (Observation& seen : run.seen) {
    if (seen.node.empty() && files[seen.place.file].coarse()) seen.place.time_us = kNoStamp;
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!files[i].coarse()) continue;
    run.facts.push_back(run.files[i] +
                        " has stamps of whole seconds or tenths, which are left out");
  }
}

// Makes times count from `begin_us`, else from the first one, and orders what several taps saw.
Run in_one_order(Run run, const AlignOptions& options, std::optional<std::int64_t>& begin_us) {
  const auto by_file = [](const Observation& a, const Observation& b) {
    return a.place.file < b.place.file;
  };
  if (!std::is_sorted(run.seen.begin(), run.seen.end(), by_file)) {  // Files that grew at a time.
    std::stable_sort(run.seen.begin(), run.seen.end(), by_file);
  }
  leave_out_networks(run);
  find_grid(run);
  leave_out_coarse_stamps(run);
  find_directions(run);
  mend_steps(run, options.response_us);
  const bool own_zero = begin_logs(run);
  align(run, options, own_zero);
  stamp_damaged(run);
  std::int64_t first_us = first_stamp(run.seen, [](const Observation&) { return true; });
  if (begin_us) first_us = *begin_us;
  if (first_us != kNone) run.begin_us = *(begin_us = first_us);
  for (Observation& seen : run.seen) {
    // What comes late, and has an earlier stamp than the first one had, is at the begin.
    seen.place.time_us = seen.place.time_us == kNoStamp
                             ? -1
                             : std::max<std::int64_t>(0, seen.place.time_us - first_us);
  }
  place_steps(run);
  for (LoosePlace& place : run.loose) {
    place.early_us -= first_us;
    place.late_us -= first_us;
  }
  move_nodes(run, std::nullopt, [&](std::int64_t time_us) { return time_us - first_us; });
  merge(run);
  return run;
}

}  // namespace

struct RunReader::State {
  AlignOptions align;
  Run run;
  std::vector<ReadSource> growing;       // By file; others are unused.
  std::optional<std::int64_t> begin_us;  // The first stamp, if it is forgotten.
  // One file that is read whole.
  std::unique_ptr<Reader> reader;
  ReadSource source;

  void take(const Packet& packet) {
    const auto& interfaces = reader->interfaces();
    const bool known = packet.interface_id < interfaces.size();
    observe(packet, known ? std::string_view(interfaces[packet.interface_id].name) : "", source,
            run);
  }

  void begin(const std::string& name, Bytes start, const std::string& interface_name) {
    run.files.push_back(name);
    ReaderOptions options{.interface_name = interface_name};
    reader = make_reader(detect(start), options);
    source = ReadSource{static_cast<std::uint32_t>(run.files.size() - 1), {}, 0};
  }
};

RunReader::RunReader(const AlignOptions& options) : state_(std::make_unique<State>()) {
  state_->align = options;
  state_->run.storage = std::make_shared<RunStorage>();
}
RunReader::~RunReader() = default;

std::uint32_t RunReader::open(const std::string& name) {
  const auto file = static_cast<std::uint32_t>(state_->run.files.size());
  state_->run.files.push_back(name);
  state_->growing.resize(file + 1);
  state_->growing[file].file = file;
  return file;
}

void RunReader::take(std::uint32_t file, const Packet& packet, std::string_view interface_name,
                     std::uint64_t number) {
  if (number != 0) state_->growing[file].frames = number - 1;
  observe(packet, interface_name, state_->growing[file], state_->run);
}

Run RunReader::snapshot() const {
  std::optional<std::int64_t> begin_us = state_->begin_us;
  return in_one_order(state_->run, state_->align, begin_us);
}

void RunReader::forget(const Run& known, std::size_t end) {
  Run& run = state_->run;
  if (!state_->begin_us) in_one_order(run, state_->align, state_->begin_us);
  if (!state_->begin_us) return;
  // By tap: the last frame to forget. Taps that count for nothing, as another has the same, are
  // forgotten by their stamps.
  std::vector<std::uint64_t> last(run.taps.size());
  std::vector<bool> counts(run.taps.size());
  struct Known {
    std::uint64_t frame = 0;
    std::int64_t time_us = 0;
  };
  std::vector<Known> newest(run.files.size());
  for (std::size_t i = known.past.senders.size(); i < known.seen.size(); ++i) {
    const Place& place = known.seen[i].place;
    counts[known.seen[i].tap] = true;
    if (i < end) last[known.seen[i].tap] = std::max(last[known.seen[i].tap], place.frame);
    if (newest[place.file].frame < place.frame) newest[place.file] = {place.frame, place.time_us};
  }
  std::vector<std::int64_t> later_us(run.files.size());
  for (const Observation& seen : run.seen) {
    const Known& its = newest[seen.place.file];
    if (its.frame != seen.place.frame || seen.place.time_us == kNoStamp) continue;
    later_us[seen.place.file] = its.time_us + *state_->begin_us - seen.place.time_us;
  }
  const std::int64_t until_us = end < known.seen.size() ? known.seen[end].place.time_us : INT64_MAX;
  auto storage = std::make_shared<RunStorage>();
  std::vector<Observation> kept;
  for (Observation& seen : run.seen) {
    seen.place.time_us += seen.place.time_us == kNoStamp ? 0 : later_us[seen.place.file];
    const bool gone = counts[seen.tap] ? seen.place.frame <= last[seen.tap]
                                       : seen.place.time_us - *state_->begin_us < until_us;
    if (gone) continue;
    seen.frame.payload = storage->keep(seen.frame.payload);
    seen.frame.packet = storage->keep(seen.frame.packet);
    kept.push_back(seen);
  }
  run.seen = std::move(kept);
  run.storage = std::move(storage);
  for (std::size_t file = 0; file < state_->growing.size(); ++file) {
    state_->growing[file].later_us += later_us[file];
  }
}

std::size_t RunReader::held() const { return state_->run.seen.size(); }

std::int64_t RunReader::span_us() const {
  const auto& seen = state_->run.seen;
  if (seen.empty()) return 0;
  const std::int64_t first = seen.front().place.time_us;
  const std::int64_t last = seen.back().place.time_us;
  return first == kNoStamp || last == kNoStamp ? 0 : last - first;
}

bool RunReader::add_bytes(const std::string& name, std::string_view bytes, std::string& error) {
  const Bytes all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  if (looks_like_trace(bytes)) {
    state_->run.files.push_back(name);
    return read_trace(name, bytes, state_->run, error);
  }
  state_->begin(name, all.first(std::min(all.size(), kLookBytes)), name);
  if (!state_->reader) {
    error = name +
            ": not a capture that can be judged: neither pcap, pcapng, serial bytes, "
            "serial forwarder stream, hex nor .rtr";
    return false;
  }
  auto take = [this](const Packet& packet) { state_->take(packet); };
  state_->reader->feed(all, PacketSink(take));
  state_->reader->finish(PacketSink(take));
  return true;
}

bool RunReader::add_file(const std::string& path, std::string& error) {
  std::string bytes;
  if (const int wrong = text::read_file(path, bytes)) {
    error = path + ": " + std::generic_category().message(wrong);
    return false;
  }
  return add_bytes(path, bytes, error);
}

Run RunReader::finish() {
  Run run = std::move(state_->run);
  const AlignOptions options = state_->align;
  state_ = std::make_unique<State>();
  state_->align = options;
  state_->run.storage = std::make_shared<RunStorage>();
  std::optional<std::int64_t> begin_us;
  return in_one_order(std::move(run), options, begin_us);
}

std::optional<Run> read(const std::vector<std::string>& files, std::string& error) {
  RunReader reader;
  for (const std::string& file : files) {
    if (!reader.add_file(file, error)) return std::nullopt;
  }
  return reader.finish();
}

void merge(Run& run) {
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  const auto time_of = [](const Observation& seen) {
    return seen.place.time_us < 0 ? kLast : seen.place.time_us;
  };
  const auto earlier = [&](const Observation& a, const Observation& b) {
    return time_of(a) < time_of(b);
  };
  if (!std::is_sorted(run.seen.begin(), run.seen.end(), earlier)) {
    std::stable_sort(run.seen.begin(), run.seen.end(), earlier);
  }
  run.has_time = std::all_of(run.seen.begin(), run.seen.end(),
                             [](const Observation& seen) { return seen.place.timed(); });
  run.start_us = run.seen.empty() ? 0 : std::max<std::int64_t>(0, run.seen.front().place.time_us);
  const auto last = std::find_if(run.seen.rbegin(), run.seen.rend(),
                                 [](const Observation& seen) { return seen.place.timed(); });
  run.end_us = last == run.seen.rend() ? run.start_us : last->place.time_us;
  run.end_us = std::max(run.end_us, run.watched_until_us);
}

}  // namespace rubric::check
