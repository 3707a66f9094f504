// Property: any parsed text prints as a text that parses to the same and prints the same; mistakes
// are within the text; a frame made from a line matches that line.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/trace/check.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/match.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"
#include "fuzz/support/places.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric::trace;
using rubric::fuzz::require;

void places_are_within(const Parsed& parsed, std::string_view text) {
  const std::vector<std::size_t> sizes = rubric::fuzz::line_sizes(text);
  for (const Diagnostic& one : parsed.diagnostics) {
    require(one.place.line >= 1 && one.place.line <= sizes.size(), "a mistake is in a line");
    require(one.place.column >= 1 && one.place.column <= sizes[one.place.line - 1] + 1,
            "a mistake is in a column of its line");
    require(!one.text.empty() && one.text.find('\n') == std::string::npos, "it is one line");
  }
  require(parsed.ok() == parsed.errors().empty(), "errors are shown");
}

// Requires the kit's frame for this line to match the line.
void frame_is_asked_for(const Line& line, const Scope& scope) {
  const auto link = scope.link(line.link);
  if (line.op != Op::kGiven || !link || *link == LinkKind::kApp || *link == LinkKind::kPower) {
    return;
  }
  AmFrame frame;
  try {
    frame = frame_of(line, scope);
  } catch (const TraceError&) {
    return;
  }
  Bindings bindings;
  const Match same = match(line, decode(frame, *link), bindings);
  require(static_cast<bool>(same), same.text().c_str());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Parsed parsed = parse(text, "input");
  places_are_within(parsed, text);

  const Parsed syntax = parse_syntax(text, "input");
  const std::string printed = print(syntax.file);
  const Parsed again = parse_syntax(printed, "input");
  require(again.ok(), "what was printed parses");
  require(again.file == syntax.file, "what was printed is the same");
  require(print(again.file) == printed, "there is one canonical layout");
  if (syntax.ok()) require(parse(printed, "input").ok() == parsed.ok(), "it is as right or wrong");
  require(check(parsed.file).empty() || !parsed.ok(), "a file in memory is checked the same");
  if (!parsed.ok()) return 0;
  for (const Case& one : parsed.file.cases) {
    const Scope scope = scope_of(parsed.file, one);
    for (const Line* line : one.lines()) frame_is_asked_for(*line, scope);
  }
  return 0;
}
