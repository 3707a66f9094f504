#include "conformance/oracle/read_trace.h"

namespace rubric::oracle {

bool looks_like_trace(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    std::string_view line = bytes.substr(0, end);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.empty() && line.front() != '#' && line.front() != ';') {
      return line.substr(0, 4) == "%rtr";
    }
    if (end == std::string_view::npos) return false;
    bytes.remove_prefix(end + 1);
  }
  return false;
}

bool read_trace(const std::string& name, std::string_view, Run&, std::string& error) {
  error = name + ": .rtr logs cannot be read yet";
  return false;
}

}  // namespace rubric::oracle
