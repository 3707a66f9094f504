#include "codec/lines/host_link.h"

#include <gtest/gtest.h>

#include <random>

#include "codec/runtime/hdlc.h"

namespace rubric::lines {
namespace {

using Octets = std::vector<std::uint8_t>;
using Submitted = HostLink::Submitted;

const SteadyTime kBegin{std::chrono::hours(1)};
const Octets kConfig{0, 0, 1, 0, 0, 3, 0, 37, 10, 0, 12};
const Octets kOther{0, 0, 1, 0, 0, 3, 0, 37, 10, 0x7e, 0x7d};

SteadyTime at(int time_ms) { return kBegin + Milliseconds(time_ms); }
Bytes view(const Octets& octets) { return {octets.data(), octets.size()}; }

Octets frame(const Octets& content) {
  Octets out(hdlc_frame_room(content.size() + 2));
  out.resize(*write_hdlc_frame(view(content), MutableBytes(out.data(), out.size())));
  return out;
}
Octets packet_frame(std::uint8_t kind, std::uint8_t seq, const Octets& packet) {
  Octets content{kind, seq};
  content.insert(content.end(), packet.begin(), packet.end());
  return frame(content);
}
Octets sent(std::uint8_t seq, const Octets& packet) {
  return packet_frame(kSerialPacketAck, seq, packet);
}
Octets ack(std::uint8_t seq) { return frame({kSerialAck, seq}); }

/// A link and its output.
struct Host {
  explicit Host(const HostLinkOptions& options = {})
      : link(options, [this](const HostLink::Outcome& one) { outcomes.push_back(one); }) {}

  /// Returns its present output.
  Octets wrote() {
    const Octets out(link.output().begin(), link.output().end());
    link.written(out.size());
    return out;
  }
  void take(const Octets& bytes, int time_ms) {
    auto keep = [&](const Packet& packet) {
      kinds.push_back(packet.error.fault == Fault::kNone ? packet.kind : -1);
      packets += brings_packet(packet);
    };
    link.take(view(bytes), at(time_ms), keep);
  }

  std::vector<HostLink::Outcome> outcomes;
  std::vector<int> kinds;  ///< The kinds of frames that came; -1: malformed.
  int packets = 0;
  HostLink link;
};

TEST(HostLink, APacketIsConfirmed) {
  Host host;
  EXPECT_FALSE(host.link.next());
  ASSERT_EQ(host.link.submit(view(kConfig), at(0)), Submitted::kTaken);
  EXPECT_EQ(host.wrote(), sent(14, kConfig));
  EXPECT_EQ(host.link.next(), at(1000));
  host.take(ack(14), 30);
  ASSERT_EQ(host.outcomes.size(), 1U);
  const HostLink::Outcome& outcome = host.outcomes[0];
  EXPECT_TRUE(outcome.confirmed);
  EXPECT_EQ(outcome.tries, 1);
  EXPECT_EQ(outcome.begun, at(0));
  EXPECT_EQ(outcome.ended, at(30));
  EXPECT_FALSE(host.link.next());
  EXPECT_EQ(host.link.pending(), 0U);
  EXPECT_EQ(host.wrote(), Octets{});
}

TEST(HostLink, OneAtATimeInOrder) {
  Host host;
  host.link.submit(view(kConfig), at(0));
  host.link.submit(view(kOther), at(1));
  EXPECT_EQ(host.wrote(), sent(14, kConfig));
  host.take(ack(14), 5);
  EXPECT_EQ(host.wrote(), sent(15, kOther));
  EXPECT_EQ(host.link.next(), at(1005));
  host.take(ack(15), 6);
  ASSERT_EQ(host.outcomes.size(), 2U);
  EXPECT_EQ(host.outcomes[0].packet, 0U);
  EXPECT_EQ(host.outcomes[1].packet, 1U);
  EXPECT_EQ(host.outcomes[1].begun, at(5));
}

TEST(HostLink, SentAgainUnderTheNextNumberThenGivenUp) {
  HostLinkOptions options{.tries = 3};
  Host host(options);
  host.link.submit(view(kConfig), at(0));
  EXPECT_EQ(host.wrote(), sent(14, kConfig));
  host.link.tick(at(999));
  EXPECT_EQ(host.wrote(), Octets{});
  host.link.tick(at(1000));
  EXPECT_EQ(host.wrote(), sent(15, kConfig));
  host.link.tick(at(2007));
  EXPECT_EQ(host.wrote(), sent(16, kConfig));
  EXPECT_EQ(host.link.next(), at(3007));
  EXPECT_TRUE(host.outcomes.empty());
  host.link.tick(at(3007));
  EXPECT_EQ(host.wrote(), Octets{});
  ASSERT_EQ(host.outcomes.size(), 1U);
  EXPECT_FALSE(host.outcomes[0].confirmed);
  EXPECT_EQ(host.outcomes[0].tries, 3);
  host.take(ack(16), 3008);  // Too late, and for no packet.
  host.link.submit(view(kOther), at(3009));
  EXPECT_EQ(host.wrote(), sent(17, kOther));
  host.take(ack(16), 3010);
  EXPECT_EQ(host.outcomes.size(), 1U);
  host.take(ack(17), 3011);
  ASSERT_EQ(host.outcomes.size(), 2U);
  EXPECT_TRUE(host.outcomes[1].confirmed);
  EXPECT_EQ(host.outcomes[1].strange_acks, 1);
}

TEST(HostLink, TriesByDefaultAsTinyOsHosts) {
  Host host;
  host.link.submit(view(kConfig), at(0));
  int tries = 0;
  while (host.link.next()) {
    tries += !host.wrote().empty();
    host.link.tick(*host.link.next());
  }
  EXPECT_EQ(tries, 25);
  ASSERT_EQ(host.outcomes.size(), 1U);
  EXPECT_EQ(host.outcomes[0].ended, at(25'000));
}

TEST(HostLink, ALateConfirmationOfAnEarlierTryCounts) {
  Host host;
  host.link.submit(view(kConfig), at(0));
  host.wrote();
  host.link.tick(at(1000));
  EXPECT_EQ(host.wrote(), sent(15, kConfig));
  host.take(ack(14), 1001);
  ASSERT_EQ(host.outcomes.size(), 1U);
  EXPECT_TRUE(host.outcomes[0].confirmed);
  EXPECT_EQ(host.outcomes[0].tries, 2);
  host.link.submit(view(kOther), at(1002));  // The second try's is no confirmation of this one.
  EXPECT_EQ(host.wrote(), sent(16, kOther));
  host.take(ack(15), 1003);
  EXPECT_EQ(host.outcomes.size(), 1U);
}

TEST(HostLink, NumbersWrap) {
  Host host;
  for (int i = 0; i < 600; ++i) {
    host.link.submit(view(kConfig), at(i));
    const auto seq = static_cast<std::uint8_t>(14 + i);
    ASSERT_EQ(host.wrote(), sent(seq, kConfig)) << i;
    host.take(ack(static_cast<std::uint8_t>(seq + 1)), i);  // Not sent yet: of 255 before.
    host.take(ack(static_cast<std::uint8_t>(seq - 1)), i);
    ASSERT_EQ(host.outcomes.size(), static_cast<std::size_t>(i));
    host.take(ack(seq), i);
    ASSERT_EQ(host.outcomes.size(), static_cast<std::size_t>(i) + 1);
    EXPECT_EQ(host.outcomes.back().strange_acks, 2);
  }
}

TEST(HostLink, WhatComesIsAnsweredAndGivenUp) {
  Host host;
  host.take({0x00, 0x11, 0x22, 0x33, 0x44}, 0);  // Noise in front.
  host.take(packet_frame(kSerialPacketAck, 0x2a, kConfig), 1);
  EXPECT_EQ(host.wrote(), ack(0x2a));
  host.take(frame({kSerialPacketNoAck, 0x00, 0x01}), 2);
  EXPECT_EQ(host.wrote(), Octets{});
  host.take(frame({0x99, 0x01, 0x02}), 3);
  EXPECT_EQ(host.wrote(), frame({kSerialUnknown, 0x99}));
  host.take(frame({kSerialUnknown, 0x44}), 4);  // No answer to an answer.
  host.take(frame({kSerialAck, 77}), 5);
  Octets bad = packet_frame(kSerialPacketAck, 0x2b, kConfig);
  bad[5] ^= 1;
  host.take(bad, 6);
  EXPECT_EQ(host.wrote(), Octets{});
  EXPECT_EQ(host.kinds, (std::vector<int>{-1, 0x44, 0x45, 0x99, 0xff, 0x43, -1}));
  EXPECT_EQ(host.packets, 2);
}

TEST(HostLink, ListenOnlyWritesNothing) {
  HostLinkOptions options{.listen_only = true};
  Host host(options);
  EXPECT_EQ(host.link.submit(view(kConfig), at(0)), Submitted::kListenOnly);
  host.take(packet_frame(kSerialPacketAck, 0x2a, kConfig), 1);
  host.take(frame({0x99, 0x01, 0x02}), 2);
  EXPECT_EQ(host.wrote(), Octets{});
  EXPECT_EQ(host.packets, 1);
}

TEST(HostLink, WhatIsRefused) {
  HostLinkOptions options{.waiting_max = 2};
  Host host(options);
  EXPECT_EQ(host.link.submit({}, at(0)), Submitted::kBadSize);
  EXPECT_EQ(host.link.submit(view(Octets(253, 0)), at(0)), Submitted::kBadSize);
  EXPECT_EQ(host.link.submit(view(Octets(252, 0x7e)), at(0)), Submitted::kTaken);
  EXPECT_EQ(host.wrote(), sent(14, Octets(252, 0x7e)));
  EXPECT_EQ(host.link.submit(view(kConfig), at(0)), Submitted::kTaken);
  EXPECT_EQ(host.link.submit(view(kConfig), at(0)), Submitted::kTaken);
  EXPECT_EQ(host.link.submit(view(kConfig), at(0)), Submitted::kFull);
  EXPECT_EQ(host.link.taken(), 3U);
  host.take(ack(14), 1);
  EXPECT_EQ(host.link.submit(view(kConfig), at(2)), Submitted::kTaken);
}

// A line that takes nothing for a while gets no second copy, and no endless heap of answers.
TEST(HostLink, ALineThatTakesNothing) {
  Host host;
  host.link.submit(view(kConfig), at(0));
  host.link.tick(at(1000));
  host.link.tick(at(2000));
  EXPECT_EQ(host.link.output().size(), sent(14, kConfig).size());
  host.link.written(3);  // A part of it.
  host.link.tick(at(3000));
  EXPECT_EQ(host.link.output().size(), sent(14, kConfig).size() - 3);
  for (int i = 0; i < 2000; ++i) host.take(packet_frame(kSerialPacketAck, 1, kConfig), 3001);
  EXPECT_LE(host.link.output().size(), HostLink::kOutputMax);
  EXPECT_EQ(host.packets, 2000);
  host.wrote();
  host.link.tick(at(4000));
  EXPECT_EQ(host.wrote(), sent(15, kConfig));
  host.take(ack(14), 4500);
  ASSERT_EQ(host.outcomes.size(), 1U);
  EXPECT_EQ(host.outcomes[0].tries, 2);  // After five turns.
}

TEST(HostLink, ALineThatTakesNothingIsGivenUpInTime) {
  HostLinkOptions options{.tries = 3};
  Host host(options);
  host.link.submit(view(kConfig), at(0));
  host.link.submit(view(kOther), at(0));
  for (int time_ms = 1000; time_ms <= 3000; time_ms += 1000) {
    EXPECT_TRUE(host.outcomes.empty());
    host.link.tick(at(time_ms));
  }
  ASSERT_EQ(host.outcomes.size(), 1U);
  EXPECT_FALSE(host.outcomes[0].confirmed);
  EXPECT_EQ(host.outcomes[0].tries, 1);
  host.take(ack(15), 3001);  // For the next packet.
  ASSERT_EQ(host.outcomes.size(), 2U);
  EXPECT_EQ(host.outcomes[1].tries, 1);
}

TEST(HostLink, TheLineGoes) {
  Host host;
  host.link.submit(view(kConfig), at(0));
  host.link.submit(view(kOther), at(0));
  host.take({0x7e, kSerialPacketNoAck, 0x00}, 1);
  int left = 0;
  auto count = [&](const Packet& packet) { left += packet.error.fault == Fault::kCut; };
  host.link.reset(at(2), count);
  EXPECT_EQ(left, 1);
  ASSERT_EQ(host.outcomes.size(), 2U);
  EXPECT_EQ(host.outcomes[0].tries, 1);
  EXPECT_EQ(host.outcomes[1].tries, 0);
  EXPECT_EQ(host.outcomes[1].packet, 1U);
  EXPECT_FALSE(host.outcomes[0].confirmed || host.outcomes[1].confirmed);
  EXPECT_EQ(host.wrote(), Octets{});
  EXPECT_FALSE(host.link.next());
  host.link.submit(view(kOther), at(3));
  EXPECT_EQ(host.wrote(), sent(15, kOther));
  host.take(ack(15), 4);
  EXPECT_TRUE(host.outcomes.back().confirmed);
}

TEST(HostLink, TheOutcomeMaySubmit) {
  HostLink* which = nullptr;
  int more = 3;
  HostLink link({}, [&](const HostLink::Outcome& outcome) {
    if (more-- > 0) {
      EXPECT_EQ(which->submit(view(kConfig), outcome.ended), Submitted::kTaken);
    }
  });
  which = &link;
  auto nothing = [](const Packet&) {};
  link.submit(view(kConfig), at(0));
  for (std::uint8_t seq = 14; seq < 18; ++seq) {
    EXPECT_EQ(link.pending(), 1U);
    link.take(view(ack(seq)), at(seq), nothing);
  }
  EXPECT_EQ(link.pending(), 0U);
}

// Whatever bytes come when: packets end in order, each once, and no try is beyond the bound.
TEST(HostLink, AnyBytesAnyTimes) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    HostLinkOptions options{.tries = 1 + static_cast<int>(random() % 4),
                            .waiting_max = random() % 5};
    Host host(options);
    int time_ms = 0;
    std::uint8_t last = 13;
    for (int step = 0; step < 200; ++step) {
      time_ms += static_cast<int>(random() % 700);
      switch (random() % 5) {
        case 0: host.link.submit(view(random() % 2 ? kConfig : kOther), at(time_ms)); break;
        case 1: host.link.tick(at(time_ms)); break;
        case 2: {
          const Octets out = host.wrote();
          if (out.size() > 3 && out[1] == kSerialPacketAck) last = out[2];
          break;
        }
        case 3: host.take(ack(static_cast<std::uint8_t>(last + random() % 3 - 1)), time_ms); break;
        default: {
          Octets noise(random() % 40);
          for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(0x40 + random() % 64);
          host.take(noise, time_ms);
        }
      }
      ASSERT_EQ(host.link.next().has_value(), host.link.pending() > 0);
      ASSERT_LE(host.link.pending(), options.waiting_max + 1);
    }
    host.link.reset(at(time_ms));
    ASSERT_EQ(host.outcomes.size(), host.link.taken());
    for (std::size_t i = 0; i < host.outcomes.size(); ++i) {
      ASSERT_EQ(host.outcomes[i].packet, i);
      ASSERT_LE(host.outcomes[i].tries, options.tries);
      ASSERT_LE(host.outcomes[i].begun, host.outcomes[i].ended);
    }
  }
}

}  // namespace
}  // namespace rubric::lines
