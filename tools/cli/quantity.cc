#include "tools/cli/quantity.h"

#include <charconv>
#include <string_view>

namespace rubric::cli {
namespace {

struct Unit {
  std::string_view name;
  Quantity one;
};
constexpr Unit kUnits[] = {
    {"k", {1ULL << 10, 0}}, {"M", {1ULL << 20, 0}}, {"G", {1ULL << 30, 0}}, {"s", {0, 1}},
    {"min", {0, 60}},       {"h", {0, 3'600}},      {"d", {0, 86'400}},
};

}  // namespace

std::optional<Quantity> parse_quantity(const std::string& text) {
  constexpr std::uint64_t kMost = 1'000'000;
  const char* const end = text.data() + text.size();
  std::uint64_t number = 0;
  const auto [rest, fault] = std::from_chars(text.data(), end, number);
  if (fault != std::errc() || number == 0 || number > kMost) return std::nullopt;
  for (const Unit& unit : kUnits) {
    if (unit.name != std::string_view(rest, static_cast<std::size_t>(end - rest))) continue;
    return Quantity{number * unit.one.bytes, number * unit.one.seconds};
  }
  return std::nullopt;
}

}  // namespace rubric::cli
