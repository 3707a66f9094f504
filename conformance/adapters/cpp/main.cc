// The node behind rct/1, the protocol of conformance/PORTING.md: reads commands, drives the node,
// writes its outputs. All that is special to an implementation is in call() and in the events.
#include <cmath>
#include <iostream>
#include <map>
#include <memory>

#include "codec/generated/tinyos/am_header.h"
#include "conformance/adapters/cpp/base_station.h"
#include "conformance/adapters/cpp/mote.h"
#include "conformance/adapters/cpp/sink.h"
#include "conformance/adapters/cpp/words.h"

namespace rubric::cpp_node {
namespace {

const std::string kLines[] = {"radio", "serial", "peis"};

Line line_of(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kLines); ++i) {
    if (kLines[i] == name) return static_cast<Line>(i);
  }
  throw Unsupported("no line " + name);
}

std::string text(Address one) {
  return std::to_string(one.island) + ":" + std::to_string(one.device);
}
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

class Adapter : public World {
 public:
  /// Answers one command; returns false after the last.
  bool answer(const std::string& line);

  void transmit(Line line, const Frame& frame) override;
  void joined(Address own, bool success) override {
    up("joined(" + text(own) + " " + text(success) + ")");
  }
  void mote_joined(Address mote, const MoteDesc& description) override {
    up("mote_joined(" + text(mote) + " " + std::to_string(int(description.mote_type)) + " " +
       std::to_string(description.transducers.raw()) + " " +
       std::to_string(description.actuators.raw()) + ")");
  }
  void received(Address src, Component application, Bytes data) override {
    up("received(" + text(src) + " " + std::to_string(int(application)) + " x" + hex_of(data) +
       ")");
  }
  void ack_received(Component application, std::uint16_t number, bool success) override {
    up("ack_received(" + std::to_string(int(application)) + " " + std::to_string(number) + " " +
       text(success) + ")");
  }
  void syn_data(ChannelId channel, DataStatus status) override {
    up("syn_data(" + text(channel) + " " + std::to_string(int(status)) + ")");
  }

 private:
  std::string closing(const std::vector<std::string>& words);
  std::string work(const std::vector<std::string>& words, Ticks time);
  void reset(const std::vector<std::string>& words);
  void start();
  void pass(Ticks time, bool stop_at_output);
  void rx(const std::string& line, const std::string& hex);
  void call(const std::string& text);
  void power(const std::string& what);
  void up(const std::string& news) { write("up", news); }
  void write(const std::string& what, const std::string& rest) {
    std::cout << what << ' ' << now_ << ' ' << rest << '\n';
    wrote_ = true;
  }

  std::string role_;
  Settings settings_;
  std::unique_ptr<Node> node_;  // None while the power is off.
  std::map<Line, bool> taken_;  // By somebody else, whether the node has power or not.
  Ticks now_ = 0;
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

// What `reset` may set.
const std::string kSettings = " id island channels seed profile ";

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
std::string Adapter::work(const std::vector<std::string>& words, Ticks time) {
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
    if (node_) rx(words[2], words[3]);
  } else if (command == "linkack" && words.size() == 3) {
    if (node_) node_->confirmed(words[2] == "1");
  } else if (command == "line" && words.size() == 4) {
    const bool busy = words[3] == "busy";
    if (node_ && words[2] == "app") node_->set_application_busy(busy);
    if (words[2] != "app") taken_[line_of(words[2])] = busy;
    if (node_ && words[2] != "app") node_->set_busy(line_of(words[2]), busy);
  } else if (command != "until") {
    throw Unsupported(command);
  }
  const std::optional<Ticks> due = node_ ? node_->due() : std::nullopt;
  std::cout << "next " << (due ? std::to_string(*due) : "-") << '\n';
  return "done " + std::to_string(now_);
}

void Adapter::reset(const std::vector<std::string>& words) {
  const Arguments arguments(words);
  role_ = words[1];
  settings_ = {};
  settings_.device = arguments.number("id");
  settings_.island = arguments.number("island");
  settings_.channels = arguments.number("channels");
  const auto seed = arguments.number<std::uint64_t>("seed");
  settings_.next_number = static_cast<std::uint16_t>(1000 + 257 * seed);
  now_ = 0;
  taken_.clear();
  start();
}

void Adapter::start() {
  settings_.now = now_;
  node_.reset();
  if (role_ == "mote") node_ = std::make_unique<Mote>(settings_, *this);
  if (role_ == "sink") node_ = std::make_unique<Sink>(settings_, *this);
  if (role_ == "base_station") node_ = std::make_unique<BaseStation>(settings_, *this);
  if (!node_) throw Unsupported("role " + role_);
  for (const auto& [line, busy] : taken_) node_->set_busy(line, busy);
}

// Lets time pass to `time`, or to the first instant at which the node writes something.
void Adapter::pass(Ticks time, bool stop_at_output) {
  while (node_ && node_->due() && *node_->due() <= time && !(stop_at_output && wrote_)) {
    now_ = std::max(now_, *node_->due());
    node_->set_time(now_);
    node_->run_due();
  }
  if (stop_at_output && wrote_) return;
  now_ = std::max(now_, time);
  if (node_) node_->set_time(now_);
}

void Adapter::power(const std::string& what) {
  if (node_) settings_.next_number = node_->next_number();
  node_.reset();
  if (what == "reboot") start();
}

void Adapter::rx(const std::string& line, const std::string& hex) {
  const Data packet = bytes_of_hex(hex);
  const auto header = tinyos::AmHeaderView::parse(Bytes(packet.data(), packet.size()));
  if (!header) throw Unsupported("a frame without its header");
  Frame frame;
  frame.dest = header->dest();
  frame.src = header->src();
  frame.type = static_cast<AmType>(header->type());
  frame.payload.assign(header->stale().begin(), header->stale().end());
  node_->heard(line_of(line), frame);
}

void Adapter::transmit(Line line, const Frame& frame) {
  tinyos::AmHeader header;
  header.dest = frame.dest;
  header.src = frame.src;
  header.length = static_cast<std::uint8_t>(frame.payload.size());
  header.type = static_cast<std::uint8_t>(frame.type);
  Data packet(tinyos::AmHeaderView::kMaxSizeBytes);
  tinyos::AmHeaderLayout::store(header, packet.data());
  packet.insert(packet.end(), frame.payload.begin(), frame.payload.end());
  write("tx", kLines[static_cast<std::size_t>(line)] + " " +
                  hex_of(Bytes(packet.data(), packet.size())) + (frame.link_ack ? " linkack" : ""));
}

void Adapter::call(const std::string& call) {
  const std::size_t open = call.find('(');
  if (open == std::string::npos || call.back() != ')') throw Unsupported(call);
  const std::string name = call.substr(0, open);
  const Arguments with(words_of(call.substr(open + 1, call.size() - open - 2)));
  const auto result = [&](bool success) { up("op_result(" + text(success) + ")"); };
  const auto made = [&](std::optional<ChannelId> id) {
    up("channel_result(" + text(id.value_or(0)) + " " + text(id.has_value()) + ")");
  };
  Synaptic& synaptic = node_->synaptic();

  if (name == "join") {
    MoteDesc description;
    description.mote_type = static_cast<rubicon::MoteType>(with.number<std::uint8_t>("type"));
    description.transducers = rubicon::TransducerMask(with.number("transducers"));
    description.actuators = rubicon::ActuatorMask(with.number<std::uint8_t>("actuators"));
    node_->join(description);
  } else if (name == "send") {
    const Data data = with.bytes("data");
    const auto application = static_cast<Component>(with.number<std::uint8_t>("app_id"));
    const auto number = node_->send(with.address("dest"), application, with.number("reliable") == 1,
                                    Bytes(data.data(), data.size()));
    up("send_result(" + std::to_string(number) + ")");
  } else if (name == "interface") {
    result(node_->set_interface(static_cast<Line>(with.number("link")), with.number("on") == 1));
  } else if (name == "get_interface") {
    const auto on = node_->interface(static_cast<Line>(with.number("link")));
    if (!on) return result(false);
    up("interface_state(" + with.text("link") + " " + (*on ? "on" : "off") + ")");
  } else if (name == "create_out") {
    made(node_->create(Direction::kOut, with.address("dest"), with.number("size"),
                       static_cast<Mode>(with.number("mode"))));
  } else if (name == "create_in") {
    made(node_->create(Direction::kIn, with.address("src"), with.number("size"),
                       static_cast<Mode>(with.number("mode"))));
  } else if (name == "dispose") {
    result(synaptic.dispose(with.channel("channel")));
  } else if (name == "start") {
    result(node_->start_channel(with.channel("channel")));
  } else if (name == "stop") {
    result(synaptic.stop(with.channel("channel")));
  } else if (name == "start_all") {
    node_->start_all_channels();
    result(true);
  } else if (name == "stop_all") {
    synaptic.stop_all();
    result(true);
  } else if (name == "write_output") {
    result(synaptic.write(with.channel("channel"), with.number("pos"), with.real("value")));
  } else if (name == "read_input") {
    const auto value = synaptic.read(with.channel("channel"), with.number("pos"));
    up("input_value(" + text(value.value_or(0.0f)) + " " + text(value.has_value()) + ")");
  } else if (name == "set_time_step") {
    result(synaptic.set_period(with.number("clock")));
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
