#include "tools/count/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "codec/reflect/fault_text.h"
#include "conformance/report/text.h"
#include "tools/format/put.h"
#include "tools/layout/table.h"

namespace rubric::count {
namespace {

using report::json_string;
using report::json_string_or_null;

using NamedFlow = std::pair<std::string, const Flow*>;

// Returns the most frequent first; equally frequent ones by name, so that the order is always the
// same.
std::vector<NamedFlow> sorted(const Counters::Flows& flows) {
  std::vector<NamedFlow> list;
  for (const auto& [name, flow] : flows) list.emplace_back(name, &flow);
  std::sort(list.begin(), list.end(), [](const NamedFlow& a, const NamedFlow& b) {
    if (a.second->frames != b.second->frames) return a.second->frames > b.second->frames;
    return a.first < b.first;
  });
  return list;
}

std::string seconds(std::int64_t ns) {
  char text[format::kMaxTimeChars];
  return {text, format::put_time(text, ns)};
}

std::string short_seconds(std::int64_t ns) {
  return ns < 0 ? std::string{} : fmt::format("{:.3f}", static_cast<double>(ns) / 1e9);
}

std::string place_text(const Place& place) {
  return fmt::format("frame {} at {} s, byte {} of {}", place.number, seconds(place.time_ns),
                     place.offset, place.file);
}

std::string or_empty(std::uint64_t number) { return number ? std::to_string(number) : ""; }

std::string flows_text(const char* heading, const Counters::Flows& flows) {
  layout::Table table({heading, "frames", "bytes", "malformed", "repeated", "frames/s",
                       "largest gap s"});
  for (std::size_t column = 1; column < 7; ++column) table.align_right(column);
  for (const auto& [name, flow] : sorted(flows)) {
    table.add({name, std::to_string(flow->frames), std::to_string(flow->bytes),
               or_empty(flow->malformed), or_empty(flow->repeated),
               flow->rate() > 0 ? fmt::format("{:.2f}", flow->rate()) : "",
               short_seconds(flow->gap_ns)});
  }
  return table.empty() ? std::string{} : '\n' + table.text();
}

std::string faults_text(const Counters& counters) {
  layout::Table table({"fault", "rule", "frames", "first frame", "of file", "sentence"});
  table.align_right(2);
  table.align_right(3);
  const auto& faults = counters.faults();
  const bool one_file = std::all_of(faults.begin(), faults.end(), [&](const auto& fault) {
    return fault.second.first.file == counters.all().last.file;
  });
  for (const auto& [key, count] : faults) {
    const reflect::Requirement& rule = reflect::requirement(key.second);
    table.add({std::string(reflect::fault_name(key.first)), rule.id,
               std::to_string(count.frames), std::to_string(count.first.number),
               one_file ? "" : count.first.file, rule.sentence});
  }
  return table.empty() ? std::string{} : '\n' + table.text_within(layout::kColumns);
}

std::string json(const Place& place) {
  return fmt::format(R"({{"file":{},"index":{},"offset":{},"time":{}}})", json_string(place.file),
                     place.index, place.offset,
                     place.time_ns == kNoTime ? "null" : seconds(place.time_ns));
}

std::string json(const Flow& flow) {
  std::string out = fmt::format(
      R"("frames":{},"bytes":{},"malformed":{},"repeated":{},"backward":{},"frames_per_second":{})",
      flow.frames, flow.bytes, flow.malformed, flow.repeated, flow.backward,
      flow.rate() > 0 ? fmt::format("{:.6g}", flow.rate()) : "null");
  if (flow.gap_ns < 0) return out + ",\"largest_gap\":null";
  return out + fmt::format(R"(,"largest_gap":{{"seconds":{},"from":{},"to":{}}})",
                           seconds(flow.gap_ns), json(flow.gap_from), json(flow.gap_to));
}

std::string json(const char* name_key, const Counters::Flows& flows) {
  std::string out = "[";
  const char* separator = "\n";
  for (const auto& [name, flow] : sorted(flows)) {
    out += fmt::format("{}{{\"{}\":{},{}}}", separator, name_key, json_string(name), json(*flow));
    separator = ",\n";
  }
  return out + ']';
}

}  // namespace

std::string text_report(const Counters& counters) {
  const Flow& all = counters.all();
  std::string out = fmt::format("{} frames, {} bytes, {} malformed", all.frames, all.bytes,
                                all.malformed);
  if (all.rate() > 0) {
    out += fmt::format(", {:.2f} frames/s over {:.3f} s", all.rate(), all.seconds);
  }
  if (all.repeated) out += fmt::format(", {} with a repeated sequence number", all.repeated);
  if (all.backward) out += fmt::format(", {} older than the frame before", all.backward);
  out += '\n';
  if (all.gap_ns >= 0) {
    out += fmt::format("largest gap: {} s\n  from {}\n  to   {}\n", seconds(all.gap_ns),
                       place_text(all.gap_from), place_text(all.gap_to));
  }
  out += flows_text("message", counters.messages());
  out += flows_text("source>destination", counters.pairs());
  if (counters.interfaces().size() > 1) {
    layout::Table table({"interface", "frames"});
    table.align_right(1);
    for (const auto& [name, frames] : counters.interfaces()) {
      table.add({name.empty() ? "(unnamed)" : name, std::to_string(frames)});
    }
    out += '\n' + table.text();
  }
  out += faults_text(counters);
  for (const auto& [kind, count] : counters.notes()) {
    out += fmt::format("\nnoted {} times: {}", count, reflect::note_name(kind));
  }
  return counters.notes().empty() ? out : out + '\n';
}

std::string json_report(const Counters& counters) {
  std::string out = fmt::format("{{\"schema\":\"rubric.stats/1\",{}", json(counters.all()));
  out += ",\"messages\":" + json("message", counters.messages());
  out += ",\"pairs\":" + json("pair", counters.pairs());
  out += ",\"interfaces\":[";
  const char* separator = "";
  for (const auto& [name, frames] : counters.interfaces()) {
    out += fmt::format(R"({}{{"interface":{},"frames":{}}})", separator,
                       json_string_or_null(name), frames);
    separator = ",";
  }
  out += "],\"faults\":[";
  separator = "\n";
  for (const auto& [key, count] : counters.faults()) {
    out += fmt::format(R"({}{{"fault":{},"requirement":{},"frames":{},"first":{}}})", separator,
                       json_string(reflect::fault_name(key.first)),
                       json_string_or_null(reflect::requirement(key.second).id), count.frames,
                       json(count.first));
    separator = ",\n";
  }
  out += "],\"notes\":[";
  separator = "";
  for (const auto& [kind, count] : counters.notes()) {
    out += fmt::format(R"({}{{"note":{},"count":{}}})", separator,
                       json_string(reflect::note_name(kind)), count);
    separator = ",";
  }
  return out + "]}\n";
}

}  // namespace rubric::count
