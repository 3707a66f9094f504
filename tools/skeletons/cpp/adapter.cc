// rct/1 around MyNode: reads commands, drives the node, writes what happens.
//
//   g++ -std=c++17 -O2 -Wall -Wextra -o my_node adapter.cc
//   rubric test --target ./my_node
#include <algorithm>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "my_node.h"

namespace {

// A feature that this implementation lacks: the case is skipped, and the report shows it.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Arguments arguments_of(const std::string& text) {
  Arguments arguments;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    const std::size_t equals = word.find('=');
    if (equals != std::string::npos) arguments[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return arguments;
}

Packet packet_of(const std::string& hex) {
  Packet packet;
  for (std::size_t at = 0; at + 1 < hex.size(); at += 2) {
    packet.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(at, 2), nullptr, 16)));
  }
  return packet;
}

class Adapter : public World {
 public:
  void tx(const std::string& line, const Packet& packet, bool link_ack) override {
    std::cout << "tx " << now_ << ' ' << line << ' ';
    for (const std::uint8_t byte : packet) {
      std::cout << "0123456789abcdef"[byte >> 4] << "0123456789abcdef"[byte & 15];
    }
    std::cout << (link_ack ? " linkack\n" : "\n");
    wrote_ = true;
  }
  void up(const std::string& news) override {
    std::cout << "up " << now_ << ' ' << news << '\n';
    wrote_ = true;
  }

  /// Returns the closing line.
  std::string answer(const std::string& line) {
    std::istringstream in(line);
    std::string command;
    in >> command;
    // TODO: the name and version of your implementation, and the roles that it can play.
    if (command == "hello") return "hello rct/1 my_node 0.1 roles=mote time=virtual";
    if (command == "reset") return reset(in);
    if (role_.empty() || !is_known(command)) throw Unsupported("command " + command);
    Ticks time = 0;
    in >> time;
    wrote_ = false;
    pass(time, command == "until");
    if (node_ || command == "power") work(command, in);
    const std::optional<Ticks> due = node_ ? node_->due() : std::nullopt;
    std::cout << "next " << (due ? std::to_string(*due) : "-") << '\n';
    return "done " + std::to_string(now_);
  }

 private:
  static bool is_known(const std::string& command) {
    return command == "rx" || command == "call" || command == "linkack" || command == "line" ||
           command == "power" || command == "until";
  }

  std::string reset(std::istringstream& in) {
    std::string role;
    in >> role;
    if (role != "mote") throw Unsupported("role " + role);  // TODO: if you can play others.
    role_ = role;
    std::string rest;
    std::getline(in, rest);
    settings_ = arguments_of(rest);
    for (const auto& [name, value] : settings_) {
      const bool known = name == "id" || name == "island" || name == "channels" || name == "seed" ||
                         name == "profile";
      if (!known) throw Unsupported(name);  // TODO: if you can be built with other parameters.
    }
    number_ = static_cast<std::uint16_t>(1000 + 257 * std::stoull(settings_["seed"]));
    now_ = 0;
    start();
    return "ready";
  }

  void start() { node_ = std::make_unique<MyNode>(*this, role_, settings_, number_, now_); }

  // Lets time pass to `time`, or to the first instant at which the node writes something.
  void pass(Ticks time, bool stop_at_output) {
    while (node_ && node_->due() && *node_->due() <= time && !(stop_at_output && wrote_)) {
      now_ = std::max(now_, *node_->due());
      node_->set_time(now_);
      node_->run_due();
    }
    if (stop_at_output && wrote_) return;
    now_ = time;
    if (node_) node_->set_time(now_);
  }

  void work(const std::string& command, std::istringstream& in) {
    std::string first, second;
    if (command == "call") {
      std::getline(in >> std::ws, first);
      const std::size_t open = first.find('(');
      const std::string name = first.substr(0, open);
      const std::string inside = open == std::string::npos ? "" : first.substr(open + 1);
      if (!node_->call(name, arguments_of(inside.substr(0, inside.rfind(')'))))) {
        throw Unsupported("call " + name);
      }
      return;
    }
    in >> first >> second;
    if (command == "rx") node_->heard(first, packet_of(second));
    if (command == "line") node_->set_busy(first, second == "busy");
    if (command == "linkack") node_->confirmed(first == "1");
    if (command == "power") {
      if (node_) number_ = node_->next_number();
      node_.reset();
      if (first == "reboot") start();
    }
  }

  std::string role_;
  Arguments settings_;
  std::unique_ptr<MyNode> node_;  // None while the power is off.
  std::uint16_t number_ = 0;
  Ticks now_ = 0;
  bool wrote_ = false;
};

}  // namespace

int main() {
  Adapter adapter;
  for (std::string line; std::getline(std::cin, line) && line != "bye";) {
    try {
      std::cout << adapter.answer(line) << std::endl;
    } catch (const Unsupported& why) {
      std::cout << "unsupported " << why.what() << std::endl;
    }
  }
}
