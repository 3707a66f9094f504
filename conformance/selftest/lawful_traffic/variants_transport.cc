// Variants of acks, timeouts, sequence numbers and buffers.

#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;

constexpr auto kMockupMessage = static_cast<std::uint8_t>(rubicon::Component::kMockup);
constexpr std::uint16_t kTesterAm = 66;

/// Loses the frames of mote 3 between 3.0 and 3.5 s, when it sends a reliable message.
void lose_a_message(Plan& plan) {
  plan.losses.push_back([](World& world, const RadioFrame& frame, const Device&) {
    return frame.src == 3 && world.now_us() > 3'000'000 && world.now_us() < 3'500'000;
  });
  plan.at(3'100'000, [](World& world) {
    if (!world.mote(1).joined()) return;
    world.mote(1).send(world.base(0).address(), kMockupMessage, {0xA2, 1, 2, 3, 4, 5, 6, 7}, true);
  });
}
void ack_deployed(Plan& plan, Random&) { plan.chats = 25; }
void ack_paper(Plan& plan, Random&) {
  plan.chats = 25;
  plan.traits.ack_form = AckForm::kPaper;
  plan.traits.serial_true_nbytes = true;  // 102 bytes would hide this form.
}
void ack_per_node(Plan& plan, Random&) {
  plan.chats = 25;
  plan.traits.ack_form = AckForm::kPerNode;
  plan.traits.serial_true_nbytes = true;
}
void ack_timeout_short(Plan& plan, Random&) {
  plan.chats = 20;
  plan.foreign_chats = false;
  plan.net_loss_percent = 20;
  lose_a_message(plan);
  plan.traits.ack_timeout_us = 400'000;
  plan.traits.app_resends = 2;
}
void ack_timeout_long(Plan& plan, Random& random) {
  ack_timeout_short(plan, random);
  plan.traits.ack_timeout_us = 3'000'000;
  plan.end_us = 14'000'000;
}
void app_resends_new_seq(Plan& plan, Random&) {
  lose_a_message(plan);
  plan.chats = 25;
  plan.net_loss_percent = 20;
  plan.traits.app_resends = 2;
  plan.end_us = 12'000'000;
}
void app_resends_same_seq(Plan& plan, Random& random) {
  app_resends_new_seq(plan, random);
  plan.traits.resend_same_seq = true;
}
void unknown_app(Plan& plan) {
  const Octets body{1, 2, 3};
  plan.at(3'000'000, [body](World& world) {
    if (!world.mote(0).joined()) return;
    world.base(0).send(world.mote(0).address(), kUnknownApp, body, true);
  });
  plan.at(3'300'000, [body](World& world) {
    if (!world.mote(0).joined()) return;
    world.mote(0).send(world.sink(0).address(), kUnknownApp, body, true);
  });
  plan.at(3'600'000, [body](World& world) {
    if (!world.mote(1).joined()) return;
    world.mote(1).send(world.base(0).address(), kUnknownApp, body, true);
  });
}
void unknown_app_acked(Plan& plan, Random&) { unknown_app(plan); }
void unknown_app_silent(Plan& plan, Random&) {
  plan.traits.ack_unknown_app = false;
  unknown_app(plan);
}

/// Returns a tester's net_msg to mote `index` with the byte at `offset` changed.
Script patched(std::size_t index, std::size_t offset, std::uint8_t value) {
  return [index, offset, value](World& world) {
    NetMessage message;
    message.dest = {world.sink(0).address().pid, world.mote(index).am()};
    message.src = {message.dest.pid, kTesterAm};
    message.seq = static_cast<std::uint16_t>(world.random().between(1, 60'000));
    message.payload =
        app_msg(rubicon::Component::kConnless, kMockupMessage, demo_body(0x0041, 600));
    Octets bytes = encode(message);
    bytes[offset] = value;
    world.outsider(kTesterAm, Role::kTester)
        .send(message.dest.devid, static_cast<std::uint8_t>(AmType::kNet), bytes);
  };
}
void tester_reliable_dropped(Plan& plan, Random&) {
  plan.chats = 0;
  plan.all_well_formed = false;
  plan.at(3'000'000, patched(0, 8, 2));
  plan.at(4'000'000, patched(1, 8, 255));
}
void tester_reliable_taken(Plan& plan, Random& random) {
  tester_reliable_dropped(plan, random);
  plan.traits.odd_reliable = OddReliable::kUnreliable;
}
void tester_nbytes(Plan& plan, Random&) {
  plan.all_well_formed = false;
  const std::uint8_t values[] = {0, 1, 8, 60, 103, 255};
  std::int64_t time = 3'000'000;
  for (const std::uint8_t value : values) {
    plan.at(time, patched(0, 11, value));
    time += 350'000;
  }
}
void host_nbytes(Plan& plan, Random&) {
  plan.all_well_formed = false;
  const std::uint8_t values[] = {0, 1, 103, 255};
  std::int64_t time = 3'000'000;
  for (const std::uint8_t value : values) {
    plan.at(time, [value](World& world) {
      NetMessage message;
      message.dest = {world.sink(0).address().pid, world.mote(0).am()};
      message.src = world.base(0).address();
      message.payload =
          app_msg(rubicon::Component::kConnless, kMockupMessage, demo_body(0x0041, 600));
      Octets bytes = encode(message);
      bytes[11] = value;
      bytes.resize(114);
      world.base(0).raw(static_cast<std::uint8_t>(AmType::kNet), bytes);
    });
    time += 400'000;
  }
}
void seq_random(Plan& plan, Random&) { plan.traits.seq_mode = SeqMode::kRandom; }
void seq_counting(Plan& plan, Random&) { plan.traits.seq_mode = SeqMode::kCounting; }
void seq_near_end(Plan& plan, Random&) { plan.traits.seq_mode = SeqMode::kNearTheEnd; }
void seq_ffff(Plan& plan, Random&) {
  plan.traits.seq_mode = SeqMode::kNearTheEnd;
  plan.traits.uses_ffff = true;
}
void answer_before_ack(Plan& plan, Random&) {
  plan.traits.answer_before_ack = true;
  for (std::int64_t time = 3'000'000; time < 6'000'000; time += 700'000) {
    plan.at(time, [](World& world) {
      Mote& mote = world.mote(world.random().below(world.motes()));
      if (!mote.joined()) return;
      world.base(0).send(mote.address(), kMockupMessage, demo_body(0x0041, 600), true);
    });
  }
}
void message_to_nonmember(Plan& plan, Random&) {
  for (MotePlan& mote : plan.motes) mote.boot_us += 2'000'000;
  plan.traits.app_resends = 1;
  const auto to_mote = [](World& world) {
    const Address dest{world.sink(0).address().pid, world.mote(0).am()};
    world.base(0).send(dest, kMockupMessage, {0xA0, 1}, true);
  };
  plan.at(800'000, to_mote);
  plan.at(2'050'000, [](World& world) {
    const Address all{world.sink(0).address().pid, kAllNodes};
    world.sink(0).send(all, kMockupMessage, {0xA0, 2}, false);
  });
}
void in_full(Plan& plan, Random&) {
  plan.traits.in_buffer = 2;
  plan.traits.delay_min_us = 60'000;
  plan.traits.delay_max_us = 110'000;
  plan.traits.app_resends = 1;
  plan.foreign_chats = false;
  for (const std::int64_t time : {3'000'000, 5'000'000}) {
    plan.at(time, [](World& world) {
      for (std::uint8_t i = 0; i < 5; ++i) {
        for (std::size_t m = 0; m < world.motes(); ++m) {
          if (!world.mote(m).joined()) continue;
          world.mote(m).send(world.sink(0).address(), kMockupMessage, {0xA0, i}, true);
        }
      }
    });
  }
}
void out_full(Plan& plan, Random&) {
  plan.traits.out_buffer = 4;
  for (const std::int64_t time : {3'000'000, 5'000'000}) {
    plan.at(time, [](World& world) {
      if (!world.mote(0).joined()) return;
      for (std::uint8_t i = 0; i < 9; ++i) {
        world.mote(0).send(world.base(0).address(), kMockupMessage, {0xA1, i}, i % 2 == 0);
      }
    });
  }
}

}  // namespace

std::vector<Variant> transport_variants() {
  return {
      mixing("ack_deployed", "acks carry a learning_notification, 4 bytes", {108}, ack_deployed),
      mixing("ack_paper", "acks carry the sequence number alone, 2 bytes", {108}, ack_paper),
      alone("ack_per_node", "some nodes ack in one form, some in the other", {108}, ack_per_node),
      alone("ack_timeout_short", "ack timeout 400 ms; applications send again", {110},
            ack_timeout_short),
      alone("ack_timeout_long", "ack timeout 3 s; applications send again", {110},
            ack_timeout_long),
      mixing("app_resends_new_seq", "applications send failed messages again, as new ones", {111},
             app_resends_new_seq),
      alone("app_resends_same_seq", "applications send failed messages again under the old number",
            {109, 111}, app_resends_same_seq),
      mixing("unknown_app_acked", "reliable messages to an unknown APPID are acked", {111},
             unknown_app_acked),
      mixing("unknown_app_silent", "reliable messages to an unknown APPID are dropped, not acked",
             {111}, unknown_app_silent),
      alone("tester_reliable_dropped", "a tester's messages with reliable 2 and 255 are dropped",
            {112}, tester_reliable_dropped),
      alone("tester_reliable_taken",
            "a tester's messages with reliable 2 and 255 count as unreliable", {112},
            tester_reliable_taken),
      alone("tester_nbytes", "a tester's messages with nbytes that lie are dropped", {113},
            tester_nbytes),
      alone("host_nbytes", "messages from serial with nbytes that lie are dropped", {113},
            host_nbytes),
      alone("seq_random", "random sequence numbers", {117}, seq_random),
      mixing("seq_counting", "counting sequence numbers", {117}, seq_counting),
      mixing("seq_near_end", "counting sequence numbers that step over 0xFFFF", {117},
             seq_near_end),
      weak("seq_ffff", "counting sequence numbers that use 0xFFFF", {117}, seq_ffff),
      mixing("answer_before_ack", "the application's answer leaves before the ack", {125},
             answer_before_ack),
      alone("message_to_nonmember", "messages to motes that have not joined are ignored", {118},
            message_to_nonmember),
      alone("in_full", "bursts at nodes that buffer two messages; what does not fit is dropped",
            {122}, in_full),
      alone("out_full", "bursts at nodes that buffer four messages; send refuses the rest", {122},
            out_full),
  };
}

}  // namespace rubric::lawful
