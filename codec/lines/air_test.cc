#include "codec/lines/air.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "codec/containers/zep_packet.h"

namespace rubric::lines {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// A frame of one byte, which names it.
std::string frame_of(std::uint8_t name, std::int64_t time_ns) {
  const std::uint8_t frame[] = {name, 0, 0};
  ZepPacket zep;
  zep.time_ns = time_ns;
  zep.frame = Bytes(frame, sizeof frame);
  std::string datagram;
  append_zep(zep, datagram);
  return datagram;
}

Bytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string next_three_of(Air& air) {
  std::string names;
  for (int i = 0; i < 3; ++i) {
    const Bytes datagram = air.receive(std::chrono::steady_clock::now() + Milliseconds(2000));
    const auto zep = parse_zep(datagram);
    names += zep ? static_cast<char>(zep->frame[0]) : '-';
  }
  return names;
}

// A sender that was late to run stamps its frame with the time at which it should have left. A hub
// that was late, too, finds it behind one that left after it.
TEST(Air, WhatIsAtHandComesInTheOrderOfItsStamps) {
  Air hub({"127.0.0.1", 0});
  hub.open();
  Air one({"127.0.0.1", hub.port()});
  Air other({"127.0.0.1", hub.port()});
  Air listener({"127.0.0.1", hub.port()});
  for (Air* air : {&one, &other, &listener}) air->open();
  hub.receive(std::chrono::steady_clock::now());  // Their greetings.
  const std::int64_t now_ns =
      std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  one.send(bytes_of(frame_of('B', now_ns - 20 * kMs)));
  other.send(bytes_of(frame_of('A', now_ns - 60 * kMs)));
  one.send(bytes_of(frame_of('C', kNoTime)));  // Now.
  EXPECT_EQ(next_three_of(hub), "ABC");
  EXPECT_EQ(next_three_of(listener), "ABC");
}

}  // namespace
}  // namespace rubric::lines
