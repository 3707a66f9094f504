// A mote with a door, which speaks JSON lines; build it and write `app: ./door` in islands.yaml:
//
//   c++ -std=c++17 door.cc -o door          # needs nlohmann/json: apt-get install
//   nlohmann-json3-dev
//
// The same in Python is door.py.
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace {

using Json = nlohmann::json;

void call(const Json& what) { std::cout << what << std::endl; }

void join() { call({{"call", "join"}, {"type", 1}, {"transducers", 0}, {"actuators", 2}}); }

std::string hex(const std::string& text) {
  std::ostringstream out;
  for (const unsigned char c : text) {
    out << std::hex << std::setw(2) << std::setfill('0') << static_cast<int>(c);
  }
  return out.str();
}

}  // namespace

int main() {
  join();
  for (std::string line; std::getline(std::cin, line);) {
    const Json event = Json::parse(line);
    if (event["event"] == "joined" && !event["success"]) join();
    if (event["event"] == "received" && event["data"] == hex("OPEN_DOOR")) {
      call({{"call", "send"},
            {"dest", event["src"]},
            {"app_id", 10},
            {"reliable", true},
            {"data", hex("DOOR_IS_OPEN")}});
    }
  }
}
