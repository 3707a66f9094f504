// Fills the holes of a template.
#include "spec/compiler/emit/template.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace rubricc {
namespace {

const std::string& value_of(std::string_view name, const Holes& holes) {
  for (const auto& [key, value] : holes) {
    if (key == name) return value;
  }
  throw std::logic_error("template: no value for the hole <<" + std::string(name) + ">>");
}

std::string indented(const std::string& value, std::string_view indent) {
  std::string out;
  for (std::size_t at = 0; at < value.size();) {
    std::size_t end = value.find('\n', at);
    if (end == std::string::npos) end = value.size();
    if (end > at) out.append(indent).append(value, at, end - at);
    if (end < value.size()) out += '\n';
    at = end + 1;
  }
  return out;
}

bool blank(std::string_view text) { return text.find_first_not_of(' ') == std::string_view::npos; }

}  // namespace

std::string fill(std::string_view text, const Holes& holes) {
  std::string out;
  std::set<std::string_view> used;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find("<<", at);
    const std::size_t close = open == text.npos ? text.npos : text.find(">>", open);
    if (close == text.npos) {
      out.append(text.substr(at));
      break;
    }
    std::string_view name = text.substr(open + 2, close - open - 2);
    const bool optional = name.ends_with('?');
    if (optional) name.remove_suffix(1);
    const std::string& value = value_of(name, holes);
    used.insert(name);
    if (value.empty() && !optional) {
      throw std::logic_error("template: the hole <<" + std::string(name) + ">> is empty");
    }
    const std::size_t line_start = out.rfind('\n') + 1;
    out.append(text.substr(at, open - at));
    const std::size_t start = std::max(line_start, out.rfind('\n') + 1);
    const std::string indent = out.substr(start);
    at = close + 2;
    const bool alone = blank(indent) && (at == text.size() || text[at] == '\n');
    if (!alone) {
      out.append(value);
      continue;
    }
    out.resize(start);
    std::string block = indented(value, indent);
    while (block.ends_with('\n')) block.pop_back();
    out.append(block);
    if (value.empty() && at < text.size()) ++at;  // The line goes with the hole.
  }
  for (const auto& [name, value] : holes) {
    if (!used.contains(name)) {
      throw std::logic_error("template: no hole takes the value " + std::string(name));
    }
  }
  return out;
}

}  // namespace rubricc
