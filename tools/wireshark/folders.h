// Where a user's own parts of Wireshark lie.
#pragma once

#include <filesystem>
#include <string_view>

namespace rubric::wireshark {

struct Folders {
  std::filesystem::path plugins;  ///< Of dissectors in Lua.
  std::filesystem::path extcap;   ///< Of programs that capture.
};

/// What tshark says; where there is none, where the Wireshark that there is looks by default, or
/// else the newest one. Throws std::runtime_error if $HOME is needed and not set.
Folders personal_folders();

/// The two of a folder that is laid out as ~/.local/lib/wireshark is.
Folders folders_in(const std::filesystem::path& base);

/// The text of the dissector that ships: tools/wireshark/generated/rubric.lua.
std::string_view dissector();

}  // namespace rubric::wireshark
