#include "tools/commands/proxy/line_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "codec/lines/broken.h"
#include "codec/text/text.h"

namespace rubric::proxy {
namespace {

using std::chrono::steady_clock;

constexpr lines::Milliseconds kTryEvery{1000};
constexpr lines::Milliseconds kOpenTime{200};
constexpr lines::Milliseconds kWriteTime{200};
constexpr std::size_t kDevicesMax = 1024;
constexpr std::size_t kWordMax = 32;

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    if (end > at) out.emplace_back(line.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

bool is_name(const std::string& word) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  };
  return word.size() <= kWordMax && std::all_of(word.begin(), word.end(), fits);
}

}  // namespace

LineNetwork::LineNetwork(lines::HostPort at, Above& above)
    : at_(std::move(at)),
      above_(above),
      refusals_(fmt::format("lines:{}:{}", at_.host, at_.port)) {}

lines::SteadyTime LineNetwork::run() {
  const auto now = steady_clock::now();
  bool more = false;
  refusals_.say_rest();
  try {
    if (!stream_.is_open()) {
      if (!devices_.empty()) {
        lost("the line is closed");
        return now;
      }
      if (now < next_try_) return next_try_;
      next_try_ = now + kTryEvery;
      stream_ = lines::connect_tcp(at_, now + kOpenTime);
      text::print(stderr, "rubric: lines:{}:{}: connected\n", at_.host, at_.port);
      said_ = false;
      input_.rest();
    }
    std::uint8_t room[1024];
    for (int reads = 0; reads < kReadsMax; ++reads) {
      const std::size_t size = stream_.read(MutableBytes(room, sizeof room), now);
      more = size > 0;
      if (!more) break;
      input_.add(
          {reinterpret_cast<const char*>(room), size},
          [this](std::string_view line) { take(line); },
          [this] { refusals_.say(fmt::format("a line of more than {} bytes", kLineMax)); });
    }
  } catch (const lines::Broken& broken) {
    lost(broken.what());
  }
  if (!stream_.is_open()) return next_try_;
  return more ? now : lines::SteadyTime::max();
}

void LineNetwork::lost(const char* why) {
  stream_.close();
  if (!said_) text::print(stderr, "rubric: lines:{}:{}: {}\n", at_.host, at_.port, why);
  said_ = true;
  while (!devices_.empty()) leave(std::string(*devices_.begin()));
}

void LineNetwork::leave(const std::string& device) {
  devices_.erase(device);
  above_.left(device);
}

void LineNetwork::take(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  const std::vector<std::string> words = words_of(line);
  const bool named = words.size() >= 2 && is_name(words[1]);
  if (named && words[0] == "there" && words.size() <= 2 + kWordMax) {
    Device device{words[1], {}, {}, true};
    std::set<std::string>* kind = &device.sensors;
    for (auto word = words.begin() + 2; word != words.end(); ++word) {
      if (*word == "-") {
        kind = &device.actuators;
      } else if (is_name(*word)) {
        kind->insert(*word);
      }
    }
    if (devices_.size() >= kDevicesMax && !devices_.contains(device.id)) return;
    devices_.insert(device.id);
    return above_.joined(device);
  }
  const bool known = named && devices_.contains(words[1]);
  if (known && words[0] == "gone" && words.size() == 2) return leave(words[1]);
  if (known && words[0] == "value" && words.size() == 4 && is_name(words[2])) {
    double value = 0;
    const std::string& text = words[3];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value)) {
      return above_.read(words[1], nlohmann::json{{words[2], {{"value", value}}}}.dump());
    }
  }
  refusals_.say(fmt::format("'{}'", line.substr(0, 80)));
}

void LineNetwork::write(const std::string& line) {
  try {
    stream_.write(Bytes(reinterpret_cast<const std::uint8_t*>(line.data()), line.size()),
                  steady_clock::now() + kWriteTime);
  } catch (const lines::Broken&) {
    stream_.close();  // The next run() tells.
  }
}

void LineNetwork::sample(const std::string& device, const Sampling& wanted) {
  std::string line = fmt::format("watch {} {}", device, wanted.period_ms);
  for (const std::string& sensor : wanted.sensors) line += ' ' + sensor;
  write(line + '\n');
}

std::string LineNetwork::command(const std::string& device, const std::string& text,
                                 std::uint64_t) {
  if (!is_name(text)) return "expected a word of small letters and digits";
  write(fmt::format("command {} {}\n", device, text));
  return {};
}

}  // namespace rubric::proxy
