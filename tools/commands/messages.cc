#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "codec/text/json.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"
#include "tools/commands/explain/table.h"
#include "tools/commands/explain/type_text.h"

namespace rubric::tools {
namespace {

using explain::Reach;
using reflect::Protocol;
using reflect::Type;
using text::Json;

struct MessagesOptions {
  cli::InputOptions input;  // Only the choice of the protocol.
  std::string format = "text";
};

constexpr const char* kMessagesFooter =
    "\nAM is a message's own number, under which serial or radio frames carry it where 'in' says\n"
    "so. No frame leads to a message 'by name', only --as; see 'rubric explain NAME'.\n";

// Returns the shown name, or that of the type if several types share the shown one.
std::string place(const Reach& reach, const std::vector<Reach>& reaches) {
  if (!reach.carrier.empty()) return reach.carrier;
  const std::string_view name = reach.parent->name;
  const bool several = std::any_of(reaches.begin(), reaches.end(), [&](const Reach& other) {
    return other.parent != reach.parent && other.parent->name == name;
  });
  return several ? reach.parent->name : reach.parent->id;
}

// Returns the places of a message: frames of which carrier, which other messages.
std::string places(const std::vector<Reach>& reaches) {
  std::vector<std::string> names;
  for (const Reach& reach : reaches) {
    const std::string name = place(reach, reaches);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names.empty() ? "by name" : fmt::format("{}", fmt::join(names, ", "));
}

std::string am_text(const Type& type, const std::vector<Reach>& reaches) {
  std::vector<std::int64_t> numbers = explain::am_types(reaches);
  if (numbers.empty() && type.am_type >= 0) numbers.push_back(type.am_type);
  return fmt::format("{}", fmt::join(numbers, ", "));
}

std::string text(const Protocol& protocol) {
  explain::Table table({"AM", "message", "bytes", "in", "what"});
  table.align_right(0);
  table.align_right(2);
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& type = *protocol.types[i];
    if (explain::is_carrier(protocol, type)) continue;
    const std::vector<Reach> reaches = explain::reaches(protocol, type);
    table.add({am_text(type, reaches), type.id, explain::size_text(type), places(reaches),
               explain::first_sentence(type.doc)});
  }
  return table.text_within(explain::kColumns) + kMessagesFooter;
}

Json json(const Reach& reach) {
  if (!reach.carrier.empty()) {
    return Json::object({{"carrier", reach.carrier}, {"am_types", Json::array(reach.values)}});
  }
  return Json::object({{"in", reach.parent->id},
                       {"field", reach.field->name},
                       {"if", Json::or_null(reach.condition)},
                       {"key", Json::or_null(reach.key)},
                       {"values", Json::array(reach.values)},
                       {"otherwise", reach.otherwise}});
}

Json json(const Protocol& protocol, const Type& type) {
  const std::vector<Reach> reaches = explain::reaches(protocol, type);
  return Json::object(
      {{"id", type.id},
       {"name", type.name},
       {"am_types", Json::array(explain::am_types(reaches))},
       {"min_size", type.min_size},
       {"max_size", type.max_size == UINT32_MAX ? Json::raw("") : Json(type.max_size)},
       {"reached", Json::array(reaches, [](const Reach& reach) { return json(reach); })},
       {"doc", type.doc ? type.doc : ""},
       {"doc_ref", type.doc_ref ? type.doc_ref : ""}});
}

std::string json(const Protocol& protocol) {
  std::vector<Json> messages;
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& type = *protocol.types[i];
    if (!explain::is_carrier(protocol, type)) messages.push_back(json(protocol, type));
  }
  const Json out = Json::object({{"schema", "rubric.messages/1"},
                                 {"spec", protocol.id},
                                 {"title", protocol.title},
                                 {"messages", Json::array(messages, {}, "\n", "\n")}});
  return out.text() + '\n';
}

}  // namespace

void add_messages(cli::Command& app) {
  auto options = std::make_shared<MessagesOptions>();
  cli::Command& sub = app.add_subcommand("messages", "List the messages of a protocol");
  sub.footer(
      "Exit codes: 0 listed, 64 usage, 66 a .ksy file is wrong, 74 output cannot be written.");
  cli::add_spec_option(sub, options->input);
  sub.add_option("--format", options->format, "Print text or json").one_of({"text", "json"});
  sub.callback([options] {
    const Protocol& protocol = cli::chosen_protocol(options->input);
    cli::Output output;
    output.buffer().append(options->format == "json"
                               ? json(protocol)
                               : text::harmless(text(protocol), text::Keep::kLines));
    if (!output.finish()) cli::exit_with(cli::kExitOutput);
  });
}

}  // namespace rubric::tools
