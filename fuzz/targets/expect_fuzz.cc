// Property: any text read as the expected failures of `rubric check` or `rubric test` is refused at
// a line of it, or its entries are whole and read the same when they are written again.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "codec/reflect/fault_text.h"
#include "conformance/check/report/expect.h"
#include "conformance/test/suite/expected.h"
#include "fuzz/support/places.h"
#include "fuzz/support/require.h"

namespace {

using rubric::fuzz::require;
using Members = std::vector<std::pair<std::string, std::string>>;

std::string quoted(const std::string& text) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else if (byte < 0x20 || byte == 0x7F) {
      out += std::string("\\x") + kDigits[byte >> 4] + kDigits[byte & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string entry_text(const Members& members) {
  std::string out;
  for (const auto& [key, value] : members) {
    if (!value.empty()) out += (out.empty() ? "- " : "  ") + key + ": " + quoted(value) + '\n';
  }
  return out;
}

// Requires a line of the text in "input.yaml:LINE: what", as both readers print it.
void line_is_within(const std::string& error, const std::string& text) {
  const std::string before = "input.yaml:";
  require(error.starts_with(before), "the file is named");
  const std::size_t line = std::stoul(error.substr(before.size()));
  require(line <= rubric::fuzz::line_sizes(text).size() + 1, "the line is one of the text");
  require(error.find(": ") + 2 < error.size(), "it says what is wrong");
}

// What is read, its entries written again; nothing where the text is refused.
std::string read(const std::string& text, bool of_check) {
  rubric::report::KnownFailures file;
  try {
    file = of_check ? rubric::report::parse_expectations(text, "input.yaml")
                    : rubric::suite::parse_expected(text, "input.yaml");
  } catch (const std::runtime_error& error) {
    line_is_within(error.what(), text);
    return {};
  }
  std::string again;
  for (const auto& one : file.entries) {
    const bool is_rule = rubric::reflect::find_requirement(one.requirement) != rubric::ReqId::kNone;
    require(of_check ? is_rule : !one.cases.empty() && !one.requirement.empty(),
            "a rule is named, and a case where there are cases");
    require(!one.message.empty() && !one.reason.empty(), "message and reason are there");
    require(one.line <= rubric::fuzz::line_sizes(text).size(), "it has a line");
    again += entry_text({{"case", one.cases},
                         {"requirement", one.requirement},
                         {"node", one.node},
                         {"file", one.file},
                         {"message", one.message},
                         {"reason", one.reason},
                         {"target", one.target},
                         {"profile", one.profile}});
  }
  if (of_check) {
    const auto outcome = rubric::report::compare({}, {}, {}, file);
    require(outcome.results.size() == file.entries.size(), "each comes to something");
  }
  return again;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const bool of_check : {true, false}) {
    const std::string written = read(text, of_check);
    require(read(written, of_check) == written, "what was written is read, and is the same");
  }
  return 0;
}
