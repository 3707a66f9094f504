#include "conformance/test/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "codec/reflect/requirements.h"
#include "conformance/report/sequence_svg.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/print.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using machine::Action;
using report::kNoColumn;
using report::SequenceRow;
using trace::Line;
using trace::Op;
using trace::Value;

// The machine, recording its reaction to each stimulus.
class Watched : public runner::SubjectTarget {
 public:
  explicit Watched(std::vector<Reaction>& reactions)
      : SubjectTarget(std::make_unique<runner::Machine>()), reactions_(reactions) {}

  void give(runner::Ticks now, const machine::Event& event) override {
    while (run_until(now) < now) {  // Earlier output is no reaction to this.
    }
    const std::size_t before = labels().size();
    SubjectTarget::give(now, event);
    Reaction reaction;
    bool acted = false;
    for (std::size_t i = before; i < labels().size(); ++i) {
      const Action& action = labels()[i];
      if (action.what == Action::What::kIgnored) {
        reaction.is_ignored = true;
        reaction.ignored.push_back(action.requirement);
      } else if (action.what == Action::What::kFollowed) {
        acted = true;
        reaction.followed.push_back(action.requirement);
      } else {
        acted = true;
      }
    }
    reaction.is_ignored = reaction.is_ignored && !acted;
    reactions_.push_back(std::move(reaction));
  }

 private:
  std::vector<Reaction>& reactions_;
};

std::string tail_of(const std::string& path) { return path.substr(path.rfind('.') + 1); }

std::string text_at(const trace::Message& message, std::string_view path) {
  const Value* value = message.find(path);
  return value == nullptr ? std::string() : trace::value_text(*value);
}

std::string cut(std::string text, std::size_t length_max) {
  if (text.size() > length_max) {
    text.resize(length_max - 3);
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) {
      text.pop_back();
    }
    text += "...";
  }
  return text;
}

std::string net_msg_text(const trace::Message& message) {
  const std::string ends = text_at(message, "src") + "->" + text_at(message, "dest");
  if (text_at(message, "payload.trans_id") == "rubicon_ack") {
    return fmt::format("{} {}", short_text(message), ends);
  }
  const std::string app = text_at(message, "payload.app_id");
  const std::string seq = text_at(message, "seq_num");
  return fmt::format("net_msg {}{}{}{}", ends, seq == "0" ? "" : " seq " + seq,
                     text_at(message, "reliable") == "1" ? " reliable" : "",
                     app.empty() ? "" : " " + app);
}

// Returns "joined(11:5 success)": names and addresses are shown without their fields.
std::string fields_text(const trace::Message& message) {
  std::string out;
  for (const trace::FieldValue& field : message.fields) {
    const Value::Kind kind = field.value.kind;
    const bool plain = kind == Value::Kind::kNames || kind == Value::Kind::kAddress ||
                       kind == Value::Kind::kChannel || kind == Value::Kind::kText;
    if (!out.empty()) out += ' ';
    if (!plain) out += tail_of(field.path) + "=";
    out += trace::value_text(field.value);
  }
  return message.name + (out.empty() ? "" : "(" + out + ")");
}

// `is_frame`: what stands for a frame though it has no addresses.
SequenceRow::Way way_of(const Line& line, const CaseRun& one, bool is_frame) {
  using Way = SequenceRow::Way;
  trace::Scope scope{.nodes = one.nodes, .links = one.links};
  if (!is_frame)
    return line.link == "app" && line.message.name != "busy" && line.message.name != "idle"
               ? Way::kCall
               : Way::kState;
  switch (scope.link(line.link).value_or(trace::LinkKind::kAny)) {
    case trace::LinkKind::kSerial: return Way::kSerial;
    case trace::LinkKind::kPeis: return Way::kPeis;
    default: return Way::kRadio;
  }
}

std::string full_text(const Line& line) {
  Line copy = line;
  copy.bytes.reset();
  std::string out;
  trace::put_line(copy, out);
  const std::size_t begin = out.find_first_not_of(' ');
  return begin == out.npos ? out : out.substr(begin);
}

// Returns the rules, each once.
std::string rules_text(const std::vector<ReqId>& rules) {
  std::string out;
  std::set<ReqId, reflect::CatalogueOrder> seen{ReqId::kNone};
  for (const ReqId rule : rules) {
    if (!seen.insert(rule).second) continue;
    out += (out.empty() ? "" : ", ") + std::string(trace::requirement_text(rule));
  }
  return out;
}

// The names of the nodes that a line is from and for.
std::set<std::string> ends_of(const CaseRun& one, const Line& line) {
  std::set<std::string> out = {line.node};
  for (const std::size_t i : peers_of(one.nodes, line)) out.insert(one.nodes[i].name);
  return out;
}

void add_note(std::string& note, const std::string& more) {
  if (more.empty()) return;
  note += (note.empty() ? "" : ", ") + more;
}

/// Makes the rows of a log, in its order.
class Chart {
 public:
  Chart(const CaseRun& one, const Reactions& reactions, Stage::Apps apps = Stage::Apps::kAlone)
      : one_(one),
        reactions_(reactions),
        stage_(one, apps),
        log_(one.result.log.read()),
        lines_(log_.lines()) {}

  report::Sequence take(bool with_failures = false) {
    const std::vector<std::size_t> before = first_seen(lines_, true);
    find_reactions();
    find_links();
    rows_of_.assign(lines_.size(), kNoLine);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (before[i] == kNoLine) {
        add(i);
      } else {
        heard(i, rows_of_[before[i]]);
      }
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) complete(i);
    if (with_failures) {
      for (const runner::Failure& failure : one_.result.failures) mark(failure);
    }
    report::Sequence out{.columns = stage_.names(),
                         .about = stage_.about(),
                         .number_title = "tick",
                         .rows = std::move(rows_)};
    drop_idle_columns(out);
    return out;
  }

 private:
  void find_reactions() {
    std::map<std::string, std::size_t, std::less<>> next;
    reaction_of_.assign(lines_.size(), nullptr);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i]->op != Op::kGiven) continue;
      const auto found = reactions_.find(lines_[i]->node);
      if (found == reactions_.end()) continue;
      const std::size_t at = next[lines_[i]->node]++;
      if (at < found->second.size()) reaction_of_[i] = &found->second[at];
    }
  }

  // Finds the links that each node under test uses.
  void find_links() {
    for (const Line* line : lines_) {
      if (line->am) on_link_[line->link].insert(stage_.column(line->node));
    }
  }

  void add(std::size_t i) {
    const Line& line = *lines_[i];
    SequenceRow row = stage_.row(line);
    row.number = std::to_string(line.time.from);
    row.detail = key_text(line.message, report::kSvgLabelMax);
    row.full = full_text(line);
    row.way = way_of(line, one_, static_cast<bool>(line.am));
    if (row.way == SequenceRow::Way::kRadio && row.from == kNoColumn) {
      row.detail += " (from " + trace::value_text(line.am->source) + ")";
    } else if (row.way == SequenceRow::Way::kRadio && row.to.empty()) {
      row.detail += " (to " + trace::value_text(line.am->dest) + ")";
    }
    row.lines = {i};
    row.stimulus = line.op == Op::kGiven;
    for (const std::string& rule : line.requirements) add_note(row.note, rule);
    rows_of_[i] = rows_.size();
    rows_.push_back(std::move(row));
    takers_.emplace_back();
    if (line.op == Op::kGiven) {
      takers_.back().push_back(i);
    } else if (line.am) {
      split_hearers(rows_.back());
    }
  }

  // Splits hearers: nodes under test hear what they are given, and nothing else.
  void split_hearers(SequenceRow& row) const {
    const Line& line = *lines_[row.lines.front()];
    std::vector<std::size_t> stay;
    for (const std::size_t column : row.to) {
      const bool tested = std::any_of(one_.nodes.begin(), one_.nodes.end(), [&](const auto& node) {
        return node.iut && stage_.column(node.name) == column;
      });
      const auto on_link = on_link_.find(line.link);
      if (!tested) {
        stay.push_back(column);
      } else if (on_link != on_link_.end() && on_link->second.contains(column)) {
        row.missed.push_back(column);
      }
    }
    row.to = std::move(stay);
  }

  void heard(std::size_t i, std::size_t at) {
    SequenceRow& row = rows_[at];
    const std::size_t column = stage_.column(lines_[i]->node);
    row.lines.push_back(i);
    std::erase(row.missed, column);
    if (std::find(row.to.begin(), row.to.end(), column) == row.to.end()) row.to.push_back(column);
    rows_of_[i] = at;
    takers_[at].push_back(i);
  }

  // Adds the reactions of those who received it.
  void complete(std::size_t at) {
    SequenceRow& row = rows_[at];
    for (const std::size_t i : takers_[at]) {
      const Reaction* reaction = reaction_of_[i];
      if (reaction == nullptr) continue;
      add_note(row.note, rules_text(reaction->followed));
      if (reaction->ignored.empty()) continue;
      if (reaction->is_ignored) row.ignored_by.push_back(stage_.column(lines_[i]->node));
      const std::string rules = rules_text(reaction->ignored);
      const std::string who = row.to.size() > 1 ? " by " + lines_[i]->node : "";
      add_note(row.note, "ignored" + who + (rules.empty() ? "" : ": " + rules));
    }
    for (const std::size_t column : row.missed) {
      add_note(row.note, "not heard by " + stage_.names()[column]);
    }
  }

  void mark(const runner::Failure& failure) {
    const auto breaks = [&](std::size_t line) { return is_broken_by(failure, *lines_[line]); };
    const auto broken = std::find_if(rows_.begin(), rows_.end(), [&](const SequenceRow& row) {
      return std::any_of(row.lines.begin(), row.lines.end(), breaks);
    });
    if (broken != rows_.end()) {
      point_at(*broken);
      return;
    }
    SequenceRow row;
    const std::optional<Line> asked = asked_line(failure);
    if (asked) {
      row = stage_.row(*asked);
      row.missed = std::move(row.to);
      row.to.clear();
      row.way = way_of(*asked, one_, asked->link != "app");
    }
    row.absent = true;
    row.number = std::to_string(failure.to);
    row.detail = asked ? "no " + short_text(asked->message) : "it broke";
    row.detail += elsewhere_text(failure);
    point_at(row);
    const auto next = std::find_if(rows_.begin(), rows_.end(), [&](const SequenceRow& other) {
      return std::stoull(other.number) > failure.to;
    });
    rows_.insert(next, std::move(row));
  }

  static void point_at(SequenceRow& row) {
    if (!row.marked) row.detail = "\u25c0 " + row.detail;
    row.marked = true;
  }

  static void drop_idle_columns(report::Sequence& sequence) {
    std::set<std::size_t> used;
    for (const SequenceRow& row : sequence.rows) {
      used.insert(row.from);
      used.insert(row.to.begin(), row.to.end());
      used.insert(row.missed.begin(), row.missed.end());
    }
    std::vector<std::size_t> place(sequence.columns.size(), kNoColumn);
    std::vector<std::string> names;
    std::vector<std::string> about;
    for (std::size_t c = 0; c < sequence.columns.size(); ++c) {
      if (!used.contains(c)) continue;
      place[c] = names.size();
      names.push_back(sequence.columns[c]);
      about.push_back(sequence.about[c]);
    }
    for (SequenceRow& row : sequence.rows) {
      if (row.from != kNoColumn) row.from = place[row.from];
      for (std::size_t& c : row.to) c = place[c];
      for (std::size_t& c : row.missed) c = place[c];
      for (std::size_t& c : row.ignored_by) c = place[c];
    }
    sequence.columns = std::move(names);
    sequence.about = std::move(about);
  }

  const CaseRun& one_;
  const Reactions& reactions_;
  const Stage stage_;
  const trace::Case log_;
  const std::vector<const Line*> lines_;
  std::vector<const Reaction*> reaction_of_;
  std::map<std::string, std::set<std::size_t>, std::less<>> on_link_;
  std::vector<std::size_t> rows_of_;
  std::vector<SequenceRow> rows_;
  std::vector<std::vector<std::size_t>> takers_;  // For each row: lines that were given.
};

}  // namespace

MachineRun run_on_machine(const SuiteCase& one) {
  MachineRun out{.run = one.blank()};
  out.run.result =
      runner::run_case(one.file->file, one.whole(),
                       [&](const trace::NodeHeader& node) -> std::unique_ptr<runner::Target> {
                         return std::make_unique<Watched>(out.reactions[node.name]);
                       });
  return out;
}

Stage::Stage(const CaseRun& one, Apps apps) : nodes_(one.nodes) {
  if (apps == Apps::kAll) {
    for (const trace::NodeHeader& node : nodes_) {
      const bool mote = node.role == trace::Role::kMote;
      const std::size_t first = names_.size();
      apps_[first + mote] = first + !mote;
      names_.insert(names_.end(), 2, "application");
      names_[first + mote] = node.name;
    }
    return;
  }
  const auto tested = std::count_if(nodes_.begin(), nodes_.end(),
                                    [](const trace::NodeHeader& node) { return node.iut; });
  if (tested == 1) {
    names_.emplace_back("app");
    apps_[1] = 0;
  }
  for (const bool under_test : {true, false}) {  // The others beside whom they talk to.
    for (const trace::NodeHeader& node : nodes_) {
      if (node.iut == under_test) names_.push_back(node.name);
    }
  }
}

std::size_t Stage::column(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  return found == names_.end() ? kNoColumn : static_cast<std::size_t>(found - names_.begin());
}

SequenceRow Stage::row(const Line& line) const {
  SequenceRow row{.label = short_text(line.message)};
  const std::size_t node = column(line.node);
  const bool given = line.op == Op::kGiven;
  const bool frame{line.am};
  std::vector<std::size_t> peers;
  if (frame) {
    for (const std::size_t i : peers_of(nodes_, line)) peers.push_back(column(nodes_[i].name));
  } else if (const auto app = apps_.find(node); line.link == "app" && app != apps_.end()) {
    peers = {app->second};
  }
  if (!given) {
    row.from = node;
    row.to = peers;
    row.sent = frame;
  } else {
    if (peers.size() == 1) row.from = peers.front();
    if (node != kNoColumn) row.to = {node};
  }
  return row;
}

std::vector<std::string> Stage::about() const {
  std::vector<std::string> out;
  for (const std::string& name : names_) {
    std::string words;
    for (const trace::NodeHeader& node : nodes_) {
      if (node.name != name) continue;
      words = trace::role_text(node.role);
      std::replace(words.begin(), words.end(), '_', ' ');
      if (node.island) words += fmt::format(" {}", *node.island);
      if (node.id) words += fmt::format("{}{}", node.island ? ":" : " ", *node.id);
    }
    out.push_back(std::move(words));
  }
  return out;
}

std::string key_text(const trace::Message& message, std::size_t length_max) {
  const std::string& name = message.name;
  const std::string seq = text_at(message, "seq_num");
  std::string out;
  if (name == "join_request" && !seq.empty()) {
    out = fmt::format("{} seq {}", name, seq);
  } else if (name == "join_reply" && !seq.empty()) {
    out = fmt::format("{} {}:{} seq {}", name, text_at(message, "island_addr"),
                      text_at(message, "mote_addr"), seq);
  } else if (name == "ack_join" && !seq.empty()) {
    out = fmt::format("{} {}->{} seq {}", name, text_at(message, "src"), text_at(message, "dest"),
                      seq);
  } else if (name == "net_msg" && !seq.empty()) {
    out = net_msg_text(message);
  } else {
    out = fields_text(message);
  }
  return cut(std::move(out), length_max);
}

report::Sequence chart(const CaseRun& one, const Reactions& reactions) {
  return Chart(one, reactions).take();
}

report::Sequence failure_chart(const CaseRun& one) { return Chart(one, {}).take(true); }

std::optional<report::Sequence> join_chart(const CaseRun& one) {
  constexpr std::int64_t kNoticeTicks = 600;  // A sink reports the mote so long after its ack.
  static const std::set<std::string> kWords = {"join",     "join_request", "join_reply",
                                               "ack_join", "joined",       "mote_joined"};
  const trace::Case log = one.result.log.read();
  const std::vector<const Line*> lines = log.lines();
  const auto ack = std::find_if(lines.begin(), lines.end(), [](const Line* line) {
    return line->message.name == "ack_join" && line->op == Op::kEmits && line->am;
  });
  if (ack == lines.end()) return std::nullopt;
  const std::string& mote = (*ack)->node;
  std::set<std::string> party;  // The mote and the sinks that answer it.
  bool asked = false;
  for (const Line* line : lines) {
    const std::set<std::string> ends = ends_of(one, *line);
    if (!ends.contains(mote)) continue;
    asked = asked || line->message.name == "join_request";
    if (line->message.name == "join_reply") party.insert(ends.begin(), ends.end());
  }
  if (!asked || party.empty()) return std::nullopt;
  CaseRun figure = one;
  figure.result.log = {};
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    const std::string& word = (*line)->message.name;
    if ((*line)->time.from > (*ack)->time.from + kNoticeTicks) break;
    const bool shown =
        (*line)->am ? ends_of(one, **line).contains(mote) : party.contains((*line)->node);
    if (!kWords.contains(word) || !shown) continue;
    figure.result.log.add(**line);
    if (line > ack && word == "mote_joined") break;
  }
  return Chart(figure, {}, Stage::Apps::kAll).take();
}

}  // namespace rubric::suite
