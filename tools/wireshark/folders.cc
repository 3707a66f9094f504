#include "tools/wireshark/folders.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

namespace rubric::wireshark {
namespace {

namespace fs = std::filesystem;

std::string output_of(const char* command) {
  std::string out;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command, "r"), ::pclose);
  char part[4096];
  while (pipe) {
    const std::size_t size = std::fread(part, 1, sizeof part, pipe.get());
    if (size == 0) break;
    out.append(part, size);
  }
  return out;
}

/// Returns the text after `name`, a colon and blanks at the beginning of a line; empty if there is
/// none.
std::string line_of(const std::string& text, std::string_view name) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line(text.data() + at, end - at);
    at = end + 1;
    if (!line.starts_with(name) || line.substr(name.size(), 1) != ":") continue;
    line.remove_prefix(name.size() + 1);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    return std::string(line);
  }
  return {};
}

fs::path home() {
  const char* const set = std::getenv("HOME");
  if (set == nullptr || *set == '\0') throw std::runtime_error("$HOME is not set; give --dir");
  return set;
}

fs::path default_config() {
  const char* const set = std::getenv("XDG_CONFIG_HOME");
  return (set != nullptr && *set == '/' ? fs::path(set) : home() / ".config") / "wireshark";
}

/// Returns whether personal extcap programs are beside the configuration, as until 4.2.
bool is_before_4_2(const std::string& version_text) {
  const std::size_t at = version_text.find("Wireshark");
  if (at == version_text.npos) return false;
  const std::size_t digits = version_text.find_first_of("0123456789", at);
  int major = 0;
  int minor = 0;
  if (digits == version_text.npos ||
      std::sscanf(version_text.c_str() + digits, "%d.%d", &major, &minor) != 2) {
    return false;
  }
  return major < 4 || (major == 4 && minor < 2);
}

}  // namespace

Folders folders_in(const fs::path& base) { return {base / "plugins", base / "extcap", {}, {}}; }

Folders personal_folders() {
  const std::string said = output_of("tshark -G folders 2>/dev/null");
  Folders out{line_of(said, "Personal Lua Plugins"), line_of(said, "Personal Extcap path"), {}, {}};
  const std::string config = line_of(said, "Personal configuration");
  if (out.extcap.empty() && !config.empty()) out.extcap = fs::path(config) / "extcap";
  out.config = config;
  out.shipped_config = line_of(said, "Global configuration");
  if (!out.plugins.empty() && !out.extcap.empty()) return out;

  out = folders_in(home() / ".local/lib/wireshark");
  const std::string version =
      output_of("wireshark --version 2>/dev/null || dumpcap --version 2>/dev/null");
  if (is_before_4_2(version)) out.extcap = default_config() / "extcap";
  return out;
}

}  // namespace rubric::wireshark
