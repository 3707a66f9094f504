// The generated views and the tables against spec/vectors: bytes and their meaning, decided without
// them.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/registry.h"
#include "codec/tests/every_view.h"
#include "tools/tests/readme/number.h"

namespace rubric {
namespace {

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

// Returns a number as 64 bits, however it is written.
std::string canonical(const std::string& value) {
  std::size_t used = 0;
  const long long number = std::stoll(value, &used, 0);
  if (used != value.size()) throw std::runtime_error("not a number: " + value);
  return std::to_string(number);
}

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

// Reads all of `folder`; throws if a file is not as spec/vectors/README.md says.
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

// Prints the fields of a view as text, by path.
class Dump {
 public:
  std::map<std::string, std::string> fields;

  template <class T>
  void operator()(const char* name, const T& value) {
    add(path_ + name, value);
  }

 private:
  template <class T>
  static std::string text(const T& value) {
    if constexpr (std::is_same_v<T, float>) {
      return std::to_string(bits_of_float(value));
    } else if constexpr (requires { value.raw(); }) {
      return std::to_string(value.raw());
    } else {
      return std::to_string(static_cast<long long>(value));
    }
  }
  void add(const std::string& path, Bytes value) { fields[path] = "x" + testing::to_hex(value); }
  template <class T>
  void add(const std::string& path, const T& value) {
    if constexpr (requires { T::kMinSizeBytes; }) {
      within(path, value);
    } else {
      fields[path] = text(value);
    }
  }
  template <class Number>
  void add(const std::string& path, const NumberArrayView<Number>& values) {
    std::string out;
    for (const auto value : values) out += (out.empty() ? "" : " ") + text(value);
    fields[path] = "[" + out + "]";
  }
  template <class View>
  void add(const std::string& path, const StructArrayView<View>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      within(path + "." + std::to_string(i), values[i]);
    }
  }
  template <class View>
  void within(const std::string& path, const View& view) {
    const std::string before = path_;
    path_ = path + ".";
    visit_fields(view, *this);
    path_ = before;
  }

  std::string path_;
};

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::kTruncated: return "truncated";
    case Fault::kUnexpected: return "unexpected";
    case Fault::kOutOfRange: return "out_of_range";
    default: return "another";
  }
}

using Check = std::function<void(const Vector&)>;

template <class View>
void check(const Vector& vector) {
  const Bytes bytes(vector.bytes.data(), vector.bytes.size());
  const Result<View> view = View::parse(bytes);
  const std::size_t dot = vector.message.find('.');
  const reflect::Protocol& spec = *reflect::find_spec(vector.message.substr(0, dot));
  reflect::Decoded decoded;
  reflect::decode(*reflect::find_type(spec, vector.message.substr(dot + 1)), bytes,
                  reflect::Tail::kStale, true, decoded);
  EXPECT_EQ(decoded.error, view.error());
  if (vector.fault) {
    ASSERT_FALSE(view.has_value());
    EXPECT_EQ(name_of(view.error().fault), vector.fault->kind);
    EXPECT_EQ(view.error().offset_bytes, vector.fault->offset_bytes);
    EXPECT_EQ(view.error().requirement, rule_number(vector.fault->requirement.c_str()));
    return;
  }
  ASSERT_TRUE(view.has_value()) << name_of(view.error().fault) << " at "
                                << view.error().offset_bytes;
  EXPECT_EQ(view->bytes().size(), vector.size_bytes);
  EXPECT_EQ(view->bytes().size() + view->stale().size(), vector.bytes.size());
  Dump dump;
  visit_fields(*view, dump);
  EXPECT_EQ(dump.fields, vector.fields);
}

std::map<std::string, Check> checks() {
  std::map<std::string, Check> out;
  for_each_view_of_all(
      [&out]<class View>(const std::string& name, ViewTag<View>) { out[name] = &check<View>; });
  return out;
}

TEST(Vectors, ViewsAcceptReadAndRefuseAsTheySay) {
  const auto by_name = checks();
  const std::vector<Vector> vectors = load_vectors("spec/vectors");
  EXPECT_EQ(vectors.size(), readme_number("# [vectors]"));
  std::set<std::string> made_by_mig;
  std::size_t valid = 0;
  for (const Vector& vector : vectors) {
    SCOPED_TRACE(vector.file);
    const auto found = by_name.find(vector.message);
    ASSERT_NE(found, by_name.end());
    found->second(vector);
    valid += !vector.fault;
    if (vector.file.find("/mig_") != std::string::npos) made_by_mig.insert(vector.message);
  }
  EXPECT_EQ(made_by_mig.size(), readme_number("generator for # structures"));
  std::cout << vectors.size() << " vectors: " << valid << " valid, " << vectors.size() - valid
            << " invalid\n";
}

// Chosen at run time, by the tables of all.h: the value of a valid vector is written as its meant
// bytes again, and the table's functions refuse with the same error as parse.
TEST(Vectors, CodecsByNameWriteTheMeantBytesAgain) {
  std::map<std::string, MessageCodec> codecs;
  for (const NamedCodec& named : all_codecs()) codecs.emplace(named.name, named.codec);
  EXPECT_EQ(codecs.size(), checks().size());
  std::size_t rewritten = 0;
  std::size_t refused = 0;
  for (const Vector& vector : load_vectors("spec/vectors")) {
    SCOPED_TRACE(vector.file);
    const auto found = codecs.find(vector.message);
    ASSERT_NE(found, codecs.end());
    const MessageCodec& codec = found->second;
    const Bytes bytes(vector.bytes.data(), vector.bytes.size());
    const Result<Bytes> meant = codec.parse(bytes);
    std::uint8_t out[512];
    const Result<MutableBytes> again = codec.rewrite(bytes, MutableBytes(out));
    if (vector.fault) {
      ++refused;
      ASSERT_FALSE(meant.has_value());
      EXPECT_EQ(name_of(meant.error().fault), vector.fault->kind);
      ASSERT_FALSE(again.has_value());
      EXPECT_EQ(again.error(), meant.error());
      continue;
    }
    ++rewritten;
    ASSERT_TRUE(meant.has_value());
    EXPECT_TRUE(equal(*meant, bytes.first(vector.size_bytes)));
    EXPECT_GE(meant->size(), codec.min_size_bytes);
    EXPECT_LE(meant->size(), codec.max_size_bytes);
    ASSERT_TRUE(again.has_value());
    EXPECT_TRUE(equal(*again, *meant));
  }
  EXPECT_GE(rewritten, 300U);
  EXPECT_GE(refused, 200U);
  std::cout << rewritten << " written again, " << refused << " refused\n";
}

TEST(Vectors, EachStructureHasValidAndInvalidOnes) {
  std::map<std::string, std::pair<int, int>> counts;
  for (const Vector& vector : load_vectors("spec/vectors")) {
    auto& [good, bad] = counts[vector.message];
    ++(vector.fault ? bad : good);
  }
  for (const auto& [name, check] : checks()) {
    EXPECT_GE(counts[name].first, 1) << name;
    EXPECT_GE(counts[name].second, 1) << name;
  }
  std::cout << counts.size() << " structures\n";
}

}  // namespace
}  // namespace rubric
