#include "tools/commands/commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "conformance/report/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/layout/reach.h"
#include "tools/layout/table.h"
#include "tools/layout/type_text.h"

namespace rubric::tools {
namespace {

using report::json_string;
using layout::Reach;
using reflect::Protocol;
using reflect::Type;

struct MessagesOptions {
  cli::InputOptions input;  // Only the choice of the protocol.
  std::string format = "text";
};

constexpr const char* kMessagesFooter =
    "\nAM is a message's own number; it stands in frames under that number where 'in' is serial\n"
    "or radio. No frame leads to a message 'by name', only --as; see 'rubric explain NAME'.\n";

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
  std::vector<std::int64_t> numbers = layout::am_types(reaches);
  if (numbers.empty() && type.am_type >= 0) numbers.push_back(type.am_type);
  return fmt::format("{}", fmt::join(numbers, ", "));
}

std::string text(const Protocol& protocol) {
  layout::Table table({"AM", "message", "bytes", "in", "what"});
  table.align_right(0);
  table.align_right(2);
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& type = *protocol.types[i];
    if (layout::is_carrier(protocol, type)) continue;
    const std::vector<Reach> reaches = layout::reaches(protocol, type);
    table.add({am_text(type, reaches), type.id, layout::size_text(type), places(reaches),
               layout::first_sentence(type.doc)});
  }
  return table.text_within(layout::kColumns) + kMessagesFooter;
}

std::string json(const Reach& reach) {
  if (!reach.carrier.empty()) {
    return fmt::format(R"({{"carrier":{},"am_types":[{}]}})", json_string(reach.carrier),
                       fmt::join(reach.values, ","));
  }
  std::string out = fmt::format(R"({{"in":{},"field":{})", json_string(reach.parent->id),
                                json_string(reach.field->name));
  out += ",\"if\":" + report::json_string_or_null(reach.condition);
  out += ",\"key\":" + report::json_string_or_null(reach.key);
  return out + fmt::format(R"(,"values":[{}],"otherwise":{}}})", fmt::join(reach.values, ","),
                           reach.otherwise);
}

std::string json(const Protocol& protocol) {
  std::string out =
      fmt::format(R"({{"schema":"rubric.messages/1","spec":{},"title":{},"messages":[)",
                  json_string(protocol.id), json_string(protocol.title));
  const char* separator = "\n";
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& type = *protocol.types[i];
    if (layout::is_carrier(protocol, type)) continue;
    const std::vector<Reach> reaches = layout::reaches(protocol, type);
    out += separator;
    separator = ",\n";
    out += fmt::format(R"({{"id":{},"name":{},"am_types":[{}],"min_size":{},"max_size":{})",
                       json_string(type.id), json_string(type.name),
                       fmt::join(layout::am_types(reaches), ","), type.min_size,
                       type.max_size == UINT32_MAX ? "null" : std::to_string(type.max_size));
    out += ",\"reached\":[";
    for (std::size_t k = 0; k < reaches.size(); ++k) out += (k ? "," : "") + json(reaches[k]);
    out += fmt::format(R"(],"doc":{},"doc_ref":{}}})", json_string(type.doc ? type.doc : ""),
                       json_string(type.doc_ref ? type.doc_ref : ""));
  }
  return out + "\n]}\n";
}

}  // namespace

void add_messages(cli::Command& app) {
  auto options = std::make_shared<MessagesOptions>();
  cli::Command& sub = app.add_subcommand("messages", "The messages of a protocol");
  sub.add_option("--spec", options->input.spec, "Protocol above the AM layer")
      .show_default();
  sub.add_option("--format", options->format, "text or json")
      .one_of({"text", "json"})
      .show_default();
  sub.callback([options] {
    const Protocol& protocol = cli::chosen_protocol(options->input);
    cli::Output output;
    output.buffer().append(options->format == "json" ? json(protocol) : text(protocol));
    output.flush();
    if (output.failed()) cli::exit_with(cli::kExitInput);
  });
}

}  // namespace rubric::tools
