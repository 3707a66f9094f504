// What the targets of readers and writers share: reading whole and in pieces, writing and reading
// again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/testing.h"

namespace rubric::fuzz {

using testing::Kept;
using MakeReader = std::function<std::unique_ptr<Reader>()>;

/// Everything that a new reader makes of `input`, which must come out the same when a reader that
/// was used gets it, and when it comes in small pieces and in large ones, of which the input
/// decides. Each piece is a heap block of its own, so that a sanitizer sees a read beyond it and of
/// one that is gone.
std::vector<Kept> read_in_any_pieces(const MakeReader& make, Bytes input);

/// The same packets, whatever they are; prints the first that differ.
void require_same(const std::vector<Kept>& got, const std::vector<Kept>& wanted,
                  const char* property);

/// The name of the interface that each of `packets` was heard on.
std::string_view interface_name(const Reader& reader, const Packet& packet);

/// What each packet holds stands in the input where the packet says.
void require_in_place(const std::vector<Kept>& packets, Bytes input);

/// For comparing what was read, written and read again: the packet without its place in the file.
Kept placeless(const Kept& kept);

/// A number that depends on all bytes, for choices that an input need not spend bytes on.
std::uint32_t hash_of(Bytes input);

}  // namespace rubric::fuzz
