// The common part of readers of length-prefixed containers: joins what spans two chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/containers/reader.h"

namespace rubric {

/// Reads an input that is a row of units, each of which gives its size near its beginning. Passes
/// on a unit that lies in one chunk in place; joins one that spans chunks in a buffer, which grows
/// with the bytes that really came, never with what a length claims.
class UnitReader : public Reader {
 public:
  void feed(Bytes chunk, PacketSink sink) final;
  void finish(PacketSink sink) final;

 protected:
  /// The result of a step: the bytes that it has finished, or, if none, how many it needs to see
  /// together (more than it saw).
  struct Step {
    std::size_t used_bytes;
    std::size_t wanted_bytes;
  };
  static Step used(std::size_t bytes) { return {bytes, 0}; }
  static Step want(std::size_t bytes) { return {0, bytes}; }

  /// Takes units off the front of `input`, which is not empty and begins at offset().
  virtual Step step(Bytes input, PacketSink sink) = 0;
  /// Ends the input with `rest`, of which step wanted more. Resets the reader.
  virtual void end(Bytes rest, PacketSink sink) = 0;

  /// Returns the offset in the whole input of the first byte that step or end sees.
  std::uint64_t offset() const { return offset_; }
  void advance(std::size_t bytes) { offset_ += bytes; }

 private:
  std::uint64_t offset_ = 0;
  Bytes held() const { return Bytes(held_.data() + held_begin_, held_.size() - held_begin_); }
  void drop_held(std::size_t bytes);

  std::vector<std::uint8_t> held_;
  std::size_t held_begin_ = 0;  // Finished bytes before it remain.
  std::size_t wanted_ = 0;
};

}  // namespace rubric
