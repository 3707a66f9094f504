// The tables and the generated views are two readers of one spec: over random and mutated bytes of
// every structure they must find the same faults, the same meant bytes, and the same values in all
// fields, nested structures and arrays.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "codec/reflect/compare_view.h"
#include "codec/reflect/registry.h"

namespace rubric::reflect {
namespace {

constexpr int kInputsPerStructure = 4000;

const Type* type_of(const std::string& name) {
  const std::size_t dot = name.find('.');
  const Protocol* const spec = find_spec(name.substr(0, dot));
  return spec ? find_type(*spec, name.substr(dot + 1)) : nullptr;
}

/// Returns bytes that often hold the structure: small counts, real sizes, short and long ones.
std::vector<std::uint8_t> make_bytes(std::mt19937_64& random, const Type& type) {
  const std::size_t most = std::min<std::size_t>(type.max_size, 130);
  std::size_t size = random() % (most + 4);
  if (random() % 2) size = most;
  std::vector<std::uint8_t> bytes(size);
  const std::uint64_t ceiling = random() % 3 ? 26 : 256;
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % ceiling);
  // The places of sizes, kinds and sources in the outer structures.
  for (const auto& [at, value] : {std::pair<std::size_t, int>{0, 0}, {5, 100}, {9, 0x3f}}) {
    if (at < size && random() % 3 == 0) bytes[at] = static_cast<std::uint8_t>(value);
  }
  return bytes;
}

TEST(Agreement, TablesAndViews_SameFaultsSameBytesSameValues) {
  std::mt19937_64 random(7);
  std::map<std::string, int> faults;
  long numbers = 0;
  long elements = 0;
  int structures = 0;
  Decoded decoded;
  for_each_view_of_all([&](const std::string& name, auto tag) {
    using View = typename decltype(tag)::Type;
    const Type* type = type_of(name);
    ASSERT_NE(type, nullptr) << name;
    ++structures;
    for (int i = 0; i < kInputsPerStructure && !testing::Test::HasFailure(); ++i) {
      const std::vector<std::uint8_t> input = make_bytes(random, *type);
      const Bytes bytes(input.data(), input.size());
      const Result<View> view = View::parse(bytes);
      decode(*type, bytes, Tail::kStale, true, decoded);
      EXPECT_EQ(decoded.error, view.error()) << name << " input " << i;
      ++faults[std::to_string(static_cast<int>(decoded.error.fault))];
      if (!view || decoded.error.fault != Fault::kNone) continue;
      ViewComparer comparer(decoded);
      comparer.structure(*view, 0);
      EXPECT_EQ(comparer.difference(), "") << name << " input " << i;
      numbers += comparer.numbers();
      elements += comparer.elements();
    }
  });
  EXPECT_GE(structures, 40);
  EXPECT_GE(numbers, 300000);
  EXPECT_GE(elements, 20000);
  std::printf("%d structures, %ld numbers and %ld elements compared; inputs by fault:", structures,
              numbers, elements);
  for (const auto& [fault, count] : faults) std::printf(" %s:%d", fault.c_str(), count);
  std::printf("\n");
}

}  // namespace
}  // namespace rubric::reflect
