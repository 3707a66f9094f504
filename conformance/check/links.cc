#include "conformance/check/links.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kSerialAckWithinUs = 100'000;

}  // namespace

bool link_acked(const Run& run, std::uint32_t index) {
  const Observation& sent = run.seen[index];
  if (!sent.ack_request || !sent.has_dsn || sent.kind != Observation::Kind::kRadio) return false;
  const std::int64_t last = sent.place.time_us + ack_within_us(sent) + run.grid_us;
  for (std::size_t i = index + 1; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (seen.place.time_us > last) return false;
    if (seen.kind == Observation::Kind::kRadio && seen.tap == sent.tap) return false;
    if (seen.kind == Observation::Kind::kLinkAck && seen.tap == sent.tap && seen.dsn == sent.dsn) {
      return true;
    }
  }
  return false;
}

bool serial_acked(const Run& run, std::uint32_t index) {
  const Observation& sent = run.seen[index];
  if (!sent.ack_request || !sent.to_mote || sent.kind != Observation::Kind::kSerial) return false;
  for (std::size_t i = index + 1; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (seen.place.time_us > sent.place.time_us + kSerialAckWithinUs) return false;
    if (seen.tap != sent.tap) continue;
    if (seen.kind == Observation::Kind::kLinkAck && !seen.to_mote && seen.dsn == sent.dsn) {
      return true;
    }
    if (seen.kind == Observation::Kind::kSerial && seen.to_mote) return false;
  }
  return false;
}

}  // namespace rubric::check
