#include "conformance/selftest/scripts/difference.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "codec/generated/rubicon/net_msg.h"
#include "conformance/machine/messages.h"
#include "conformance/selftest/scripts/cpp_target.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/encode.h"

namespace rubric::script {
namespace {

using machine::Link;
using runner::Output;
using trace::FieldValue;
using trace::Line;
using trace::Message;
using trace::Value;
namespace am = machine::am;

constexpr std::size_t kOutputsMax = 4000;  // A clock of a tick could fill any memory.

FieldValue* field(Line& line, std::string_view path) {
  for (FieldValue& one : line.message.fields) {
    if (one.path == path) return &one;
  }
  return nullptr;
}

void free_field(Line& line, std::string_view path) {
  if (FieldValue* found = field(line, path)) found->value = Value::any();
}

// Lets a clock be a millisecond off, by how it rounds.
void loosen(FieldValue* found) {
  if (!found || !found->value.is(Value::Kind::kNumber)) return;
  const std::int64_t ms = found->value.number;
  constexpr std::int64_t kMax = 0xFFFFFFFF;
  found->value = Value::range(std::max<std::int64_t>(ms - 1, 0), std::min(ms + 1, kMax));
}

// Replaces the node's own numbers, which it chooses freely, by variables, one for each.
class Numbers {
 public:
  /// Returns the variable for this number, whose first use binds it.
  Value chosen(std::uint16_t number) {
    auto [at, fresh] = names_.try_emplace(number);
    if (fresh) at->second = "q" + std::to_string(++count_);
    return Value::variable(at->second);
  }
  /// Returns its variable; nothing if the node has not used the number.
  std::optional<Value> known(std::uint16_t number) const {
    const auto at = names_.find(number);
    if (at == names_.end()) return {};
    return Value::variable(at->second);
  }

 private:
  std::map<std::uint16_t, std::string> names_;
  int count_ = 0;
};

bool is_forwarded(const Output& output, const std::set<std::uint16_t>& sent) {
  for (const ReqId rule :
       {"N6-FORWARD"_rule, "N6-ROUTE"_rule, "N7-RADIO"_rule, "N8-INCOMING"_rule}) {
    if (output.requirement == rule) return true;
  }
  if (output.requirement != "N8-PEIS"_rule) return false;
  const auto message = rubicon::NetMsgView::parse(output.frame.bytes());
  return !message || !sent.contains(message->seq_num()) ||
         machine::address_of(message->src()).devid != machine::kNullDevid;
}

bool same(const Output& a, const Output& b) {
  if (a.time != b.time || a.is_frame != b.is_frame) return false;
  if (!a.is_frame) return line_of(a, "").message == line_of(b, "").message;
  return a.frame.link == b.frame.link && a.frame.type == b.frame.type &&
         a.frame.dest == b.frame.dest && a.frame.src == b.frame.src &&
         equal(a.frame.bytes(), b.frame.bytes());
}
bool same(const std::vector<Output>& a, const std::vector<Output>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Output& x, const Output& y) { return same(x, y); });
}

class Lenient {
 public:
  Lenient(const Script& script, const Played& played)
      : script_(script), played_(played), node_(node_of(script).name) {
    for (const Output& output : played.outputs) {
      const auto* sent = std::get_if<machine::SendResult>(&output.notice);
      if (!output.is_frame && sent) sent_.insert(sent->seq_num);
    }
  }

  trace::File file(const Title& title) {
    trace::File file = begin_file(script_);
    trace::Case one(title.case_name);
    for (const std::string& text : title.comments) {
      one.items.emplace_back(trace::Comment{';', false, " " + text});
    }
    one.add(nothing_else(script_.length(), node_, title.rules));
    Ticks now = 0;
    for (std::size_t i = 0; i < played_.before.size(); ++i) {
      show(played_.before[i], one);
      now += script_.steps[i].delay;
      one.add(given(script_.steps[i], now));
      const bool frame = std::holds_alternative<machine::Heard>(script_.steps[i].event);
      heard_at_ = frame ? std::optional<Ticks>(now) : std::nullopt;
    }
    show(played_.outputs.size(), one);
    file.cases.push_back(std::move(one));
    return file;
  }

 private:
  void show(std::size_t to, trace::Case& one) {
    for (; shown_ < to; ++shown_) one.add(expected(played_.outputs[shown_]));
  }

  Line expected(const Output& output) {
    Line line = line_of(output, node_);
    line.bytes.reset();
    line.message.open = output.is_frame;
    if (output.is_frame) {
      loosen_frame(output, line);
    } else {
      loosen_notice(output.notice, line);
    }
    return line;
  }

  void loosen_frame(const Output& output, Line& line) {
    const std::uint8_t type = output.frame.type;
    if (output.frame.link == Link::kSerial) line.am.reset();  // Not compared (FACTS 2).
    if (type == am::kJoinReply) {
      // A reply that waited for the radio may have the time of its request.
      if (output.time != heard_at_) free_field(line, "cur_time");
      loosen(field(line, "cur_time"));
    }
    if (type == am::kJoin || type == am::kAckJoin) variable(line, "seq_num");
    if (type != am::kNet) return;
    if (is_forwarded(output, sent_)) {
      FieldValue* acked = field(line, "payload.body.seq_num");
      const bool changed = acked && answered_.contains(acked->value.number);
      if (changed) variable(line, "payload.body.seq_num");
    } else if (output.requirement == "T2-ACK"_rule || output.requirement == "S2-SEND"_rule ||
               output.requirement == "S3-CHANGED"_rule || output.requirement == "J6-REPORT"_rule) {
      free_field(line, "seq_num");
      // An ack holds the number alone, or a code as well (decision 108).
      FieldValue* const nbytes = field(line, "nbytes");
      if (nbytes && output.requirement == "T2-ACK"_rule) nbytes->value = Value::range(4, 6);
    } else {
      variable(line, "seq_num");
    }
  }

  void variable(Line& line, std::string_view path) {
    FieldValue* found = field(line, path);
    if (!found || !found->value.is(Value::Kind::kNumber)) return;
    found->value = numbers_.chosen(static_cast<std::uint16_t>(found->value.number));
  }

  void loosen_notice(const machine::Notice& notice, Line& line) {
    if (const auto* sent = std::get_if<machine::SendResult>(&notice)) {
      if (sent->seq_num == machine::kNoSeq) return;
      variable(line, "seq_num");
    } else if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) {
      if (ack->success && not_well_.contains(ack->seq_num)) free_field(line, "result");
      variable(line, "seq_num");
    } else if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
      if (!joined->success) free_field(line, "address");
    } else if (const auto* made = std::get_if<machine::ChannelResult>(&notice)) {
      if (!made->success) free_field(line, "channel");
    } else if (const auto* value = std::get_if<machine::InputValue>(&notice)) {
      if (!value->success) free_field(line, "value");
    } else if (std::holds_alternative<machine::Clock>(notice)) {
      loosen(field(line, "ms"));
    }
  }

  // Returns the line of a step; a frame that answers the node has the number that the node chose.
  Line given(const Step& step, Ticks now) {
    Line line = line_of(step, now, node_);
    // Success and failure are both right for it (decision 108).
    const FieldValue* code = field(line, "payload.body.ack");
    const FieldValue* acked = field(line, "payload.body.seq_num");
    if (code && acked && code->value.number != 0) {
      not_well_.insert(static_cast<std::uint16_t>(acked->value.number));
    }
    for (const std::string_view path : {"seq_num", "payload.body.seq_num"}) {
      FieldValue* found = field(line, path);
      const bool answers = line.message.name == "join_reply" || path != "seq_num";
      if (!found || !answers || !found->value.is(Value::Kind::kNumber)) continue;
      const auto known = numbers_.known(static_cast<std::uint16_t>(found->value.number));
      if (!known || !is_whole(line)) continue;
      answered_.insert(found->value.number);
      found->value = *known;
      line.bytes.reset();
    }
    return line;
  }

  // Returns whether the fields of a frame's line cover all its bytes, except for left-over ones at
  // the end.
  bool is_whole(Line line) const try {
    trace::AmFrame exact = trace::frame_of(line, {});
    line.bytes.reset();
    trace::AmFrame said = trace::frame_of(line, {});
    if (exact.payload.size() < said.payload.size()) return false;
    const std::size_t content = trace::encode(line.message).payload.size();
    exact.payload.resize(content);
    said.payload.resize(content);
    return said == exact;
  } catch (const trace::TraceError&) {
    return false;  // Its nbytes counts left-over bytes as well.
  }

  const Script& script_;
  const Played& played_;
  std::string node_;
  Numbers numbers_;
  std::set<std::uint16_t> sent_;      // Numbers that send returned,
  std::set<std::uint16_t> not_well_;  // and that were acked with a code other than 0.
  std::set<std::int64_t> answered_;   // Numbers for which a given frame has their variable.
  std::size_t shown_ = 0;
  std::optional<Ticks> heard_at_;  // If the last step was a frame.
};

}  // namespace

trace::File lenient_file(const Script& script, const Played& played, const Title& title) {
  return Lenient(script, played).file(title);
}

Difference difference(const Script& script, flaws::StepFunction step) {
  const Script compared = without_guesses(until_free(without_undecided(script), step), step);
  runner::SubjectTarget reference(std::make_unique<runner::Machine>(step));
  const Played played = play(compared, reference);
  Difference out;
  out.steps = compared.steps.size();
  if (played.outputs.size() > kOutputsMax) return out;
  const auto other = cpp_target();
  if (same(played.outputs, play(compared, *other).outputs)) return out;  // Mostly, and fast.
  out.file = lenient_file(compared, played, {"repro.difference", {}, {}});
  const runner::CaseResult result = runner::run_case(
      out.file, out.file.cases[0], [](const trace::NodeHeader&) { return cpp_target(); });
  if (result.verdict == runner::CaseVerdict::kPass) return out;
  if (result.verdict == runner::CaseVerdict::kWeak) return out;
  out.text = result.failures.empty() ? result.reason : runner::explain(result, "difference");
  return out;
}

}  // namespace rubric::script
