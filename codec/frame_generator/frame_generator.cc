#include "codec/frame_generator/frame_generator.h"

#include <stdexcept>
#include <utility>

#include "codec/containers/link_record.h"
#include "codec/frame_generator/break.h"
#include "codec/frame_generator/frame_writer.h"
#include "codec/reflect/decode.h"

namespace rubric::generate {
namespace {

constexpr int kTries = 200;
constexpr int kBreakTries = 60;
constexpr double kBodyShare = 0.3;
constexpr double kValueShare = 0.3;
// TinyOS's serial line has room for this many bytes with kind, sequence number and CRC around.
constexpr std::size_t kSerialBytesMax = 252;

std::size_t most_bytes(bool radio) { return radio ? kRadioFrameMax - kFcsBytes : kSerialBytesMax; }

Framing framing_of(const reflect::Route& route) {
  if (is_bare(route)) return Framing::kBare;
  return is_radio(route) ? Framing::kRadio : Framing::kSf;
}

// Returns the numbers in `bytes`, which differ from the draft's at most in and after its body.
std::vector<NumberAt> numbers_of(const Draft& draft, const std::vector<std::uint8_t>& bytes,
                                 bool with_body) {
  std::vector<NumberAt> out;
  for (const Part& part : draft.parts) {
    if (part.kind != PartKind::kNumber || !(part.hard || with_body)) continue;
    out.push_back({draft.scopes[part.scope].type, part.field, part.at,
                   reflect::load_number(*part.field, bytes.data() + part.at)});
  }
  return out;
}

// Tries the ways in any order, values more often first, since most rules are about these; few
// messages can be broken in all ways.
bool break_somehow(const Draft& draft, std::size_t max_bytes, const reflect::Type* short_radio,
                   Random& random, Broken& out) {
  if (random.chance(kValueShare) &&
      break_one(draft, Breakage::kValue, max_bytes, short_radio, random, out)) {
    return true;
  }
  Breakage ways[kBreakages];
  for (std::size_t i = 0; i < kBreakages; ++i) ways[i] = static_cast<Breakage>(i);
  for (std::size_t left = kBreakages; left > 0; --left) {
    std::swap(ways[random.below(left)], ways[left - 1]);
    if (break_one(draft, ways[left - 1], max_bytes, short_radio, random, out)) return true;
  }
  return false;
}

}  // namespace

bool is_radio(const reflect::Route& route) {
  return std::string_view(route.carrier).starts_with("radio");
}

bool is_bare(const reflect::Route& route) { return std::string_view(route.carrier) == "bare"; }

Draft FrameGenerator::draft(const reflect::Route& route) {
  const reflect::Type* carrier =
      is_bare(route) ? route.type : reflect::find_carrier(protocol_, route.carrier);
  const bool radio = is_radio(route);
  for (int i = 0; carrier && i < kTries; ++i) {
    Draft out;
    if (write_frame(route, *carrier, radio, most_bytes(radio), random_, out)) return out;
  }
  throw std::logic_error("no frame of " + std::string(protocol_.id) + " leads to " +
                         route.type->name + " on " + route.carrier);
}

Generated FrameGenerator::valid(const reflect::Route& route) {
  Draft made = draft(route);
  std::vector<NumberAt> numbers = numbers_of(made, made.bytes, true);
  return {.framing = framing_of(route),
          .bytes = std::move(made.bytes),
          .route = &route,
          .path = std::move(made.path),
          .numbers = std::move(numbers),
          .what = "valid"};
}

Generated FrameGenerator::near_valid(const reflect::Route& route) {
  const bool radio = is_radio(route);
  const reflect::Type* const short_radio =
      radio ? reflect::find_carrier(protocol_, "radio_i") : nullptr;
  Broken broken;
  for (int i = 0; i < kBreakTries; ++i) {
    Draft made = draft(route);
    if (made.body.type && random_.chance(kBodyShare)) {
      if (!break_body(made, most_bytes(radio), random_, broken)) continue;
      made.path.pop_back();
      std::vector<NumberAt> numbers = numbers_of(made, broken.bytes, false);
      return {.framing = framing_of(route),
              .bytes = std::move(broken.bytes),
              .route = &route,
              .path = std::move(made.path),
              .numbers = std::move(numbers),
              .unfit = broken.error,
              .unfit_message = made.body.type,
              .what = std::move(broken.what)};
    }
    if (!break_somehow(made, most_bytes(radio), short_radio, random_, broken)) continue;
    return {.framing = framing_of(route),
            .bytes = std::move(broken.bytes),
            .route = &route,
            .error = broken.error,
            .what = std::move(broken.what)};
  }
  return valid(route);
}

}  // namespace rubric::generate
