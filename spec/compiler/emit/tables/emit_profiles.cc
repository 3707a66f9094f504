// Emits conformance/generated/profiles.h: each profile as a constant, and what it accepts.
#include <fmt/core.h>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/model.h"

namespace rubricc {
namespace {

constexpr std::string_view kProfilesFile = R"(<<banner>>
#pragma once

#include <array>
#include <span>
#include <string_view>

<<includes>>

namespace rubric::machine {

/// A difference that a profile does not hold against an implementation.
struct AcceptedDifference {
  ReqId requirement;
  const char* sentence;  ///< What is accepted instead.
};

/// A profile as `--profile` names it.
struct NamedProfile {
  const char* name;
  const char* doc;
  Profile profile;
  std::span<const AcceptedDifference> accepted;
};

<<profiles>>

inline constexpr std::array<NamedProfile, <<count>>> kProfiles{{
    <<entries>>
}};

/// The profile of this name; null if there is none.
constexpr const NamedProfile* find_profile(std::string_view name) {
  for (const NamedProfile& one : kProfiles) {
    if (name == one.name) return &one;
  }
  return nullptr;
}

}  // namespace rubric::machine
)";

/// Returns a string literal in lines that fit, each after `indent` blanks except the first.
std::string literal(const std::string& text, std::size_t indent) {
  std::string out;
  for (const std::string& piece : cpp_string_pieces(text, 88 - indent)) {
    out += (out.empty() ? "" : "\n" + std::string(indent, ' ')) + piece;
  }
  return out;
}

std::string constants_of(const Profile& profile) {
  std::string out;
  for (std::size_t i = 0; i < profile_fields().size(); ++i) {
    const ProfileField& field = profile_fields()[i];
    const std::int64_t value = profile.values.at(i);
    out += fmt::format("    .{} = {},\n", field.name,
                       field.is_switch ? (value != 0 ? "true" : "false") : cpp_int(value));
  }
  return out;
}

std::string accepted_by(const Profile& profile) {
  std::string out = fmt::format("inline constexpr std::array<AcceptedDifference, {}> {}Accepted",
                                profile.accepted.size(), cpp_constant(profile.name));
  if (profile.accepted.empty()) return out + "{};\n";
  out += "{{\n";
  for (const AcceptedDifference& one : profile.accepted) {
    out +=
        fmt::format("    {{{},\n     {}}},\n", cpp_rule(one.requirement), literal(one.sentence, 5));
  }
  return out + "}};\n";
}

}  // namespace

GeneratedFiles emit_profiles(const Model& model) {
  std::string inputs, profiles, entries;
  for (const Profile& one : model.profiles) {
    const std::string name = cpp_constant(one.name);
    inputs += (inputs.empty() ? "" : ", ") + one.file;
    profiles +=
        fmt::format("{}inline constexpr Profile {}{{\n{}}};\n{}", profiles.empty() ? "" : "\n",
                    name, constants_of(one), accepted_by(one));
    entries += fmt::format("{{{},\n {},\n {}, {}Accepted}},\n", cpp_string(one.name),
                           literal(one.doc, 1), name, name);
  }
  if (model.profiles.empty()) return {};
  return {{"conformance/generated/profiles.h",
           fill(kProfilesFile, {{"banner", banner("// ", inputs)},
                                {"includes", cpp_include("codec/runtime/rule.h") + "\n" +
                                                 cpp_include("conformance/machine/profile.h")},
                                {"profiles", profiles},
                                {"count", std::to_string(model.profiles.size())},
                                {"entries", entries}})}};
}

}  // namespace rubricc
