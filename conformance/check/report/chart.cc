#include "conformance/check/report/chart.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/text/text.h"
#include "conformance/report/sequence.h"

namespace rubric::report {

using check::kNobody;
using Kind = check::Observation::Kind;

namespace {

constexpr std::size_t kColumnsMost = 16;  // More are wider than any page.

}  // namespace

std::string chart(const Scene& scene, const std::vector<std::size_t>& rows, std::size_t marked,
                  std::size_t indent, std::size_t width) {
  std::vector<std::uint16_t> nodes;
  const auto add = [&](std::uint16_t node) {
    if (node == kNobody || nodes.size() == kColumnsMost ||
        std::find(nodes.begin(), nodes.end(), node) != nodes.end())
      return;
    nodes.push_back(node);
  };
  for (const std::size_t i : rows) add(scene.sender(i));
  for (const std::size_t i : rows) {
    for (const std::uint16_t node : scene.receivers(i)) add(node);
  }
  std::sort(nodes.begin(), nodes.end(), [&](std::uint16_t a, std::uint16_t b) {
    return scene.column_rank(a) < scene.column_rank(b);
  });
  const auto column = [&](std::uint16_t node) {
    const auto found = std::find(nodes.begin(), nodes.end(), node);
    return found == nodes.end() ? kNoColumn : static_cast<std::size_t>(found - nodes.begin());
  };
  Sequence sequence;
  for (const std::uint16_t node : nodes) sequence.columns.push_back(scene.name(node));
  for (const std::size_t i : rows) {
    const check::Observation& seen = scene.run().seen[i];
    SequenceRow row;
    row.time = text::seconds_text(seen.place.time_us);
    row.number = std::to_string(seen.place.frame);
    row.label = scene.label(i);
    row.from = column(scene.sender(i));
    std::size_t left_out = 0;
    for (const std::uint16_t node : scene.receivers(i)) {
      if (node == kNobody) continue;
      const std::size_t to = column(node);
      if (to == kNoColumn) {
        ++left_out;
      } else {
        row.to.push_back(to);
      }
    }
    if (left_out != 0) row.note = fmt::format("and {} more nodes", left_out);
    row.sent = seen.kind == Kind::kRadio || seen.kind == Kind::kSerial;
    row.marked = i == marked;
    sequence.rows.push_back(std::move(row));
  }
  return sequence_text(sequence, indent, width);
}

}  // namespace rubric::report
