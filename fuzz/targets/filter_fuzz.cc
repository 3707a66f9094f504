// Property: any text gives a filter expression or is refused at a place within it; a filter says
// the same twice of every frame, and the opposite under `!`.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "fuzz/support/require.h"
#include "tools/format/filter.h"
#include "tools/format/testing.h"

namespace {

using namespace rubric;
using format::Filter;
using format::FilterError;
using format::Sample;
using fuzz::require;

const std::deque<Sample>& frames() {
  static const std::deque<Sample> all = [] {
    std::deque<Sample> made;
    made.emplace_back(format::kUpdates);
    made.emplace_back(format::kUpdates, Framing::kHdlc);
    made.emplace_back("00 ffff 0000 02 00 0b 0001");
    made.emplace_back(
        "4188 07 2200 0100 0200 3f 1c 000b 0001 000b 0002 01 0007 09 03 0a"
        "23 01 0001 0002",
        Framing::kRadio);
    made.emplace_back("0200 07", Framing::kRadio);
    made.emplace_back("");
    made.emplace_back(format::kJoinRequest, Framing::kBare, "join_request");
    made.emplace_back("8002 0001 3f000000 7fc00000 ff800000", Framing::kBare, "synaptic_data");
    return made;
  }();
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const Filter filter(text, format::rubicon());
    // A level deeper it may be too deep.
    const std::string opposite = "!(" + std::string(text) + ")";
    const std::string doubled = "(" + std::string(text) + ") && (" + std::string(text) + ")";
    try {
      const Filter denied(opposite, format::rubicon());
      const Filter both(doubled, format::rubicon());
      for (const Sample& frame : frames()) {
        const bool holds = filter.matches(frame.record);
        require(denied.matches(frame.record) != holds, "`!` is the opposite");
        require(both.matches(frame.record) == holds, "a and a is a");
      }
    } catch (const FilterError& error) {
      require(std::string_view(error.what()).find("deep") != std::string_view::npos ||
                  std::string_view(error.what()).find("longer") != std::string_view::npos,
              error.what());
    }
  } catch (const FilterError& error) {
    require(error.position() <= text.size(), "a mistake is within the text");
    require(!error.explain(text).empty(), "a mistake is explained");
  }
  return 0;
}
