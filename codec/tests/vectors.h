// The vectors of spec/vectors; their form is described in spec/vectors/README.md.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rubric {

struct ExpectedFault {
  std::string kind;
  std::uint32_t offset_bytes;
  std::string requirement;
};

struct Vector {
  std::string file;
  std::string message;  // "rubicon.net_msg"
  std::vector<std::uint8_t> bytes;
  std::optional<ExpectedFault> fault;
  std::size_t size_bytes = 0;                 // Valid ones: the meant bytes.
  std::map<std::string, std::string> fields;  // Valid ones: path to value, as text.
};

/// Reads all of `folder`; throws if a file is not as the README says.
std::vector<Vector> load_vectors(const std::string& folder);

/// Returns a number as 64 bits, however it is written.
std::string canonical(const std::string& value);

}  // namespace rubric
