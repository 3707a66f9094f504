// Property: any text read as a protocol's app.yaml is refused at a line of it, or each role,
// parameter, call and event of the protocol has one name, by which it is found, and bounds that
// hold.
#include <cstddef>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

#include "codec/reflect/registry.h"
#include "conformance/trace/parameters.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/trace.h"
#include "fuzz/support/places.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;

const reflect::Protocol& find_wire(const std::string& name) {
  const reflect::Protocol* const found = reflect::find_protocol(name);
  if (found == nullptr) throw std::invalid_argument("no spec " + name);
  return *found;
}

// Requires "input.yaml:LINE:COLUMN: what", with a line of the text.
void place_is_within(const std::string& error, const std::string& text) {
  const std::string before = "input.yaml:";
  require(error.starts_with(before), "the file is named");
  const std::size_t line = std::stoul(error.substr(before.size()));
  require(line >= 1 && line <= fuzz::line_sizes(text).size() + 1, "the line is one of the text");
  require(error.find(": ") + 2 < error.size(), "it says what is wrong");
}

void check_names() {
  const trace::Protocol& read = trace::protocol();
  require(!read.name.empty() && read.wire != nullptr && !read.roles.empty(), "nothing is missing");
  for (const trace::RoleInfo& role : read.roles) {
    const auto found = trace::find_role(role.name);
    require(found && trace::role_text(*found) == role.name, "a role is found by its name");
  }
  for (const trace::Parameter& one : read.parameters) {
    const trace::Parameter* const found = trace::find_parameter(one.name);
    require(found != nullptr && found->id == one.id, "a parameter is found by its name");
    require(one.min <= one.max, "a parameter has values");
  }
  std::set<std::string> names;
  for (const trace::AppMessage& one : read.messages) {
    const bool own = one.what == trace::AppWhat::kCall || one.what == trace::AppWhat::kEvent;
    require(!own || names.insert(one.name).second, "a call or an event has a name of its own");
    std::set<std::string> fields;
    for (const trace::AppField& field : one.fields) {
      require(fields.insert(field.name).second, "so has each of its fields");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    trace::use(trace::read_protocol(text, "input.yaml", find_wire));
    check_names();
  } catch (const std::runtime_error& error) {
    place_is_within(error.what(), text);
  }
  return 0;
}
