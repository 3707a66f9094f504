// The node behind rct/1, the protocol of conformance/PORTING.md: reads commands, drives the node,
// writes its outputs. All that is special to an implementation is in call() and in the events.
#include <cmath>
#include <iostream>
#include <map>
#include <optional>

#include "conformance/adapters/cpp/words.h"
#include "conformance/node/node.h"
#include "conformance/node/silence.h"

namespace rubric::cpp_node {
namespace {

using namespace node;
using Time = std::uint64_t;

const std::string kLineNames[] = {"radio", "serial", "peis"};

Line line_of(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kLineNames); ++i) {
    if (kLineNames[i] == name) return static_cast<Line>(i);
  }
  throw Unsupported("no line " + name);
}

std::string text(Address one) { return std::to_string(one.pid) + ":" + std::to_string(one.devid); }
std::string text(ChannelId id) {
  return std::to_string(id >> 16) + "->" + std::to_string(id & 0xFFFF);
}
std::string text(bool success) { return success ? "success" : "fail"; }
std::string text(float value) {
  if (std::isnan(value)) return "nan";
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

class Adapter : public Driver, public Application {
 public:
  /// Answers one command; returns false after the last.
  bool answer(const std::string& line);

  void transmit(Line line, Bytes packet, bool link_ack) override;
  void joined(Address own, bool success) override {
    up("joined(" + text(own) + " " + text(success) + ")");
  }
  void mote_joined(Address mote, const Descriptor& description) override {
    up("mote_joined(" + text(mote) + " " + std::to_string(int(description.mote_type)) + " " +
       std::to_string(description.transducers.raw()) + " " +
       std::to_string(description.actuators.raw()) + ")");
  }
  void mote_left(Address mote) override { up("mote_left(" + text(mote) + ")"); }
  void received(Address src, std::uint8_t app_id, Bytes data) override {
    up("received(" + text(src) + " " + std::to_string(app_id) + " x" + hex_of(data) + ")");
  }
  void ack_received(std::uint8_t app_id, std::uint16_t number, bool success) override {
    up("ack_received(" + std::to_string(app_id) + " " + std::to_string(number) + " " +
       text(success) + ")");
  }
  void syn_data_received(ChannelId channel, DataStatus status) override {
    up("syn_data(" + text(channel) + " " + std::to_string(int(status)) + ")");
  }

 private:
  std::string closing(const std::vector<std::string>& words);
  std::string work(const std::vector<std::string>& words, Time time);
  void reset(const std::vector<std::string>& words);
  void start();
  void hear(Line line, Bytes packet);
  void run();
  void pass(Time time, bool stop_at_output);
  void call(const std::string& text);
  void power(const std::string& what);
  void up(const std::string& news) { write("up", news); }
  void write(const std::string& what, const std::string& rest) {
    std::cout << what << ' ' << now_ << ' ' << rest << '\n';
    wrote_ = true;
  }

  std::string role_;
  Setup setup_{};
  std::optional<SizedNode<AnySizes>> node_;  // None while the power is off.
  Ticks gone_after_ = 0;
  Silence<AnySizes::kMembers> silence_;
  std::optional<Time> due_;
  std::map<Line, bool> taken_;  // By somebody else, whether the node has power or not.
  Time now_ = 0;
  bool wrote_ = false;
};

bool Adapter::answer(const std::string& line) {
  const std::vector<std::string> words = words_of(line);
  if (words.size() == 1 && words[0] == "bye") return false;
  try {
    std::cout << closing(words) << std::endl;
  } catch (const Unsupported& why) {
    std::cout << "unsupported " << why.what() << std::endl;
  }
  return true;
}

// The parameters that `reset` may set.
const std::string kSettings = " id island channels seed profile members gone_after ";

std::string Adapter::closing(const std::vector<std::string>& words) {
  if (words.size() == 2 && words[0] == "hello") {
    return "hello rct/1 rubric_cpp_node 1.0 roles=mote,sink,base_station time=virtual";
  }
  if (words.size() > 2 && words[0] == "reset") {
    for (std::size_t i = 2; i < words.size(); ++i) {
      const std::string name = words[i].substr(0, words[i].find('='));
      if (kSettings.find(' ' + name + ' ') == std::string::npos) throw Unsupported(name);
    }
    reset(words);
    return "ready";
  }
  if (role_.empty() || words.size() < 2) throw Unsupported("this command");
  return work(words, number_of(words[1]));
}

// Runs a command with a time, which is its second word.
std::string Adapter::work(const std::vector<std::string>& words, Time time) {
  const std::string& command = words[0];
  wrote_ = false;
  pass(time, command == "until");
  if (command == "power" && words.size() == 3) {
    power(words[2]);
  } else if (command == "call" && words.size() > 2) {
    std::string rest = words[2];
    for (std::size_t i = 3; i < words.size(); ++i) rest += " " + words[i];
    if (node_) call(rest);
  } else if (command == "rx" && words.size() == 4) {
    const Data packet = bytes_of_hex(words[3]);
    if (node_) hear(line_of(words[2]), Bytes(packet.data(), packet.size()));
  } else if (command == "linkack" && words.size() == 3) {
    if (node_) node_->sent(Line::kRadio, words[2] == "1");
  } else if (command == "line" && words.size() == 4) {
    const bool busy = words[3] == "busy";
    if (node_ && words[2] == "app") node_->set_application_busy(busy);
    if (words[2] != "app") taken_[line_of(words[2])] = busy;
    if (node_ && words[2] != "app") node_->set_busy(line_of(words[2]), busy);
  } else if (command != "until") {
    throw Unsupported(command);
  }
  run();
  std::cout << "next " << (due_ ? std::to_string(*due_) : "-") << '\n';
  return "done " + std::to_string(now_);
}

void Adapter::reset(const std::vector<std::string>& words) {
  const Arguments arguments(words);
  role_ = words[1];
  setup_ = {};
  if (role_ == "sink") setup_.role = Role::kSink;
  if (role_ == "base_station") setup_.role = Role::kBaseStation;
  if (role_ != "mote" && setup_.role == Role::kMote) throw Unsupported("role " + role_);
  setup_.id = arguments.number("id");
  setup_.island = arguments.number("island");
  setup_.channels = arguments.number<std::uint8_t>("channels");
  const auto seed = arguments.number<std::uint64_t>("seed");
  setup_.last_seq_num = static_cast<std::uint16_t>(999 + 257 * seed);
  if (arguments.has("members")) setup_.members = arguments.number<std::uint8_t>("members");
  gone_after_ = arguments.has("gone_after") ? arguments.number<Ticks>("gone_after") : 0;
  now_ = 0;
  taken_.clear();
  start();
}

void Adapter::start() {
  setup_.now = static_cast<Ticks>(now_);
  node_.emplace(*this, *this);
  node_->start(setup_);
  silence_.start(gone_after_);
  for (const auto& [line, busy] : taken_) node_->set_busy(line, busy);
}

void Adapter::hear(Line line, Bytes packet) {
  node_->received(line, packet);
  silence_.received(*node_, setup_.role, line, packet, static_cast<Ticks>(now_));
}

// Does what is due now.
void Adapter::run() {
  due_.reset();
  if (!node_) return;
  const auto now = static_cast<Ticks>(now_);
  Ticks due = 0;
  if (node_->run(now, due)) due_ = now_ + (due - now);
  if (silence_.run(*node_, *this, now, due)) {
    const Time other = now_ + (due - now);
    due_ = due_ ? std::min(*due_, other) : other;
  }
}

// Lets time pass to `time`, or to the first instant at which the node writes something.
void Adapter::pass(Time time, bool stop_at_output) {
  while (due_ && *due_ <= time && !(stop_at_output && wrote_)) {
    now_ = *due_;
    run();
  }
  if (stop_at_output && wrote_) return;
  now_ = time;
  run();
}

void Adapter::power(const std::string& what) {
  if (node_) setup_.last_seq_num = node_->last_seq_num();
  node_.reset();
  if (what == "reboot") start();
}

void Adapter::transmit(Line line, Bytes packet, bool link_ack) {
  write("tx", kLineNames[static_cast<std::size_t>(line)] + " " + hex_of(packet) +
                  (link_ack ? " linkack" : ""));
  if (!link_ack) node_->sent(line, false);  // It takes no time.
}

void Adapter::call(const std::string& call) {
  const std::size_t open = call.find('(');
  if (open == std::string::npos || call.back() != ')') throw Unsupported(call);
  const std::string name = call.substr(0, open);
  const Arguments with(words_of(call.substr(open + 1, call.size() - open - 2)));
  const auto result = [&](bool success) { up("op_result(" + text(success) + ")"); };
  const auto made = [&](ChannelResult channel) {
    up("channel_result(" + text(channel.id) + " " + text(channel.success) + ")");
  };
  const auto line = [&] { return static_cast<Line>(with.number("link")); };
  const auto mode = [&] { return static_cast<Mode>(with.number("mode")); };
  const auto channel = [&] { return with.channel("channel"); };

  if (name == "join") {
    Descriptor description;
    description.mote_type = static_cast<rubicon::MoteType>(with.number<std::uint8_t>("type"));
    description.transducers = rubicon::TransducerMask(with.number("transducers"));
    description.actuators = rubicon::ActuatorMask(with.number<std::uint8_t>("actuators"));
    node_->join(description);
  } else if (name == "send") {
    const Data data = with.bytes("data");
    const auto number = node_->send(with.address("dest"), with.number<std::uint8_t>("app_id"),
                                    with.number("reliable") == 1, Bytes(data.data(), data.size()));
    up("send_result(" + std::to_string(number) + ")");
  } else if (name == "interface") {
    result(node_->set_interface(line(), with.number("on") == 1));
  } else if (name == "get_interface") {
    if (line() == Line::kPeis) return result(false);
    up("interface_state(" + with.text("link") + " " +
       (node_->interface_is_on(line()) ? "on" : "off") + ")");
  } else if (name == "create_out") {
    made(node_->create_out(with.address("dest"), with.number<std::uint8_t>("size"), mode()));
  } else if (name == "create_in") {
    made(node_->create_in(with.address("src"), with.number<std::uint8_t>("size"), mode()));
  } else if (name == "dispose") {
    result(node_->dispose(channel()));
  } else if (name == "start") {
    result(node_->start_channel(channel()));
  } else if (name == "stop") {
    result(node_->stop_channel(channel()));
  } else if (name == "start_all") {
    result(node_->start_all());
  } else if (name == "stop_all") {
    result(node_->stop_all());
  } else if (name == "write_output") {
    result(node_->write_output(channel(), with.number<std::uint8_t>("pos"), with.real("value")));
  } else if (name == "read_input") {
    const InputValue value = node_->read_input(channel(), with.number<std::uint8_t>("pos"));
    up("input_value(" + text(value.value) + " " + text(value.success) + ")");
  } else if (name == "set_time_step") {
    result(node_->set_time_step(with.number("clock")));
  } else if (name == "set_island_id") {
    result(node_->set_island(with.number("island")));
  } else if (name == "get_clock") {
    up("clock(" + std::to_string(node_->clock_ms()) + ")");
  } else {
    throw Unsupported("call " + name);
  }
}

}  // namespace
}  // namespace rubric::cpp_node

int main() {
  std::ios::sync_with_stdio(false);
  rubric::cpp_node::Adapter adapter;
  for (std::string line; std::getline(std::cin, line);) {
    if (!adapter.answer(line)) return 0;
  }
  return 0;
}
