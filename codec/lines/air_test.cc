#include "codec/lines/air.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <chrono>
#include <string>
#include <thread>

#include "codec/containers/zep_packet.h"

namespace rubric::lines {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// A frame of one byte, which names it.
std::string frame_of(std::uint8_t name, std::int64_t time_ns) {
  const std::uint8_t frame[] = {name, 0, 0};
  ZepPacket zep{.time_ns = time_ns, .frame = Bytes(frame, sizeof frame)};
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

// Another program, perhaps the hub of another air, has the port of one that has gone.
TEST(Air, AHubForgetsWhoHasGone) {
  using std::chrono::steady_clock;
  Air hub({"127.0.0.1", 0}, Milliseconds(20));
  hub.open();
  Descriptor member(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const SocketAddress to = resolve("127.0.0.1", hub.port(), true).front();
  ASSERT_EQ(::connect(member.get(), to.get(), to.size_bytes), 0);
  ZepPacket ack{.type = ZepPacket::Type::kAck};
  std::string greeting;
  append_zep(ack, greeting);
  const auto greets = [&] {
    ASSERT_EQ(::send(member.get(), greeting.data(), greeting.size(), 0),
              static_cast<ssize_t>(greeting.size()));
    hub.receive(steady_clock::now());
  };
  const auto hears = [&] {
    std::uint8_t room[256];
    int frames = 0;
    for (ssize_t size; (size = ::recv(member.get(), room, sizeof room, 0)) > 0;) {
      const auto zep = parse_zep(Bytes(room, static_cast<std::size_t>(size)));
      frames += zep && zep->type != ZepPacket::Type::kAck;
    }
    return frames;
  };
  greets();
  hub.send(bytes_of(frame_of('A', kNoTime)));
  EXPECT_EQ(hears(), 1);
  std::this_thread::sleep_for(Milliseconds(40));
  hub.send(bytes_of(frame_of('B', kNoTime)));
  EXPECT_EQ(hears(), 0);
  greets();
  hub.send(bytes_of(frame_of('C', kNoTime)));
  EXPECT_EQ(hears(), 1);
}

}  // namespace
}  // namespace rubric::lines
