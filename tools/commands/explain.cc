#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <span>
#include <stdexcept>

#include "codec/containers/hex_reader.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/suggest.h"
#include "codec/text/text.h"
#include "conformance/test/suite/cases.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/specs.h"
#include "tools/cli/verdict.h"
#include "tools/commands/commands.h"
#include "tools/commands/explain/explain_frame.h"
#include "tools/commands/explain/explain_rule.h"
#include "tools/commands/explain/type_text.h"
#include "tools/commands/protocol_folder.h"

namespace rubric::tools {
namespace {

using reflect::Protocol;

struct ExplainOptions {
  cli::InputOptions input;  // The protocol, and the message that bytes are.
  std::vector<std::string> words;
  std::string framing = "auto";
  bool all_cases = false;
  std::string folder;  // Of another protocol.
};

constexpr const char* kExplainFooter =
    "X is a message, a rule (WIRE-NET-NBYTES) or a group of them (J4), an enum or a mask, or the\n"
    "hex bytes of a frame: a serial packet as Listen prints it, a serial frame with its kind\n"
    "byte, an 802.15.4 frame.\n"
    "Examples:\n"
    "  rubric explain J4-SEQ\n"
    "  rubric explain --protocol my_protocol ANSWER-VALUE\n"
    "Exit codes: 0 explained, 1 the frame is malformed, 64 usage or nothing of that\n"
    "name.";

// Returns the protocol above and the frames below, in which names are looked up.
std::vector<const Protocol*> layers(const Protocol& protocol) {
  return {&protocol, &tinyos::tables::kProtocol};
}

// Returns where the cases of a protocol's folder name rules; they point into `cases`.
std::vector<cases::CaseUse> uses_in(const suite::Cases& cases) {
  std::vector<cases::CaseUse> out;
  for (const suite::SuiteCase& one : cases.all()) {
    one.each_line([&](const trace::Line& line) {
      const bool negative = line.op == trace::Op::kMustNot;
      for (const std::string& rule : line.requirements) {
        const cases::CaseUse use{one.one->name.c_str(), one.file->file_name.c_str(),
                                 trace::requirement_id(rule), negative};
        const bool known = std::ranges::any_of(out, [&](const cases::CaseUse& other) {
          return other.name == use.name && other.requirement == use.requirement &&
                 other.negative == negative;
        });
        if (!known) out.push_back(use);
      }
    });
  }
  return out;
}

// Where rules are tried, and where the project keeps them.
struct RuleUses {
  std::span<const cases::CaseUse> uses = cases::kCaseUses;
  std::span<const explain::RulePlace> places = explain::rule_places();
};

// Returns an empty text if nothing has this name.
std::string explain_name(const Protocol& protocol, const std::string& name, bool all_cases,
                         const RuleUses& rules) {
  std::string out;
  const auto add = [&](std::string text) { out += (out.empty() ? "" : "\n") + std::move(text); };
  std::vector<const Protocol*> all = reflect::protocols();
  all.push_back(&tinyos::tables::kProtocol);
  const auto list = all_cases ? explain::CaseList::kWhole : explain::CaseList::kShort;
  for (const ReqId rule : explain::rules_named(name)) {
    add(explain::explain_rule(all, rule, list, rules.uses, rules.places));
  }
  for (const Protocol* layer : layers(protocol)) {
    if (const reflect::Type* type = reflect::find_type(*layer, name)) {
      add(explain::explain_type(*layer, *type));
    }
    for (int i = 0; i < layer->enum_count; ++i) {
      if (name == layer->enums[i]->name) add(explain::explain_enum(*layer, *layer->enums[i]));
    }
    for (int i = 0; i < layer->mask_count; ++i) {
      if (name == layer->masks[i]->name) add(explain::explain_mask(*layer, *layer->masks[i]));
    }
    if (!out.empty()) break;
  }
  return out;
}

std::vector<std::string> all_names(const Protocol& protocol) {
  std::vector<std::string> names;
  for (const Protocol* layer : layers(protocol)) {
    for (int i = 0; i < layer->type_count; ++i) names.emplace_back(layer->types[i]->id);
    for (int i = 0; i < layer->enum_count; ++i) names.emplace_back(layer->enums[i]->name);
    for (int i = 0; i < layer->mask_count; ++i) names.emplace_back(layer->masks[i]->name);
  }
  for (const std::string& group : explain::rule_groups()) {
    names.push_back(group);
    for (const ReqId rule : explain::rules_named(group)) {
      names.emplace_back(reflect::requirement(rule).id);
    }
  }
  return names;
}

std::string in_case(std::string text, int (*to_case)(int)) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [to_case](unsigned char c) { return static_cast<char>(to_case(c)); });
  return text;
}

// Returns the rules with a similar name: those of its group, else the groups.
std::string rules_like(const std::string& name) {
  const std::string group = in_case(name.substr(0, name.find('-')), std::toupper);
  const bool letter_and_number = group.size() > 1 && std::isalpha(group[0]) != 0 &&
                                 std::all_of(group.begin() + 1, group.end(),
                                             [](unsigned char c) { return std::isdigit(c) != 0; });
  const std::vector<std::string> groups = explain::rule_groups();
  std::vector<std::string> rules;
  for (const ReqId rule : explain::rules_named(group)) {
    rules.emplace_back(reflect::requirement(rule).id);
  }
  if (group != "WIRE" && !rules.empty()) {
    return fmt::format("; rules of {} are {}", group, fmt::join(rules, ", "));
  }
  if (!letter_and_number) return "";
  return fmt::format("; groups of rules are {}", fmt::join(groups, ", "));
}

[[noreturn]] void nothing_of(const std::string& name, const Protocol& protocol) {
  struct stat status {};
  if (::stat(name.c_str(), &status) == 0 && S_ISREG(status.st_mode)) {
    throw cli::UsageError(fmt::format(
        "'{}' is a file; 'rubric decode' prints its frames, 'rubric check' judges them", name));
  }
  const std::vector<std::string> names = all_names(protocol);
  std::string hint = reflect::did_you_mean(name, names);
  if (hint.empty()) hint = reflect::did_you_mean(in_case(name, std::tolower), names);
  if (hint.empty()) hint = reflect::did_you_mean(in_case(name, std::toupper), names);
  throw cli::UsageError(
      fmt::format("nothing is called '{}'{}{}{}; 'rubric messages' lists the messages, "
                  "'rubric coverage' the rules of behaviour",
                  name, hint, rules_like(name), cli::spec_with_message(protocol, name)));
}

bool parse_frame(const std::vector<std::string>& words, std::vector<std::uint8_t>& bytes) {
  std::string line;
  for (const std::string& word : words) line += word + ' ';
  const Bytes text(reinterpret_cast<const std::uint8_t*>(line.data()), line.size());
  return decode_hex_line(text, bytes).fault == Fault::kNone && !bytes.empty();
}

int explain_bytes(const ExplainOptions& options, const Protocol& protocol,
                  const std::vector<std::uint8_t>& bytes, std::string& out) {
  const reflect::Type* message = cli::chosen_message(options.input, protocol);
  auto given = explain::take_frame(bytes, message ? "bare" : options.framing);
  if (!given) {
    throw cli::UsageError(
        "these bytes begin like no frame; say what they are with --framing or --as");
  }
  if (message) given->what = fmt::format("the message {} alone", message->id);
  // Moving the bytes left them in their place, so the packet still points at them.
  reflect::Frame frame;
  reflect::FrameDecoder(protocol, message).decode(given->packet, frame);
  cli::OtherSpecs(protocol).look(frame);
  out =
      fmt::format("Taken as {}, {}.\n\n", given->what, text::counted(given->bytes.size(), "byte"));
  out += explain::explain_frame(frame);
  return frame.malformed() ? cli::kExitFindings : cli::kExitClean;
}

int run_explain(const ExplainOptions& options) {
  std::vector<std::string> traces;
  use_protocol(options.folder, {}, traces);
  const bool other = !options.folder.empty();
  const Protocol& protocol = other ? *trace::protocol().wire : cli::chosen_protocol(options.input);
  suite::Cases cases;
  std::vector<cases::CaseUse> uses;
  RuleUses rules;
  if (other) {
    try {
      cases = suite::Cases::of(traces);
    } catch (const std::runtime_error& error) {
      cli::unreadable(error.what());
    }
    uses = uses_in(cases);
    rules = {uses, {}};
  }
  const bool as_bytes = !options.input.as_message.empty() || options.framing != "auto";
  std::string text;
  int code = cli::kExitClean;
  std::vector<std::uint8_t> bytes;
  if (!as_bytes) text = explain_name(protocol, options.words.front(), options.all_cases, rules);
  if (!text.empty()) {
    for (std::size_t i = 1; i < options.words.size(); ++i) {
      const std::string more = explain_name(protocol, options.words[i], options.all_cases, rules);
      if (more.empty()) nothing_of(options.words[i], protocol);
      text += '\n' + more;
    }
  } else if (parse_frame(options.words, bytes)) {
    code = explain_bytes(options, protocol, bytes, text);
  } else if (as_bytes) {
    throw cli::UsageError("expected hex digits, two a byte");
  } else {
    nothing_of(options.words.front(), protocol);
  }
  cli::Output output;
  output.buffer().append(text::harmless(text, text::Keep::kLines));
  return output.finish() ? code : cli::kExitOutput;
}

}  // namespace

void add_explain(cli::Command& app) {
  auto options = std::make_shared<ExplainOptions>();
  cli::Command& sub = app.add_subcommand("explain", "Explain a message, a rule, a name or a frame");
  sub.footer(kExplainFooter);
  sub.add_option("X", options->words, "A name, or hex bytes in one word or several").required();
  cli::add_spec_option(sub, options->input);
  add_protocol_option(sub, options->folder);
  sub.get_option("--protocol").excludes(sub.get_option("--spec"));
  sub.add_option("--as", options->input.as_message, "Read the bytes as this message alone");
  sub.add_option("--framing", options->framing,
                 "Read the bytes as auto, sf (from the dispatch byte), hdlc (from the kind byte) "
                 "or radio (802.15.4)")
      .one_of({"auto", "sf", "hdlc", "radio"});
  sub.add_flag("--cases", options->all_cases, "Print all golden traces that name a rule");
  sub.exit_code_of([options] { return run_explain(*options); });
}

}  // namespace rubric::tools
