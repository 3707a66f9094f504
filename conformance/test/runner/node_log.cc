#include "conformance/test/runner/node_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "conformance/generated/profiles.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"

namespace rubric::runner {
namespace {

using machine::Link;
using trace::LinkKind;

LinkKind kind_of(const Output& output) {
  if (!output.is_frame) return LinkKind::kApp;
  switch (output.frame.link) {
    case Link::kRadio: return LinkKind::kRadio;
    case Link::kSerial: return LinkKind::kSerial;
    case Link::kPeis: return LinkKind::kPeis;
  }
  return LinkKind::kAny;
}

trace::Concrete message_of(const Output& output) {
  if (output.is_frame) {
    const machine::Transmit& frame = output.frame;
    const Bytes bytes = frame.bytes();
    return trace::decode({frame.dest, frame.src, 0, frame.type, {bytes.begin(), bytes.end()}},
                         kind_of(output));
  }
  return trace::concrete(output.news);
}

constexpr std::string_view kAckedNumber = "payload.body.seq_num";

bool is_ack(const trace::Message& message) {
  const trace::Value* const kind = message.find("payload.trans_id");
  return kind != nullptr && kind->text == "rubicon_ack";
}

// Returns what the output is in one order with: what came by its link, but for what a timer of its
// own caused. Which of two messages is told first that no ack came is free, as their timers may be
// late (decision 110), and so is the order of the channels within a tick (decision 120).
std::string order_of(std::string_view link, const trace::Message& message) {
  const auto is = [&](const char* path, std::string_view text) {
    const trace::Value* const value = message.find(path);
    return value != nullptr && value->text == text;
  };
  if (message.name == "ack_received" && is("result", "fail")) return trace::print(message);
  if (message.name != "syn_data" || is("status", "unknown_channel")) return std::string(link);
  trace::Message of_channel = message;
  std::erase_if(of_channel.fields, [](const auto& field) { return field.path == "status"; });
  return trace::print(of_channel);
}

// Returns whether it is a frame of a type that the protocol does not have on any line: what a node
// says besides is its own. (decision 124)
bool is_foreign(const Output& output) {
  const trace::Schema& schema = trace::Schema::get();
  return output.is_frame && !schema.payload_type(LinkKind::kRadio, output.frame.type) &&
         !schema.payload_type(LinkKind::kSerial, output.frame.type);
}

LoggedLine logged(Ticks time, const trace::Line& line) {
  std::string text = trace::print(line);
  text.shrink_to_fit();
  return {time, std::move(text)};
}

}  // namespace

machine::Profile profile_of(const trace::Scope& scope) {
  return scope.profile == "deployed" ? machine::kDeployed : machine::kPaper;
}

machine::Config config_of(const trace::Scope& scope, const trace::NodeHeader& node) {
  machine::Config config;
  config.role = static_cast<machine::Role>(node.role);
  config.id = node.id.value_or(0);
  config.island = node.island.value_or(0);
  config.profile = profile_of(scope);
  events::state(config.profile, node.stated);
  config.first_seq = static_cast<std::uint16_t>(1000 + 257 * scope.seed);
  return config;
}

void Target::start(const trace::Scope& scope, const trace::NodeHeader& node) {
  reset(config_of(scope, node));
}

void Target::call(Ticks now, const trace::Concrete& message) {
  const auto call = events::to_call(message);
  if (!call) throw Unsupported(message.name + " is not a call of RUBICON");
  give(now, machine::Called{*call});
}

NodeLog::NodeLog(const trace::Scope& scope, const trace::Case& one, const trace::NodeHeader& header,
                 std::unique_ptr<Target> target)
    : name_(header.name), id_(header.id.value_or(0)), target_(std::move(target)) {
  link_names_ = {{Link::kRadio, "rA"}, {Link::kSerial, "serA"}, {Link::kPeis, "peis"}};
  for (const trace::Line* line : one.lines()) {
    if (line->node != name_) continue;
    if (const auto kind = scope.link(line->link)) {
      if (const auto link = events::to_link(*kind)) link_names_[*link] = line->link;
    }
  }
}

std::string_view NodeLog::link_name(const Output& output) const {
  return output.is_frame ? std::string_view(link_names_.at(output.frame.link)) : "app";
}

const trace::Concrete& NodeLog::message_at(std::size_t place) const {
  if (place_ != place) message_ = message_of(target_->outputs()[place]);
  place_ = place;
  return message_;
}

Ticks NodeLog::run_until(Ticks time) {
  const Ticks reached = target_->run_until(time);
  read_outputs();
  return reached;
}

bool NodeLog::is_about(const trace::Line& line, const Seen& seen) {
  const bool any_message = line.message.name == "*";
  return (line.link == "*" || line.link == seen.link) && !(any_message && seen.foreign);
}

void NodeLog::read_outputs() {
  const std::vector<Output>& outputs = target_->outputs();
  for (std::size_t i = seen_.size(); i < outputs.size(); ++i) {
    const Output& output = outputs[i];
    in_order_ = in_order_ && (i == 0 || outputs[i - 1].time <= output.time);
    const trace::Concrete& message = message_at(i);
    const auto order = orders_.emplace(order_of(link_name(output), message.message), next_.size());
    if (order.second) next_.push_back(0);
    seen_.push_back({message.message.name, link_name(output), message.size_rule, message.excess,
                     order.first->second, prompts_.size(), is_foreign(output)});
    const Seen& seen = seen_.back();
    (seen.foreign ? foreign_links_ : links_).emplace(seen.link);
    trace::Line line =
        output.is_frame
            ? trace::frame_line(output.time, name_, trace::Op::kEmits, seen.link, kind_of(output),
                                *message.frame)
            : trace::app_line(output.time, name_, trace::Op::kEmits, "app", message.message);
    if (output.requirement != ReqId::kNone) {
      line.requirements.emplace_back(trace::requirement_text(output.requirement));
    }
    log_.push_back(logged(output.time, line));
  }
}

Window NodeLog::give(const trace::Line& line, Ticks now, const trace::Scope& scope,
                     const trace::Bindings& bindings) {
  const LinkKind kind = scope.link(line.link).value_or(LinkKind::kAny);
  const trace::Shape* shape = trace::Schema::get().find(line.message.name);
  const auto link = events::to_link(kind);
  const bool is_state = shape && shape->app && shape->app->what != trace::AppWhat::kFrame;
  if (!is_state && link) {
    const trace::AmFrame frame = trace::frame_of(line, scope, bindings);
    trace::Line its = trace::frame_line(now, name_, trace::Op::kGiven, line.link, kind, frame);
    log_.push_back(logged(now, its));
    const machine::Frame heard{*link,
                               frame.dest,
                               frame.src,
                               frame.type,
                               Bytes(frame.payload.data(), frame.payload.size()),
                               Bytes(frame.packet.data(), frame.packet.size())};
    target_->give(now, machine::Heard{heard});
    return given(now, std::move(its));
  }
  const trace::Concrete message = trace::concrete(line.message, bindings);
  trace::Line its = trace::app_line(now, name_, trace::Op::kGiven, line.link, message.message);
  log_.push_back(logged(now, its));
  if (shape && shape->app && shape->app->what == trace::AppWhat::kCall) {
    target_->call(now, message);
    return given(now, std::move(its));
  }
  if (const auto state = events::to_state(message, kind)) {
    if (std::holds_alternative<machine::SendDone>(*state)) {
      target_->hold_link_acks(--link_acks_to_come > 0);
    }
    target_->give(now, *state);
    return given(now, std::move(its));
  }
  throw trace::TraceError(line.place, line.message.name + " cannot be given to a node");
}

Window NodeLog::given(Ticks now, trace::Line line) {
  const Window given = target_->given().value_or(Window{now, now});
  if (given.from != now) {
    line.time = trace::Time::at(given.from);
    log_.back() = logged(given.from, line);
  }
  note_prompt(given.from, line.message);
  read_outputs();
  return given;
}

NodeLog::Span NodeLog::in_window(const Window& window) const {
  if (!in_order_) return {0, seen_.size()};
  const std::vector<Output>& outputs = target_->outputs();
  const auto count = static_cast<std::ptrdiff_t>(seen_.size());
  const auto last = outputs.begin() + count;
  const auto from = std::lower_bound(outputs.begin(), last, window.from,
                                     [](const Output& one, Ticks at) { return one.time < at; });
  const auto to = std::upper_bound(from, last, window.to,
                                   [](Ticks at, const Output& one) { return at < one.time; });
  return {static_cast<std::size_t>(from - outputs.begin()),
          static_cast<std::size_t>(to - outputs.begin())};
}

template <class Find, class Test>
const Output* NodeLog::first(const trace::Line& line, const Window& window, Span span, Find find,
                             Test test) {
  const std::vector<Output>& outputs = target_->outputs();
  const auto is_it = [&](std::size_t i) {
    const Seen& seen = seen_[i];
    return !seen.taken && is_about(line, seen) && window.holds(outputs[i].time) && test(i);
  };
  if (!span.has_many()) {
    for (std::size_t i = span.begin; i < span.end; ++i) {
      if (is_it(i)) return &outputs[i];
    }
    return nullptr;
  }
  for (; indexed_ < seen_.size(); ++indexed_) {
    const Seen& seen = seen_[indexed_];
    if (seen.taken) continue;
    index_.add(static_cast<std::uint32_t>(indexed_), message_at(indexed_), seen.link, seen.foreign);
  }
  const OutputIndex::Places places = find(index_);
  auto at = std::ranges::lower_bound(places, span.begin);
  for (; at != places.end() && *at < span.end; ++at) {
    if (is_it(*at)) return &outputs[*at];
  }
  return nullptr;
}

// What no output matched, none of the same ones will: they are only taken, in turn. Only what binds
// a variable changes what a line means.
const Output* NodeLog::matching(const trace::Line& line, const Window& window,
                                const trace::Bindings& bindings, bool in_turn) {
  Span span = in_window(window);
  Span nothing;
  Span* none = &nothing;
  if (span.has_many() && in_order_) {
    std::string asked = trace::print(trace::Line{
        .link = line.link, .am = line.am, .message = line.message, .bytes = line.bytes});
    if (asked.find('$') != std::string::npos) asked += std::to_string(bindings.all().size());
    none = &none_[in_turn][std::move(asked)];
  }
  if (none->begin <= span.begin && span.begin < none->end) span.begin = none->end;
  if (none->begin < span.end && span.end <= none->end) span.end = none->begin;
  if (span.begin >= span.end) return nullptr;
  const Output* const output = first(
      line, window, span, [&](const OutputIndex& index) { return index.like(line, bindings); },
      [&](std::size_t i) {
        const Seen& seen = seen_[i];
        return (!in_turn || i >= next_[seen.order]) && trace::may_match(line.message, seen.name) &&
               trace::compare(line, message_at(i), bindings);
      });
  if (output != nullptr) span.end = place_of(*output);
  if (none->begin < none->end && span.begin <= none->end && none->begin <= span.end) {
    span = {std::min(span.begin, none->begin), std::max(span.end, none->end)};
  }
  if (span.end - span.begin >= none->end - none->begin) *none = span;
  return output;
}

void NodeLog::take(const Output& output, const trace::Line& line) {
  const std::size_t place = place_of(output);
  Seen& seen = seen_[place];
  seen.taken = &line;
  if (place >= indexed_) return;
  index_.remove(static_cast<std::uint32_t>(place), message_at(place), seen.link, seen.foreign);
}

const Output* NodeLog::take(const trace::Line& line, const Window& window,
                            trace::Bindings& bindings) {
  const Output* const output = matching(line, window, bindings, true);
  if (output == nullptr) return nullptr;
  const Seen& seen = seen_[place_of(*output)];
  trace::match(line, message_at(place_of(*output)), bindings);
  take(*output, line);
  next_[seen.order] = place_of(*output) + 1;
  return output;
}

void NodeLog::allow(const trace::Line& line, const Window& window,
                    const trace::Bindings& bindings) {
  if (const Output* output = forbidden(line, window, bindings)) take(*output, line);
}

const Output* NodeLog::forbidden(const trace::Line& line, const Window& window,
                                 const trace::Bindings& bindings) {
  return matching(line, window, bindings, false);
}

// What came before the last message was no answer to it, and what comes at the very tick of a later
// one is the answer to that.
const Output* NodeLog::too_early_or_late(const trace::Line& line, const Window& window,
                                         const trace::Bindings& bindings) {
  Ticks since = 0;
  for (const Prompt& prompt : prompts_) {
    if (prompt.time <= window.from) since = prompt.time;
  }
  const Output* const early =
      since < window.from ? forbidden(line, {since, window.from - 1}, bindings) : nullptr;
  if (early != nullptr) return early;
  const Ticks latest = window.to + kLateTicks;
  const Output* late = forbidden(line, {window.to + 1, latest}, bindings);
  const auto is_prompted = [&] {
    return std::ranges::any_of(prompts_,
                               [&](const Prompt& prompt) { return prompt.time == late->time; });
  };
  while (late != nullptr && is_prompted())
    late = forbidden(line, {late->time + 1, latest}, bindings);
  return late;
}

NearestMiss NodeLog::nearest_miss(const trace::Line& line, const Window& window,
                                  const trace::Bindings& bindings) {
  constexpr std::size_t kLooksMost = 100;
  NearestMiss miss{"it emitted nothing there", {"missing"}};
  const auto about = [&](const OutputIndex& index) { return index.about(line); };
  const auto any = [](std::size_t) { return true; };
  if (const Output* late = forbidden(line, window, bindings)) {
    miss = {fmt::format("at {} it came before one that was to come first", late->time),
            {"differs", "order"},
            late->time};
  } else if (const Output* output = too_early_or_late(line, window, bindings)) {
    miss.elsewhere = output->time;
    miss.text =
        fmt::format("it came at {}, not from {} to {}", output->time, window.from, window.to);
  } else {
    const Span span = in_window(window);
    std::size_t best = std::numeric_limits<std::size_t>::max();
    std::size_t looks = 0;
    const auto differ = [&](std::size_t i) {
      if (seen_[i].name != line.message.name) return false;
      const trace::Match match = trace::compare(line, message_at(i), bindings);
      const auto says_whose = [](const trace::Difference& each) {
        return each.path == "dest" || each.path == kAckedNumber;
      };
      // The ack of another message is no attempt at this one.
      if (std::ranges::any_of(match.differences, says_whose) && acked(i)) return false;
      if (match.distance() < best) {
        best = match.distance();
        const Output& one = target_->outputs()[i];
        miss = {fmt::format("nearest, at {}: {}: {}", one.time, text_of(one), match.text()),
                {"differs"},
                one.time};
        if (is_ack(message_at(i).message)) miss.evidence.insert("ack");
        for (const trace::Difference& each : match.differences) {
          miss.evidence.insert(each.path.substr(0, each.path.find_first_of(". ")));
        }
      }
      return ++looks == kLooksMost;
    };
    first(
        line, window, span, [&](const OutputIndex& index) { return index.of_its_name(line); },
        differ);
    if (looks == 0 && first(line, window, span, about, any) != nullptr) {
      miss.text = fmt::format("it emitted no {} there", line.message.name);
    }
  }
  const auto is_used = [&](const std::set<std::string>& links) {
    return line.link == "*" ? !links.empty() : links.contains(line.link);
  };
  const bool used = is_used(links_) || (line.message.name != "*" && is_used(foreign_links_));
  if (!used) miss.evidence.insert("unused");
  return miss;
}

Evidence NodeLog::evidence_of(const Output& output) {
  if (again_.size() != seen_.size()) {
    again_.clear();
    std::unordered_set<std::string> said;
    for (const Output& one : target_->outputs())
      again_.push_back(!said.insert(text_of(one)).second);
  }
  const trace::Message& message = message_at(place_of(output)).message;
  const auto text_at = [&](std::string_view path) {
    const trace::Value* value = message.find(path);
    return value ? value->text : std::string();
  };
  return {std::string(output.is_frame ? trace::link_text(kind_of(output)) : "app"),
          is_ack(message) ? "ack" : message.name, text_at("result"),
          again_[place_of(output)] ? "again" : "new"};
}

void NodeLog::note_prompt(Ticks time, const trace::Message& message) {
  const trace::Shape* const shape = trace::Schema::get().find(message.name);
  const auto what = shape && shape->app ? shape->app->what : trace::AppWhat::kFrame;
  if (what != trace::AppWhat::kFrame && what != trace::AppWhat::kCall) return;
  const auto value_at = [&](const char* path) {
    const trace::Value* const value = message.find(path);
    return value ? *value : trace::Value();
  };
  std::string kind = message.name;
  for (const char* path : {"reliable", "payload.trans_id"}) {
    const trace::Value value = value_at(path);
    kind += fmt::format(" {}{}", value.text, value.number);
  }
  if (const trace::Value dest = value_at("dest"); dest.is(trace::Value::Kind::kAddress)) {
    const auto is_all = [](const trace::Value& each) { return each.text == "all"; };
    if (std::ranges::any_of(dest.items, is_all)) {
      kind += " to all";
    } else if (dest.items.back() != trace::Value::of(id_)) {
      kind += " to another";
    }
  }
  prompts_.push_back({time, std::move(kind), value_at("src"), value_at("seq_num")});
}

const NodeLog::Prompt* NodeLog::acked(std::size_t place) const {
  const trace::Message& message = message_at(place).message;
  const trace::Value* const dest = message.find("dest");
  const trace::Value* const number = message.find(kAckedNumber);
  if (!is_ack(message) || dest == nullptr || number == nullptr) return nullptr;
  for (std::size_t i = seen_[place].prompts; i > 0; --i) {
    const Prompt& prompt = prompts_[i - 1];
    if (prompt.src == *dest && prompt.number == *number) return &prompt;
  }
  return nullptr;
}

std::string NodeLog::prompt_of(const Output& output, std::int64_t response) const {
  const std::size_t place = place_of(output);
  if (is_ack(message_at(place).message)) {
    const Prompt* const prompt = acked(place);
    return prompt ? prompt->kind : std::string();
  }
  const std::size_t before = seen_[place].prompts;
  if (before == 0 || output.time - prompts_[before - 1].time > response) return {};
  return prompts_[before - 1].kind;
}

std::vector<Overlong> NodeLog::overlong() const {
  std::vector<Overlong> out;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Seen& seen = seen_[i];
    const bool known =
        std::ranges::any_of(out, [&](const Overlong& one) { return one.rule == seen.size_rule; });
    if (seen.size_rule == ReqId::kNone || known) continue;
    out.push_back({&target_->outputs()[i], seen.taken, seen.size_rule, seen.excess});
  }
  return out;
}

std::string NodeLog::text_of(const Output& output) const {
  const std::size_t place = place_of(output);
  return fmt::format("{} {}", seen_[place].link, trace::print(message_at(place).message));
}

}  // namespace rubric::runner
