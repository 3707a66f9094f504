// Property: a key and a payload of a broker, whatever they are, are refused with a reason, or what
// is read of them is within its bounds and, written again, is read as the same.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/support/require.h"
#include "tools/commands/space/layout.h"

namespace {

using namespace rubric::space;
using rubric::Bytes;
using rubric::fuzz::require;

std::string text_of(const Key& key) {
  switch (key.kind) {
    case Key::Kind::kNet: return net_key(key.island);
    case Key::Kind::kIslandAvailability: return island_availability_key(key.island);
    case Key::Kind::kEvents: return events_key(key.island);
    case Key::Kind::kMote: return mote_key(key.island, key.mote);
    case Key::Kind::kState: return state_key(key.island, key.mote);
    case Key::Kind::kAvailability: return availability_key(key.island, key.mote);
    case Key::Kind::kSet: break;
  }
  return mote_key(key.island, key.mote) + "/set";
}

// Returns whether it was taken.
bool taken(const std::string& wrong) {
  require(wrong.size() < 4 * kPayloadMax, "a reason is no longer than what it is about");
  return wrong.empty();
}

void payload_reads_back(const Tuple& tuple) {
  Tuple again;
  require(taken(parse_payload(payload_of(tuple), again)) || payload_of(tuple).size() > kPayloadMax,
          "a payload that is written is read");
  if (payload_of(tuple).size() > kPayloadMax) return;
  require(again.data == tuple.data && again.creator == tuple.creator, "it reads back as the same");
  require(again.written_ms == tuple.written_ms, "so does its time");
}

void net_reads_back(const Tuple& tuple) {
  std::vector<std::uint8_t> packet;
  if (!taken(parse_net(tuple, packet))) return;
  require(packet.size() <= 8 + 114, "a packet is no longer than a line's");
  Tuple written = tuple;
  written.data = net_data(Bytes(packet.data(), packet.size()));
  std::vector<std::uint8_t> again;
  require(taken(parse_net(written, again)) && again == packet, "a net_msg reads back as the same");
}

void mote_reads_back(const Tuple& tuple) {
  Mote mote;
  if (!taken(parse_mote(tuple.data, mote))) return;
  Mote again;
  require(taken(parse_mote(mote_data(mote), again)), "a mote that is written is read");
  require(again.descriptor == mote.descriptor && again.joined_ms == mote.joined_ms,
          "a mote reads back as the same");
}

void wish_is_bounded(const Tuple& tuple) {
  Wish wish;
  if (!taken(parse_wish(tuple.data, wish))) return;
  require(wish.data.size() <= 100 && wish.id.size() <= 64, "a wish is within its bounds");
  // Any bytes may be what a mote sends.
  Mote mote;
  mote.descriptor.mote_type = 1;
  const Bytes data(wish.data.data(), wish.data.size());
  for (const std::uint8_t app_id : {std::uint8_t{10}, std::uint8_t{5}, wish.app_id}) {
    state_data(mote, app_id, data);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(text.find('\n'), text.size());
  Tuple tuple{.key = text.substr(0, end)};
  const auto key = parse_key(tuple.key);
  if (key) require(text_of(*key) == tuple.key, "a key has one spelling");
  require(matches("#", tuple.key) && matches(tuple.key, tuple.key), "a key matches itself");
  if (!taken(parse_payload(std::string_view(text).substr(std::min(end + 1, size)), tuple)))
    return 0;
  payload_reads_back(tuple);
  net_reads_back(tuple);
  mote_reads_back(tuple);
  wish_is_bounded(tuple);
  return 0;
}
