// Fills in what `...` leaves open in a message that is given to a node.
#pragma once

#include <cstddef>
#include <vector>

#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"

namespace rubric::trace {

/// Decisions that have several answers, tried one after the other: what a body is depends on fields
/// that are filled in as well.
class Choices {
 public:
  /// The answer to the next question, from 0 to count - 1.
  std::size_t take(std::size_t count);
  /// Goes on to the next combination of answers; false when there is none.
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
/// bytes. Those that the encoder fills in by itself stay away.
void fill(const reflect::Type& type, reflect::Value& tree, Choices& choices);

/// Bytes that are given in place of a body, which is a structure, go to the opaque field below it.
void give_opaque(const reflect::Type& type, reflect::Value& tree);

}  // namespace rubric::trace
