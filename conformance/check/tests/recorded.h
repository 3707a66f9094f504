// What a simulated network leaves: a capture, and a log; and both with changes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "codec/containers/reader.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"
#include "conformance/trace/print.h"

namespace rubric::check {

// The capture of a network, and the lines of its applications in ticks.
struct Recorded {
  std::string capture;
  std::string log;
};

// Returns the capture, and what the applications and the nodes of the network did.
inline Recorded all_of(const std::string& scenario, std::int64_t length_us = 0) {
  const simulate::Scenario& network = *simulate::find_scenario(scenario);
  simulate::Network made = simulate::make_network(network, {});
  simulate::CaptureRecorder capture(made);
  simulate::TraceRecorder trace(made, network.name);
  simulate::Simulation simulation(std::move(made), {&capture, &trace});
  simulation.run_until(length_us == 0 ? network.length_us : length_us);
  return {capture.finish(), trace::print(trace.file())};
}

/// The first words of a line of a log: "@12", "m3", ">", "rA". By hand, as std::regex takes most of
/// a test's time.
class Words {
 public:
  explicit Words(const std::string& line) {
    std::istringstream in(line);
    for (std::string& word : words_) in >> word;
  }

  const std::string& operator[](std::size_t i) const { return words_[i]; }
  bool timed() const {
    const std::string& time = words_[0];
    return time.size() > 1 && time[0] == '@' &&
           time.find_first_not_of("0123456789", 1) == time.npos;
  }
  /// Whether a frame or an event went over a link, whose name is a word that is not empty.
  bool over_a_link() const {
    return timed() && (words_[2] == "<" || words_[2] == ">") && !words_[3].empty();
  }

 private:
  std::array<std::string, 4> words_;
};

inline Recorded recorded(const std::string& scenario, std::int64_t length_us = 0) {
  const Recorded all = all_of(scenario, length_us);
  Recorded out{all.capture, {}};
  std::istringstream lines(all.log);
  for (std::string line; std::getline(lines, line);) {
    const Words words(line);
    const bool own = words[3].starts_with("app") || words[3].starts_with("power");
    if (!words.over_a_link() || own) out.log += line + "\n";
  }
  return out;
}

// Returns the log with other times, where `of` says so; a line is dropped where that is negative.
inline std::string retimed(const std::string& log,
                           const std::function<int(int tick, const std::string& line)>& of) {
  std::string out;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (Words(line).timed()) {
      const std::size_t begin = line.find('@') + 1;
      std::size_t digits = 0;
      const int tick = of(std::stoi(line.substr(begin), &digits), line);
      if (tick < 0) continue;
      line.replace(begin, digits, std::to_string(tick));
    }
    out += line + "\n";
  }
  return out;
}

// Calls `call` with each packet of the capture and the name of its interface.
inline void each_packet(const std::string& capture,
                        const std::function<void(const Packet&, const std::string&)>& call) {
  const std::unique_ptr<Reader> packets = make_reader(InputFormat::kPcapng, {});
  auto take = [&](const Packet& packet) {
    call(packet, packets->interfaces()[packet.interface_id].name);
  };
  packets->feed(Bytes(reinterpret_cast<const std::uint8_t*>(capture.data()), capture.size()),
                PacketSink(take));
  packets->finish(PacketSink(take));
}

// Reads the capture as several files, and then the logs. `file_of` says of each packet, which it
// may change, in which file it lies, from 0; or -1, and it is left out.
inline Run read_apart(const std::string& capture, int files,
                      const std::function<int(Packet&)>& file_of,
                      const std::vector<std::string>& logs) {
  RunReader reader;
  std::vector<std::uint32_t> opened;
  for (int i = 0; i < files; ++i) opened.push_back(reader.open("capture" + std::to_string(i)));
  each_packet(capture, [&](const Packet& packet, const std::string& interface) {
    Packet one = packet;
    const int file = file_of(one);
    if (file >= 0) reader.take(opened[static_cast<std::size_t>(file)], one, interface);
  });
  std::string error;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    EXPECT_TRUE(reader.add_bytes("log" + std::to_string(i), logs[i], error)) << error;
  }
  return reader.finish();
}

// Reads the capture with its packets in order of the stamps that `stamp_ns` gives them.
inline Run read_sorted(const std::string& capture,
                       const std::function<std::int64_t(const Packet&)>& stamp_ns) {
  struct Kept {
    Packet packet;
    std::string interface;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Kept> kept;
  each_packet(capture, [&](const Packet& packet, const std::string& interface) {
    kept.push_back({packet, interface, {packet.bytes.begin(), packet.bytes.end()}});
    kept.back().packet.time_ns = stamp_ns(packet);
  });
  std::ranges::stable_sort(kept, {}, [](const Kept& one) { return one.packet.time_ns; });
  RunReader reader;
  const std::uint32_t file = reader.open("capture");
  for (Kept& one : kept) {
    one.packet.bytes = Bytes(one.bytes.data(), one.bytes.size());
    reader.take(file, one.packet, one.interface);
  }
  return reader.finish();
}

// Returns the log as if each node had kept one, with those of its lines that `has` wants.
inline std::vector<std::string> log_of_each(
    const std::string& log, const std::function<bool(const std::string& line)>& has) {
  std::vector<std::pair<std::string, std::string>> logs;  // By node.
  std::string head;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    const Words words(line);
    if (words[0] != "%node" && !words.timed()) {
      if (line[0] == '%' && !line.starts_with("%link")) head += line + "\n";
    } else if (line[0] == '%') {
      logs.emplace_back(words[1], line + "\ncase run\n");
    } else if (has(line)) {
      for (auto& [name, text] : logs) text += name == words[1] ? line + "\n" : "";
    }
  }
  std::vector<std::string> out;
  for (const auto& [name, text] : logs) out.push_back(head + text);
  return out;
}

}  // namespace rubric::check
