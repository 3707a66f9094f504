#include "tools/commands/space/mqtt_space.h"

#include <fmt/format.h>
#include <mosquitto.h>
#include <poll.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "codec/lines/broken.h"
#include "codec/text/text.h"
#include "tools/commands/run/wall_clock.h"
#include "tools/commands/space/layout.h"

namespace rubric::space {
namespace {

constexpr int kKeepAliveS = 20;
constexpr std::chrono::seconds kFirstPause{1};
constexpr std::chrono::seconds kLongestPause{30};
constexpr int kLookMs = 100;               // How often its thread looks whether it shall end.
constexpr int kQos = 2;                    // Once, and in order.
constexpr std::size_t kInboxMax = 10'000;  // Tuples that nobody has taken yet.
constexpr int kUnsentMax = 1000;           // Events while there is no broker.
constexpr std::chrono::seconds kGoodbye{2};

std::uint16_t port_of(const std::string& text, const std::string& url) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port == 0) {
    throw std::invalid_argument(fmt::format("'{}': no port '{}'", url, text));
  }
  return port;
}

void check(int result, const char* what) {
  if (result == MOSQ_ERR_SUCCESS) return;
  throw lines::Broken(fmt::format("mqtt: {}: {}", what, mosquitto_strerror(result)));
}

}  // namespace

MqttSettings parse_mqtt(const std::string& url) {
  MqttSettings out;
  const std::string_view plain = "mqtt://";
  const std::string_view tls = "mqtts://";
  out.tls = url.starts_with(tls);
  if (!out.tls && !url.starts_with(plain)) {
    throw std::invalid_argument(fmt::format("'{}': expected mqtt://HOST:PORT/ROOT", url));
  }
  std::string rest = url.substr(out.tls ? tls.size() : plain.size());
  if (const std::size_t slash = rest.find('/'); slash != rest.npos) {
    out.root = rest.substr(slash + 1);
    rest.resize(slash);
    if (out.root.ends_with('/')) out.root.pop_back();
    if (out.root.empty() || out.root.find_first_of("+#$") != out.root.npos) {
      throw std::invalid_argument(fmt::format("'{}': no root of topics", url));
    }
  }
  // Seen by everybody who lists processes.
  if (rest.find('@') != rest.npos) {
    throw std::invalid_argument(
        "user and password belong into a file or the environment: --credentials, or "
        "RUBRIC_MQTT_USER and RUBRIC_MQTT_PASSWORD");
  }
  out.port = out.tls ? 8883 : 1883;
  const std::size_t colon = rest.rfind(':');
  const bool v6 = rest.starts_with('[');
  if (colon != rest.npos && (!v6 || rest[colon - 1] == ']')) {
    out.port = port_of(rest.substr(colon + 1), url);
    rest.resize(colon);
  }
  if (v6 && rest.ends_with(']')) rest = rest.substr(1, rest.size() - 2);
  if (rest.empty()) throw std::invalid_argument(fmt::format("'{}': no host", url));
  out.host = rest;
  return out;
}

void add_credentials(const std::string& file, MqttSettings& settings) {
  if (file.empty()) {
    if (const char* user = std::getenv("RUBRIC_MQTT_USER")) settings.user = user;
    if (const char* password = std::getenv("RUBRIC_MQTT_PASSWORD")) settings.password = password;
    return;
  }
  std::ifstream in(file);
  if (!in) throw lines::Broken(file + ": cannot be read");
  const std::map<std::string, std::string*> places = {{"user", &settings.user},
                                                      {"password", &settings.password},
                                                      {"ca", &settings.ca_file},
                                                      {"cert", &settings.cert_file},
                                                      {"key", &settings.key_file}};
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::size_t equals = line.find('=');
    const auto place = places.find(line.substr(0, equals));
    if (equals == line.npos || place == places.end()) {
      // The line may be a password.
      throw std::invalid_argument(
          fmt::format("{}:{}: expected user=, password=, ca=, cert= or key=", file, number));
    }
    *place->second = line.substr(equals + 1);
    const bool is_file = place->first != "user" && place->first != "password";
    if (is_file && !std::ifstream(*place->second)) {
      throw std::invalid_argument(
          fmt::format("{}:{}: {} cannot be read", file, number, *place->second));
    }
  }
  if (settings.cert_file.empty() != settings.key_file.empty()) {
    throw std::invalid_argument(file + ": cert= and key= belong together");
  }
}

class MqttSpace::Client {
 public:
  Client(const MqttSettings& settings, const std::string& creator, const Tuple& will)
      : creator_(creator),
        root_(settings.root + '/'),
        name_(fmt::format("mqtt{}://{}:{}/{}", settings.tls ? "s" : "", settings.host,
                          settings.port, settings.root)) {
    static const int library = mosquitto_lib_init();
    check(library, "library");
    handle_ = mosquitto_new(nullptr, true, this);
    if (handle_ == nullptr) throw lines::Broken("mqtt: no memory");
    try {
      set_up(settings, will);
    } catch (...) {
      mosquitto_destroy(handle_);
      throw;
    }
  }
  ~Client() {
    say_goodbye();
    mosquitto_destroy(handle_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  std::int64_t put(const std::string& key, const std::string& data, Stay stay) {
    const std::int64_t now_ms = run::wall_ms();
    const std::string payload = payload_of({key, data, creator_, now_ms, false});
    const std::lock_guard lock(mutex_);
    if (stay == Stay::kTuple) {
      keep(root_ + key, payload);
    } else if (connected_ || ++unsent_ <= kUnsentMax) {
      publish(root_ + key, payload, false);
    } else if (unsent_ == kUnsentMax + 1) {
      text::print(stderr, "rubric: {}: not there; events are lost\n", name_);
    }
    return now_ms;
  }

  void announce(const std::string& topic, const std::string& payload) {
    const std::lock_guard lock(mutex_);
    keep(topic, payload);
  }

  void remove(const std::string& key) {
    const std::lock_guard lock(mutex_);
    tuples_.erase(root_ + key);
    publish(root_ + key, "", true);
  }

  void subscribe(const std::string& filter) {
    const std::lock_guard lock(mutex_);
    filters_.insert(filter);
    if (connected_) mosquitto_subscribe(handle_, nullptr, (root_ + filter).c_str(), kQos);
  }

  std::vector<Tuple> take() {
    const std::lock_guard lock(mutex_);
    if (!broken_.empty()) throw lines::Broken(broken_);
    return std::exchange(inbox_, {});
  }

 private:
  void set_up(const MqttSettings& settings, const Tuple& will) {
    mosquitto_connect_callback_set(handle_, [](mosquitto*, void* self, int code) {
      static_cast<Client*>(self)->connected(code);
    });
    mosquitto_disconnect_callback_set(handle_, [](mosquitto*, void* self, int code) {
      static_cast<Client*>(self)->disconnected(code);
    });
    mosquitto_message_callback_set(handle_,
                                   [](mosquitto*, void* self, const mosquitto_message* message) {
                                     static_cast<Client*>(self)->arrived(*message);
                                   });
    mosquitto_publish_callback_set(
        handle_, [](mosquitto*, void* self, int id) { static_cast<Client*>(self)->published(id); });
    // Of a TLS that fails after connect() this line is all that the library says.
    mosquitto_log_callback_set(handle_, [](mosquitto*, void* self, int level, const char* text) {
      if (level == MOSQ_LOG_ERR && std::string_view(text).starts_with("OpenSSL Error")) {
        static_cast<Client*>(self)->tls_failed_ = true;
      }
    });
    if (!settings.user.empty()) {
      const char* const password = settings.password.empty() ? nullptr : settings.password.c_str();
      check(mosquitto_username_pw_set(handle_, settings.user.c_str(), password), "user");
    }
    const auto path = [](const std::string& text) { return text.empty() ? nullptr : text.c_str(); };
    if (settings.tls) {
      const char* const folder = settings.ca_file.empty() ? "/etc/ssl/certs" : nullptr;
      check(mosquitto_tls_set(handle_, path(settings.ca_file), folder, path(settings.cert_file),
                              path(settings.key_file), nullptr),
            "TLS");
    }
    if (!will.key.empty()) {
      const std::string last = payload_of({will.key, will.data, creator_, run::wall_ms(), false});
      check(mosquitto_will_set(handle_, (root_ + will.key).c_str(), static_cast<int>(last.size()),
                               last.data(), kQos, true),
            "last will");
    }
    check(mosquitto_threaded_set(handle_, true), "thread");
    thread_ = std::jthread([this, host = settings.host, port = settings.port](
                               const std::stop_token& stop) { serve(stop, host, port); });
  }

  // Connects, again and again: a broker may start later, or go and come. The library's own thread
  // does that, too, but ends for good when a connection over TLS is cut.
  void serve(const std::stop_token& stop, const std::string& host, int port) {
    for (auto pause = kFirstPause; !stop.stop_requested();
         pause = std::min(2 * pause, kLongestPause)) {
      tls_failed_ = false;
      // Tries all addresses of the host, and may take minutes; say_goodbye() does not wait for it.
      pthread_setcancelstate(PTHREAD_CANCEL_ENABLE, nullptr);
      int result = mosquitto_connect(handle_, host.c_str(), port, kKeepAliveS);
      pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, nullptr);
      const bool tried = result == MOSQ_ERR_SUCCESS;
      while (result == MOSQ_ERR_SUCCESS && !stop.stop_requested()) {
        result = mosquitto_loop(handle_, kLookMs, 1);
        if (connected_) pause = kFirstPause;
        if (result == MOSQ_ERR_SUCCESS && cut()) result = MOSQ_ERR_CONN_LOST;
      }
      std::unique_lock lock(mutex_);
      if (!tried || result == MOSQ_ERR_CONN_LOST) say(mosquitto_strerror(result));
      if (!was_connected_ && (tls_failed_ || result == MOSQ_ERR_TLS)) {
        broken_ = name_ +
                  ": no TLS: its certificate is not trusted (ca= in --credentials) or names "
                  "another host, "
                  "it asks for one (cert=, key=), or nothing speaks TLS there";
      } else if (!was_connected_ && result == MOSQ_ERR_EAI) {
        broken_ = fmt::format("mqtt: {}: {}", host, mosquitto_strerror(result));
      }
      if (!broken_.empty()) return;
      done_.wait_for(lock, stop, pause, [] { return false; });
    }
  }

  // Returns whether the other end is gone: in TLS's handshake the library itself never notices.
  bool cut() const {
    pollfd end{mosquitto_socket(handle_), 0, 0};
    return !connected_ && poll(&end, 1, 0) == 1 && (end.revents & (POLLERR | POLLHUP)) != 0;
  }

  // Writes a tuple, now or when the broker is there. Both with the mutex held.
  void keep(const std::string& topic, const std::string& payload) {
    tuples_[topic] = payload;
    if (connected_) publish(topic, payload, true);
  }
  void publish(const std::string& topic, const std::string& payload, bool stays) {
    int id = 0;
    const int result = mosquitto_publish(
        handle_, &id, topic.c_str(), static_cast<int>(payload.size()), payload.data(), kQos, stays);
    if (result == MOSQ_ERR_SUCCESS || result == MOSQ_ERR_NO_CONN) last_id_ = id;
  }

  void connected(int code) {
    const std::lock_guard lock(mutex_);
    if (code != 0) {
      say(mosquitto_connack_string(code));
      return;
    }
    was_connected_ = true;
    text::print(stderr, "rubric: {}: connected\n", name_);
    connected_ = true;
    said_ = false;
    unsent_ = 0;
    for (const std::string& filter : filters_) {
      mosquitto_subscribe(handle_, nullptr, (root_ + filter).c_str(), kQos);
    }
    for (const auto& [topic, payload] : tuples_) publish(topic, payload, true);
  }

  void disconnected(int code) {
    const std::lock_guard lock(mutex_);
    if (code != 0) say(connected_ ? "the connection is lost" : mosquitto_strerror(code));
    connected_ = false;
    done_.notify_all();
  }

  // Says why it is not connected, once; with the mutex held.
  void say(const char* why) {
    if (!said_) text::print(stderr, "rubric: {}: {}\n", name_, why);
    said_ = true;
  }

  void published(int id) {
    const std::lock_guard lock(mutex_);
    if (id == last_id_) last_id_ = 0;
    done_.notify_all();
  }

  void arrived(const mosquitto_message& message) {
    Tuple tuple;
    const std::string topic = message.topic;
    if (!topic.starts_with(root_) || message.payloadlen == 0) return;  // A tuple taken away.
    tuple.key = topic.substr(root_.size());
    tuple.stays = message.retain;
    const auto* const bytes = static_cast<const char*>(message.payload);
    tuple.wrong = parse_payload({bytes, static_cast<std::size_t>(message.payloadlen)}, tuple);
    const std::lock_guard lock(mutex_);
    if (inbox_.size() < kInboxMax) inbox_.push_back(std::move(tuple));
  }

  // Ends the session in order, so that the last will is not carried out.
  void say_goodbye() {
    std::unique_lock lock(mutex_);
    done_.wait_for(lock, kGoodbye, [this] { return !connected_ || last_id_ == 0; });
    lock.unlock();
    mosquitto_disconnect(handle_);
    lock.lock();
    done_.wait_for(lock, kGoodbye, [this] { return !connected_; });
    lock.unlock();
    thread_.request_stop();
    pthread_cancel(thread_.native_handle());
    thread_.join();
  }

  const std::string creator_;
  const std::string root_;
  const std::string name_;
  mosquitto* handle_ = nullptr;
  // Also held while the library is called; its callbacks come without its locks.
  std::mutex mutex_;
  std::condition_variable_any done_;
  std::atomic<bool> connected_ = false;
  bool was_connected_ = false;  // Ever: from then on, what fails is tried again.
  std::atomic<bool> tls_failed_ = false;
  std::string broken_;  // Why it was given up.
  bool said_ = false;
  int unsent_ = 0;
  int last_id_ = 0;                            // Of what was published last and is not done.
  std::map<std::string, std::string> tuples_;  // This participant's, by topic.
  std::set<std::string> filters_;
  std::vector<Tuple> inbox_;
  std::jthread thread_;  // The last: it uses all others.
};

MqttSpace::MqttSpace(const MqttSettings& settings, const std::string& creator, const Tuple& will)
    : client_(std::make_unique<Client>(settings, creator, will)) {}
MqttSpace::~MqttSpace() = default;

std::int64_t MqttSpace::put(const std::string& key, const std::string& data, Stay stay) {
  return client_->put(key, data, stay);
}
void MqttSpace::announce(const std::string& topic, const std::string& payload) {
  client_->announce(topic, payload);
}
void MqttSpace::remove(const std::string& key) { client_->remove(key); }
void MqttSpace::subscribe(const std::string& filter) { client_->subscribe(filter); }
std::vector<Tuple> MqttSpace::take() { return client_->take(); }

}  // namespace rubric::space
