#include "tools/commands/stats/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "codec/reflect/fault_text.h"
#include "codec/text/json.h"
#include "codec/text/text.h"
#include "tools/commands/explain/table.h"
#include "tools/format/put.h"

namespace rubric::stats {
namespace {

using text::Json;

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

std::string short_gap(std::int64_t ns) {
  return fmt::format("{:.3g}", static_cast<double>(ns) / 1e9);
}

std::string place_text(const Place& place) {
  return fmt::format("frame {} at {} s, byte {} of {}", place.number, seconds(place.time_ns),
                     place.offset, text::harmless(place.file));
}

// Returns an empty text for frames within less than a second, which are no rate.
std::string rate_text(const Flow& flow) {
  return flow.seconds() < 1 ? std::string{} : fmt::format("{:.2f}", flow.rate());
}

std::string or_empty(std::uint64_t number) { return number ? std::to_string(number) : ""; }

std::string flows_text(const char* heading, const Counters::Flows& flows) {
  explain::Table table(
      {heading, "frames", "bytes", "malformed", "repeated", "frames/s", "largest gap s"});
  for (std::size_t column = 1; column < 7; ++column) table.align_right(column);
  for (const auto& [name, flow] : sorted(flows)) {
    table.add({name, std::to_string(flow->frames), std::to_string(flow->bytes),
               or_empty(flow->malformed), or_empty(flow->repeated), rate_text(*flow),
               short_seconds(flow->gap_ns)});
  }
  return table.empty() ? std::string{} : '\n' + table.text();
}

std::string faults_text(const Counters& counters) {
  explain::Table table({"fault", "rule", "frames", "first frame", "of file", "sentence"});
  table.align_right(2);
  table.align_right(3);
  const auto& faults = counters.faults();
  const bool one_file = std::all_of(faults.begin(), faults.end(), [&](const auto& fault) {
    return fault.second.first.file == counters.all().last.file;
  });
  for (const auto& [key, count] : faults) {
    const reflect::Requirement& rule = reflect::requirement(key.second);
    table.add({std::string(reflect::fault_name(key.first)), rule.id, std::to_string(count.frames),
               std::to_string(count.first.number), one_file ? "" : text::harmless(count.first.file),
               rule.sentence});
  }
  return table.empty() ? std::string{} : '\n' + table.text_within(explain::kColumns);
}

Json json(const Place& place) {
  return Json::object(
      {{"file", place.file},
       {"index", place.index},
       {"offset", place.offset},
       {"time", Json::raw(place.time_ns == kNoTime ? "" : seconds(place.time_ns))}});
}

void add(const Flow& flow, Json::Members& out) {
  const auto gap = [&] {
    return Json::object({{"seconds", Json::raw(seconds(flow.gap_ns))},
                         {"from", json(flow.gap_from)},
                         {"to", json(flow.gap_to)}});
  };
  const double rate = flow.rate();
  out.insert(out.end(),
             {{"frames", flow.frames},
              {"bytes", flow.bytes},
              {"malformed", flow.malformed},
              {"repeated", flow.repeated},
              {"backward", flow.backward},
              {"seconds", Json::raw(flow.timed ? fmt::format("{:.9g}", flow.seconds()) : "")},
              {"frames_per_second", Json::raw(rate > 0 ? fmt::format("{:.6g}", rate) : "")},
              {"largest_gap", flow.gap_ns < 0 ? Json::raw("") : gap()}});
}

Json json(const char* name_key, const Counters::Flows& flows) {
  return Json::array(
      sorted(flows),
      [&](const NamedFlow& one) {
        Json::Members out = {{name_key, one.first}};
        add(*one.second, out);
        return Json::object(out);
      },
      "\n");
}

struct Percent {
  const char* key;
  double percent;
};
constexpr Percent kPercents[] = {{"p50", 50}, {"p90", 90}, {"p95", 95}, {"p99", 99}};
constexpr std::size_t kTalkersMost = 10;
constexpr std::size_t kBarChars = 50;

std::string gaps_text(const Gaps& gaps) {
  if (gaps.count() == 0) return {};
  std::string out = "between frames:";
  for (const auto& [key, percent] : kPercents) {
    out += fmt::format(" {:.0f} % within {} s,", percent, short_gap(gaps.percentile(percent)));
  }
  out.back() = '\n';
  return out;
}

std::string time_line_text(const TimeLine& line) {
  if (line.bins().size() < 2) return {};
  std::uint64_t most = 1;
  for (const auto& [bin, frames] : line.bins()) most = std::max(most, frames);
  std::string out = fmt::format("\nframes over time, each line {:g} s\n",
                                static_cast<double>(line.width_ns()) / 1e9);
  for (std::int64_t bin = line.bins().begin()->first; bin <= line.bins().rbegin()->first; ++bin) {
    const auto found = line.bins().find(bin);
    const std::uint64_t frames = found == line.bins().end() ? 0 : found->second;
    const std::size_t bar = static_cast<std::size_t>((frames * kBarChars + most - 1) / most);
    const double begin = static_cast<double>(bin) * static_cast<double>(line.width_ns()) / 1e9;
    out += fmt::format("  {:>14.3f} {:>8}{}{:#<{}}\n", begin, frames, bar ? " " : "", "", bar);
  }
  return out;
}

std::string talkers_text(const Counters& counters) {
  explain::Table table({"source", "frames", "share", "bytes", "frames/s"});
  for (std::size_t column = 1; column < 5; ++column) table.align_right(column);
  const std::vector<NamedFlow> all = sorted(counters.sources());
  for (std::size_t i = 0; i < all.size() && i < kTalkersMost; ++i) {
    const Flow& flow = *all[i].second;
    const double share =
        100 * static_cast<double>(flow.frames) / static_cast<double>(counters.all().frames);
    table.add({all[i].first, std::to_string(flow.frames), fmt::format("{:.1f} %", share),
               std::to_string(flow.bytes), rate_text(flow)});
  }
  return table.empty() ? std::string{} : '\n' + table.text();
}

std::string range_text(const Signal::Range& range) {
  if (range.count == 0) return {};
  return fmt::format("{:g} to {:g}, mean {:.1f}", range.min, range.max, range.mean());
}

std::string signal_text(const Counters& counters) {
  std::string out;
  explain::Table links({"link", "frames", "RSSI", "link quality"});
  links.align_right(1);
  for (const auto& [link, signal] : counters.links()) {
    links.add(
        {link, std::to_string(signal.frames), range_text(signal.rssi), range_text(signal.lqi)});
  }
  if (!links.empty()) out += '\n' + links.text();
  explain::Table channels({"channel", "frames"});
  channels.align_right(1);
  for (const auto& [channel, frames] : counters.channels()) {
    channels.add({std::to_string(channel), std::to_string(frames)});
  }
  return channels.empty() ? out : out + '\n' + channels.text();
}

Json json(const Signal::Range& range) {
  if (range.count == 0) return Json::raw("");
  const auto number = [](double value) { return Json::raw(fmt::format("{:.6g}", value)); };
  return Json::object(
      {{"min", number(range.min)}, {"max", number(range.max)}, {"mean", number(range.mean())}});
}

void add_distributions(const Counters& counters, Json::Members& out) {
  Json::Members gaps;
  for (const auto& [key, percent] : kPercents) {
    const std::int64_t gap_ns = counters.gaps().percentile(percent);
    gaps.emplace_back(key, Json::raw(gap_ns < 0 ? "" : seconds(gap_ns)));
  }
  out.emplace_back("gaps", Json::object(gaps));
  const std::int64_t width_ns = counters.time_line().width_ns();
  const auto bins = Json::array(counters.time_line().bins(), [&](const auto& bin) {
    const double begin = static_cast<double>(bin.first) * static_cast<double>(width_ns) / 1e9;
    return Json::object(
        {{"time", Json::raw(fmt::format("{:.3f}", begin))}, {"frames", bin.second}});
  });
  out.emplace_back("over_time",
                   Json::object({{"seconds", Json::raw(seconds(width_ns))}, {"bins", bins}}));
  out.emplace_back("links", Json::array(counters.links(), [](const auto& link) {
                     return Json::object({{"link", link.first},
                                          {"frames", link.second.frames},
                                          {"rssi", json(link.second.rssi)},
                                          {"lqi", json(link.second.lqi)}});
                   }));
  out.emplace_back("channels", Json::array(counters.channels(), [](const auto& channel) {
                     return Json::object({{"channel", static_cast<std::uint64_t>(channel.first)},
                                          {"frames", channel.second}});
                   }));
}

}  // namespace

std::string text_report(const Counters& counters) {
  const Flow& all = counters.all();
  std::string out =
      fmt::format("{} frames, {} bytes, {} malformed", all.frames, all.bytes, all.malformed);
  if (const std::string rate = rate_text(all); !rate.empty()) {
    out += fmt::format(", {} frames/s over {:.3f} s", rate, all.seconds());
  } else if (all.seconds() > 0) {
    out += fmt::format(", within {:.6f} s", all.seconds());
  }
  if (all.repeated) out += fmt::format(", {} with a repeated sequence number", all.repeated);
  if (all.backward) out += fmt::format(", {} older than the frame before", all.backward);
  out += '\n';
  if (all.gap_ns >= 0) {
    out += fmt::format("largest gap: {} s\n  from {}\n  to   {}\n", seconds(all.gap_ns),
                       place_text(all.gap_from), place_text(all.gap_to));
  }
  out += gaps_text(counters.gaps());
  out += flows_text("message", counters.messages());
  out += talkers_text(counters);
  out += flows_text("source>destination", counters.pairs());
  if (counters.interfaces().size() > 1) {
    explain::Table table({"interface", "frames"});
    table.align_right(1);
    for (const auto& [name, frames] : counters.interfaces()) {
      table.add({name.empty() ? "(unnamed)" : text::harmless(name), std::to_string(frames)});
    }
    out += '\n' + table.text();
  }
  out += signal_text(counters);
  out += time_line_text(counters.time_line());
  out += faults_text(counters);
  for (const auto& [kind, count] : counters.notes()) {
    out += fmt::format("\nnoted {}: {}", text::counted(count, "time"), reflect::note_name(kind));
  }
  if (!counters.notes().empty()) out += '\n';
  return text::harmless(out, text::Keep::kLines);
}

std::string json_report(const Counters& counters) {
  Json::Members out = {{"schema", "rubric.stats/1"}};
  add(counters.all(), out);
  add_distributions(counters, out);
  out.emplace_back("sources", json("source", counters.sources()));
  out.emplace_back("messages", json("message", counters.messages()));
  out.emplace_back("pairs", json("pair", counters.pairs()));
  out.emplace_back(
      "interfaces", Json::array(counters.interfaces(), [](const auto& one) {
        return Json::object({{"interface", Json::or_null(one.first)}, {"frames", one.second}});
      }));
  out.emplace_back("faults",
                   Json::array(
                       counters.faults(),
                       [](const auto& one) {
                         const auto& [key, count] = one;
                         return Json::object(
                             {{"fault", reflect::fault_name(key.first)},
                              {"requirement", Json::or_null(reflect::requirement(key.second).id)},
                              {"frames", count.frames},
                              {"first", json(count.first)}});
                       },
                       "\n"));
  out.emplace_back(
      "notes", Json::array(counters.notes(), [](const auto& one) {
        return Json::object({{"note", reflect::note_name(one.first)}, {"count", one.second}});
      }));
  return Json::object(out).text() + '\n';
}

}  // namespace rubric::stats
