// Lawful traffic: `rubric check` must not find a failure in it under profile paper.
//
// Written from the rules alone; it shares no code with the reference machine and the checker.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "conformance/selftest/lawful_traffic/traffic.h"
#include "conformance/selftest/lawful_traffic/variants.h"

namespace rubric::lawful {

/// Returns a run of the variant of that name, or of `mixed`: several compatible ones, chosen by the
/// seed. The same name and seed give the same traffic. Throws std::invalid_argument for another
/// name.
Traffic generate(std::string_view variant, std::uint64_t seed);

/// Returns it as a pcapng file: interfaces `radio` and `serial:ID`.
std::string to_pcapng(const Traffic& traffic);
/// Returns its contents as JSON (schema rubric.lawful/1).
std::string to_truth_json(const Traffic& traffic);
/// Returns the events at the applications, one JSON object per line, as in the captures of the
/// firmware.
std::string to_app_jsonl(const Traffic& traffic);

}  // namespace rubric::lawful
