// Compares the generated codec with code written by hand for these messages: a packed structure,
// the same checks, byte swaps. Compare pairs of the same run; the ratio is what counts.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "codec/generated/rubicon/all.h"

namespace rubric::rubicon {
namespace {

// Input: net_msg frames as a sink puts them on the serial line.

// Kinds of message bodies.
enum Mix : int { kUpdates = 0, kReadUpdates = 1, kSynaptic = 2, kMixed = 3 };
constexpr std::size_t kFrameCount = 1024;
using Frame = std::vector<std::uint8_t>;

Frame make_frame(int kind, std::mt19937& random) {
  Frame f(114);  // Stale bytes fill it up.
  for (std::uint8_t& byte : f) byte = static_cast<std::uint8_t>(random());
  f[6] = 0;  // From a mote.
  f[8] &= 1;
  f[12] = 3;
  f[13] = 10;
  const auto n = static_cast<std::uint8_t>(1 + random() % 10);
  switch (kind) {
    case kUpdates:
      f[14] = 35;
      f[15] = n;
      f[11] = static_cast<std::uint8_t>(4 + 4 * n);
      break;
    case kReadUpdates:
      f[14] = 36;
      f[11] = 7;
      break;
    case kSynaptic:
      f[12] = 1;
      f[13] = 11;
      f[11] = static_cast<std::uint8_t>(2 + 4 * n);
      break;
    default:  // An application's own.
      f[13] = 8;
      f[11] = 20;
      break;
  }
  return f;
}

std::vector<Frame> make_frames(int mix) {
  std::mt19937 random(7);
  std::vector<Frame> out;
  for (std::size_t i = 0; i < kFrameCount; ++i) {
    const int kind = mix == kMixed ? static_cast<int>(random() % 4) : mix;
    out.push_back(make_frame(kind, random));
  }
  return out;
}

struct __attribute__((packed)) HandNetMsg {
  std::uint16_t dest_pid, dest_devid, src_pid, src_devid;
  std::uint8_t reliable;
  std::uint16_t seq_num;
  std::uint8_t nbytes, trans_id, app_id;
};
struct __attribute__((packed)) HandUpdates {
  std::uint8_t type, count;
  struct __attribute__((packed)) {
    std::uint16_t transducer, value;
  } updates[24];
};
struct __attribute__((packed)) HandReadUpdates {
  std::uint8_t type;
  std::uint16_t rate, transducers;
};

template <class T>
void take(T value) {
  benchmark::DoNotOptimize(value);
}
void take16(std::uint16_t value) { take(__builtin_bswap16(value)); }

bool hand_updates(const std::uint8_t* body, std::size_t size) {
  if (size < 2) return false;
  const auto* u = reinterpret_cast<const HandUpdates*>(body);
  if (u->count > 24 || size - 2 < std::size_t{u->count} * 4) return false;
  take(u->type);
  take(u->count);
  for (int i = 0; i < u->count; ++i) {
    take16(u->updates[i].transducer);
    take16(u->updates[i].value);
  }
  return true;
}

bool hand_read(const std::uint8_t* p, std::size_t size) {
  if (size < 12) return false;
  const auto* h = reinterpret_cast<const HandNetMsg*>(p);
  if (h->reliable > 1 || h->nbytes < 2 || h->nbytes > 102 || size - 12 < h->nbytes) return false;
  take16(h->dest_pid);
  take16(h->dest_devid);
  take16(h->src_pid);
  take16(h->src_devid);
  take(h->reliable);
  take16(h->seq_num);
  take(h->nbytes);
  take(h->trans_id);
  take(h->app_id);
  const std::uint8_t* body = p + 14;
  const std::size_t n = h->nbytes - 2U;
  if (h->trans_id == 3 && h->app_id == 10 && n > 0) {
    if (body[0] == 35 && hand_updates(body, n)) return true;
    if (body[0] == 36 && n >= 5) {
      const auto* r = reinterpret_cast<const HandReadUpdates*>(body);
      take(r->type);
      take16(r->rate);
      take16(r->transducers);
      return true;
    }
  } else if (h->trans_id == 1 && n % 4 == 0) {
    for (std::size_t i = 0; i < n; i += 4) {
      float value;
      std::memcpy(&value, body + i, 4);
      take(value);
    }
    return true;
  }
  take(body);
  take(n);
  return true;
}

bool view_read(Bytes bytes) {
  const Result<NetMsgView> parsed = NetMsgView::parse(bytes);
  if (!parsed) return false;
  const NetMsgView m = *parsed;
  take(m.dest().pid());
  take(m.dest().devid());
  take(m.src().pid());
  take(m.src().devid());
  take(m.reliable());
  take(m.seq_num());
  take(m.nbytes());
  const AppMsgView app = m.payload_as_app_msg();
  take(app.trans_id());
  take(app.app_id());
  switch (app.body_kind()) {
    case AppMsgView::BodyKind::kUpdates: {
      const UpdatesView u = app.body_as_updates();
      take(u.type());
      take(u.output_size());
      for (const TransducerUpdateView update : u.updates()) {
        take(update.transducer().raw());
        take(update.value());
      }
      return true;
    }
    case AppMsgView::BodyKind::kReadUpdates: {
      const ReadUpdatesView r = app.body_as_read_updates();
      take(r.type());
      take(r.sampling_rate());
      take(r.transducers().raw());
      return true;
    }
    case AppMsgView::BodyKind::kSynapticData:
      for (const float value : app.body_as_synaptic_data().values()) take(value);
      return true;
    default:
      take(app.payload().data());
      take(app.payload().size());
      return true;
  }
}

void BM_ReadByHand(benchmark::State& state) {
  const std::vector<Frame> frames = make_frames(static_cast<int>(state.range(0)));
  std::size_t i = 0;
  for (auto _ : state) {
    const Frame& f = frames[i++ % kFrameCount];
    if (!hand_read(f.data(), f.size())) std::abort();
  }
}
void BM_ReadByView(benchmark::State& state) {
  const std::vector<Frame> frames = make_frames(static_cast<int>(state.range(0)));
  std::size_t i = 0;
  for (auto _ : state) {
    const Frame& f = frames[i++ % kFrameCount];
    if (!view_read(Bytes(f.data(), f.size()))) std::abort();
  }
}
BENCHMARK(BM_ReadByHand)->DenseRange(kUpdates, kMixed);
BENCHMARK(BM_ReadByView)->DenseRange(kUpdates, kMixed);

// Values unknown to the compiler.
struct Input {
  std::uint16_t seq_num = 1;
  std::uint8_t reliable = 1;
  std::uint8_t nbytes = 24;
  std::uint16_t readings[5] = {1, 2, 3, 4, 5};
  std::size_t room = 114;
};

void BM_WriteByHand(benchmark::State& state) {
  std::uint8_t out[114] = {};
  Input in;
  for (auto _ : state) {
    benchmark::DoNotOptimize(in);
    if (in.room < 14) std::abort();
    auto* h = reinterpret_cast<HandNetMsg*>(out);
    h->dest_pid = __builtin_bswap16(11);
    h->dest_devid = __builtin_bswap16(0xfffd);
    h->src_pid = __builtin_bswap16(11);
    h->src_devid = __builtin_bswap16(in.seq_num);
    if (in.reliable > 1) std::abort();
    h->reliable = in.reliable;
    h->seq_num = __builtin_bswap16(in.seq_num);
    if (in.nbytes < 2 || in.nbytes > 102 || in.nbytes > in.room - 12) std::abort();
    h->nbytes = in.nbytes;
    h->trans_id = 3;
    h->app_id = 10;
    auto* u = reinterpret_cast<HandUpdates*>(out + 14);
    if (in.room < 14 + 2 + 20) std::abort();
    u->type = 35;
    u->count = 5;
    for (int i = 0; i < 5; ++i) {
      u->updates[i].transducer = __builtin_bswap16(static_cast<std::uint16_t>(1 << i));
      u->updates[i].value = __builtin_bswap16(in.readings[i]);
    }
    benchmark::DoNotOptimize(out);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_WriteByHand);

bool build(const Input& in, MutableBytes out) {
  const Result<NetMsgBuilder> made = NetMsgBuilder::create(out);
  if (!made) return false;
  NetMsgBuilder net = *made;
  net.set_dest({Pid(11), Devid::kNull});
  net.set_src({Pid(11), Devid(in.seq_num)});
  if (!net.set_reliable(in.reliable)) return false;
  net.set_seq_num(in.seq_num);
  if (!net.set_nbytes(in.nbytes)) return false;
  const Result<AppMsgBuilder> app_made = AppMsgBuilder::create(net.payload_room());
  if (!app_made) return false;
  AppMsgBuilder app = *app_made;
  app.set_trans_id(Component::kConnless);
  app.set_app_id(Component::kControlLayer);
  const Result<UpdatesBuilder> updates_made = UpdatesBuilder::create(app.payload_room());
  if (!updates_made) return false;
  UpdatesBuilder updates = *updates_made;
  updates.set_type(AmType::kUpdates);
  if (!updates.set_output_size(5)) return false;
  for (std::size_t i = 0; i < 5; ++i) {
    updates.updates(i).set_transducer(TransducerMask(static_cast<std::uint16_t>(1 << i)));
    updates.updates(i).set_value(in.readings[i]);
  }
  return true;
}

void BM_WriteByBuilder(benchmark::State& state) {
  std::uint8_t out[114] = {};
  Input in;
  for (auto _ : state) {
    benchmark::DoNotOptimize(in);
    if (!build(in, MutableBytes(out, in.room))) std::abort();
    benchmark::DoNotOptimize(out);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_WriteByBuilder);

// Checks a whole active message after the deframer, header and payload, as a pipeline does.
void BM_ValidateActiveMessage(benchmark::State& state) {
  std::vector<Frame> frames = make_frames(static_cast<int>(state.range(0)));
  for (Frame& f : frames) {
    const std::uint8_t kHeader[] = {0, 0xff, 0xff, 0, 0, 114, 0, 28};
    f.insert(f.begin(), kHeader, kHeader + 8);
  }
  std::size_t i = 0;
  std::size_t bytes = 0;
  for (auto _ : state) {
    const Frame& f = frames[i++ % kFrameCount];
    const Result<RubiconView> view = RubiconView::parse(Bytes(f.data(), f.size()));
    if (!view) std::abort();
    if (view->payload_kind() != RubiconView::PayloadKind::kNetMsg) std::abort();
    take(view->payload_as_net_msg().payload_as_app_msg().body_kind());
    bytes += f.size();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}
BENCHMARK(BM_ValidateActiveMessage)->DenseRange(kUpdates, kMixed);

}  // namespace
}  // namespace rubric::rubicon
