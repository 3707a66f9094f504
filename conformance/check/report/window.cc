#include "conformance/check/report/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rubric::report {
namespace {

bool number(std::string_view text, std::uint64_t& out) {
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), out);
  return fault == std::errc() && end == text.data() + text.size();
}

const FrameRange* range_of(const std::vector<FrameRange>& ranges, std::uint32_t file) {
  for (const FrameRange& range : ranges) {
    if (range.file == file) return &range;
  }
  return nullptr;
}

bool same_place(const check::Place& a, const check::Place& b) {
  return a.file == b.file && a.frame == b.frame;
}

}  // namespace

bool parse_range(std::string_view text, FrameRange& out, std::string& error) {
  error = fmt::format("expected A..B, or N:A..B for the run's file N, given '{}'", text);
  out = {UINT32_MAX, 1, UINT64_MAX};
  if (const std::size_t colon = text.find(':'); colon != text.npos) {
    std::uint64_t file = 0;
    if (!number(text.substr(0, colon), file) || file == 0 || file >= UINT32_MAX) return false;
    out.file = static_cast<std::uint32_t>(file - 1);
    text.remove_prefix(colon + 1);
  }
  if (text == "none") {
    out.first = 1;
    out.last = 0;
    return true;
  }
  const std::size_t dots = text.find("..");
  const std::string_view last = dots == text.npos ? text : text.substr(dots + 2);
  if (!number(text.substr(0, dots), out.first) || !number(last, out.last)) return false;
  if (out.first != 0 && out.first <= out.last) return true;
  error = fmt::format("frames count from 1, the first before the last, given '{}'", text);
  return false;
}

std::string range_text(const FrameRange& range, std::size_t files) {
  const std::string file = files > 1 ? fmt::format("{}:", range.file + 1) : std::string();
  if (range.last == 0) return file + "none";
  return fmt::format("{}{}..{}", file, range.first, range.last);
}

check::Run part_of(const check::Run& run, const std::vector<FrameRange>& ranges,
                   check::Options& options) {
  check::Run out = run;
  out.past = {};
  out.seen.clear();
  bool begins_later = false;
  bool ends_earlier = false;
  for (const check::Observation& seen : run.seen) {
    const FrameRange* range = range_of(ranges, seen.place.file);
    if (range && seen.place.frame < range->first) {
      begins_later = true;
    } else if (range && seen.place.frame > range->last) {
      ends_earlier = true;
    } else {
      out.seen.push_back(seen);
    }
  }
  if (begins_later) options.start_cold = false;
  // A frame without a time does not show when the part begins and ends.
  const auto timed = [](const check::Observation& seen) { return seen.place.timed(); };
  const auto first = std::find_if(out.seen.begin(), out.seen.end(), timed);
  if (first == out.seen.end()) return out;
  const auto last = std::find_if(out.seen.rbegin(), out.seen.rend(), timed);
  if (begins_later) out.start_us = first->place.time_us;
  if (ends_earlier) out.end_us = std::max(out.start_us, last->place.time_us);
  return out;
}

std::size_t index_of(const check::Run& run, const check::Place& place) {
  for (std::size_t i = 0; i < run.seen.size(); ++i) {
    if (same_place(run.seen[i].place, place)) return i;
  }
  return run.seen.size();
}

std::vector<FrameRange> Windows::ranges(std::size_t begin, std::size_t end) const {
  std::vector<FrameRange> out;
  for (std::uint32_t file = 0; file < run_.files.size(); ++file) out.push_back({file, 1, 0});
  for (std::size_t i = begin; i < end; ++i) {
    FrameRange& range = out[run_.seen[i].place.file];
    const std::uint64_t frame = run_.seen[i].place.frame;
    range.first = range.last == 0 ? frame : std::min(range.first, frame);
    range.last = std::max(range.last, frame);
  }
  return out;
}

bool Windows::shows(std::size_t begin, std::size_t end, const check::Finding& finding) {
  judged_ += run_.seen.size() / 16 + (end - begin);  // Picking costs less than judging.
  check::Options options = options_;
  const check::Run part = part_of(run_, ranges(begin, end), options);
  const check::Report report = judge_(part, options);
  return std::any_of(report.findings.begin(), report.findings.end(), [&](const auto& other) {
    return other.requirement == finding.requirement && other.severity == finding.severity &&
           other.node == finding.node && same_place(other.place, finding.place);
  });
}

std::vector<FrameRange> Windows::around(const check::Finding& finding) {
  const std::size_t all = run_.seen.size();
  const std::size_t at = finding.place.frame == 0 ? all : index_of(run_, finding.place);
  if (at == all || run_.past.until_us >= 0) return {};
  const auto affordable = [&] { return judged_ + 2 * all < budget(); };
  // Extends the part after the finding first, then before it, each time as little as needed.
  std::size_t end = all;
  for (std::size_t more = 3; at + more < all && affordable(); more *= 2) {
    if (!shows(0, at + more, finding)) continue;
    end = at + more;
    break;
  }
  std::size_t begin = 0;
  for (std::size_t more = 3; more < at && affordable(); more *= 2) {
    if (!shows(at - more, end, finding)) continue;
    begin = at - more;
    break;
  }
  if (begin == 0 && end == all) return {};
  return ranges(begin, end);
}

}  // namespace rubric::report
