// Finds the outputs of a node that a line may mean without a look at each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "conformance/trace/concrete.h"

namespace rubric::runner {

/// The places of outputs, in their order, by link, message and the values of fields. What it finds
/// for a line is all that the line can mean, and mostly not much more: it knows numbers and bytes,
/// not ranges, reals and names.
class OutputIndex {
 public:
  using Places = std::span<const std::uint32_t>;

  /// Adds an output behind all others. `foreign`: no message of the protocol.
  void add(std::uint32_t place, const trace::Concrete& message, std::string_view link,
           bool foreign);
  /// Takes an output out that was added as this.
  void remove(std::uint32_t place, const trace::Concrete& message, std::string_view link,
              bool foreign);

  /// Returns the outputs that the line can be about, whatever their message.
  Places about(const trace::Line& line) const;
  /// Returns those that have the name of its message.
  Places of_its_name(const trace::Line& line) const;
  /// Returns those that may match its message.
  Places like(const trace::Line& line, const trace::Bindings& bindings) const;

 private:
  using Key = std::uint64_t;  // A hash: if two are the same, more is found than need be.
  // What is taken out is mostly near the front.
  struct Bucket {
    std::vector<std::uint32_t> places;
    std::size_t begin = 0;
  };
  template <class Take>
  void each_key(const trace::Concrete& message, std::string_view link, bool foreign, Take take);
  template <class Take>
  void each_key_of_fields(const trace::Concrete& message, Take take);
  template <class Take>
  void each_key_of_leaf(Key path, const trace::Leaf& leaf, Take take);
  Places at(Key key) const;

  std::unordered_map<Key, Bucket> buckets_;
  std::unordered_set<Key> vague_;  // Paths at which reals are, which several values may mean.
};

}  // namespace rubric::runner
