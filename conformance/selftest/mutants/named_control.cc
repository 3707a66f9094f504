// Mistakes with switches, malformed messages and sequence numbers.
#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Send;
using machine::SendResult;
using machine::SetInterface;

// Makes both lines seem to be on for this step.
void as_if_on(Moment& moment) {
  const bool radio = moment.state.radio.on;
  const bool serial = moment.state.serial.on;
  moment.state.radio.on = moment.state.serial.on = true;
  moment.honest();
  if (moment.called<SetInterface>() != nullptr) return;
  moment.state.radio.on = radio;
  moment.state.serial.on = serial;
}

void add_switches(Mutants& out) {
  add(out, "interface_off_still_sends", "An interface that is off sends.", {"N10-OFF"_rule},
      always([](Moment& moment) {
        if (moment.called<Send>() != nullptr) return as_if_on(moment);
        moment.honest();
      }));
  add(out, "interface_off_still_hears", "An interface that is off receives.", {"N10-OFF"_rule},
      always([](Moment& moment) {
        if (moment.heard() != nullptr) return as_if_on(moment);
        moment.honest();
      }));
  add(out, "interface_off_sends_synaptic", "Timers send on a radio that is off.",
      {"N10-OFF"_rule, "N2-QUEUE"_rule}, always([](Moment& moment) {
        if (std::holds_alternative<machine::TimerDue>(moment.event)) return as_if_on(moment);
        moment.honest();
      }));
  add(out, "off_for_good", "An interface that was off never comes on again.", {"N10-ON"_rule},
      always([](Moment& moment) {
        const SetInterface* const set = moment.called<SetInterface>();
        if (set == nullptr || !set->on) return moment.honest();
        moment.answer(machine::OperationResult{true}, "N10-ON"_rule);
      }));
  add(out, "switches_crossed", "Switching the radio off switches the serial line.",
      {"N10-OFF"_rule}, always([](Moment& moment) {
        const SetInterface* const set = moment.called<SetInterface>();
        if (set == nullptr) return moment.honest();
        SetInterface other = *set;
        other.link = set->link == Link::kRadio ? Link::kSerial : Link::kRadio;
        moment.honest(machine::Called{other});
      }));
  add(out, "interface_state_constant", "The state of an interface is reported as on.",
      {"N10-STATE"_rule},
      edit_told<machine::InterfaceState>(
          [](Moment&, machine::InterfaceState& told) { told.on = true; }));
  add(out, "interface_state_inverted", "The state of an interface is reported as its opposite.",
      {"N10-STATE"_rule},
      edit_told<machine::InterfaceState>(
          [](Moment&, machine::InterfaceState& told) { told.on = !told.on; }));
}

// Old memory that holds the rest of a message whose nbytes is too large.
struct Memory {
  std::array<std::uint8_t, machine::kAmPayloadMax> bytes{};
};

void trusts_nbytes(Moment& moment, Memory& memory) {
  const Frame* const frame = moment.heard(am::kNet);
  if (frame == nullptr || frame->payload.size() < 12) return moment.honest();
  const std::size_t size = std::min<std::size_t>(frame->payload.size(), machine::kAmPayloadMax);
  std::copy_n(frame->payload.begin(), size, memory.bytes.begin());
  const std::size_t promised = std::min<std::size_t>(memory.bytes[net::kNbytes], 102);
  Forged& forged = moment.forge(*frame);
  forged.bytes = memory.bytes;
  forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(promised);
  forged.resize(std::max(size, 12 + promised));
  moment.honest(machine::Heard{forged.frame});
}

// A frame on a serial line may be longer than nbytes says.
void add_lengths(Mutants& out) {
  add(out, "serial_cut_at_63",
      "A message of less than 63 bytes is filled up to 63 on the serial line.", {"N11-WHOLE"_rule},
      edit_sent([](Moment&, Transmit& frame) {
        if (frame.link != Link::kSerial || !is_net(frame)) return;
        const int used = 12 + frame.payload[net::kNbytes];
        frame.size_bytes = static_cast<std::uint8_t>(std::max(used, 63));
      }));
  add(out, "short_on_serial_dropped", "A message that is cut short on the serial line is dropped.",
      {"N11-SHORT"_rule}, hear_only([](const Moment&, const Frame& frame) {
        return frame.link != Link::kSerial || !is_net(frame) ||
               frame.payload.size() == machine::kAmPayloadMax;
      }));
  add(out, "whole_on_serial_dropped", "A message with bytes after its nbytes is dropped.",
      {"N7-RADIO"_rule, "N8-DELIVER"_rule, "N7-DELIVER"_rule, "T2-ACK"_rule},
      hear_only([](const Moment&, const Frame& frame) {
        return frame.link != Link::kSerial || !is_net(frame) ||
               frame.payload.size() == 12U + frame.payload[net::kNbytes];
      }));
}

// The last whole frame of a type, in which a node finds what a shorter one lacks.
template <std::uint8_t kType>
void completes(Moment& moment, std::vector<std::uint8_t>& last) {
  const Frame* const frame = moment.heard(kType);
  if (frame == nullptr) return moment.honest();
  const std::size_t size = frame->payload.size();
  if (size >= last.size()) {
    last.assign(frame->payload.begin(), frame->payload.end());
    return moment.honest();
  }
  Forged& forged = moment.forge(*frame);
  std::copy(last.begin() + static_cast<std::ptrdiff_t>(size), last.end(),
            forged.bytes.begin() + static_cast<std::ptrdiff_t>(size));
  forged.resize(last.size());
  moment.honest(machine::Heard{forged.frame});
}
using Last = std::vector<std::uint8_t>;

void add_cut(Mutants& out) {
  add(out, "cut_reply_accepted",
      "A reply that ends before its number is taken for the awaited one.", {"J4-SEQ"_rule},
      edit_heard([](Moment& moment, Forged& forged) {
        constexpr std::size_t kSize = rubicon::JoinReplyView::kMaxSizeBytes;
        if (forged.frame.type != am::kJoinReply || forged.size() >= kSize) return;
        forged.resize(kSize);
        put(forged, join_reply::kMote, moment.state.config.id);
        put(forged, join_reply::kSeqNum, moment.state.join.seq_num);
      }));
  add(out, "cut_request_completed", "A request that ends early is completed from the last one.",
      {"J3-ONCE"_rule}, remembering<Last>(completes<am::kJoin>));
  add(out, "cut_ack_join_completed", "An ack_join that ends early is completed from the last one.",
      {"J6-SEQ"_rule}, remembering<Last>(completes<am::kAckJoin>));
  add(out, "cut_config_completed", "A config that ends early is completed from the last one.",
      {"N9-OTHER"_rule}, remembering<Last>(completes<am::kConfig>));
  add(out, "bytes_after_nbytes_taken", "On the radio a message is as long as its frame.",
      {"T1-DELIVER"_rule, "N6-CONTENT"_rule}, edit_heard([](Moment&, Forged& forged) {
        if (forged.frame.link != Link::kRadio || !is_net(forged.frame)) return;
        const std::size_t size = forged.size() - 12;
        if (size <= 102) forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(size);
      }));
}

// Only the power switch itself; what a reboot keeps.
void add_power(Mutants& out) {
  add(out, "power_ignored", "A node goes on without power.", {"N10-OFF"_rule},
      always([](Moment& moment) {
        if (std::holds_alternative<machine::PowerOff>(moment.event)) return moment.nothing();
        moment.honest();
      }));
  add(out, "members_outlive_the_power", "A sink that starts again knows its members.",
      {"J3-REPLY"_rule},
      remembering<machine::JoinSink>([](Moment& moment, machine::JoinSink& kept) {
        if (!moment.state.off) kept = moment.state.sink;
        moment.honest();
        if (std::holds_alternative<machine::Reboot>(moment.event)) moment.state.sink = kept;
      }));
  add(out, "long_wait_forgotten", "What waits for the channel for two seconds is thrown away.",
      {"N2-QUEUE"_rule, "J3-REPLY"_rule}, remembering<Ticks>([](Moment& moment, Ticks& since) {
        const auto* const busy = std::get_if<machine::LinkBusy>(&moment.event);
        if (busy != nullptr && busy->busy) since = moment.now;
        const bool late = busy != nullptr && !busy->busy && moment.now - since > 2048;
        while (late && !moment.state.radio.out.empty()) moment.state.radio.out.pop();
        moment.honest();
      }));
  add(out, "clock_of_16_bits", "A sink's cur_time has 16 bits.", {"J3-DRIFT"_rule},
      edit_sent(am::kJoinReply, [](Moment&, Transmit& frame) {
        put(frame, join_reply::kTime, get(frame, join_reply::kTime) & 0xFFFF);
      }));
}

void add_malformed(Mutants& out) {
  add(out, "nbytes_trusted", "A node reads as many bytes as nbytes promises.", {"N11-NBYTES"_rule},
      remembering<Memory>(trusts_nbytes));
  add(out, "nbytes_cut_to_what_came", "A node mends an nbytes that promises too much.",
      {"N11-NBYTES"_rule}, edit_heard([](Moment&, Forged& forged) {
        if (forged.frame.type != am::kNet || forged.size() < 14) return;
        const std::size_t came = std::min<std::size_t>(forged.size() - 12, 102);
        std::uint8_t& nbytes = forged.bytes[net::kNbytes];
        if (nbytes > came) nbytes = static_cast<std::uint8_t>(came);
      }));
  add(out, "nbytes_below_2_is_empty", "A message without APPID is taken as an empty one.",
      {"N11-NBYTES"_rule}, edit_heard([](Moment&, Forged& forged) {
        const bool net = forged.frame.type == am::kNet && forged.size() >= 12;
        if (!net || forged.bytes[net::kNbytes] >= 2) return;
        forged.bytes[net::kNbytes] = 2;
        forged.bytes[net::kTransId] = component::kConnless;
        forged.bytes[net::kAppId] = 5;
        forged.resize(14);
      }));
  add(out, "malformed_kills", "After a malformed message a node hears no more.", {"N11-NEXT"_rule},
      remembering<bool>([](Moment& moment, bool& dead) {
        if (dead && moment.heard() != nullptr) return moment.nothing();
        moment.honest();
        for (const Action& action : moment.actions.all()) {
          dead = dead ||
                 (action.what == Action::What::kIgnored && action.requirement == "N11-NBYTES"_rule);
        }
      }));
  add(out, "runt_kills", "After a packet that is no active message a node hears no more.",
      {"N11-NEXT"_rule}, remembering<bool>([](Moment& moment, bool& dead) {
        if (dead && moment.heard() != nullptr) return moment.nothing();
        moment.honest();
        dead = dead || (moment.heard() != nullptr && !moment.heard()->packet.empty());
      }));
  add(out, "malformed_eats_the_next", "The message after a malformed one is lost.",
      {"N11-NEXT"_rule}, remembering<bool>([](Moment& moment, bool& skip) {
        const Frame* const frame = moment.heard(am::kNet);
        const bool good = frame != nullptr && is_net(*frame) &&
                          frame->payload[net::kNbytes] + 12U <= frame->payload.size();
        if (skip && good) {
          skip = false;
          return moment.nothing();
        }
        moment.honest();
        for (const Action& action : moment.actions.all()) {
          skip = skip ||
                 (action.what == Action::What::kIgnored && action.requirement == "N11-NBYTES"_rule);
        }
      }));
  add(out, "longest_message_dropped", "A node takes 101 bytes for the most.",
      {"N11-NEXT"_rule, "T1-DELIVER"_rule}, hear_only([](const Moment&, const Frame& frame) {
        return !is_net(frame) || frame.payload[net::kNbytes] < 102;
      }));
}

// Sets a number for a send: in the message, in the result and among the awaited.
void renumber(Moment& moment, std::uint16_t number) {
  const std::size_t before = moment.state.awaited.size();
  moment.honest();
  if (moment.called<Send>() == nullptr) return;
  auto& awaited = moment.state.awaited;
  if (awaited.size() > before) awaited[awaited.size() - 1].seq_num = number;
  moment.rewrite([&](const Action& action) {
    if (action.what == Action::What::kTransmit) {
      Transmit frame = moment.sent(action);
      if (is_net(frame)) put(frame, net::kSeqNum, number);
      return moment.keep(action, frame);
    }
    if (action.what != Action::What::kNotify) return moment.keep(action);
    Notice notice = moment.notice_of(action);
    auto* const result = std::get_if<SendResult>(&notice);
    if (result != nullptr && result->seq_num != machine::kNoSeq) result->seq_num = number;
    moment.keep(action, notice);
  });
}

// Keeps the lower byte of a number.
std::uint16_t in_8_bits(std::uint16_t number) {
  return number == machine::kNoSeq ? number : static_cast<std::uint16_t>(0x300 | (number & 0xFF));
}

void renumber_in_8_bits(Moment& moment) {
  moment.honest();
  moment.rewrite([&](const Action& action) {
    if (action.what == Action::What::kNotify) {
      Notice notice = moment.notice_of(action);
      if (auto* const result = std::get_if<SendResult>(&notice)) {
        result->seq_num = in_8_bits(result->seq_num);
      }
      return moment.keep(action, notice);
    }
    if (action.what != Action::What::kTransmit) return moment.keep(action);
    Transmit frame = moment.sent(action);
    const bool mine = is_net(frame) && get(frame, net::kSrcDevid) == own(moment).devid;
    if (mine) put(frame, net::kSeqNum, in_8_bits(get(frame, net::kSeqNum)));
    moment.keep(action, frame);
  });
}

void add_numbers(Mutants& out) {
  add(out, "numbers_of_8_bits", "Numbers come again after 256.", {"N12-REUSE"_rule},
      always(renumber_in_8_bits));
  add(out, "sizes_of_8_bits", "send counts the bytes of a body in 8 bits.", {"N1-SIZE"_rule},
      always([](Moment& moment) {
        const Send* const send = moment.called<Send>();
        if (send == nullptr) return moment.honest();
        Send other = *send;
        other.data = Bytes(send->data.data(), send->data.size() & 0xFF);
        moment.honest(machine::Called{other});
      }));
  add(out, "awaited_number_reused", "Every message has number 7.", {"N12-REUSE"_rule},
      always([](Moment& moment) { renumber(moment, 7); }));
  add(out, "number_for_each_destination",
      "Numbers count for each destination, from 1, and collide.", {"N12-REUSE"_rule},
      remembering<std::vector<std::uint16_t>>(
          [](Moment& moment, std::vector<std::uint16_t>& counts) {
            const Send* const send = moment.called<Send>();
            if (send == nullptr) return moment.honest();
            counts.resize(0x10000);
            renumber(moment, ++counts[send->dest.devid]);
          }));
  add(out, "error_value_used", "Messages have number 0xFFFF.", {"N12-ERROR"_rule, "N12-REUSE"_rule},
      always([](Moment& moment) { renumber(moment, machine::kNoSeq); }));
}

}  // namespace

void control_mutants(Mutants& out) {
  add_switches(out);
  add_lengths(out);
  add_cut(out);
  add_power(out);
  add_malformed(out);
  add_numbers(out);
}

}  // namespace rubric::mutants
