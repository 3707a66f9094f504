// Checks ids, and turns documentation into one line.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr std::size_t kIdMax = 64;

// Words that a generated file could not use as a name: keywords of C++ and macros of C headers.
constexpr std::string_view kReserved =
    " alignas alignof and and_eq asm assert auto bitand bitor bool break case catch char "
    "char16_t char32_t char8_t class co_await co_return co_yield compl concept const "
    "const_cast consteval constexpr constinit continue decltype default delete do double "
    "dynamic_cast else enum errno explicit export extern false float for friend goto if inline "
    "int linux long mutable namespace new noexcept not not_eq nullptr offsetof operator or "
    "or_eq private protected public register reinterpret_cast requires return short signed "
    "sizeof static static_assert static_cast stderr stdin stdout struct switch template this "
    "thread_local throw to_i true try typedef typeid typename union unix unsigned using "
    "virtual void volatile wchar_t while xor xor_eq ";

// Namespaces of the generated code that a spec's own namespace would hide.
constexpr std::array<std::string_view, 6> kReservedSpecs{"detail", "reflect", "req",
                                                         "rubric", "std",     "tables"};

bool is_snake_case(std::string_view id) {
  if (id.empty() || id.front() < 'a' || id.front() > 'z' || id.back() == '_') return false;
  for (std::size_t i = 0; i < id.size(); ++i) {
    const char c = id[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (!letter && (c != '_' || id[i - 1] == '_')) return false;
  }
  return true;
}

}  // namespace

void check_id(Diagnostics& diagnostics, const SourcePlace& place, std::string_view id,
              std::string_view what) {
  if (!is_snake_case(id)) {
    diagnostics.error(place, fmt::format("name {}", quote(id)), "lower snake case was expected");
  } else if (id.size() > kIdMax) {
    diagnostics.error(place, fmt::format("name {}", quote(id)),
                      fmt::format("at most {} characters", kIdMax));
  } else if (!what.empty() && kReserved.find(fmt::format(" {} ", id)) != kReserved.npos) {
    diagnostics.error_in_code(place, fmt::format("{} cannot be the name of {}", quote(id), what),
                              "it is a word of C++ or of the profile");
  } else if (what == "a spec" &&
             std::binary_search(kReservedSpecs.begin(), kReservedSpecs.end(), id)) {
    diagnostics.error_in_code(place, fmt::format("{} cannot be the name of {}", quote(id), what),
                              "the generated code has a namespace of that name");
  }
}

std::string one_line(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool space = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!space) out += c;
    if (space && !out.empty() && out.back() != ' ') out += ' ';
  }
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

}  // namespace rubricc
