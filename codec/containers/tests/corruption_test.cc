// Corrupts real serial streams and checks that every frame left intact is still found.
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/tests/captures.h"
#include "codec/containers/tests/testing.h"
#include "codec/runtime/hdlc.h"
#include "tools/tests/made_inputs.h"
#include "tools/tests/readme/number.h"

namespace rubric {
namespace {

using namespace testing;

// Returns the frames of all firmware captures, flags included, from their lists.
std::vector<std::string> captured_frames() {
  std::vector<std::string> frames;
  for (const std::string& path : files("spec/captures/firmware", ".sf.jsonl")) {
    for (const auto& row : read_jsonl(path)) {
      frames.push_back(from_hex(row["hdlc"].get<std::string>()));
    }
  }
  return frames;
}

// A byte that remembers its origin; frame -1 for one that the corruption made.
struct Traced {
  std::uint8_t byte;
  int frame;
  std::size_t at;
};

std::vector<Traced> trace(const std::vector<std::string>& frames) {
  std::vector<Traced> stream;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t at = 0; at < frames[i].size(); ++at) {
      stream.push_back({static_cast<std::uint8_t>(frames[i][at]), static_cast<int>(i), at});
    }
  }
  return stream;
}

// Makes one random flip, drop, insertion or truncation; every third hits flags and escapes.
void corrupt(std::vector<Traced>& stream, std::mt19937& random) {
  const std::uint8_t nasty[] = {kHdlcFlag, kHdlcEscape, 0x5E, 0x00};
  const auto made = [&] {
    return Traced{random() % 3 == 0 ? nasty[random() % 4] : static_cast<std::uint8_t>(random()), -1,
                  0};
  };
  const std::size_t at = random() % stream.size();
  const auto here = stream.begin() + static_cast<std::ptrdiff_t>(at);
  const std::size_t run = std::min<std::size_t>(stream.size() - at, 1 + random() % 8);
  switch (random() % 8) {
    case 0:  // A run is lost.
      stream.erase(here, here + static_cast<std::ptrdiff_t>(run));
      break;
    case 1: stream.erase(here); break;
    case 2:  // Noise on the idle line or within a frame.
      for (std::size_t i = 0; i < run; ++i) {
        stream.insert(stream.begin() + static_cast<std::ptrdiff_t>(at), made());
      }
      break;
    case 3: stream.insert(here, made()); break;
    case 4: {  // The line breaks down for a while.
      auto end = here;
      while (end != stream.end() && end->frame >= 0 && random() % 64 != 0) ++end;
      stream.erase(here, end);
      break;
    }
    case 5: *here = made(); break;
    default:
      here->byte = static_cast<std::uint8_t>(here->byte ^ 1u << random() % 8);
      here->frame = -1;
      break;
  }
}

// Returns where in the stream each intact frame's content begins: all its bytes in order, flags
// included.
std::map<std::uint64_t, int> intact_frames(const std::vector<Traced>& stream,
                                           const std::vector<std::string>& frames) {
  std::map<std::uint64_t, int> found;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (stream[i].frame < 0 || stream[i].at != 0) continue;
    const int frame = stream[i].frame;
    const std::size_t size = frames[static_cast<std::size_t>(frame)].size();
    std::size_t n = 0;
    while (n < size && i + n < stream.size() && stream[i + n].frame == frame &&
           stream[i + n].at == n) {
      ++n;
    }
    if (n == size) found[i + 1] = frame;
  }
  return found;
}

using Deframe = std::function<std::vector<Kept>(Bytes)>;

constexpr int kRounds = made_inputs(300);

struct Tally {
  std::size_t corruptions = 0;
  std::size_t frames = 0;
  std::size_t intact = 0;
  std::size_t missed = 0;
  std::size_t sound = 0;  // Packets without fault.
};

void run_round(const std::vector<std::string>& frames, int seed, const Deframe& deframe,
               Tally& tally) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::vector<Traced> stream = trace(frames);
  const std::size_t corruptions = 1 + random() % 200;
  for (std::size_t i = 0; i < corruptions; ++i) corrupt(stream, random);
  std::vector<std::uint8_t> bytes;
  for (const Traced& traced : stream) bytes.push_back(traced.byte);
  std::map<std::uint64_t, const Kept*> by_offset;
  const std::vector<Kept> got = deframe(Bytes(bytes.data(), bytes.size()));
  for (const Kept& kept : got) {
    by_offset[kept.packet.offset_bytes] = &kept;
    tally.sound += kept.packet.error.fault == Fault::kNone;
  }
  for (const auto& [offset, frame] : intact_frames(stream, frames)) {
    ++tally.intact;
    const auto it = by_offset.find(offset);
    std::string rebuilt;
    if (it != by_offset.end()) HdlcWriter().write(it->second->get(), rebuilt);
    if (rebuilt != frames[static_cast<std::size_t>(frame)]) ++tally.missed;
  }
  tally.corruptions += corruptions;
  tally.frames += frames.size();
}

TEST(WireHdlcFlag, IntactFramesAreFoundAmongCorruptedOnes) {
  const std::vector<std::string> frames = captured_frames();
  ASSERT_GT(frames.size(), 200u);
  Tally tally;
  for (int seed = 1; seed <= kRounds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const CpuPath path = static_cast<CpuPath>(seed % 3);
    HdlcReader reader({}, cpu_has(path) ? path : CpuPath::kPortable);
    const std::size_t piece_max = seed % 2 == 0 ? 1'000'000 : 200;
    run_round(
        frames, seed, [&](Bytes bytes) { return read_split(reader, bytes, random, piece_max); },
        tally);
  }
  std::cout << tally.corruptions << " corruptions in " << tally.frames << " frames; "
            << tally.intact << " left intact, " << tally.missed << " of them missed; "
            << tally.sound << " packets without fault\n";
  if (!kSanitized) {
    EXPECT_EQ(tally.corruptions, readme_number("# seeded corruptions"));
  }
  EXPECT_EQ(tally.missed, 0u);
  EXPECT_GT(tally.intact, tally.frames / 4);
  EXPECT_LT(tally.intact, tally.frames);
}

// Runs the mote's deframer, byte by byte. It knows no offsets: a frame begins after the flag before
// it.
std::vector<Kept> deframe_as_a_mote(Bytes stream) {
  std::vector<Kept> kept;
  std::uint8_t buffer[serial_content_max(kSerialPacketAck)];
  HdlcDeframer deframer((MutableBytes(buffer)));
  std::size_t begin = 0;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const HdlcEvent event = deframer.push(stream[i]);
    if (event != HdlcEvent::kNone) {
      Packet packet{.framing = Framing::kHdlc, .offset_bytes = begin};
      // For a sound frame the buffer still holds the CRC after the content.
      const std::size_t crc_bytes = event == HdlcEvent::kFrame ? kSerialCrcBytes : 0;
      split_serial_content(Bytes(buffer, deframer.content().size() + crc_bytes), packet);
      packet.error = deframer.error();
      kept.emplace_back(packet);
    }
    if (stream[i] == kHdlcFlag) begin = i + 1;
  }
  return kept;
}

// Returns the common part of two deframers' results: all but the rest of a stream without its flag,
// which a mote does not report, and the bytes of a frame that was too long or aborted, of which
// each keeps its own.
std::vector<Kept> comparable(const std::vector<Kept>& all) {
  std::vector<Kept> out;
  for (const Kept& kept : all) {
    const Fault fault = kept.packet.error.fault;
    if (fault == Fault::kCut) continue;
    out.push_back(kept);
    if (fault != Fault::kTooLong && fault != Fault::kAborted) continue;
    Packet packet{.framing = Framing::kHdlc};
    packet.offset_bytes = kept.packet.offset_bytes;
    packet.error.fault = fault;
    out.back() = Kept(packet);
  }
  return out;
}

// Both share a flag between two frames, so they must find the same frames with the same faults, not
// only those that were left intact.
TEST(WireHdlcFlag, TheMotesDeframerFindsTheSameFrames) {
  const std::vector<std::string> frames = captured_frames();
  Tally tally;
  std::size_t compared = 0;
  for (int seed = 1; seed <= kRounds; ++seed) {
    run_round(
        frames, seed,
        [&](Bytes bytes) {
          const std::vector<Kept> mote = deframe_as_a_mote(bytes);
          HdlcReader reader;
          EXPECT_EQ(comparable(mote), comparable(read_all(reader, bytes))) << "seed " << seed;
          compared += mote.size();
          return mote;
        },
        tally);
  }
  std::cout << tally.corruptions << " corruptions in " << tally.frames << " frames; "
            << tally.intact << " left intact, " << tally.missed << " of them missed by the mote's; "
            << compared << " frames the same from both, " << tally.sound << " without fault\n";
  if (!kSanitized) {
    EXPECT_EQ(tally.corruptions, readme_number("# seeded corruptions"));
  }
  EXPECT_EQ(tally.missed, 0u);
  EXPECT_GT(tally.intact, tally.frames / 4);
  EXPECT_GT(compared, tally.sound);
}

// A deframer with a common mistake: flags strictly open and close by turns.
std::vector<Kept> deframe_by_turns(Bytes stream) {
  std::vector<Kept> kept;
  bool inside = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (stream[i] != kHdlcFlag) continue;
    if (inside) {
      HdlcReader reader;
      auto sink = [&](const Packet& packet) {
        kept.emplace_back(packet);
        kept.back().packet.offset_bytes = begin;
      };
      reader.feed(stream.sub(begin, i + 1 - begin), sink);
    }
    inside = !inside;
    begin = i + 1;
  }
  return kept;
}

TEST(WireHdlcFlag, TheCheckAboveSeesADeframerThatLosesFrames) {
  Tally tally;
  for (int seed = 1; seed <= 5; ++seed) run_round(captured_frames(), seed, deframe_by_turns, tally);
  EXPECT_GT(tally.missed, 0u);
}

}  // namespace
}  // namespace rubric
