#include "conformance/adapters/firmware/host/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>

#include "conformance/node/sizes.h"

namespace rubric::firmware {
namespace {

class Unsupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The parameters that `reset` may set.
constexpr std::string_view kSettings = " id island channels seed profile members gone_after ";
constexpr std::uint32_t kFirstSeqNum = 1000;
constexpr std::uint32_t kSeqNumsPerSeed = 257;

class Session {
 public:
  Session(std::vector<Station>& stations, std::string name, std::string time)
      : stations_(stations), name_(std::move(name)), time_(std::move(time)) {}

  // Returns the answer to one command, with all its lines.
  std::string answer(const std::vector<std::string_view>& words) {
    const std::string_view command = words[0];
    if (command == "hello") return hello();
    if (command == "reset") return reset(words);
    if (bridge_ == nullptr) throw Unsupported("before reset");
    if (words.size() < 2) throw Unsupported("a command without time");
    const Tick now = number_of(words[1], 0xFFFFFFFF);
    if (command == "until") {
      const Tick reached = std::max(bridge_->run(now), last_);
      return done(reached, reached + 1);
    }
    last_ = std::max(last_, now);
    bridge_->advance(now);
    if (!happen(command, words)) throw Unsupported(fmt::format("there is no {}", command));
    return done(now, now);  // Its reaction may come at this tick yet.
  }

 private:
  std::string hello() const {
    std::string roles;
    for (const char* role : {"mote", "sink"}) {
      const bool sink = std::string_view(role) == "sink";
      const bool has = std::any_of(stations_.begin(), stations_.end(), [&](const Station& one) {
        return one.firmware.is_sink == sink;
      });
      if (has) roles += (roles.empty() ? "" : ",") + std::string(role);
    }
    return fmt::format("hello rct/1 {} 1.0 roles={} time={}\n", name_, roles, time_);
  }

  std::string reset(const std::vector<std::string_view>& words) {
    bridge_ = nullptr;
    if (words.size() < 2) throw Unsupported("reset without a role");
    std::map<std::string_view, std::string_view> settings;
    for (std::size_t i = 2; i < words.size(); ++i) {
      const std::size_t at = std::min(words[i].find('='), words[i].size() - 1);
      settings[words[i].substr(0, at)] = words[i].substr(at + 1);
    }
    const auto number = [&](std::string_view name, std::uint32_t otherwise, std::uint32_t max) {
      return settings.contains(name) ? number_of(settings[name], max) : otherwise;
    };
    for (const auto& [name, value] : settings) {
      if (kSettings.find(fmt::format(" {} ", name)) == std::string_view::npos) {
        throw Unsupported(fmt::format("no parameter {}", name));
      }
    }
    const std::uint32_t channels = number("channels", 4, 0xFF);
    Bridge& bridge = station(words[1], channels);
    const std::uint32_t seed = number("seed", 0, 0xFFFFFFFF);
    NodeSetup setup;
    setup.id = static_cast<std::uint16_t>(number("id", 0, 0xFFFF));
    setup.island = static_cast<std::uint16_t>(number("island", 0, 0xFFFF));
    setup.channels = static_cast<std::uint8_t>(channels);
    setup.last_seq_num = static_cast<std::uint16_t>(kFirstSeqNum + kSeqNumsPerSeed * seed - 1);
    setup.members = static_cast<std::uint8_t>(
        number("members", node::SinkSizes::kMembers, node::SinkSizes::kMembers));
    setup.gone_after = number("gone_after", 0, 0xFFFFFFFF);
    bridge.greet();
    bridge.start(setup);
    bridge_ = &bridge;
    last_ = 0;
    return "ready\n";
  }

  // Returns the firmware of that role with the fewest channels that are enough.
  Bridge& station(std::string_view role, std::uint32_t channels) {
    Station* best = nullptr;
    for (Station& one : stations_) {
      if (one.firmware.is_sink != (role == "sink") || one.firmware.channels < channels) continue;
      if (best == nullptr || one.firmware.channels < best->firmware.channels) best = &one;
    }
    if (best == nullptr || (role != "sink" && role != "mote")) {
      throw Unsupported(fmt::format("no firmware of a {} with {} channels", role, channels));
    }
    return *best->bridge;
  }

  bool happen(std::string_view command, const std::vector<std::string_view>& words) {
    const auto word = [&](std::size_t i) {
      return i < words.size() ? words[i] : throw BadWord("too few words");
    };
    if (command == "rx") {
      const ByteVector packet = bytes_of_hex(word(3));
      const Bytes bytes(packet.data(), packet.size());
      if (word(2) == "radio") bridge_->hear_radio(bytes);
      if (word(2) == "serial") bridge_->hear_serial(bytes);
      return true;  // PEIS is not for a mote or a sink.
    }
    if (command == "call") {
      std::string text(word(2));
      for (std::size_t i = 3; i < words.size(); ++i) text += " " + std::string(words[i]);
      const ByteVector record = call_record(text);
      bridge_->call(Bytes(record.data(), record.size()));
      return true;
    }
    if (command == "linkack") return bridge_->link_ack(word(2) == "1"), true;
    if (command == "line") {
      constexpr std::string_view kLines[] = {"radio", "serial", "app"};
      for (std::uint8_t i = 0; i < 3; ++i) {
        if (word(2) == kLines[i]) bridge_->busy(i, word(3) == "busy");
      }
      return true;
    }
    if (command != "power") return false;
    if (word(2) == "off") {
      bridge_->power_off();
    } else {
      bridge_->reboot();
    }
    return true;
  }

  // Ends an answer. Times of the board's lines may have passed since; rct/1 wants them in order.
  std::string done(Tick time, Tick next_min) {
    last_ = std::max(last_, time);
    std::string text;
    for (const std::string& line : bridge_->take_lines()) text += line + "\n";
    const auto next = bridge_->next();
    text += next ? fmt::format("next {}\n", std::max(*next, next_min)) : "next -\n";
    return text + fmt::format("done {}\n", time);
  }

  std::vector<Station>& stations_;
  std::string name_;
  std::string time_;
  Bridge* bridge_ = nullptr;
  Tick last_ = 0;
};

}  // namespace

int serve(std::vector<Station>& stations, const std::string& name, const std::string& time) {
  Session session(stations, name, time);
  std::string line;
  while (std::getline(std::cin, line)) {
    const auto words = split(line);
    if (words.empty()) continue;
    if (words[0] == "bye") return 0;
    try {
      std::cout << session.answer(words) << std::flush;
    } catch (const BoardBroken& error) {
      std::cerr << name << ": " << error.what() << "\n";
      return 1;
    } catch (const std::runtime_error& error) {
      std::cout << "unsupported " << error.what() << "\n" << std::flush;
    }
  }
  return 0;
}

}  // namespace rubric::firmware
