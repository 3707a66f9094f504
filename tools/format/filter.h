// The expressions of --filter: `message==updates && src.devid==4`. tools/commands/decode_format.md
// has the grammar.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tools/format/path.h"
#include "tools/format/record.h"

namespace rubric::format {

/// An error in an expression, with the character at fault.
class FilterError : public std::runtime_error {
 public:
  FilterError(const std::string& what, std::size_t position)
      : std::runtime_error(what), position_(position) {}
  std::size_t position() const { return position_; }

  /// Returns the message, the expression, and a caret below the place.
  std::string explain(std::string_view expression) const;

 private:
  std::size_t position_;
};

enum class Compare : std::uint8_t { kEq, kNe, kLt, kLe, kGt, kGe };

/// The right side of a comparison.
struct Operand {
  enum class Kind : std::uint8_t { kInteger, kReal, kText, kPath };
  Kind kind = Kind::kInteger;
  /// Twice the number, or where that is not whole the number between: they compare as all do with
  /// twice a whole one.
  reflect::Whole halves = 0;
  double real = 0;
  std::string text;
  std::size_t path = 0;  ///< kPath: index into the filter's paths.
};

/// A part of an expression. Parts refer to others by their index in the filter.
struct Term {
  enum class Kind : std::uint8_t { kAny, kAll, kNot, kPresent, kCompare };
  Kind kind = Kind::kAll;
  std::vector<std::size_t> parts;      ///< kAny, kAll: of these; kNot: the first.
  std::size_t path = 0;                ///< kPresent, kCompare: index into the filter's paths.
  bool masked = false;                 ///< The value is first reduced to these bits:
  std::int64_t mask = 0;               ///< by number,
  std::vector<std::string> mask_bits;  ///< and by name, as the value's mask has them.
  Compare compare = Compare::kEq;
  Operand operand;
};

/// A compiled expression. Values of a path are compared one by one: a comparison holds if it holds
/// for any of them, != if there are values and all of them differ.
class Filter {
 public:
  /// Throws FilterError. Names are checked against the protocol.
  Filter(std::string_view expression, const reflect::Protocol& protocol);

  bool matches(const Record& record) const { return holds(root_, record); }

 private:
  friend class FilterParser;

  bool holds(std::size_t term, const Record& record) const;
  bool present(const Term& term, const Record& record) const;
  bool compares(const Term& term, const Record& record) const;
  bool compares_with_path(const Term& term, const Record& record) const;

  std::vector<Term> terms_;
  std::vector<Path> paths_;
  std::size_t root_ = 0;
};

}  // namespace rubric::format
