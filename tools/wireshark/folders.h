// Finds a user's personal folders of Wireshark.
#pragma once

#include <filesystem>
#include <string_view>

namespace rubric::wireshark {

struct Folders {
  std::filesystem::path plugins;  ///< For dissectors in Lua.
  std::filesystem::path extcap;   ///< For programs that capture.
  std::filesystem::path config;   ///< The user's settings; empty: unknown, or not one user's.
  std::filesystem::path shipped_config;  ///< Those that ship with Wireshark; empty: unknown.
};

/// Returns tshark's answer; without tshark, the default of the installed Wireshark, or else of the
/// newest one. Throws std::runtime_error if $HOME is needed and not set.
Folders personal_folders();

/// Returns the two of a folder with the layout of ~/.local/lib/wireshark.
Folders folders_in(const std::filesystem::path& base);

/// Returns the text of the dissector that ships: tools/wireshark/generated/rubric.lua.
std::string_view dissector();

}  // namespace rubric::wireshark
