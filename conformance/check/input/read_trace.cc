#include "conformance/check/input/read_trace.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "conformance/check/storage.h"
#include "conformance/trace/each_line.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"

namespace rubric::check {
namespace {

using trace::Line;
using trace::LinkKind;
using trace::Op;

machine::Role role_of(trace::Role role) {
  switch (role) {
    case trace::Role::kMote: return machine::Role::kMote;
    case trace::Role::kSink: return machine::Role::kSink;
    case trace::Role::kBaseStation: break;
  }
  return machine::Role::kBaseStation;
}

class LogReader {
 public:
  LogReader(const trace::File& file, Run& run)
      : run_(run), scope_(trace::scope_of(file, file.cases.front())) {
    const bool marked = std::ranges::any_of(scope_.nodes, &trace::NodeHeader::iut);
    trace::Statement stated;  // By those under test.
    for (const trace::NodeHeader& header : scope_.nodes) {
      if (header.iut) stated = joined(std::move(stated), header.stated);
    }
    first_ = run_.nodes.size();
    for (const trace::NodeHeader& header : scope_.nodes) {
      LoggedNode node;
      node.name = header.name;
      node.file = static_cast<std::uint32_t>(run_.files.size() - 1);
      node.role = role_of(header.role);
      node.id = header.id.value_or(0);
      node.island = header.island.value_or(kNoIsland);
      node.under_test = !marked || header.iut;
      node.stated = header.stated;
      // Whom the trace plays is taken for the like of those under test, as the runner does.
      if (!header.iut) node.stated = joined(std::move(node.stated), stated);
      node.whole = header.whole;
      run_.nodes.push_back(std::move(node));
    }
    run_.marked = run_.marked || marked;
    whole_ = std::ranges::any_of(scope_.nodes, &trace::NodeHeader::whole);
    for (std::size_t i = 0; i < run_.nodes.size(); ++i) index(i);
  }

  void read(const Line& line) {
    note(line);
    take(line);
  }

  void finish() {
    bool applications = false;
    for (std::size_t i = first_; i < run_.nodes.size(); ++i) {
      LoggedNode& node = run_.nodes[i];
      if (node.whole) {
        node.logged = node.application = node.hearing = true;
        node.peis = node.role == machine::Role::kBaseStation;
      }
      applications = applications || node.application;
    }
    drop_others();
    // If a log has applications, a node with radio input has its application as well, even if that
    // was never called.
    for (LoggedNode& node : run_.nodes) {
      node.application = node.application || (applications && node.hearing);
    }
  }

 private:
  using Busy = std::pair<std::size_t, std::optional<machine::Link>>;

  // Returns the places in the run of the nodes of this name, also those of other logs.
  const std::vector<std::size_t>& named(const std::string& name) const {
    static const std::vector<std::size_t> none;
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? none : found->second;
  }

  // Another log of a node may have begun what this one ends.
  void index(std::size_t i) {
    const LoggedNode& node = run_.nodes[i];
    by_name_[node.name].push_back(i);
    for (std::size_t at = 0; at < node.busy.size(); ++at) {
      if (node.busy[at].to_us == INT64_MAX) busy_[{i, node.busy[at].line}] = at;
    }
  }

  // Notes what the log has of the line's node.
  void note(const Line& line) {
    const std::optional<LinkKind> link = scope_.link(line.link);
    for (const std::size_t i : named(line.node)) {
      if (i < first_) continue;
      LoggedNode& node = run_.nodes[i];
      node.logged = true;
      node.application = node.application || link == LinkKind::kApp;
      node.hearing =
          node.hearing || (hears_by(node.role, link) && line.op == Op::kGiven && !is_state(line));
      node.peis = node.peis || link == LinkKind::kPeis;
    }
  }

  // A node that only a header names is that of the log which has lines of it, if there is one.
  void drop_others() {
    std::vector<LoggedNode> kept;
    for (LoggedNode& node : run_.nodes) {
      const auto better = [&](std::size_t i) {
        const LoggedNode& other = run_.nodes[i];
        return other.logged > node.logged || (&other < &node && !node.logged);
      };
      if (std::ranges::none_of(named(node.name), better)) kept.push_back(std::move(node));
    }
    run_.nodes = std::move(kept);
  }

  // Returns whether the line is about the link itself, not a frame.
  static bool is_state(const Line& line) {
    const std::string& name = line.message.name;
    return name == "linkack" || name == "busy" || name == "idle";
  }

  static bool hears_by(machine::Role role, std::optional<LinkKind> link) {
    if (role != machine::Role::kBaseStation) return link == LinkKind::kRadio;
    return link == LinkKind::kSerial || link == LinkKind::kPeis;
  }

  std::int64_t time_of(const Line& line) {
    if (!line.time.from_terms.empty()) {
      throw trace::TraceError(line.place, "a log has times in ticks, not " + print(line.time));
    }
    std::int64_t ticks = line.time.from;
    if (line.time.base == trace::Time::Base::kPrevious) ticks += last_ticks_;
    if (line.time.base == trace::Time::Base::kLabel) ticks += labels_[line.time.label];
    last_ticks_ = ticks;
    if (!line.label.empty()) labels_[line.label] = ticks;
    return us_of(ticks);
  }

  std::int64_t us_of(std::int64_t ticks) const {
    const std::int64_t per_second = trace::ticks_per_second(scope_.tick);
    return ticks / per_second * 1'000'000 + ticks % per_second * 1'000'000 / per_second;
  }

  void take(const Line& line) {
    const std::int64_t time_us = time_of(line);
    if (whole_ && line.op == Op::kMustNot && line.time.base == trace::Time::Base::kStart) {
      run_.watched_until_us = std::max(run_.watched_until_us, us_of(line.time.to + 1));
    }
    if (line.op != Op::kGiven && line.op != Op::kEmits) return;
    if (line.op == Op::kGiven) take_state(line, time_us);
    const std::optional<LinkKind> kind = scope_.link(line.link);
    if (!kind || line.node == "*") return;
    Observation seen;
    seen.place.file = static_cast<std::uint32_t>(run_.files.size() - 1);
    seen.place.frame = ++frames_;
    seen.place.offset_bytes = line.place.line;
    seen.place.time_us = time_us;
    seen.node = run_.storage->keep(std::string_view(line.node));
    seen.received = line.op == Op::kGiven;
    const bool frames = *kind != LinkKind::kApp && *kind != LinkKind::kPower;
    if (seen.received && *kind != LinkKind::kPower && without_power_.contains(line.node)) return;
    if (frames && !is_state(line)) {
      take_frame(line, *kind, seen);
    } else if (*kind == LinkKind::kApp || *kind == LinkKind::kPower) {
      take_news(line, *kind, seen);
    }
  }

  void take_state(const Line& line, std::int64_t time_us) {
    if (line.message.name == "linkack") return take_link_ack(line, time_us);
    const bool busy = line.message.name == "busy";
    const std::optional<LinkKind> kind = scope_.link(line.link);
    if ((!busy && line.message.name != "idle") || !kind) return;
    const std::optional<machine::Link> link = events::to_link(*kind);
    end_busy(line.node, link, time_us);
    if (!busy) return;
    for (const std::size_t i : named(line.node)) {
      std::vector<BusyTime>& its = run_.nodes[i].busy;
      busy_[{i, link}] = its.size();
      its.push_back({time_us, INT64_MAX, link});
    }
  }

  // Ends what is still busy of a node: a line, or its application.
  void end_busy(const std::string& name, std::optional<machine::Link> line, std::int64_t time_us) {
    for (const std::size_t i : named(name)) {
      const auto since = busy_.find({i, line});
      if (since == busy_.end()) continue;
      run_.nodes[i].busy[since->second].to_us = time_us;
      busy_.erase(since);
    }
  }

  void take_link_ack(const Line& line, std::int64_t time_us) {
    const auto acked = [](const trace::FieldValue& field) {
      return field.path == "acked" && field.value.number == 1;
    };
    const bool fails = std::ranges::none_of(line.message.fields, acked);
    for (const std::size_t i : named(line.node)) {
      LoggedNode& node = run_.nodes[i];
      (fails ? node.link_failures_us : node.link_acks_us).push_back(time_us);
    }
  }

  void take_frame(const Line& line, LinkKind kind, Observation& seen) {
    const trace::AmFrame frame = trace::frame_of(line, scope_);
    if (!frame.packet.empty()) return;  // No active message, so that no rule is about it.
    const bool radio = kind == LinkKind::kRadio;
    seen.frame.link = events::to_link(kind).value_or(machine::Link::kSerial);
    const bool peis = kind == LinkKind::kPeis;
    seen.kind = radio  ? Observation::Kind::kRadio
                : peis ? Observation::Kind::kPeis
                       : Observation::Kind::kSerial;
    seen.frame.dest = frame.dest;
    seen.frame.src = frame.src;
    seen.frame.type = frame.type;
    seen.frame.payload = run_.storage->keep(Bytes(frame.payload.data(), frame.payload.size()));
    seen.tap = tap_of(line.link, seen.frame.link);
    const auto is_sink = [&](std::size_t i) {
      return i >= first_ && run_.nodes[i].role == machine::Role::kSink;
    };
    const bool sink = std::ranges::any_of(named(line.node), is_sink);
    // The line was given to a sink, or sent by its host.
    if (kind == LinkKind::kSerial) seen.to_mote = sink == seen.received;
    run_.seen.push_back(seen);
  }

  std::uint32_t tap_of(const std::string& name, machine::Link link) {
    const auto found = taps_.find(name);
    if (found != taps_.end()) return found->second;
    const auto made = static_cast<std::uint32_t>(run_.taps.size());
    run_.taps.push_back({name, link, true});
    taps_[name] = made;
    return made;
  }

  void take_news(const Line& line, LinkKind kind, Observation& seen) {
    const auto message = std::make_shared<const trace::Concrete>(trace::concrete(line.message));
    seen.tap = tap_of("app", machine::Link::kRadio);
    RunStorage& storage = *run_.storage;
    if (const auto state = events::to_state(*message, kind)) {
      const bool reboot = std::holds_alternative<machine::Reboot>(*state);
      if (!reboot && !std::holds_alternative<machine::PowerOff>(*state)) return;
      if (reboot) without_power_.erase(line.node);
      if (!reboot) without_power_.insert(line.node);
      end_busy(line.node, std::nullopt, seen.place.time_us);  // The application begins anew.
      seen.kind = Observation::Kind::kReboot;
      seen.received = false;
    } else if (const auto call = events::to_call(*message); call && seen.received) {
      seen.kind = Observation::Kind::kCall;
      seen.received = false;
      seen.call = &storage.calls.emplace_back(*call);
      storage.owned.push_back(message);
    } else if (const auto notice = events::to_notice(*message); notice && !seen.received) {
      seen.kind = Observation::Kind::kNotice;
      seen.notice = &storage.notices.emplace_back(*notice);
      storage.owned.push_back(message);
    } else {
      return;
    }
    run_.seen.push_back(seen);
  }

  Run& run_;
  trace::Scope scope_;
  std::size_t first_ = 0;  // Of the run's nodes: the log's first.
  bool whole_ = false;     // A node of the log is.
  std::unordered_map<std::string, std::vector<std::size_t>> by_name_;
  std::map<Busy, std::size_t> busy_;  // By node and line: the place of what has not ended.
  std::map<std::string, std::int64_t> labels_;
  std::map<std::string, std::uint32_t> taps_;
  std::set<std::string> without_power_;
  std::int64_t last_ticks_ = 0;
  std::uint64_t frames_ = 0;
};

}  // namespace

bool looks_like_trace(std::string_view bytes) {
  if (bytes.starts_with(trace::kByteOrderMark)) bytes.remove_prefix(trace::kByteOrderMark.size());
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    std::string_view line = bytes.substr(0, end);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.empty() && line.front() != '#' && line.front() != ';') {
      return line.substr(0, 4) == "%rtr";
    }
    if (end == std::string_view::npos) return false;
    bytes.remove_prefix(end + 1);
  }
  return false;
}

bool read_trace(const std::string& name, std::string_view text, Run& run, std::string& error) {
  // Its writer may have been stopped within a line.
  const std::string_view whole_lines = text.substr(0, text.rfind('\n') + 1);
  const auto check = [&](std::string_view part) {
    return trace::each_line(part, name, [](const trace::File&, const Line&) {});
  };
  if (whole_lines.size() != text.size() && !check(text).ok()) {
    const trace::Parsed parsed = check(whole_lines);
    const bool cut = parsed.ok() && !parsed.file.cases.empty();
    run.cut = run.cut || cut;
    if (cut) text = whole_lines;
  }
  std::optional<LogReader> reader;
  std::string broken;
  const auto read = [&](const trace::File& file, const Line& line) {
    if (file.cases.size() != 1 || !broken.empty()) return;
    try {
      if (!reader) reader.emplace(file, run);
      reader->read(line);
    } catch (const trace::TraceError& wrong) {
      broken = name + ":" + std::to_string(wrong.place().line) + ": " + wrong.what();
    }
  };
  const trace::Parsed parsed = trace::each_line(text, name, read);
  if (!parsed.ok()) {
    error = parsed.errors();
  } else if (parsed.file.cases.size() != 1) {
    error = name + ": has " + std::to_string(parsed.file.cases.size()) +
            " cases; a log of a run has one";
  } else if (!broken.empty()) {
    error = broken;
  } else {
    if (!reader) reader.emplace(parsed.file, run);
    reader->finish();
    return true;
  }
  return false;
}

}  // namespace rubric::check
