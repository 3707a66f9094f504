#include "conformance/trace/check.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "codec/reflect/requirements.h"
#include "codec/reflect/suggest.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/each_line.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/ends.h"
#include "conformance/trace/headers.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/trace.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

using Report = std::function<void(Place, std::string)>;
/// Variables of the case that some line before this one has bound.
using BoundNames = std::unordered_set<std::string>;

// Returns what is wrong with a value for a slot, or nothing.

std::string leaf_misfit(const Value& value, const Domain& domain) {
  const bool number = domain.kind == Domain::Kind::kNumber;
  bool fits = false;
  switch (value.kind) {
    case Value::Kind::kAny:
    case Value::Kind::kVariable: return {};
    case Value::Kind::kNumber:
      fits = domain.kind == Domain::Kind::kReal ||
             (number && value.number >= domain.min && value.number <= domain.max);
      break;
    case Value::Kind::kRange:
      fits = number &&
             (!value.text.empty() || (value.number >= domain.min && value.max <= domain.max));
      break;
    case Value::Kind::kReal: fits = domain.kind == Domain::Kind::kReal; break;
    case Value::Kind::kNames: fits = number && domain.number_of(value.text).has_value(); break;
    case Value::Kind::kBytes:
    case Value::Kind::kText: fits = domain.kind == Domain::Kind::kBytes; break;
    default: break;
  }
  if (fits) return {};
  return "expected " + domain.expectation() + ", given '" + value_text(value) + "'";
}

std::string pair_misfit(const Value& value, Value::Kind wanted, const Domain& first,
                        const char* example) {
  if (value.is(Value::Kind::kAny) || value.is(Value::Kind::kVariable)) return {};
  if (!value.is(wanted)) return std::string("expected ") + example;
  const std::string problem = leaf_misfit(value.items[0], first);
  return problem.empty() ? leaf_misfit(value.items[1], Domain::devid()) : problem;
}

std::string list_misfit(const Value& value, const Domain& domain) {
  if (value.is(Value::Kind::kAny) || value.is(Value::Kind::kVariable)) return {};
  if (!value.is(Value::Kind::kList)) return "expected a list, as [1 2]";
  for (const Value& item : value.items) {
    const std::string problem = leaf_misfit(item, domain);
    if (!problem.empty()) return problem;
  }
  return {};
}

std::string misfit(const Value& value, const Slot& slot) {
  switch (slot.kind) {
    case Slot::Kind::kLeaf: return leaf_misfit(value, slot.domain);
    case Slot::Kind::kAddress:
      return pair_misfit(value, Value::Kind::kAddress, Domain::pid(), "an address, as 11:5");
    case Slot::Kind::kChannel:
      return pair_misfit(value, Value::Kind::kChannel, Domain::devid(), "a channel, as 2->1");
    case Slot::Kind::kList: return list_misfit(value, slot.domain);
    case Slot::Kind::kStruct:
      if (value.is(Value::Kind::kBytes) || value.is(Value::Kind::kText) ||
          value.is(Value::Kind::kAny) || value.is(Value::Kind::kVariable)) {
        return {};
      }
      return "it has fields: expected bytes (x0a0b), or the fields one by one";
  }
  return {};
}

class MessageCheck {
 public:
  MessageCheck(const Line& line, LinkKind link, BoundNames& bound, const Report& report)
      : line_(line), link_(link), bound_(bound), report_(report) {}

  void run() {
    const Message& message = line_.message;
    if (is_fault(line_.op) && (link_ == LinkKind::kApp || link_ == LinkKind::kPower)) {
      return fail(line_.place, "nothing is lost or doubled on " + quoted(line_.link));
    }
    am();
    if (message.name == "*") {
      any();
    } else if (const Shape* shape = Schema::get().find(message.name)) {
      named(*shape);
    } else {
      std::vector<std::string> known;
      for (const auto& [name, one] : Schema::get().shapes()) known.push_back(name);
      fail(message.place,
           "unknown message " + quoted(message.name) + reflect::did_you_mean(message.name, known));
    }
    if (!failed_) bytes();
    for (std::string& name : binds_) bound_.insert(std::move(name));
  }

 private:
  void fail(Place place, const std::string& text) {
    failed_ = true;
    report_(place.line ? place : line_.place, text);
  }

  bool given() const { return line_.op == Op::kGiven; }
  /// Returns whether fields are required; with bytes they are not.
  bool must_be_whole() const { return given() && !line_.bytes; }

  void any() {
    if (given() && !(line_.bytes && link_ == LinkKind::kSerial)) {
      fail(line_.message.place, "expected what to give to the node, given '*'");
    }
    if (line_.message.form != Message::Form::kBare) {
      fail(line_.message.place, "'*' is any message and has no fields");
    }
  }

  void am() {
    if (!line_.am) return;
    if (link_ == LinkKind::kApp || link_ == LinkKind::kPower) {
      return fail(line_.place, "there are no AM addresses on " + quoted(line_.link));
    }
    for (const Value* side : {&line_.am->source, &line_.am->dest}) {
      const std::string problem = leaf_misfit(*side, Domain::devid());
      if (!problem.empty()) fail(line_.place, "am: " + problem);
      if (side->is(Value::Kind::kAny) && must_be_whole()) {
        fail(line_.place, "am: expected an address, given '*'");
      }
      variables(*side, line_.place);
    }
  }

  void named(const Shape& shape) {
    const Message& message = line_.message;
    if (!shape.travels(link_)) {
      return fail(message.place,
                  quoted(message.name) + " does not travel on " + quoted(line_.link));
    }
    direction(shape);
    if (message.form != Message::Form::kFields) {
      if (shape.has_fields() && must_be_whole()) {
        fail(message.place, "the fields of what is given are missing: " + message.name + "(...)");
      }
      return;
    }
    std::vector<FieldValue> whole;
    whole.reserve(message.fields.size());
    std::size_t position = 0;
    for (const FieldValue& one : message.fields) {
      try {
        whole.push_back(with_path(one, shape, position));
      } catch (const TraceError& error) {
        fail(error.place(), error.what());
        continue;
      }
      field(whole, shape);
    }
    if (failed_) return;
    missing(whole, shape);
    const bool closed = !message.open && line_.op == Op::kEmits && !line_.bytes;
    if (!failed_ && shape.type && (closed || must_be_whole())) possible();
  }

  void possible() {
    try {
      check_possible(line_.message);
    } catch (const TraceError& error) {
      fail(error.place(), error.what());
    }
  }

  void direction(const Shape& shape) {
    if (!shape.app || shape.app->what == AppWhat::kFrame) return;
    const bool event = shape.app->what == AppWhat::kEvent;
    if (event == !given() && !is_fault(line_.op)) return;
    const char* text = event ? " comes from a node: expected >, given "
                             : " is given to a node: expected <, given ";
    fail(line_.message.place, quoted(shape.name) + text + std::string(op_text(line_.op)));
  }

  void field(const std::vector<FieldValue>& whole, const Shape& shape) {
    const FieldValue& one = whole.back();
    for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
      const std::string& other = whole[i].path;
      const auto within = [](const std::string& part, const std::string& of) {
        return part.size() > of.size() && part.starts_with(of) &&
               (part[of.size()] == '.' || part[of.size()] == '[');
      };
      if (other == one.path || within(other, one.path) || within(one.path, other)) {
        fail(one.place, "field " + quoted(one.path) + " is given twice");
      }
    }
    const Shape::Alternatives& slots = *shape.find(one.path);
    std::string problem = misfit(one.value, slots[0]);
    for (std::size_t i = 1; i < slots.size() && !problem.empty(); ++i) {
      if (misfit(one.value, slots[i]).empty()) problem.clear();
    }
    if (!problem.empty()) return fail(one.place, one.path + ": " + problem);
    if (must_be_whole()) single(one.value, one.place);
    variables(one.value, one.place);
  }

  // Checks that a stimulus has single values.
  void single(const Value& value, Place place) {
    if (value.is(Value::Kind::kAny)) fail(place, "expected a value, given '*'");
    const bool number = !value.text.empty() && value.number == value.max;
    if (value.is(Value::Kind::kRange) && !number) fail(place, "expected a value, given a range");
    for (const Value& item : value.items) single(item, place);
  }

  void variables(const Value& value, Place place) {
    for (const Value& item : value.items) variables(item, place);
    const bool range = value.is(Value::Kind::kRange) && !value.text.empty();
    const bool judged = !must_be_whole() || value.number == value.max;
    if (range && judged && !bound_.contains(value.text)) {
      fail(place, "no line above binds $" + value.text);
    }
    if (!value.is(Value::Kind::kVariable) || bound_.contains(value.text)) return;
    const bool here = std::find(binds_.begin(), binds_.end(), value.text) != binds_.end();
    if (here) return;
    if (value.negated || must_be_whole() || line_.op == Op::kMustNot || line_.op == Op::kMay) {
      fail(place, "no line above binds $" + value.text);
    } else {
      binds_.push_back(value.text);
    }
  }

  // Reports missing fields; messages of an application have one form, so these are known.
  void missing(const std::vector<FieldValue>& whole, const Shape& shape) {
    if (!shape.app || line_.message.open || is_fault(line_.op)) return;
    for (const AppField& field : shape.app->fields) {
      if (field.derived) continue;
      const bool there = std::any_of(whole.begin(), whole.end(), [&](const FieldValue& one) {
        return one.path.substr(0, one.path.find('.')) == field.name;
      });
      if (!there) {
        fail(line_.message.place, "field " + quoted(field.name) + " of " + shape.name +
                                      " is neither given nor left free by '...'");
      }
    }
  }

  void bytes() {
    if (!line_.bytes) return;
    AmFrame frame;
    if (link_ == LinkKind::kApp || link_ == LinkKind::kPower) {
      return fail(line_.place, "there are no frames on " + quoted(line_.link));
    }
    if (!parse_packet(*line_.bytes, frame)) {
      if (given() && line_.message.name == "*") return;  // A packet that is no active message.
      return fail(line_.place,
                  "the bytes are no packet: 00, AM destination, source, length, "
                  "group, type, and as many bytes as length says");
    }
    Bindings bindings;
    // A variable's value is known only when the case runs.
    Line line{.op = line_.op, .am = line_.am, .message = line_.message};
    const auto soften = [](Value& value) {
      const bool range = value.is(Value::Kind::kRange) && !value.text.empty();
      if (range || value.is(Value::Kind::kVariable)) value = Value::any();
    };
    for (FieldValue& one : line.message.fields) {
      for (Value& item : one.value.items) soften(item);
      soften(one.value);
    }
    if (line.am) {
      soften(line.am->source);
      soften(line.am->dest);
    }
    if (const Match found = match(line, decode(frame, link_), bindings); !found) {
      fail(line_.message.place, "the bytes say something else: " + found.text());
    }
  }

  const Line& line_;
  LinkKind link_;
  BoundNames& bound_;
  const Report& report_;
  std::vector<std::string> binds_;
  bool failed_ = false;
};

/// Reports errors, and adds the variables that the line binds.
void check_message(const Line& line, LinkKind link, BoundNames& bound, const Report& report) {
  MessageCheck(line, link, bound, report).run();
}

/// Returns the ids and families ("J4" of "J4-SEQ") of the catalogue.
const std::unordered_set<std::string>& known_requirements() {
  static const std::unordered_set<std::string> known = [] {
    std::unordered_set<std::string> all;
    for (const reflect::Requirement& one : reflect::requirements().subspan(1)) {
      const std::string id = one.id;
      all.insert(id);
      all.insert(id.substr(0, id.find('-')));
    }
    return all;
  }();
  return known;
}

// The headers of a file or a case.
struct Said {
  bool version = false, profile = false, tick = false, seed = false, values = false;
  std::unordered_set<std::string> nodes, links;
};

// The case that is read.
struct Now {
  const Case* one = nullptr;
  Said said;
  bool lines = false;
  const Ends* ends = nullptr;  // Once they were asked for.
  std::optional<Ends> own;     // Unless those of the head are its.
  std::unordered_map<std::string, Place> labels;
  BoundNames bound{kSeeded};
  std::int64_t latest = 0;
};

class FileCheck : public Listener {
 public:
  FileCheck(const File& file, const Report& report) : file_(file), report_(report) {}

  void run() {
    for (const Case& one : file_.cases) {
      begin(one);
      for (const Item& item : one.items) {
        if (const auto* its = item.as<Header>()) header(*its);
        if (const auto* its = item.as<Line>()) line(*its);
      }
    }
    finish();
  }

  void begin(const Case& one) override {
    finish();
    now_.emplace().one = &one;
    const auto [at, fresh] = names_.emplace(one.name, one.place);
    if (!fresh) {
      report_(one.place, "case " + quoted(one.name) + " is already in line " +
                             std::to_string(at->second.line));
    }
  }

  void header(const Header& one) override {
    if (std::holds_alternative<VersionHeader>(one.what) ||
        std::holds_alternative<TickHeader>(one.what)) {
      report_(one.place, "%rtr and %tick come before the first case");
    } else if (now_->lines && !std::holds_alternative<NoteHeader>(one.what)) {
      report_(one.place, "the headers of a case come before its lines");
    }
    check_header(one, now_->said);
  }

  void line(const Line& one) override {
    now_->lines = true;
    check_time(one, now_->labels, now_->latest);
    check_line(one, ends(), now_->bound);
  }

  /// Ends the case, or the head if none has begun.
  void finish() {
    if (!std::exchange(headed_, true)) head();
    if (now_) link_nodes(now_->one->items, ends());
    now_.reset();
  }

 private:
  void once(bool& said, const Header& header, const char* what) {
    if (std::exchange(said, true)) report_(header.place, std::string(what) + " is given twice");
  }

  void head() {
    Said said;
    for (const Item& item : file_.head) {
      const auto* header = item.as<Header>();
      if (!header) continue;
      const bool version = std::holds_alternative<VersionHeader>(header->what);
      if (!said.version && !version && !first_) {
        report_(header->place, "the first header must be %rtr 1");
      }
      first_ = true;
      check_header(*header, said);
    }
    if (!said.version && !first_) report_({1, 1}, "expected %rtr 1 at the beginning");
    of_head_.emplace(file_, Case());
    link_nodes(file_.head, *of_head_);
  }

  void check_header(const Header& header, Said& said) {
    if (std::holds_alternative<VersionHeader>(header.what)) once(said.version, header, "%rtr");
    if (std::holds_alternative<ProfileHeader>(header.what)) once(said.profile, header, "%profile");
    if (std::holds_alternative<TickHeader>(header.what)) once(said.tick, header, "%tick");
    if (std::holds_alternative<SeedHeader>(header.what)) once(said.seed, header, "%seed");
    if (std::holds_alternative<ForHeader>(header.what)) once(said.values, header, "%for");
    if (const auto* node = std::get_if<NodeHeader>(&header.what)) {
      if (!said.nodes.insert(node->name).second) {
        report_(header.place, "node " + quoted(node->name) + " is given twice");
      }
      check_node(*node, header.place);
    }
    if (const auto* link = std::get_if<LinkHeader>(&header.what)) {
      if (!said.links.insert(link->name).second) {
        report_(header.place, "link " + quoted(link->name) + " is given twice");
      }
      if (link->name == "app" || link->name == "power") {
        report_(header.place, quoted(link->name) + " is not a name for a link between nodes");
      }
    }
  }

  void check_node(const NodeHeader& node, Place place) {
    const RoleInfo& role = role_info(node.role);
    std::string name = "a " + role.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (!node.id && role.has_id) report_(place, "node " + quoted(node.name) + " needs id=");
    if (!node.island && role.has_island) {
      report_(place, "node " + quoted(node.name) + " needs island=");
    }
    if (node.island && !role.has_island) {
      report_(place, name + " has no island of its own: " + quoted(node.name) + " joins one");
    }
    if (node.id && !role.has_id) report_(place, name + " has no TinyOS id");
    if (protocol().has_machine && node.role == Role::kBaseStation &&
        find(node.stated, ParameterId::kChannels)) {
      report_(place, "a base station has no synaptic channels");
    }
  }

  void link_nodes(const std::vector<Item>& items, const Ends& ends) {
    for (const Item& item : items) {
      const auto* header = item.as<Header>();
      const auto* link = header ? std::get_if<LinkHeader>(&header->what) : nullptr;
      if (!link) continue;
      for (const std::string& node : link->nodes) {
        if (!ends.node(node)) {
          report_(header->place,
                  "no %node " + quoted(node) + ", which %link " + link->name + " names");
        }
      }
    }
  }

  void check_time(const Line& line, std::unordered_map<std::string, Place>& labels,
                  std::int64_t& latest) {
    const Time& time = line.time;
    if (time.base == Time::Base::kLabel && !labels.contains(time.label)) {
      report_(line.place, "no line above has the label " + quoted(time.label));
    }
    if (time.base == Time::Base::kStart && time.exact()) {
      if (time.from_terms.empty() && time.from < latest) {
        report_(line.place,
                "time goes back, from @" + std::to_string(latest) + " to " + print(time));
      }
      if (time.from_terms.empty()) latest = std::max(latest, time.from);
    }
    if (line.op == Op::kGiven && !time.exact() && time.base != Time::Base::kStart) {
      report_(line.place, "a window where something is given at one time: " + print(time));
    }
    if (line.label.empty()) return;
    if (find_parameter(line.label)) {
      report_(line.place, "label " + quoted(line.label) + " is the name of a parameter");
    }
    if (line.op == Op::kMustNot) {
      report_(line.place, "label " + quoted(line.label) + " at what does not happen");
    }
    if (line.op == Op::kMay) {
      report_(line.place, "label " + quoted(line.label) + " at what need not happen");
    }
    const auto [at, fresh] = labels.emplace(line.label, line.place);
    if (!fresh) {
      report_(line.place, "label " + quoted(line.label) + " is already in line " +
                              std::to_string(at->second.line));
    }
  }

  void check_line(const Line& line, const Ends& ends, BoundNames& bound) {
    for (const std::string& one : line.requirements) {
      if (!known_requirements().contains(one)) {
        report_(line.place, "no requirement " + quoted(one) + " in the catalogue");
      }
    }
    const std::optional<LinkKind> link = ends.link(line.link);
    if (!link) {
      report_(line.place, "unknown link " + quoted(line.link) +
                              ": r... is a radio, ser... a serial line, else peis, app, power or "
                              "what %link names");
      return;
    }
    if (!is_fault(line.op)) check_ends(line, *link, ends);
    if (line.op == Op::kGiven && *link == LinkKind::kAny) {
      report_(line.place, "'*' says nothing of the link by which it is given");
    }
    check_message(line, *link, bound, report_);
  }

  void check_ends(const Line& line, LinkKind link, const Ends& ends) {
    if (line.node == "*") {
      if (line.op == Op::kGiven) report_(line.place, "'*' says nothing of who is given it");
      return;
    }
    const NodeHeader* node = ends.node(line.node);
    if (!node) return report_(line.place, "no %node " + quoted(line.node));
    const RoleInfo& role = role_info(node->role);
    const bool has = link == LinkKind::kApp || link == LinkKind::kPower || link == LinkKind::kAny ||
                     (link == LinkKind::kRadio && role.radio) ||
                     (link == LinkKind::kSerial && role.serial) ||
                     (link == LinkKind::kPeis && role.peis);
    if (!has) {
      report_(line.place, "a " + std::string(role_text(node->role)) + " is not on " +
                              quoted(line.link) + ", which is " + std::string(link_text(link)));
    }
    if (!ends.is_on(line.node, line.link)) {
      report_(line.place, quoted(line.node) + " is not on the link " + quoted(line.link));
    }
  }

  const Ends& ends() {
    if (now_->ends) return *now_->ends;
    const std::vector<Item>& items = now_->one->items;
    const bool own = states<NodeHeader>(items) || states<LinkHeader>(items);
    now_->ends = own ? &now_->own.emplace(file_, *now_->one) : &*of_head_;
    return *now_->ends;
  }

  const File& file_;
  const Report& report_;
  std::optional<Ends> of_head_;
  std::unordered_map<std::string, Place> names_;
  std::optional<Now> now_;
  bool headed_ = false;
  bool first_ = false;
};

}  // namespace

void add_diagnostic(Parsed& parsed, Place place, std::string text) {
  if (parsed.diagnostics.size() < Parsed::kDiagnosticsMax) {
    parsed.diagnostics.push_back({place, std::move(text)});
  } else {
    ++parsed.dropped;
  }
}

void check(Parsed& parsed) {
  const Report report = [&](Place place, std::string text) {
    add_diagnostic(parsed, place, std::move(text));
  };
  FileCheck(parsed.file, report).run();
}

void check_as_read(Parsed& parsed, const std::function<void(Listener&)>& read) {
  const Report report = [&](Place place, std::string text) {
    add_diagnostic(parsed, place, std::move(text));
  };
  FileCheck checker(parsed.file, report);
  read(checker);
  checker.finish();
}

std::vector<Diagnostic> check(const File& file) {
  std::vector<Diagnostic> found;
  const Report report = [&](Place place, std::string text) {
    found.push_back({place, std::move(text)});
  };
  FileCheck(file, report).run();
  return found;
}

}  // namespace rubric::trace
