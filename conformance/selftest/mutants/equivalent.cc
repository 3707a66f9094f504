// Mutants that no golden trace finds. Most are equivalent to a correct node: the change is
// allowed, or invisible. The others differ in a way that traces do not judge.
#include <array>

#include "conformance/selftest/mutants/hunt.h"

namespace rubric::mutants {
namespace {

constexpr const char* kSerialAm =
    "TinyOS's serial stack ignores AM addresses, and no rule asks for one there.";
constexpr const char* kSerialNbytes =
    "On the serial line nbytes may count stale bytes after the payload (N6-CONTENT).";
constexpr const char* kFreeNumber = "What awaits no ack may have any number (decision 117).";
constexpr const char* kFailAddress = "No rule says which address joined(FAIL) has.";
constexpr const char* kRefusedId = "No rule says which id a refused creation returns.";
constexpr const char* kWhileOff =
    "Whether send refuses or queues while the interface is off is free, and a trace has no "
    "alternatives: it cannot compare what send then reported with what it did.";
constexpr const char* kRepeats =
    "Whether and how often ack_join is repeated is free, up to a bound (decision 102).";
constexpr const char* kOrigin =
    "Where a sink's clock begins is free, and a second is allowed for (decision 119).";

constexpr bool kNotJudged = false;

constexpr std::array kSurvivors{
    Survivor{"* by serial: am.dest", kSerialAm},
    Survivor{"* by serial: am.src", kSerialAm},
    Survivor{"plus one: J6-REPORT * by serial: nbytes", kSerialNbytes},
    Survivor{"plus one: N6-OWN * by serial: nbytes", kSerialNbytes},
    Survivor{"plus one: N6-* rubicon_ack by serial: nbytes", kSerialNbytes},
    Survivor{"* J6-REPORT net_msg serial_joined by serial: seq_num", kFreeNumber},
    Survivor{"* S*-* synaptic_data by radio: seq_num", kFreeNumber},
    Survivor{"* S*-* synaptic_data by serial: seq_num", kFreeNumber},
    Survivor{"* T2-ACK net_msg rubicon_ack_seq_only by *: seq_num", kFreeNumber},
    Survivor{"double: send N9-SET config", "The same island id a second time changes nothing."},
    Survivor{"plus one: tell J4-CLOCK clock: ms", kOrigin},
    Survivor{"* J3-REPLY join_reply by radio: cur_time", kOrigin},
    Survivor{"* tell J8-FAIL joined: address.*", kFailAddress},
    Survivor{"* tell J8-JOINED joined: address.*", kFailAddress},
    Survivor{"* tell J5-ONCE joined: address.*", kFailAddress},
    Survivor{"delay: tell J5-ONCE joined",
             "No rule says when a call ends that came while another one ran, only how often."},
    Survivor{"plus one: tell N9-OTHER op_result: result",
             "What a call that returns nothing answers says nothing of the node: only what it then "
             "sends is judged."},
    Survivor{"* tell S1-LIMIT channel_result: channel.*", kRefusedId},
    Survivor{"* tell N10-OFF send_result: seq_num", kWhileOff, kNotJudged},
    Survivor{"accept: S6-STOPPED mote channels started",
             "It keeps what comes for a stopped channel, but signals nothing: that is free."},
    Survivor{"double: send J4-ACK ack_join", kRepeats},
    Survivor{"drop: send J4-REPEAT ack_join", kRepeats},
    Survivor{"* N6-OWN net_msg by serial: payload.payload",
             "Stale bytes may follow on the serial line, so that cases compare bodies that can be "
             "told from them, those of demo messages.",
             kNotJudged},
    Survivor{"* tell J11-SEND send_result: seq_num",
             "A mote may keep what is sent before it joins, and tell its number (decision 118). No "
             "trace compares the number with what it then sends.",
             kNotJudged},
};

bool fits(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == name;
  if (name.substr(0, star) != pattern.substr(0, star)) return false;
  for (std::size_t i = star; i <= name.size(); ++i) {
    if (fits(pattern.substr(star + 1), name.substr(i))) return true;
  }
  return false;
}

}  // namespace

std::span<const Survivor> survivors() { return kSurvivors; }

const Survivor* find_survivor(std::string_view name) {
  for (const Survivor& one : kSurvivors) {
    if (fits(one.name, name)) return &one;
  }
  return nullptr;
}

}  // namespace rubric::mutants
