// Words of an rct/1 line, and the arguments of a call.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/runtime/bytes.h"
#include "conformance/node/types.h"

namespace rubric::cpp_node {

using Data = std::vector<std::uint8_t>;

/// Closes a command with `unsupported WHY`.
class Unsupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

template <class Number = std::uint64_t>
Number number_of(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw Unsupported("not a number here: " + text);
  }
  return value;
}

inline Data bytes_of_hex(const std::string& hex) {
  Data bytes;
  if (hex.size() % 2 != 0) throw Unsupported("half a byte of hex");
  for (std::size_t at = 0; at < hex.size(); at += 2) {
    std::uint8_t byte = 0;
    const char* end = hex.data() + at + 2;
    if (std::from_chars(hex.data() + at, end, byte, 16).ptr != end) throw Unsupported("not hex");
    bytes.push_back(byte);
  }
  return bytes;
}

inline std::string hex_of(Bytes bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  return hex;
}

/// Returns `name=value` words by their names.
class Arguments {
 public:
  explicit Arguments(const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      const std::size_t equals = word.find('=');
      if (equals != std::string::npos) values_[word.substr(0, equals)] = word.substr(equals + 1);
    }
  }
  bool has(const std::string& name) const { return values_.count(name) > 0; }
  const std::string& text(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw Unsupported("no argument " + name);
    return found->second;
  }
  template <class Number = std::uint16_t>
  Number number(const std::string& name) const {
    return number_of<Number>(text(name));
  }
  /// Reads `11:5`.
  node::Address address(const std::string& name) const {
    const auto [island, device] = two(name, ":");
    return {island, device};
  }
  /// Reads `2->1`.
  std::uint32_t channel(const std::string& name) const {
    const auto [source, destination] = two(name, "->");
    return std::uint32_t{source} << 16 | destination;
  }
  float real(const std::string& name) const { return std::strtof(text(name).c_str(), nullptr); }
  Data bytes(const std::string& name) const { return bytes_of_hex(text(name).substr(1)); }

 private:
  std::pair<std::uint16_t, std::uint16_t> two(const std::string& name,
                                              const std::string& between) const {
    const std::string& both = text(name);
    const std::size_t at = both.find(between);
    if (at == std::string::npos) throw Unsupported("no " + between + " in " + both);
    return {number_of<std::uint16_t>(both.substr(0, at)),
            number_of<std::uint16_t>(both.substr(at + between.size()))};
  }

  std::map<std::string, std::string> values_;
};

}  // namespace rubric::cpp_node
