// Helpers of the targets of readers and writers: read whole and in pieces, write and read again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/tests/testing.h"

namespace rubric::fuzz {

using testing::Kept;
using MakeReader = std::function<std::unique_ptr<Reader>()>;

/// Returns everything that a new reader makes of `input`. Requires the same from a reader that was
/// used before, and in small and in large pieces, chosen by the input. Each piece is a heap block
/// of its own, so that a sanitizer sees a read beyond it and of one that is gone.
std::vector<Kept> read_in_any_pieces(const MakeReader& make, Bytes input);

/// Requires the same packets; prints the first that differ.
void require_same(const std::vector<Kept>& got, const std::vector<Kept>& wanted,
                  const char* property);

/// Returns the name of the interface that each of `packets` was heard on.
std::string_view interface_name(const Reader& reader, const Packet& packet);

/// Requires each packet's bytes to be in the input at its stated place.
void require_in_place(const std::vector<Kept>& packets, Bytes input);

/// Returns the packet without its place in the file, to compare it before and after writing.
Kept placeless(const Kept& kept);

/// Returns a number that depends on all bytes, for choices that an input need not spend bytes on.
std::uint32_t hash_of(Bytes input);

}  // namespace rubric::fuzz
