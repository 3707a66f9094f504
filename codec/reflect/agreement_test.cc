// The tables and the generated views are two readers of one spec: over random and mutated bytes of
// every structure they must find the same faults, the same meant bytes, and the same numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "codec/codec_test/every_view.h"
#include "codec/generated/oscilloscope/tables.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/decode.h"

namespace rubric::reflect {
namespace {

constexpr int kInputsPerStructure = 4000;

const Type* type_of(const std::string& name) {
  const std::size_t dot = name.find('.');
  for (const Protocol* protocol : {&tinyos::tables::kProtocol, &rubicon::tables::kProtocol,
                                   &oscilloscope::tables::kProtocol}) {
    if (name.substr(0, dot) == protocol->id) return find_type(*protocol, name.substr(dot + 1));
  }
  return nullptr;
}

template <class T, class = void>
struct HasRaw : std::false_type {};
template <class T>
struct HasRaw<T, std::void_t<decltype(std::declval<T>().raw())>> : std::true_type {};

/// Compares the numbers among the fields of a view with the children of the outermost node.
struct NumberVisitor {
  const Decoded& decoded;
  int compared = 0;

  template <class T>
  void operator()(const char* name, const T& field) {
    const std::size_t node = decoded.child(0, name);
    if constexpr (std::is_integral_v<T> || std::is_enum_v<T>) {
      compare(name, node, static_cast<std::int64_t>(field));
    } else if constexpr (HasRaw<T>::value) {
      compare(name, node, static_cast<std::int64_t>(field.raw()));
    }
  }
  void compare(const char* name, std::size_t node, std::int64_t value) {
    if (node == 0) return;  // A conditional field that is absent.
    EXPECT_EQ(decoded[node].value, value) << name;
    ++compared;
  }
};

/// Bytes that often hold the structure: small counts, real sizes, short and long ones.
std::vector<std::uint8_t> make_bytes(std::mt19937_64& random, const Type& type) {
  const std::size_t most = std::min<std::size_t>(type.max_size, 130);
  std::size_t size = random() % (most + 4);
  if (random() % 2) size = most;
  std::vector<std::uint8_t> bytes(size);
  const std::uint64_t ceiling = random() % 3 ? 26 : 256;
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % ceiling);
  // The places where sizes, kinds and sources stand in the outer structures.
  for (const auto& [at, value] : {std::pair<std::size_t, int>{0, 0}, {5, 100}, {9, 0x3f}}) {
    if (at < size && random() % 3 == 0) bytes[at] = static_cast<std::uint8_t>(value);
  }
  return bytes;
}

TEST(Agreement, TablesAndViews_SameFaultsSameBytesSameNumbers) {
  std::mt19937_64 random(7);
  std::map<std::string, int> faults;
  int numbers = 0;
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
      EXPECT_EQ(decoded[0].size, view->bytes().size()) << name << " input " << i;
      NumberVisitor visitor{decoded};
      visit_fields(*view, visitor);
      numbers += visitor.compared;
    }
  });
  EXPECT_GE(structures, 40);
  EXPECT_GE(numbers, 100000);
  std::printf("%d structures, %d numbers compared; inputs by fault:", structures, numbers);
  for (const auto& [fault, count] : faults) std::printf(" %s:%d", fault.c_str(), count);
  std::printf("\n");
}

}  // namespace
}  // namespace rubric::reflect
