// The hash of a state: live content only, so that states that compare equal hash equal.
#include "conformance/machine/step.h"

namespace rubric::machine {
namespace {

class Hasher {
 public:
  void add(std::uint64_t word) {
    const unsigned __int128 product =
        static_cast<unsigned __int128>(word ^ kOdd) * (sum_ ^ 0x9E3779B97F4A7C15);
    sum_ = static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
  }
  void add(std::uint16_t a, std::uint16_t b, std::uint16_t c = 0, std::uint16_t d = 0) {
    add(std::uint64_t{a} << 48 | std::uint64_t{b} << 32 | std::uint64_t{c} << 16 | d);
  }
  void add(Address a, Address b = {}) { add(a.pid, a.devid, b.pid, b.devid); }
  void add(const Descriptor& d, std::uint16_t more = 0) {
    add(d.mote_type, d.actuators, d.transducers, more);
  }
  void add(Bytes bytes) {
    while (bytes.size() >= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes.data(), sizeof(word));
      add(word);
      bytes = bytes.from(8);
    }
    std::uint64_t rest = 0;
    if (!bytes.empty()) std::memcpy(&rest, bytes.data(), bytes.size());
    add(rest ^ std::uint64_t{bytes.size()} << 56);
  }
  std::uint64_t sum() const { return sum_; }

 private:
  static constexpr std::uint64_t kOdd = 0xA0761D6478BD642F;
  std::uint64_t sum_ = 0xE7037ED1A0B428DB;
};

void add(Hasher& hasher, const Profile& p) {
  hasher.add(p.ticks_per_second, p.join_period_ticks, p.ack_timeout_ticks, p.synaptic_period_ticks);
  const unsigned switches =
      (p.join_fail_signalled ? 1u : 0u) | (p.listed_ignored ? 2u : 0u) | (p.short_acks ? 4u : 0u);
  hasher.add(p.join_requests_max, p.ack_join_max, p.members_max, p.sink_id);
  hasher.add(p.response_ticks, p.early_ticks, p.synaptic_phase_ticks,
             static_cast<std::uint16_t>(switches | unsigned{p.channels_max} << 8));
  hasher.add(std::uint64_t{p.gone_after_ticks});
}

void add(Hasher& hasher, const Config& config) {
  hasher.add(config.id, config.island, config.first_seq,
             static_cast<std::uint16_t>(static_cast<unsigned>(config.role) << 1 |
                                        (config.random_seq ? 1u : 0u)));
  add(hasher, config.profile);
}

void add(Hasher& hasher, const JoinMote& join) {
  hasher.add(static_cast<std::uint16_t>(join.phase), join.requests, join.acks,
             join.acked ? std::uint16_t{1} : std::uint16_t{0});
  hasher.add(join.address, {join.seq_num, join.sink_devid});
  hasher.add(join.descriptor);
  hasher.add(std::uint64_t{join.due} << 32 | join.accepted);
  hasher.add(std::uint64_t{join.asked ? 1u : 0u});
}

template <std::size_t kRoom>
void add(Hasher& hasher, const BoundedList<Admission, kRoom>& list) {
  hasher.add(std::uint64_t{list.size()});
  for (const Admission& admission : list) {
    const Descriptor& d = admission.descriptor;
    hasher.add(admission.devid, admission.seq_num, d.transducers,
               static_cast<std::uint16_t>(d.mote_type << 8 | d.actuators));
  }
}

void add(Hasher& hasher, const BoundedList<Channel, kChannelsRoom>& channels) {
  hasher.add(std::uint64_t{channels.size()});
  for (const Channel& channel : channels) {
    const unsigned flags = static_cast<unsigned>(channel.mode) | (channel.started ? 2u : 0u) |
                           (channel.fresh ? 4u : 0u) | unsigned{channel.size} << 8;
    hasher.add(std::uint64_t{channel.id} << 32 | flags);
    hasher.add(channel.peer);
    for (std::size_t i = 0; i < channel.size; i += 2) {
      const std::uint64_t next = i + 1 < channel.size ? channel.value_bits[i + 1] : 0;
      hasher.add(next << 32 | channel.value_bits[i]);
    }
  }
}

template <std::size_t kRoom>
void add(Hasher& hasher, const BoundedQueue<Buffered, kRoom>& queue) {
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Buffered& frame = queue[i];
    const unsigned type = frame.type | (frame.link_ack ? 0x100u : 0u);
    hasher.add(frame.dest, frame.src, static_cast<std::uint16_t>(type), frame.awaited);
    hasher.add(frame.bytes());
  }
}

template <std::size_t kRoom>
void add(Hasher& hasher, const Interface<kRoom>& line) {
  const unsigned flags = (line.on ? 1u : 0u) | (line.sending ? 2u : 0u) |
                         (line.sending_ack_join ? 4u : 0u) | (line.taken ? 8u : 0u);
  hasher.add(std::uint64_t{line.out.size()} << 16 | std::uint64_t{line.in.size()} << 8 | flags);
  add(hasher, line.out);
  add(hasher, line.in);
}

}  // namespace

std::uint64_t hash_value(const State& state) {
  Hasher hasher;
  add(hasher, state.config);
  hasher.add(std::uint64_t{state.clock_offset_ms} << 32 | std::uint64_t{state.island} << 16 |
             (state.app_busy ? 1u : 0u) | (state.off ? 2u : 0u));
  hasher.add(state.sequence.last, state.sequence.random ? std::uint16_t{1} : std::uint16_t{0});
  add(hasher, state.join);
  add(hasher, state.sink.members);
  add(hasher, state.sink.pending);
  add(hasher, state.sink.unreported);
  hasher.add(std::uint64_t{state.present.size()});
  for (const Presence& one : state.present) hasher.add(std::uint64_t{one.devid} << 32 | one.heard);
  hasher.add(std::uint64_t{state.awaited.size()});
  for (const Awaited& awaited : state.awaited) {
    hasher.add(awaited.dest, {awaited.seq_num, awaited.app_id});
    hasher.add(std::uint64_t{awaited.due});
  }
  add(hasher, state.synaptic.out);
  add(hasher, state.synaptic.in);
  hasher.add(std::uint64_t{state.synaptic.due} << 32 | state.synaptic.phase_ticks);
  hasher.add(state.synaptic.period_ticks, std::uint16_t{0});
  add(hasher, state.radio);
  add(hasher, state.serial);
  for (std::size_t i = 0; i < state.waiting.size(); ++i) {
    hasher.add(std::uint64_t{static_cast<std::uint8_t>(state.waiting[i])});
  }
  return hasher.sum();
}

}  // namespace rubric::machine
