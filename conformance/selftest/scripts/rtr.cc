#include "conformance/selftest/scripts/rtr.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/events/lines.h"

namespace rubric::script {
namespace {

using runner::Output;
using trace::Message;
using trace::Op;

// Inverts config_of() of the runner: first numbers are 1000 + 257 * seed, modulo 2^16.
std::uint64_t seed_of(std::uint16_t first_seq) {
  constexpr std::uint32_t kInverseOf257 = 0xFF01;
  return static_cast<std::uint16_t>((first_seq - 1000U) * kInverseOf257);
}

events::NodeNames names_of(const std::string& node) { return {node, "rA", "serA"}; }

// The machine as the runner's target, which records its inputs, and its outputs at its end.
class Recorder : public runner::SubjectTarget {
 public:
  explicit Recorder(CaseScript& out)
      : SubjectTarget(std::make_unique<runner::Machine>()), out_(out) {}
  ~Recorder() override { out_.outputs = SubjectTarget::outputs(); }

  void reset(const machine::Config& config) override {
    out_.script.config = config;
    SubjectTarget::reset(config);
  }
  void give(Ticks now, const machine::Event& event) override {
    Step step{now - last_, event, {}};
    if (auto* heard = std::get_if<machine::Heard>(&step.event)) {
      step.bytes = taken(heard->frame.payload);
    } else if (auto* called = std::get_if<machine::Called>(&step.event)) {
      if (auto* send = std::get_if<machine::Send>(&called->call)) step.bytes = taken(send->data);
    }
    last_ = now;
    out_.script.steps.push_back(std::move(step));
    SubjectTarget::give(now, event);
  }

 private:
  static std::vector<std::uint8_t> taken(Bytes& bytes) {
    std::vector<std::uint8_t> out(bytes.begin(), bytes.end());
    bytes = {};
    return out;
  }

  CaseScript& out_;
  Ticks last_ = 0;
};

// Returns whether it sends more bytes at once, lasts longer, or has more steps, than any script.
bool is_beyond(const Script& script) {
  return script.length() > kLengthMax || script.steps.size() > kStepsMax ||
         std::any_of(script.steps.begin(), script.steps.end(),
                     [](const Step& step) { return step.bytes.size() > kSendBytesMax; });
}

bool fits(const Script& script) {
  const auto whole = [](const Step& step) { return fitting_delay(step.delay) == step.delay; };
  return std::all_of(script.steps.begin(), script.steps.end(), whole);
}

void add_scripts(const trace::File& file, const trace::Case& one, std::vector<CaseScript>& out) {
  std::vector<std::unique_ptr<CaseScript>> made;
  const auto make = [&](const trace::NodeHeader& node) -> std::unique_ptr<runner::Target> {
    made.push_back(std::make_unique<CaseScript>(CaseScript{one.name, node.name, {}, {}}));
    return std::make_unique<Recorder>(*made.back());
  };
  const runner::CaseResult result = runner::run_case(file, one, make);
  if (result.verdict == runner::CaseVerdict::kError) {
    throw std::runtime_error(one.name + ": " + result.reason);
  }
  for (const auto& each : made) {
    Script& script = each->script;
    Ticks given = 0;
    for (const Step& step : script.steps) given += step.delay;
    script.rest = std::min(result.length - given, kRestMax);
    if (is_beyond(script)) continue;
    if (!fits(script)) throw std::runtime_error(one.name + ": too long for a script");
    out.push_back(std::move(*each));
  }
}

trace::File begin_file(const Script& script) {
  const machine::Config& config = script.config;
  trace::File file = trace::File::begin(is_deployed(config.profile) ? "deployed" : "paper");
  file.header({trace::SeedHeader{seed_of(config.first_seq)}, {}, {}});
  return file.node(node_of(script));
}

// Returns a `!>` line: nothing but what other lines take, from the start to `end`. It comes first,
// so that it counts even if the case ends at a line that finds nothing.
trace::Line nothing_else(Ticks end, const std::string& node, const std::vector<ReqId>& rules) {
  trace::Line line;
  line.time = trace::Time::at(0);
  line.time.to = end;
  line.node = node;
  line.op = Op::kMustNot;
  line.link = "*";
  line.message = Message::any();
  for (const ReqId rule : rules) line.requirements.emplace_back(trace::requirement_text(rule));
  return line;
}

}  // namespace

std::vector<CaseScript> golden_scripts(const std::filesystem::path& folder) {
  std::vector<CaseScript> out;
  for (const trace::Parsed& file : runner::load_cases(folder)) {
    for (const trace::Case& one : file.file.cases) add_scripts(file.file, one, out);
  }
  return out;
}

trace::NodeHeader node_of(const Script& script) {
  const machine::Config& config = script.config;
  std::string name = config.role == machine::Role::kSink ? "sA" : "bA";
  if (config.role == machine::Role::kMote) name = "m" + std::to_string(config.id);
  trace::NodeHeader node = events::header_of(config, std::move(name));
  if (node.id) node.stated.push_back({trace::ParameterId::kChannels, config.profile.channels_max});
  return node;
}

trace::Line line_of(const Output& output, const std::string& node) {
  const events::NodeNames names = names_of(node);
  if (output.is_frame) {
    return events::emitted_line(output.time, names, output.frame.frame(), output.requirement);
  }
  trace::Line line = trace::app_line(output.time, node, Op::kEmits, "app", output.news);
  const std::string_view rule = trace::requirement_text(output.requirement);
  if (!rule.empty()) line.requirements.emplace_back(rule);
  return line;
}

std::optional<std::uint16_t> number_sent(const Output& output) {
  const trace::Value* const number = output.news.find("seq_num");
  if (output.is_frame || output.news.name != "send_result" || !number) return std::nullopt;
  return static_cast<std::uint16_t>(number->number);
}

trace::Line line_of(const Step& step, Ticks now, const std::string& node) {
  return events::given_line(now, names_of(node), step.event_with_bytes()).value();
}

trace::File to_file(const Script& script, const Played& run, const Title& title) {
  const std::string node = node_of(script).name;
  return to_file(
      script, run, title, [&](const Output& output) { return line_of(output, node); },
      [&](const Step& step, Ticks now) { return line_of(step, now, node); });
}

trace::File to_file(const Script& script, const Played& run, const Title& title,
                    const std::function<trace::Line(const Output&)>& shown,
                    const std::function<trace::Line(const Step&, Ticks now)>& given) {
  trace::File file = begin_file(script);
  trace::Case one(title.case_name);
  for (const std::string& text : title.comments) {
    one.items.emplace_back(trace::Comment{';', false, " " + text});
  }
  one.add(nothing_else(script.length(), node_of(script).name, title.rules));
  std::size_t at = 0;
  const auto show = [&](std::size_t to) {
    for (; at < to; ++at) one.add(shown(run.outputs[at]));
  };
  Ticks now = 0;
  for (std::size_t i = 0; i < run.before.size(); ++i) {
    show(run.before[i]);
    now += script.steps[i].delay;
    one.add(given(script.steps[i], now));
  }
  show(run.outputs.size());
  file.cases.push_back(std::move(one));
  return file;
}

}  // namespace rubric::script
