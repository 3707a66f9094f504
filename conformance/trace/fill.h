// Fills in the fields that `...` leaves open in a message that is given to a node.
#pragma once

#include <cstddef>
#include <vector>

#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"

namespace rubric::trace {

/// Decisions with several answers, tried one after the other: a body's type depends on fields that
/// are filled in as well.
class Choices {
 public:
  /// Returns the answer to the next question, from 0 to count - 1.
  std::size_t take(std::size_t count);
  /// Advances to the next combination of answers; returns false if there is none.
  bool next();

 private:
  struct Choice {
    std::size_t answer;
    std::size_t count;
  };
  std::vector<Choice> all_;
  std::size_t used_ = 0;
};

/// Adds the fields of `type` that `tree` lacks: the least value that is allowed, empty lists and
/// bytes. Leaves out those that the encoder fills in.
void fill(const reflect::Type& type, reflect::Value& tree, Choices& choices);

/// Moves bytes given in place of a body, which is a structure, to the opaque field below it.
void give_opaque(const reflect::Type& type, reflect::Value& tree);

}  // namespace rubric::trace
