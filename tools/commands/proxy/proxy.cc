#include "tools/commands/proxy/proxy.h"

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "codec/lines/address.h"
#include "codec/lines/broken.h"

namespace rubric::proxy {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::steady_clock;

constexpr std::size_t kOutputMax = 1 << 20;  // A client that reads nothing is let go.
constexpr std::size_t kClientsMax = 64;
constexpr std::size_t kWantsMax = 1024;
constexpr lines::Milliseconds kLookAgain{50};
constexpr std::uint32_t kPeriodMaxMs = 65'535;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string text_at(const Json& json, const char* name) {
  if (!json.contains(name) || !json.at(name).is_string()) {
    throw std::invalid_argument(fmt::format("{}: expected a text", name));
  }
  return json.at(name).get<std::string>();
}

Sampling sampling_of(const Json& json) {
  Sampling out;
  const Json period = json.value("period_ms", Json(1000U));
  if (!period.is_number_unsigned() || period == 0 || period > kPeriodMaxMs) {
    throw std::invalid_argument(fmt::format("period_ms: expected 1 to {}", kPeriodMaxMs));
  }
  out.period_ms = period.get<std::uint32_t>();
  const Json sensors = json.value("sensors", Json::array());
  if (!sensors.is_array()) throw std::invalid_argument("sensors: expected a list of names");
  for (const Json& sensor : sensors) {
    if (!sensor.is_string()) throw std::invalid_argument("sensors: expected names");
    out.sensors.insert(sensor.get<std::string>());
  }
  return out;
}

}  // namespace

Proxy::Proxy(std::uint16_t island, std::uint16_t port)
    : listener_(lines::listen_at("127.0.0.1", port)), poll_(::epoll_create1(EPOLL_CLOEXEC)) {
  if (!poll_.is_open()) throw lines::Broken(std::strerror(errno));
  Above& above = *this;
  auto motes = std::make_unique<MoteNetwork>(island, above);
  motes_ = motes.get();
  networks_.push_back(std::move(motes));
  watch(listener_.get());
}

Proxy::~Proxy() = default;

void Proxy::add_lines(const lines::HostPort& at) {
  Above& above = *this;
  networks_.push_back(std::make_unique<LineNetwork>(at, above));
}

std::uint16_t Proxy::port() const { return lines::address_here(listener_.get()).port(); }

// The kernel forgets a descriptor that is closed.
void Proxy::watch(int fd) const {
  epoll_event event{};
  event.events = EPOLLIN;
  ::epoll_ctl(poll_.get(), EPOLL_CTL_ADD, fd, &event);
}

void Proxy::happened(const machine::Notice& notice, run::Caller& caller) {
  telling_ = motes_;
  motes_->happened(notice, caller);
}

lines::SteadyTime Proxy::run(run::Caller&) {
  lines::SteadyTime until = lines::SteadyTime::max();
  for (const auto& network : networks_) {
    telling_ = network.get();
    until = std::min(until, network->run());
    if (network.get() == motes_ || network->fd() == watched_) continue;
    watched_ = network->fd();
    if (watched_ >= 0) watch(watched_);
  }
  accept();
  for (const auto& client : clients_) {
    if (read(*client)) until = steady_clock::now();
  }
  for (const auto& client : clients_) {
    if (client->stream.is_open()) continue;
    const auto wants = std::exchange(client->wants, {});
    for (const auto& [device, sampling] : wants) apply(device);
  }
  std::erase_if(clients_, [](const auto& client) { return !client->stream.is_open(); });
  const bool waits = std::any_of(clients_.begin(), clients_.end(),
                                 [](const auto& client) { return !client->output.empty(); });
  return waits ? std::min(until, steady_clock::now() + kLookAgain) : until;
}

void Proxy::accept() {
  const int fd = ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  lines::Descriptor descriptor(fd);
  if (clients_.size() >= kClientsMax) return;
  watch(fd);
  Client& client = *clients_.emplace_back(std::make_unique<Client>());
  client.stream = lines::ByteStream(std::move(descriptor));
  for (const auto& [id, known] : devices_) put(client, line_of(known));
}

bool Proxy::read(Client& client) {
  bool more = false;
  try {
    std::uint8_t room[1024];
    for (int reads = 0; reads < kReadsMax; ++reads) {
      const std::size_t size =
          client.stream.read(MutableBytes(room, sizeof room), steady_clock::now());
      more = size > 0;
      if (!more) break;
      client.input.add(
          {reinterpret_cast<const char*>(room), size},
          [&](const std::string& line) { take(client, line); },
          [&] { put_error(client, fmt::format("a line of more than {} bytes", kRequestMax)); });
    }
    put(client, "");
  } catch (const lines::Broken&) {
    client.stream.close();
  }
  return more && client.stream.is_open();
}

void Proxy::take(Client& client, const std::string& line) {
  try {
    const Json json = Json::parse(line);
    if (!json.is_object()) throw std::invalid_argument("expected an object");
    if (json.contains("subscribe")) {
      const std::string device = text_at(json, "subscribe");
      return subscribe(client, device, sampling_of(json));
    }
    if (json.contains("unsubscribe")) {
      const std::string device = text_at(json, "unsubscribe");
      client.wants.erase(device);
      return apply(device);
    }
    if (!json.contains("command")) {
      throw std::invalid_argument("expected subscribe, unsubscribe or command");
    }
    command(client, json);
  } catch (const std::invalid_argument& error) {
    put_error(client, error.what());
  } catch (const Json::exception& error) {
    put_error(client, fmt::format("no JSON: {}", error.what()));
  }
}

void Proxy::command(Client& client, const Json& request) {
  const std::string device = text_at(request, "device");
  const std::string text = text_at(request, "command");
  const auto known = devices_.find(device);
  std::string wrong;
  if (known == devices_.end()) wrong = "no such device";
  if (client.commands.size() >= kWantsMax) wrong = "too many commands";
  Json event = {{"event", "command"}, {"device", device}, {"command", text}};
  const std::uint64_t number = ++commands_;
  if (wrong.empty()) wrong = known->second.network->command(device, text, number);
  if (!wrong.empty()) {
    event["outcome"] = "refused";
    event["text"] = wrong;
  } else if (known->second.network->answers()) {
    client.commands[number] = event;
    return;
  } else {
    event["outcome"] = "sent";
  }
  put(client, text_of(event));
}

void Proxy::answered(std::uint64_t command, bool done) {
  for (const auto& client : clients_) {
    const auto found = client->commands.find(command);
    if (found == client->commands.end()) continue;
    Json event = std::move(found->second);
    client->commands.erase(found);
    event["outcome"] = done ? "done" : "no answer";
    return put(*client, text_of(event));
  }
}

void Proxy::subscribe(Client& client, const std::string& device, const Sampling& wanted) {
  if (client.wants.size() >= kWantsMax) throw std::invalid_argument("too many subscriptions");
  const auto found = devices_.find(device);
  const bool is_there = found != devices_.end();
  for (const std::string& sensor : wanted.sensors) {
    if (!is_there || !found->second.device.is_described) break;
    if (found->second.device.sensors.contains(sensor)) continue;
    throw std::invalid_argument(fmt::format("{} has no sensor '{}'", device, sensor));
  }
  client.wants[device] = wanted;
  if (!is_there) put(client, text_of({{"event", "awaited"}, {"device", device}}));
  apply(device);
}

void Proxy::put_error(Client& client, const std::string& text) {
  put(client, text_of({{"event", "error"}, {"text", text}}));
}

void Proxy::put(Client& client, std::string line) {
  client.output += line;
  if (client.output.empty() || !client.stream.is_open()) return;
  try {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(client.output.data());
    client.output.erase(0, client.stream.write_some(Bytes(bytes, client.output.size())));
    if (client.output.size() > kOutputMax) client.stream.close();
  } catch (const lines::Broken&) {
    client.stream.close();
  }
}

void Proxy::put_all(const std::string& line) {
  for (const auto& client : clients_) put(*client, line);
}

std::string Proxy::line_of(const Known& known) {
  return text_of({{"event", "device"},
                  {"network", known.network->name()},
                  {"device", known.device.id},
                  {"sensors", known.device.sensors},
                  {"actuators", known.device.actuators}});
}

void Proxy::joined(const Device& device) {
  Known& known = devices_[device.id];
  known = {telling_, device, {}};  // One that comes back has forgotten what it was told.
  put_all(line_of(known));
  apply(device.id);
}

void Proxy::read(const std::string& device, const std::string& data) {
  const std::string line =
      text_of({{"event", "reading"}, {"device", device}, {"data", Json::parse(data)}});
  for (const auto& client : clients_) {
    if (client->wants.contains(device)) put(*client, line);
  }
}

void Proxy::left(const std::string& device) {
  if (devices_.erase(device) == 0) return;
  put_all(text_of({{"event", "left"}, {"device", device}}));
}

void Proxy::apply(const std::string& device) {
  const auto found = devices_.find(device);
  if (found == devices_.end()) return;
  Known& known = found->second;
  Sampling all;
  for (const auto& client : clients_) {
    const auto want = client->wants.find(device);
    if (want == client->wants.end()) continue;
    const Sampling& one = want->second;
    all.period_ms = all.period_ms == 0 ? one.period_ms : std::min(all.period_ms, one.period_ms);
    for (const std::string& sensor : one.sensors.empty() ? known.device.sensors : one.sensors) {
      if (known.device.sensors.contains(sensor)) all.sensors.insert(sensor);
    }
  }
  if (all.sensors.empty()) all = {};
  if (all == known.set) return;
  known.set = all;
  known.network->sample(device, all);
}

}  // namespace rubric::proxy
