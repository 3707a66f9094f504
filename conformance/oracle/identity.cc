#include "conformance/oracle/identity.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "conformance/oracle/message.h"
#include "conformance/oracle/streams.h"

namespace rubric::oracle {
namespace {

using machine::Role;

constexpr std::uint64_t kResumeFrames = 3;  // A stream that began elsewhere and goes on is a node.
constexpr std::size_t kRecentFrames = 64;
constexpr std::int64_t kSameFrameUs = 1'000'000;
constexpr std::int64_t kSerialRepeatUs = 1'500'000;  // TinyOS hosts wait 1000 ms.

// A serial line in the first pass.
struct Line {
  std::uint16_t island = 0;   // Now.
  std::uint16_t first = 0;
  std::uint32_t last_down = 0;  // The last packet to the sink that asked for confirmation, + 1.
};

class Identifier {
 public:
  Identifier(const Run& run, const Options& options)
      : run_(run), options_(options), streams_(run, options), lines_(run.taps.size()) {}

  Identity run() {
    out_.marks.resize(run_.seen.size());
    for (const LoggedNode& node : run_.nodes) add_logged(node);
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
    resolve_streams();
    resolve_lines();
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) settle(i);
    name_devices(run_, out_);
    return std::move(out_);
  }

 private:
  std::uint16_t add(Device device) {
    out_.devices.push_back(std::move(device));
    return static_cast<std::uint16_t>(out_.devices.size() - 1);
  }

  void add_logged(const LoggedNode& node) {
    Device device;
    device.am = node.id;
    device.role = node.role;
    device.island = node.island;
    device.judged = node.under_test;
    device.application = node.application;
    device.hearing = node.hearing;
    device.name = node.name;
    add(device);
  }

  std::uint16_t logged(std::string_view name) const {
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      if (run_.nodes[i].name == name) return static_cast<std::uint16_t>(i);
    }
    return kNobody;
  }

  // First look at one observation.
  void look(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    if (!seen.node.empty()) return look_logged(index);
    if (seen.kind == Observation::Kind::kDamaged) out_.damaged_us.push_back(seen.place.time_us);
    if (seen.kind == Observation::Kind::kRadio) {
      out_.hears_radio = true;
      if (seen.frame.type == am::kJoin) remember_request(seen);
      mark.device = streams_.assign(index, mark.repeat);  // A stream so far.
      return;
    }
    if (seen.kind == Observation::Kind::kSerial) {
      mark.repeat = repeats_serial(index);
      look_serial(seen);
    }
  }

  // A host sends a packet again, with the next number, while its confirmation does not come.
  bool repeats_serial(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    if (!seen.to_mote || !seen.ack_request) return false;
    Line& line = lines_[seen.tap];
    const std::uint32_t before = line.last_down;
    line.last_down = index + 1;
    if (before == 0) return false;
    const Observation& last = run_.seen[before - 1];
    return last.frame.type == seen.frame.type && equal(last.frame.payload, seen.frame.payload) &&
           seen.place.time_us - last.place.time_us <= kSerialRepeatUs;
  }

  void look_logged(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    const std::uint16_t node = logged(seen.node);
    if (!seen.received) {
      mark.device = node;
      if (seen.kind == Observation::Kind::kRadio) out_.hears_radio = true;
      if (seen.kind == Observation::Kind::kRadio && node != kNobody) {
        Device& device = out_.devices[node];  // A log has all that its node sent.
        device.radio = true;
        device.first_us = run_.start_us;
        device.last_us = run_.end_us;
        ++device.frames;
      }
      if (seen.kind == Observation::Kind::kSerial) look_serial(seen);
      if (seen.kind == Observation::Kind::kRadio || seen.kind == Observation::Kind::kSerial) {
        recent_[recent_next_++ % kRecentFrames] = index + 1;
      }
      return;
    }
    if (seen.kind == Observation::Kind::kSerial) look_serial(seen);
    mark.receiver = node;
    for (const std::uint32_t before : recent_) {
      if (before == 0) continue;
      const Observation& sent = run_.seen[before - 1];
      if (sent.kind == seen.kind && sent.frame.src == seen.frame.src &&
          sent.frame.type == seen.frame.type && equal(sent.frame.payload, seen.frame.payload) &&
          seen.place.time_us - sent.place.time_us <= kSameFrameUs) {
        mark.repeat = true;
        mark.device = out_.marks[before - 1].device;
        mark.again = !given_.insert({before, node}).second;
        return;
      }
    }
    if (seen.kind == Observation::Kind::kRadio) mark.device = logged_sender(seen.frame);
    if (seen.kind == Observation::Kind::kSerial) mark.device = base_station_of(node);
  }

  // Who of the log's nodes a frame that was given to another comes from, if that is certain.
  std::uint16_t logged_sender(const machine::Frame& frame) const {
    std::uint16_t found = kNobody;
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      const LoggedNode& node = run_.nodes[i];
      if (node.role == Role::kBaseStation || node.id != frame.src) continue;
      if (found != kNobody) return kNobody;
      found = static_cast<std::uint16_t>(i);
    }
    return found;
  }
  std::uint16_t base_station_of(std::uint16_t sink) const {
    if (sink == kNobody) return kNobody;
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) {
      const LoggedNode& node = run_.nodes[i];
      if (node.role == Role::kBaseStation && node.island == run_.nodes[sink].island) {
        return static_cast<std::uint16_t>(i);
      }
    }
    return kNobody;
  }

  // A line's island: from SET_ISLAND_ID, serial_joined or the source of what passes, never from
  // where it goes.
  void look_serial(const Observation& seen) {
    Line& line = lines_[seen.tap];
    if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
      const auto island = static_cast<std::uint16_t>(id);
      streams_.rename_island(line.island, island);
      if (line.first == 0) line.first = island;
      line.island = island;
      return;
    }
    Net net;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
    if (line.island != 0) {
      if (seen.to_mote) streams_.heard_on_serial(net, line.island);
      return;
    }
    SerialJoined joined;
    std::uint16_t island = 0;
    if (!seen.to_mote && parse_serial_joined(net, joined)) {
      island = joined.address.pid;
    } else if (seen.to_mote ? net.src.devid == machine::kNullDevid
                            : net.src.devid == streams_.sink_am() ||
                                  net.dest == machine::Address{net.src.pid, machine::kNullDevid}) {
      island = net.src.pid;
    }
    line.island = line.first = island;
    if (seen.to_mote) streams_.heard_on_serial(net, island);
  }

  void remember_request(const Observation& seen) {
    Request request;
    if (!parse_request(seen.frame.payload, request)) return;
    requests_[request_next_++ % requests_.size()] = {seen.frame.src, request.seq_num};
  }

  // A sink of which only one reply was heard, which answers nothing, could be anybody.
  bool answers_nothing(const Stream& stream) const {
    if (!stream.sink || stream.frames != 1) return false;
    const machine::Frame& frame = run_.seen[stream.first].frame;
    Reply reply;
    if (frame.type != am::kJoinReply || !parse_reply(frame.payload, reply)) return false;
    return std::find(requests_.begin(), requests_.end(),
                     std::pair{frame.dest, reply.seq_num}) == requests_.end();
  }

  bool is_tester(std::uint16_t am) const {
    return std::find(options_.testers.begin(), options_.testers.end(), am) !=
           options_.testers.end();
  }

  void resolve_streams() {
    const auto& streams = streams_.all();
    device_of_stream_.assign(streams.size(), kNobody);
    starts_life_.assign(streams.size(), false);
    for (std::size_t i = 0; i < streams.size(); ++i) {
      const Stream& stream = streams[i];
      const std::uint16_t before = earlier_device(stream);
      if (before != kNobody && follows(stream, before)) {
        Device& device = out_.devices[before];
        starts_life_[i] = device.radio && (stream.joins || stream.sink);
        if (device.radio) device.holes.emplace_back(device.last_us, stream.first_us);
        device.holes.insert(device.holes.end(), stream.holes.begin(), stream.holes.end());
        if (!device.radio) device.first_us = stream.first_us;
        device.last_us = stream.last_us;
        device.frames += stream.frames;
        device.radio = true;
        device_of_stream_[i] = before;
        continue;
      }
      Device device;
      device.am = stream.am;
      device.role = stream.sink ? Role::kSink : Role::kMote;
      device.island = stream.sink ? stream.first_island : std::uint16_t{0};
      device.judged = !is_tester(stream.am);
      // A second mote with the same id, in another island, shows by going on beside the first.
      const bool another = !stream.sink && stream.frames >= kResumeFrames;
      device.known = device.judged && (before == kNobody || another) && !answers_nothing(stream);
      device.radio = true;
      device.frames = stream.frames;
      device.first_us = stream.first_us;
      device.last_us = stream.last_us;
      device.holes = stream.holes;
      apply_known(device);
      device_of_stream_[i] = add(device);
    }
  }

  void apply_known(Device& device) {
    for (const KnownNode& node : options_.nodes) {
      if (node.id != device.am) continue;
      device.role = node.role;
      if (node.role != Role::kSink || node.island == 0) continue;
      if (device.island == 0) device.island = node.island;
    }
  }

  // The device that a stream would belong to, were its DSNs to follow: one that has ended before
  // the stream begins, if there is any.
  std::uint16_t earlier_device(const Stream& stream) const {
    std::uint16_t found = kNobody;
    for (std::size_t i = 0; i < out_.devices.size(); ++i) {
      const Device& device = out_.devices[i];
      if (!device.known || device.am != stream.am || device.role == Role::kBaseStation) continue;
      if ((device.role == Role::kSink) != stream.sink) continue;
      const bool same_island = device.island == stream.first_island || device.island == 0 ||
                               stream.first_island == 0 ||
                               last_island(device) == stream.first_island;
      if (stream.sink && !same_island) continue;
      if (follows(stream, static_cast<std::uint16_t>(i))) return static_cast<std::uint16_t>(i);
      found = static_cast<std::uint16_t>(i);
    }
    return found;
  }

  // Of a sink's streams so far the last; SET_ISLAND_ID may have changed it.
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
    if (!device.radio) return true;  // Only its log was known.
    if (device.last_us > stream.first_us) return false;  // The old stream goes on: a stranger.
    return stream.joins || stream.frames >= kResumeFrames;
  }

  void resolve_lines() {
    out_.sink_of_tap.assign(run_.taps.size(), kNobody);
    for (std::uint32_t tap = 0; tap < lines_.size(); ++tap) {
      if (run_.taps[tap].link != machine::Link::kSerial) continue;
      const Line& line = lines_[tap];
      if (line.island == 0) continue;
      std::uint16_t sink = kNobody;
      for (std::size_t i = 0; i < out_.devices.size(); ++i) {
        const Device& device = out_.devices[i];
        if (!device.known || device.role != Role::kSink) continue;
        if (device.island == line.island || device.island == line.first) {
          sink = static_cast<std::uint16_t>(i);
          break;
        }
      }
      if (sink == kNobody) {
        Device device;
        device.am = streams_.sink_am();
        device.role = Role::kSink;
        device.island = line.first;
        sink = add(device);
      }
      out_.devices[sink].taps.push_back(tap);
      out_.sink_of_tap[tap] = sink;
      if (out_.devices[sink].partner == kNobody) add_base_station(sink, line.first);
    }
  }

  void add_base_station(std::uint16_t sink, std::uint16_t island) {
    for (std::size_t i = 0; i < out_.devices.size(); ++i) {
      Device& device = out_.devices[i];
      if (device.role != Role::kBaseStation || device.partner != kNobody) continue;
      if (device.island != island && device.island != 0) continue;
      device.partner = sink;
      out_.devices[sink].partner = static_cast<std::uint16_t>(i);
      return;
    }
    Device base;
    base.role = Role::kBaseStation;
    base.island = island;
    base.partner = sink;
    base.judged = !is_tester(0);  // A host's AM source is 0.
    const std::uint16_t made = add(base);
    out_.devices[sink].partner = made;
  }

  void settle(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    Mark& mark = out_.marks[index];
    if (!seen.node.empty()) {
      const bool given = seen.kind == Observation::Kind::kSerial && mark.receiver != kNobody;
      if (given && mark.device == kNobody) mark.device = out_.devices[mark.receiver].partner;
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
  Streams streams_;
  std::vector<Line> lines_;
  Identity out_;
  std::vector<std::uint16_t> device_of_stream_;
  std::vector<bool> starts_life_;
  std::array<std::uint32_t, kRecentFrames> recent_{};  // Observation + 1.
  std::size_t recent_next_ = 0;
  std::set<std::pair<std::uint32_t, std::uint16_t>> given_;  // Frames of recent_, to whom.
  std::array<std::pair<std::uint16_t, std::uint16_t>, 256> requests_{};
  std::size_t request_next_ = 0;
};

}  // namespace

Identity identify(const Run& run, const Options& options) { return Identifier(run, options).run(); }

}  // namespace rubric::oracle
