// One node reduced to its synaptic part, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "conformance/machine/synaptic.h"

namespace rubric::machine {

inline constexpr Address kSink{11, 1};
inline constexpr Address kOwn{11, 2};
inline constexpr Address kPeer{11, 5};
inline constexpr ChannelId kToSink = 0x0002'0001;
inline constexpr ChannelId kFromPeer = 0x0005'0002;
inline constexpr ChannelId kLocal = 0x0002'0002;

struct Signal {
  ChannelId id;
  DataStatus status;
  friend bool operator==(const Signal&, const Signal&) = default;
};

/// Starts as mote 2 of island 11 at time 1000.
class SynapticTest : public testing::Test {
 protected:
  SynapticTest() { config_.id = kOwn.devid; }

  bool call(const Call& call) {
    actions_.clear();
    call_synaptic(synaptic_, config_, own_, now_, call, actions_);
    EXPECT_TRUE(actions_.transmits().empty());
    EXPECT_EQ(actions_.notices().size(), 1U);
    const Notice& notice = actions_.notices()[0];
    if (const auto* made = std::get_if<ChannelResult>(&notice)) {
      id_ = made->id;
      return made->success;
    }
    if (const auto* read = std::get_if<InputValue>(&notice)) {
      bits_ = bits_of_float(read->value);
      return read->success;
    }
    return std::get<OperationResult>(notice).success;
  }
  ReqId rule() const { return actions_.all().back().requirement; }
  bool create_out(std::uint8_t size, Mode mode = Mode::kReliable, Address peer = kSink) {
    return call(CreateChannel{Direction::kOut, peer, size, mode});
  }
  bool create_in(std::uint8_t size, Address peer = kPeer) {
    return call(CreateChannel{Direction::kIn, peer, size, Mode::kReliable});
  }
  bool write(ChannelId id, std::uint8_t pos, float value) {
    return call(WriteOutput{id, pos, value});
  }
  std::uint32_t read_bits(ChannelId id, std::uint8_t pos) {
    EXPECT_TRUE(call(ReadInput{id, pos}));
    return bits_;
  }
  // Lets the clock tick when it is due.
  std::vector<Signal> tick() {
    EXPECT_NE(synaptic_.due, 0U);
    now_ = synaptic_.due;
    sends_.clear();
    actions_.clear();
    tick_synaptic(synaptic_, own_, now_, sends_, actions_);
    std::vector<Signal> signals;
    for (const Notice& notice : actions_.notices()) {
      const auto& told = std::get<SynDataReceived>(notice);
      signals.push_back({told.id, told.status});
    }
    return signals;
  }
  void hear(Address src, const std::vector<std::uint32_t>& values, std::size_t cut_bytes = 0) {
    std::vector<std::uint8_t> bytes(values.size() * 4);
    for (std::size_t i = 0; i < values.size(); ++i) store_le32(bytes.data() + 4 * i, values[i]);
    actions_.clear();
    hear_synaptic(synaptic_, own_, src, Bytes(bytes.data(), bytes.size() - cut_bytes), actions_);
  }

  Config config_;
  Address own_ = kOwn;
  Synaptic synaptic_;
  Ticks now_ = 1000;
  Actions actions_;
  SynapticSends sends_;
  ChannelId id_ = 0;
  std::uint32_t bits_ = 0;
};

}  // namespace rubric::machine
