// Legal traffic: what `rubric check` must not find a failure in under profile paper.
//
// Written from the rules alone; it shares no code with the reference machine and the oracle.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "conformance/legal/traffic.h"
#include "conformance/legal/variants.h"

namespace rubric::legal {

/// A run of the variant of that name, or of `mixed`: several that go together, chosen by the seed.
/// The same name and seed give the same traffic. Throws std::invalid_argument for another name.
Traffic generate(std::string_view variant, std::uint64_t seed);

/// The same, written as a pcapng file: interfaces `radio` and `serial:ID`.
std::string to_pcapng(const Traffic& traffic);
/// What is in it, as JSON (schema rubric.legal/1).
std::string to_truth_json(const Traffic& traffic);
/// The events at the applications, a JSON object a line, as in the captures of the firmware.
std::string to_app_jsonl(const Traffic& traffic);

}  // namespace rubric::legal
