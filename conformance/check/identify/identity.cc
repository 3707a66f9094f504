#include "conformance/check/identify/identity.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "conformance/check/identify/serial_lines.h"
#include "conformance/check/identify/streams.h"
#include "conformance/check/message.h"

namespace rubric::check {
namespace {

using machine::Role;

constexpr std::uint64_t kResumeFrames = 3;  // A stream that began elsewhere and goes on is a node.
constexpr std::size_t kRecentFrames = 64;
constexpr std::int64_t kSameFrameUs = 1'000'000;

class Identifier {
 public:
  Identifier(const Run& run, const Options& options)
      : run_(run),
        options_(options),
        given_(options),
        streams_(run, options),
        lines_(run, options, given_, streams_) {}

  Identity run() {
    out_.marks.resize(run_.seen.size());
    out_.facts = run_.facts;
    out_.gone_us = run_.past.until_us;
    captured_ = !run_.marked || std::any_of(run_.seen.begin(), run_.seen.end(),
                                            [](const auto& seen) { return seen.node.empty(); });
    for (const LoggedNode& node : run_.nodes) add_logged(node);
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
    out_.sees_air = sniffed_ || (out_.sees_air && !applications_alone());
    out_.hears_radio = out_.sees_air || run_.tells_all();
    resolve_streams();
    resolve_lines();
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) settle(i);
    name_devices(run_, out_);
    say_what_is_left_out();
    compare_with_given();
    return std::move(out_);
  }

 private:
  // Returns whether the logs have the application of a node and nothing of its radio: what they
  // have of other nodes' radios is then not all that was on the air.
  bool applications_alone() const {
    return std::ranges::any_of(out_.devices, [](const Device& device) {
      return device.application && !device.whole && !device.hearing && !device.radio &&
             device.role != Role::kBaseStation;
    });
  }

  std::uint16_t add(Device device) {
    const auto number = static_cast<std::uint16_t>(out_.devices.size());
    devices_of_[device.am].push_back(number);
    out_.devices.push_back(std::move(device));
    return number;
  }

  void add_logged(const LoggedNode& node) {
    Device device{.am = node.id, .role = node.role, .island = node.island};
    // Of one that only a header names as under test the log shows nothing; a capture may.
    device.judged = node.under_test && (node.logged || captured_);
    device.application = node.application;
    device.hearing = node.hearing;
    device.whole = node.whole;
    device.name = node.name;
    add(device);
  }

  std::uint16_t logged(std::string_view name) const {
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      if (run_.nodes[i].name == name) return static_cast<std::uint16_t>(i);
    }
    return kNobody;
  }

  // Takes a first look at one observation.
  void look(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    if (!seen.node.empty()) return look_logged(index);
    if (seen.kind == Observation::Kind::kDamaged) out_.damaged_us.push_back(seen.place.time_us);
    if (seen.kind == Observation::Kind::kRadio) {
      sniffed_ = true;
      if (seen.frame.type == am::kJoin) remember_request(seen);
      roles_.look(seen.frame, index);
      mark.device = streams_.assign(index, out_.marks);  // A stream so far.
      return;
    }
    if (seen.kind == Observation::Kind::kSerial) {
      mark.repeat = lines_.repeats(index);
      lines_.look(index);
    }
  }

  void look_logged(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    const std::uint16_t node = logged(seen.node);
    const bool serial = seen.kind == Observation::Kind::kSerial && node != kNobody;
    if (serial && run_.nodes[node].role == Role::kSink) logged_sink_[seen.tap] = node;
    if (serial && run_.nodes[node].role == Role::kBaseStation) logged_host_[seen.tap] = node;
    if (seen.kind == Observation::Kind::kReboot) reboots_.insert(node);
    if (!seen.received) {
      mark.device = node;
      if (seen.kind == Observation::Kind::kRadio) out_.sees_air = true;
      if (seen.kind == Observation::Kind::kRadio && node != kNobody) {
        Device& device = out_.devices[node];  // A log has all that its node sent.
        device.radio = true;
        device.first_us = run_.start_us;
        device.last_us = run_.end_us;
        ++device.frames;
      }
      if (seen.kind == Observation::Kind::kSerial) lines_.look(index);
      if (seen.kind == Observation::Kind::kRadio || seen.kind == Observation::Kind::kSerial) {
        recent_[recent_next_++ % kRecentFrames] = index + 1;
      }
      return;
    }
    if (seen.kind == Observation::Kind::kSerial) lines_.look(index);
    mark.receiver = node;
    for (const std::uint32_t before : recent_) {
      if (before == 0) continue;
      const Observation& sent = run_.seen[before - 1];
      if (sent.kind == seen.kind && same_content(sent.frame, seen.frame) &&
          seen.place.time_us - sent.place.time_us <= kSameFrameUs) {
        mark.repeat = true;
        mark.device = out_.marks[before - 1].device;
        mark.again = !handed_.insert({before, node}).second;
        return;
      }
    }
    if (seen.kind == Observation::Kind::kRadio) mark.device = logged_sender(seen.frame, node);
    if (seen.kind == Observation::Kind::kSerial) mark.device = base_station_of(node);
    const bool other =
        mark.device != kNobody && mark.device < run_.nodes.size() && run_.nodes[mark.device].whole;
    if (other) mark.device = kNobody;  // Its log would have it.
  }

  // Returns the log's node that sent a frame given to `receiver`, if that is certain. A log has all
  // frames of its marked nodes, so it is none of these.
  std::uint16_t logged_sender(const machine::Frame& frame, std::uint16_t receiver) const {
    std::uint16_t found = kNobody;
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      const LoggedNode& node = run_.nodes[i];
      if (node.role == Role::kBaseStation || node.id != frame.src || i == receiver) continue;
      if (run_.marked && node.under_test && node.logged) continue;
      if (found != kNobody) return kNobody;
      found = static_cast<std::uint16_t>(i);
    }
    return found;
  }
  // Returns the host of a sink, by the log; nobody for a base station, whose sink settle() finds.
  std::uint16_t base_station_of(std::uint16_t sink) const {
    if (sink == kNobody || run_.nodes[sink].role == Role::kBaseStation) return kNobody;
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      const LoggedNode& node = run_.nodes[i];
      if (node.role == Role::kBaseStation && node.island == run_.nodes[sink].island) {
        return static_cast<std::uint16_t>(i);
      }
    }
    return kNobody;
  }

  void remember_request(const Observation& seen) {
    Request request;
    if (!parse_request(seen.frame.payload, request)) return;
    requests_[request_next_++ % requests_.size()] = {seen.frame.src, request.seq_num};
  }

  // A sink that is known by one reply alone, to a request that nobody sent, could be anybody.
  bool answers_nothing(const Stream& stream) const {
    if (!stream.sink || stream.frames != 1) return false;
    const machine::Frame& frame = run_.seen[stream.first].frame;
    Reply reply;
    if (frame.type != am::kJoinReply || !parse_reply(frame.payload, reply)) return false;
    return std::find(requests_.begin(), requests_.end(), std::pair{frame.dest, reply.seq_num}) ==
           requests_.end();
  }

  bool is_tester(std::uint16_t am) const {
    return std::find(options_.testers.begin(), options_.testers.end(), am) !=
           options_.testers.end();
  }

  // Returns the stream whose one missing frame `which` is, in the name of another island: where no
  // frame escapes, its DSN tells whose it is. It may be the first frame after a reboot.
  std::optional<std::size_t> misnamed(std::size_t which) const {
    const auto& streams = streams_.all();
    const Stream& stream = streams[which];
    if (!options_.sniffer_complete || !stream.sink || stream.frames != 1) return {};
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < streams.size(); ++i) {
      const bool lacks = i < which ? streams[i].lacks(stream) : begins_anew(which, i);
      if (lacks && found) return {};
      if (lacks) found = i;
    }
    return found;
  }

  // Returns whether a later stream is of a sink that was heard before the frame of `which`, and has
  // the DSNs after it.
  bool begins_anew(std::size_t which, std::size_t later) const {
    const auto& streams = streams_.all();
    const Stream& one = streams[which];
    const Stream& next = streams[later];
    const auto dsn = static_cast<std::uint8_t>(one.dsn + 1);
    if (!next.sink || next.am != one.am || next.frames < kResumeFrames) return false;
    if (run_.seen[next.first].dsn != dsn || next.first_island == one.first_island) return false;
    return std::any_of(streams.begin(), streams.begin() + static_cast<std::ptrdiff_t>(which),
                       [&](const Stream& before) {
                         return before.sink && before.am == next.am &&
                                before.first_island == next.first_island;
                       });
  }

  // Returns whether a node that no log names may be blamed. Whole logs have all of their own nodes,
  // not all that others hear.
  bool may_be_judged(std::uint16_t am) const {
    return !run_.marked && !run_.tells_all() && !is_tester(am);
  }

  void resolve_streams() {
    const auto& streams = streams_.all();
    device_of_stream_.assign(streams.size(), kNobody);
    starts_life_.assign(streams.size(), false);
    for (std::size_t i = 0; i < streams.size(); ++i) {
      const Stream& stream = streams[i];
      if (const std::optional<std::size_t> owner = misnamed(i)) {
        misnamed_.emplace_back(i, *owner);
        continue;
      }
      const std::uint16_t moved = device_before_move(stream);
      const std::uint16_t before = moved != kNobody ? moved : earlier_device(stream);
      // A second mote with the same id, in another island, sends while the first does.
      const bool another = role_of(stream) == Role::kMote && stream.frames >= kResumeFrames;
      const bool named = given_.names(stream.am, stream.plain_island);
      const bool goes_on = moved != kNobody || (before != kNobody && follows(stream, before));
      if (goes_on || (before != kNobody && named && !another)) {
        // Where no frame escapes, only a reboot makes the DSNs begin elsewhere; but the DSNs of one
        // who was silent for long may have gone with the past.
        const bool complete = options_.sniffer_complete && run_.past.until_us < 0;
        const bool anew = stream.joins || stream.sink || complete;
        starts_life_[i] = goes_on && out_.devices[before].radio && anew &&
                          !reboots_.contains(before) &&
                          !(moved != kNobody && counts_on(stream, before));
        take_stream(out_.devices[before], stream);
        device_of_stream_[i] = before;
        continue;
      }
      Device device{.am = stream.am,
                    .role = role_of(stream),
                    .island = stream.sink ? stream.first_island : kNoIsland,
                    .known = !is_tester(stream.am) && (named || ((before == kNobody || another) &&
                                                                 !answers_nothing(stream))),
                    .judged = may_be_judged(stream.am)};
      take_stream(device, stream);
      device_of_stream_[i] = add(device);
    }
    for (const auto& [stream, owner] : misnamed_) {
      device_of_stream_[stream] = device_of_stream_[owner];
      ++out_.devices[device_of_stream_[owner]].frames;
      if (owner < stream) continue;
      starts_life_[stream] = starts_life_[owner];
      starts_life_[owner] = false;
    }
  }

  static void take_stream(Device& device, const Stream& stream) {
    if (device.radio) {
      device.holes.emplace_back(std::min(device.last_us, stream.first_us),
                                std::max(device.last_us, stream.first_us));
    } else {
      device.first_us = stream.first_us;
    }
    for (const Stream::Hole& hole : stream.holes) {
      device.holes.emplace_back(hole.from_us, hole.to_us);
    }
    device.last_us = std::max(device.last_us, stream.last_us);
    device.frames += stream.frames;
    device.radio = true;
  }

  Role role_of(const Stream& stream) const {
    return roles_.role_of(stream.am, stream.sink ? Role::kSink : Role::kMote);
  }

  // A log's header is believed, too.
  void compare_logged_with_given(std::vector<Shown>& shown) {
    if (given_.empty()) return;
    for (std::uint16_t node = 0; node < run_.nodes.size(); ++node) {
      const LoggedNode& logged = run_.nodes[node];
      const auto mark = std::find_if(out_.marks.begin(), out_.marks.end(),
                                     [&](const Mark& m) { return m.device == node; });
      if (logged.role == Role::kBaseStation || mark == out_.marks.end()) continue;
      const auto index = static_cast<std::uint32_t>(mark - out_.marks.begin());
      const Role said = given_.role(logged.id).value_or(logged.role);
      if (said != logged.role) {
        out_.contradictions.push_back(role_contradiction(logged.id, said, logged.role, index));
      } else if (logged.role == Role::kSink && logged.island != kNoIsland) {
        shown.push_back({logged.id, logged.island, index});
      }
    }
  }

  void say_what_is_left_out() {
    if (streams_.left_out() == 0) return;
    out_.facts.push_back("senders beyond the first " + std::to_string(streams_.all().size()) +
                         ": " + std::to_string(streams_.left_out()) +
                         " frames on the air, for which nobody is blamed");
  }

  // Compares the user's statements with what was found.
  void compare_with_given() {
    for (const KnownNode& node : given_.nodes()) {
      const bool seen = std::any_of(out_.devices.begin(), out_.devices.end(), [&](const auto& d) {
        return d.am == node.id && d.known && d.role != Role::kBaseStation;
      });
      if (!seen && node.role != Role::kBaseStation) {
        out_.facts.push_back("AM address " + std::to_string(node.id) + ", given: no frame of it");
      }
    }
    roles_.contradict(out_.contradictions);
    std::vector<Shown> shown = lines_.shown();
    compare_logged_with_given(shown);
    for (std::size_t i = 0; i < streams_.all().size(); ++i) {
      const Stream& stream = streams_.all()[i];
      const std::uint16_t device = device_of_stream_[i];
      if (stream.plain == 0 || !out_.devices[device].known) continue;
      if (out_.devices[device].role != Role::kSink) continue;
      shown.push_back({stream.am, stream.plain_island, stream.plain - 1});
    }
    std::sort(shown.begin(), shown.end(),
              [](const Shown& a, const Shown& b) { return a.index < b.index; });
    for (Contradiction& one : island_contradictions(run_, given_, shown)) {
      out_.contradictions.push_back(std::move(one));
    }
  }

  // Returns the device that the stream would belong to if its DSNs followed: one that ended before
  // the stream begins, if there is any.
  std::uint16_t earlier_device(const Stream& stream) const {
    std::uint16_t found = kNobody;
    const auto of_this = devices_of_.find(stream.am);
    if (of_this == devices_of_.end()) return found;
    for (const std::uint16_t i : of_this->second) {
      const Device& device = out_.devices[i];
      if (!device.known || device.role == Role::kBaseStation) continue;
      if (device.role != role_of(stream)) continue;
      const bool same_island = device.island == stream.first_island || device.island == kNoIsland ||
                               stream.first_island == kNoIsland ||
                               last_island(device) == stream.first_island;
      if (stream.sink && !same_island) continue;
      if (follows(stream, i)) return i;
      found = i;
    }
    return found;
  }

  // Returns the sink, silent since then, whose own line says that it is of this stream's island: it
  // has an island that nobody saw before, as after it lost its power.
  std::uint16_t device_before_move(const Stream& stream) const {
    const auto of_this = devices_of_.find(stream.am);
    if (of_this == devices_of_.end() || !stream.sink) return kNobody;
    for (const std::uint16_t i : of_this->second) {
      const Device& device = out_.devices[i];
      if (!device.known || !device.radio || device.role != Role::kSink) continue;
      const bool silent = device.last_us <= stream.first_us;
      const bool moved =
          lines_.alone_reports(device.island, stream.first_island, !options_.start_cold);
      if (silent && moved && device.island != stream.first_island) return i;
    }
    return kNobody;
  }

  // Returns whether the stream's DSNs follow the device's last one, as if it had not rebooted.
  bool counts_on(const Stream& stream, std::uint16_t before) const {
    for (std::size_t i = streams_.all().size(); i-- > 0;) {
      if (device_of_stream_[i] != before) continue;
      const std::uint8_t first = run_.seen[stream.first].dsn;
      const auto ahead = static_cast<std::uint8_t>(first - streams_.all()[i].dsn);
      return ahead >= 1 && ahead <= kGapMax;
    }
    return false;
  }

  // Returns the sink's island in its last stream so far; SET_ISLAND_ID may have changed it.
  std::uint16_t last_island(const Device& device) const {
    std::uint16_t island = device.island;
    for (std::size_t i = 0; i < streams_.all().size(); ++i) {
      const std::uint16_t owner = device_of_stream_[i];
      if (owner != kNobody && &out_.devices[owner] == &device) island = streams_.all()[i].island;
    }
    return island;
  }

  bool follows(const Stream& stream, std::uint16_t before) const {
    const Device& device = out_.devices[before];
    if (!device.radio) return true;                      // Only its log was known.
    if (device.last_us > stream.first_us) return false;  // The old stream goes on: a stranger.
    return stream.joins || stream.frames >= kResumeFrames;
  }

  void resolve_lines() {
    out_.sink_of_tap.assign(run_.taps.size(), kNobody);
    for (std::uint32_t tap = 0; tap < run_.taps.size(); ++tap) {
      if (run_.taps[tap].link != machine::Link::kSerial) continue;
      SerialLine line = lines_.at(tap);
      const auto host = logged_host_.find(tap);
      if (host != logged_host_.end() && run_.nodes[host->second].island != kNoIsland) {
        line.first = run_.nodes[host->second].island;  // Whatever it sets later.
        if (line.island == kNoIsland) line.island = line.first;
      }
      const auto owner = logged_sink_.find(tap);
      if (line.island == kNoIsland && owner == logged_sink_.end()) continue;
      std::uint16_t sink = owner == logged_sink_.end() ? sink_of(line) : owner->second;
      if (sink == kNobody) {
        Device device;
        const std::uint16_t am = streams_.sink_am();
        const bool is_sink = roles_.role_of(am, Role::kSink) == Role::kSink;
        device.am = is_sink ? am : machine::Profile{}.sink_id;
        device.role = Role::kSink;
        device.island = line.first;
        device.judged = may_be_judged(device.am);
        sink = add(device);
      }
      const bool logs = owner != logged_sink_.end();
      // Perhaps it was heard by radio only after its base station had set its island.
      Device& its_sink = out_.devices[sink];
      if (!logs && line.first != kNoIsland && its_sink.island == line.island)
        its_sink.island = line.first;
      const bool heard = its_sink.radio && its_sink.first_us < line.set_us;
      const bool told = logs || host != logged_host_.end();  // A log's header says its island.
      its_sink.set_later = line.set_later && !told && !heard;
      const std::uint16_t said = logs ? out_.devices[sink].island : kNoIsland;
      out_.devices[sink].taps.push_back(tap);
      out_.sink_of_tap[tap] = sink;
      const std::uint16_t its = said != kNoIsland ? said : line.first;
      if (out_.devices[sink].partner == kNobody) add_base_station(sink, its);
    }
  }

  // Returns the sink of the line: one of its first island, else of its last, else the only one in
  // sight, whatever island was given for it.
  std::uint16_t sink_of(const SerialLine& line) const {
    std::uint16_t only = kNobody;
    std::uint16_t later = kNobody;
    std::size_t sinks = 0;
    for (std::size_t i = 0; i < out_.devices.size(); ++i) {
      const Device& device = out_.devices[i];
      if (!device.known || device.role != Role::kSink) continue;
      only = static_cast<std::uint16_t>(i);
      if (device.island == line.first) return only;
      if (later == kNobody && device.island == line.island) later = only;
      ++sinks;
    }
    if (later != kNobody) return later;
    return line.given && sinks == 1 ? only : kNobody;
  }

  void add_base_station(std::uint16_t sink, std::uint16_t island) {
    for (std::size_t i = 0; i < out_.devices.size(); ++i) {
      Device& device = out_.devices[i];
      if (device.role != Role::kBaseStation || device.partner != kNobody) continue;
      if (device.island != island && device.island != kNoIsland) continue;
      device.partner = sink;
      out_.devices[sink].partner = static_cast<std::uint16_t>(i);
      return;
    }
    Device base{.role = Role::kBaseStation, .island = island, .partner = sink};
    base.judged = may_be_judged(0);  // A host's AM source is 0.
    const std::uint16_t made = add(base);
    out_.devices[sink].partner = made;
  }

  void settle(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    if (!seen.node.empty()) {
      const bool given = seen.kind == Observation::Kind::kSerial && mark.receiver != kNobody;
      if (!given || mark.device != kNobody) return;
      mark.device = out_.devices[mark.receiver].partner;
      // A log has all that its nodes under test sent: it is one of these, with other bytes after
      // it.
      mark.repeat = mark.device < run_.nodes.size() && run_.nodes[mark.device].under_test &&
                    run_.nodes[mark.device].logged &&
                    run_.nodes[mark.device].shown(seen.place.time_us);
      return;
    }
    if (seen.kind == Observation::Kind::kSerial || seen.kind == Observation::Kind::kLinkAck) {
      if (seen.tap >= out_.sink_of_tap.size()) return;
      const std::uint16_t sink = out_.sink_of_tap[seen.tap];
      if (sink == kNobody) return;
      mark.device = seen.to_mote ? out_.devices[sink].partner : sink;
      return;
    }
    if (seen.kind != Observation::Kind::kRadio || mark.device == kNobody) return;
    const std::uint16_t stream = mark.device;
    mark.device = device_of_stream_[stream];
    mark.new_life = starts_life_[stream] && streams_.all()[stream].first == index;
  }

  const Run& run_;
  const Options& options_;
  bool captured_ = false;  // Something but a log that marks its nodes.
  bool sniffed_ = false;   // A capture has frames of the air.
  const Given given_;
  GivenRoles roles_{given_};
  Streams streams_;
  SerialLines lines_;
  Identity out_;
  std::unordered_map<std::uint16_t, std::vector<std::uint16_t>> devices_of_;  // By AM address.
  std::map<std::uint32_t, std::uint16_t> logged_sink_;  // User of a tap, by a log.
  std::map<std::uint32_t, std::uint16_t> logged_host_;  // The base station at its other end.
  std::set<std::uint16_t> reboots_;  // Nodes whose log tells that they started anew.
  std::vector<std::uint16_t> device_of_stream_;
  std::vector<bool> starts_life_;
  std::vector<std::pair<std::size_t, std::size_t>> misnamed_;  // Streams of one frame, and whose.
  std::array<std::uint32_t, kRecentFrames> recent_{};          // Observation + 1.
  std::size_t recent_next_ = 0;
  std::set<std::pair<std::uint32_t, std::uint16_t>> handed_;  // Frames of recent_, to whom.
  std::array<std::pair<std::uint16_t, std::uint16_t>, 256> requests_{};
  std::size_t request_next_ = 0;
};

}  // namespace

Identity identify(const Run& run, const Options& options) { return Identifier(run, options).run(); }

}  // namespace rubric::check
