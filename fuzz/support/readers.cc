#include "fuzz/support/readers.h"

#include <algorithm>
#include <iostream>
#include <random>

#include "fuzz/support/require.h"

namespace rubric::fuzz {

std::uint32_t hash_of(Bytes input) {
  std::uint32_t hash = 2166136261u;  // FNV-1a.
  for (const std::uint8_t byte : input) hash = (hash ^ byte) * 16777619u;
  return hash;
}

std::vector<Kept> read_in_any_pieces(const MakeReader& make, Bytes input) {
  const std::vector<Kept> whole = testing::read_all(*make(), input);
  const auto used = make();
  for (int time = 0; time < 2; ++time) {
    std::vector<Kept> again = testing::read_all(*used, input);
    for (std::size_t i = 0; i < std::min(again.size(), whole.size()); ++i) {
      again[i].packet.interface_id = whole[i].packet.interface_id;  // They count on.
    }
    require_same(again, whole, "after the end a reader takes a new input");
  }
  std::minstd_rand random(hash_of(input));
  constexpr std::size_t kSmall[] = {1, 3, 20, 90};
  for (const std::size_t piece_max : {kSmall[random() % 4], std::size_t{800}}) {
    const auto reader = make();
    require_same(testing::read_split(*reader, input, random, piece_max), whole,
                 "any split of the input gives the same packets");
  }
  return whole;
}

void require_same(const std::vector<Kept>& got, const std::vector<Kept>& wanted,
                  const char* property) {
  if (got == wanted) return;
  for (std::size_t i = 0; i < std::max(got.size(), wanted.size()); ++i) {
    if (i < got.size() && i < wanted.size() && got[i] == wanted[i]) continue;
    std::cerr << "packet " << i << " of " << got.size() << ", wanted " << wanted.size() << "\n";
    if (i < got.size()) std::cerr << "got:    " << got[i];
    if (i < wanted.size()) std::cerr << "wanted: " << wanted[i];
    break;
  }
  require(false, property);
}

std::string_view interface_name(const Reader& reader, const Packet& packet) {
  const std::vector<Interface>& interfaces = reader.interfaces();
  if (packet.interface_id >= interfaces.size()) return {};
  return interfaces[packet.interface_id].name;
}

void require_in_place(const std::vector<Kept>& packets, Bytes input) {
  for (const Kept& kept : packets) {
    const Packet& packet = kept.packet;
    // In a serial frame kind and sequence number precede the bytes.
    const std::uint64_t head = (packet.kind != kAbsent) + (packet.serial_seq != kAbsent);
    const std::uint64_t at = packet.offset_bytes + head;
    require(at <= input.size() && kept.bytes.size() <= input.size() - at,
            "a packet lies within the input");
    require(equal(input.sub(at, kept.bytes.size()), testing::view(kept.bytes)),
            "a packet's bytes are those of the input at its offset");
  }
}

Kept placeless(const Kept& kept) {
  Kept out = kept;
  out.packet.offset_bytes = 0;
  out.packet.interface_id = 0;
  return out;
}

}  // namespace rubric::fuzz
