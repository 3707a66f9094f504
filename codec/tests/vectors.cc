#include "codec/tests/vectors.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "codec/reflect/encode.h"

namespace rubric {
namespace {

std::vector<std::uint8_t> bytes_of(std::string hex) {
  std::erase(hex, '\n');
  std::vector<std::uint8_t> out;
  if (!reflect::parse_hex(hex, out)) throw std::runtime_error("not bytes in hex");
  return out;
}

std::string value_of(const YAML::Node& node) {
  if (node.IsSequence()) {
    std::string out;
    for (const auto& item : node) out += (out.empty() ? "" : " ") + canonical(item.Scalar());
    return "[" + out + "]";
  }
  if (node.Tag() == "!") {  // Quoted or folded: opaque bytes.
    std::string hex = node.Scalar();
    std::erase(hex, ' ');
    return "x" + hex;
  }
  return canonical(node.Scalar());
}

Vector load(const std::filesystem::path& path) {
  const YAML::Node root = YAML::LoadFile(path.string());
  static const std::set<std::string> kKeys{"message", "bytes", "fault", "size", "fields"};
  for (const auto& entry : root) {
    if (!kKeys.contains(entry.first.Scalar())) throw std::runtime_error("unknown key");
  }
  Vector out;
  out.file = path.string();
  out.message = root["message"].as<std::string>();
  out.bytes = bytes_of(root["bytes"].as<std::string>());
  if (const YAML::Node fault = root["fault"]) {
    out.fault = ExpectedFault{fault["kind"].as<std::string>(), fault["offset"].as<std::uint32_t>(),
                              fault["requirement"].as<std::string>()};
    return out;
  }
  out.size_bytes = root["size"].as<std::size_t>();
  for (const auto& field : root["fields"]) {
    out.fields[field.first.as<std::string>()] = value_of(field.second);
  }
  return out;
}

}  // namespace

std::string canonical(const std::string& value) {
  std::size_t used = 0;
  const long long number = std::stoll(value, &used, 0);
  if (used != value.size()) throw std::runtime_error("not a number: " + value);
  return std::to_string(number);
}

std::vector<Vector> load_vectors(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Vector> out;
  for (const auto& path : paths) {
    try {
      out.push_back(load(path));
    } catch (const std::exception& e) {
      throw std::runtime_error(path.string() + ": " + e.what());
    }
  }
  return out;
}

}  // namespace rubric
