#include "conformance/trace/check_message.h"

#include <algorithm>
#include <optional>

#include "codec/reflect/suggest.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/match.h"
#include "conformance/trace/substitute.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

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
    for (const AppField& field : shape.app->all()) {
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
    Line line = line_;
    line.bytes.reset();
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

}  // namespace

void check_message(const Line& line, LinkKind link, BoundNames& bound, const Report& report) {
  MessageCheck(line, link, bound, report).run();
}

}  // namespace rubric::trace
