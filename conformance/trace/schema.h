// The messages that a trace can name, and their fields: the tables of the wire spec and of
// protocol.h, looked up by name and path.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "codec/reflect/schema.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// The domain of a leaf: a number with its names, a real, or bytes.
struct Domain {
  enum class Kind : std::uint8_t { kNumber, kReal, kBytes };
  Kind kind = Kind::kNumber;
  bool derived = false;  ///< A size or count of what follows; messages leave it out.
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::int64_t implied = -1;  ///< The only value, or the one that is expected; -1: none.
  const reflect::EnumTable* names = nullptr;
  const reflect::MaskTable* mask = nullptr;
  const reflect::Field* characters = nullptr;  ///< kBytes: the field, if it holds characters.
  friend bool operator==(const Domain&, const Domain&) = default;

  static Domain of(const reflect::Field& field, const reflect::Type& owner);
  static Domain of(const AppField& field);
  static Domain pid();
  static Domain devid();

  /// Returns the number that the names mean: an enumerator, bits of the mask, `all` for broadcast.
  std::optional<std::int64_t> number_of(std::string_view names) const;
  /// Returns a real or number, by its name if it has one.
  Value show(std::int64_t number) const;
  /// Returns "a number from 0 to 255 or a name of am_type (...)".
  std::string expectation() const;
};

/// The target of a path.
struct Slot {
  enum class Kind : std::uint8_t { kLeaf, kAddress, kChannel, kList, kStruct };
  Kind kind = Kind::kLeaf;
  Domain domain;  ///< kLeaf; kList: of an element.
  friend bool operator==(const Slot&, const Slot&) = default;
};

/// A message and its fields. Indexes in paths are left empty here: "payload.body.updates[].value".
struct Shape {
  using Alternatives = std::vector<Slot>;

  std::string name;
  const reflect::Type* type = nullptr;  ///< In the wire spec, or null.
  const AppMessage* app = nullptr;      ///< Else; or null.
  bool radio = false;                   ///< The links on which it travels.
  bool serial = false;
  bool peis = false;
  std::uint8_t am_type = 0;  ///< For messages of the wire spec.
  /// Whole paths. A body's type depends on other fields, so a path may lead to several things.
  std::unordered_map<std::string, Alternatives> slots;
  /// Tails of paths, and the whole paths that they may mean.
  std::unordered_map<std::string, std::vector<std::string>> tails;

  bool has_fields() const { return !slots.empty(); }
  bool travels(LinkKind link) const;
  /// Returns the whole path that `path` means, with its indexes; empty if none or several, and then
  /// `candidates` has them.
  std::string resolve(std::string_view path, std::vector<std::string>* candidates = nullptr) const;
  /// Returns the slots of a whole path, or null.
  const Alternatives* find(std::string_view whole_path) const;
};

class Schema {
 public:
  /// Returns the schema of the protocol in use.
  static const Schema& get();

  /// Returns the shape of this name, or null.
  const Shape* find(std::string_view name) const;
  /// Returns the type that the key chooses on this link; null if none.
  const reflect::Type* payload_type(LinkKind link, std::uint8_t am_type) const;
  const std::unordered_map<std::string, Shape>& shapes() const { return shapes_; }

 private:
  Schema();
  void add_carrier(const reflect::Protocol& wire, const char* carrier, bool Shape::*travels);

  std::unordered_map<std::string, Shape> shapes_;
  const reflect::Switch* radio_ = nullptr;
  const reflect::Switch* serial_ = nullptr;
};

/// Returns "a.b[3].c" as "a.b[].c".
std::string without_indexes(std::string_view path);

}  // namespace rubric::trace
