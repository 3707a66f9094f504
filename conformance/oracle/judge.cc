// The second pass: shows each observation to the parts that judge it.
#include "conformance/oracle/judge.h"

#include <algorithm>

#include "conformance/oracle/links.h"
#include "conformance/oracle/mote_join.h"
#include "conformance/oracle/sink_join.h"

namespace rubric::oracle {
namespace {

using machine::Role;
using Kind = Observation::Kind;

class Judge {
 public:
  Judge(const Run& run, const Options& options)
      : run_(run),
        who_(identify(run, options)),
        findings_(options.deployed),
        context_(run, options, who_, findings_),
        motes_((setup(), context_), who_.devices.size()),
        sinks_(context_) {}

  Report judge() {
    Report report;
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
    motes_.finish(run_.end_us);
    sinks_.finish(run_.end_us);
    report.frames = frames_;
    report.facts = who_.facts;
    if (findings_.dropped() > 0) {
      report.facts.push_back(number(findings_.dropped()) + " more findings are not listed.");
    }
    report.exercised = findings_.exercised();
    report.findings = findings_.take();
    report.verdict = verdict_of(report.findings);
    return report;
  }

 private:
  void setup() {
    context_.sink_am = context_.profile().sink_id;
    std::uint16_t sinks = 0;
    for (std::size_t i = 0; i < who_.devices.size(); ++i) {
      const Device& device = who_.devices[i];
      if (device.role != Role::kSink || !device.known) continue;
      context_.sink_am = device.am;
      context_.only_sink = sinks++ == 0 ? static_cast<std::uint16_t>(i) : kNobody;
    }
    for (const KnownNode& node : context_.options.nodes) {
      if (node.role == Role::kSink) context_.sink_am = node.id;
    }
    for (const Tap& tap : run_.taps) {
      context_.hears_radio = context_.hears_radio || tap.link == machine::Link::kRadio;
    }
  }

  static Verdict verdict_of(const std::vector<Finding>& findings) {
    Severity worst = Severity::kNote;
    for (const Finding& finding : findings) worst = std::max(worst, finding.severity);
    switch (worst) {
      case Severity::kNote:
        return Verdict::kPass;
      case Severity::kWeak:
        return Verdict::kWeak;
      case Severity::kStray:
        return Verdict::kStray;
      case Severity::kInconclusive:
        return Verdict::kInconclusive;
      case Severity::kFail:
        break;
    }
    return Verdict::kFail;
  }

  bool is(std::uint16_t device, Role role) const {
    return device != kNobody && who_.devices[device].known && who_.devices[device].role == role;
  }

  void look(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    const Mark& mark = who_.marks[index];
    switch (seen.kind) {
      case Kind::kRadio:
        ++frames_;
        if (mark.repeat) return;
        if (mark.new_life && is(mark.device, Role::kMote)) motes_.begin_life(mark.device);
        if (mark.new_life && is(mark.device, Role::kSink)) sinks_.begin_life(mark.device);
        radio(index, seen, mark);
        break;
      case Kind::kSerial:
        ++frames_;
        if (mark.device != kNobody) serial(index, seen, mark);
        break;
      case Kind::kCall:
        if (mark.device != kNobody) called(seen, mark.device);
        break;
      case Kind::kNotice:
        if (mark.device != kNobody) told(seen, mark.device);
        break;
      case Kind::kLinkAck:
      case Kind::kDamaged:
        break;
    }
  }

  // Who surely received a frame for the sinks' address.
  std::uint16_t sure_sink(std::uint32_t index) const {
    return context_.only_sink != kNobody && link_acked(run_, index) ? context_.only_sink : kNobody;
  }

  void radio(std::uint32_t index, const Observation& seen, const Mark& mark) {
    if (mark.device != kNobody && !who_.devices[mark.device].known) stranger(seen, mark.device);
    switch (seen.frame.type) {
      case kAmJoin: {
        Request request;
        if (!parse_request(seen.frame.payload, request)) return;
        if (is(mark.device, Role::kMote)) motes_.request(mark.device, seen, request);
        sinks_.request(mark.device, seen, request, sure_sink(index));
        return;
      }
      case kAmJoinReply: {
        Reply reply;
        if (!parse_reply(seen.frame.payload, reply)) return;
        if (is(mark.device, Role::kSink)) sinks_.reply(mark.device, seen, reply);
        for (std::size_t i = 0; i < who_.devices.size(); ++i) {
          const Device& device = who_.devices[i];
          if (device.role != Role::kMote || !device.known || device.am != seen.frame.dest) continue;
          const auto mote = static_cast<std::uint16_t>(i);
          motes_.reply(mote, seen, index, reply, mark.receiver == mote);
        }
        return;
      }
      case kAmAckJoin: {
        AckJoin ack;
        if (!parse_ack_join(seen.frame.payload, ack)) return;
        if (is(mark.device, Role::kMote)) motes_.ack_join(mark.device, seen, ack);
        sinks_.ack_join(mark.device, seen, ack, sure_sink(index));
        return;
      }
      case kAmNet: {
        Net net;
        if (!parse_net(seen.frame.payload, net)) return;
        if (is(mark.device, Role::kMote)) motes_.net_msg(mark.device, seen, net);
        return;
      }
      default:
        return;
    }
  }

  void serial(std::uint32_t, const Observation& seen, const Mark& mark) {
    if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
      const std::uint16_t sink = who_.devices[mark.device].partner;
      sinks_.set_island(sink, static_cast<std::uint16_t>(id), seen.place);
      return;
    }
    if (!seen.to_mote) sinks_.showed_life(mark.device, seen.place.time_us, true);
    Net net;
    SerialJoined joined;
    if (seen.frame.type != kAmNet || !parse_net(seen.frame.payload, net)) return;
    if (!seen.to_mote && parse_serial_joined(net, joined)) {
      sinks_.report(mark.device, seen, net, joined);
    }
  }

  void stranger(const Observation& seen, std::uint16_t device) {
    context_.report(ReqId::kNone, Severity::kStray, seen.place, device,
                    {"A frame from AM address " + number(seen.frame.src) +
                         " whose DSN follows none of that address's.",
                     "Frames of nodes that the run shows.", {}});
  }

  void called(const Observation& seen, std::uint16_t device) {
    if (const auto* join = std::get_if<machine::JoinIsland>(seen.call)) {
      if (is(device, Role::kMote)) motes_.called(device, seen, *join);
    }
  }

  void told(const Observation& seen, std::uint16_t device) {
    if (const auto* joined = std::get_if<machine::Joined>(seen.notice)) {
      if (is(device, Role::kMote)) motes_.told(device, seen, *joined);
    } else if (const auto* mote_joined = std::get_if<machine::MoteJoined>(seen.notice)) {
      if (is(device, Role::kSink)) sinks_.told(device, seen, *mote_joined);
    }
  }

  const Run& run_;
  Identity who_;
  Findings findings_;
  Context context_;
  MoteJoins motes_;
  SinkJoins sinks_;
  std::uint64_t frames_ = 0;
};

}  // namespace

Report judge(const Run& run, const Options& options) { return Judge(run, options).judge(); }

}  // namespace rubric::oracle
