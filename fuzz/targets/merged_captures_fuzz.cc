// Property: the order in which two captures are named changes neither whether they are refused nor
// how many frames are judged; each finding names a file of the run; a file named twice counts once.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "conformance/check/input/duplicates.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;

using File = std::pair<std::string, std::string_view>;  // Name and bytes.

struct Judged {
  bool refused = false;
  check::Verdict verdict{};
  std::uint64_t frames = 0;
};

Judged judged(const std::vector<File>& files) {
  check::RunReader reader;
  std::string error;
  Judged out;
  for (const auto& [name, bytes] : files) {
    if (reader.add_bytes(name, bytes, error)) continue;
    require(!error.empty(), "a refusal has a reason");
    out.refused = true;
    return out;
  }
  const check::Options options;
  check::Run run = reader.finish();
  if (!check::drop_duplicates(run, options, error)) {
    require(!error.empty(), "a refusal has a reason");
    out.refused = true;
    return out;
  }
  const check::Report report = check::judge(run, options);
  out.verdict = report.verdict;
  out.frames = report.frames;
  for (const check::Finding& one : report.findings) {
    require(one.place.file < files.size(), "a finding is about a file of the run");
  }
  return out;
}

}  // namespace

// The input is two files; its first two bytes say how long the first one is.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t first = input.u16();
  const std::string_view all = input.text();
  const File a{"a", all.substr(0, first)};
  const File b{"b", all.substr(std::min(first, all.size()))};
  const Judged forward = judged({a, b});
  const Judged backward = judged({b, a});
  require(forward.refused == backward.refused, "who is refused is so in each order");
  require(forward.frames == backward.frames, "as many frames are judged in each order");
  const Judged alone = judged({a});
  const Judged twice = judged({a, {"again", a.second}});
  if (!alone.refused && !twice.refused) {
    require(alone.verdict == twice.verdict && alone.frames == twice.frames,
            "what is there twice counts once");
  }
  return 0;
}
