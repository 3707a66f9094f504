// The first pass's results in words, and the frames that the sniffer may have missed.
#include <algorithm>
#include <string>

#include "conformance/check/identify/identity.h"

namespace rubric::check {

using machine::Role;

namespace {

// Returns "1 frame", "2 frames".
std::string counted(std::uint64_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

}  // namespace

void name_devices(const Run& run, Identity& out) {
  for (Device& device : out.devices) {
    const std::string id = std::to_string(device.am);
    const std::string island = std::to_string(device.island);
    if (!device.known) {
      device.name = "unknown sender with address " + id;
    } else if (device.role == Role::kMote) {
      device.name = "mote " + id;
    } else if (device.role == Role::kSink) {
      device.name = device.island == kNoIsland ? "sink " + id : "sink of island " + island;
    } else {
      device.name = "base station";
      if (device.island != kNoIsland) device.name += " of island " + island;
    }
    std::string fact = device.name + ":";
    if (device.radio) fact += " " + counted(device.frames, "frame") + " on the air,";
    for (const std::uint32_t tap : device.taps) fact += " serial line " + run.taps[tap].name + ",";
    if (device.application) fact += " application log,";
    // Frames that a followed run has let go are none that were missed.
    const auto gaps = std::ranges::count_if(
        device.holes, [&](const auto& hole) { return hole.first >= out.gone_us; });
    if (gaps > 0) fact += " " + counted(static_cast<std::uint64_t>(gaps), "gap") + " in its DSNs,";
    if (!device.judged) fact += " not under test,";
    fact.pop_back();
    out.facts.push_back(fact);
  }
}

bool Identity::damaged(std::int64_t from_us, std::int64_t to_us) const {
  if (gone_us >= 0 && from_us < gone_us) return true;
  const auto first = std::lower_bound(damaged_us.begin(), damaged_us.end(), from_us);
  return first != damaged_us.end() && *first <= to_us;
}

bool Identity::maybe_unseen(std::uint16_t device, std::int64_t from_us, std::int64_t to_us,
                            const Options& options) const {
  if (!hears_radio || damaged(from_us, to_us)) return true;
  if (options.sniffer_complete) return false;
  if (device == kNobody) return true;
  const Device& d = devices[device];
  if (!d.radio || from_us < d.first_us || to_us > d.last_us) return true;
  for (const auto& [begin, end] : d.holes) {
    if (begin <= to_us && end >= from_us) return true;
  }
  return false;
}

}  // namespace rubric::check
