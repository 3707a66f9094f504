#include "conformance/check/input/read.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/runtime/hdlc.h"
#include "conformance/check/identify/identity.h"
#include "conformance/check/message.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/must_read.h"

namespace rubric::check::read_test {
namespace {

constexpr const char* kFirmware = "spec/captures/firmware/";

TEST(Read, TapsAndNumbersOfACapture) {
  const check::Run run = must_read({std::string(kFirmware) + "c_two_islands.pcapng"});
  ASSERT_EQ(run.taps.size(), 3U);
  ASSERT_FALSE(run.seen.empty());
  const Observation& first = run.seen.front();
  EXPECT_EQ(first.kind, Observation::Kind::kSerial);
  EXPECT_TRUE(first.to_mote);
  EXPECT_TRUE(first.ack_request);
  EXPECT_EQ(first.place.frame, 1U);
  EXPECT_EQ(first.place.time_us, 0);
  EXPECT_EQ(run.seen[1].kind, Observation::Kind::kLinkAck);
  EXPECT_TRUE(run.has_time);
}

// Reads packets of two files, each a few at a time.
TEST(Read, ARunThatGrowsEndsAsItsFiles) {
  const std::vector<std::string> files = {std::string(kFirmware) + "a_join_data.pcapng",
                                          std::string(kFirmware) + "c_two_islands.pcapng"};
  constexpr std::size_t kPieceBytes = 501;
  RunReader growing;
  std::vector<std::string> bytes;
  std::vector<std::unique_ptr<Reader>> readers;
  for (const std::string& file : files) {
    growing.open(file);
    std::ifstream in(file, std::ios::binary);
    bytes.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    readers.push_back(make_reader(InputFormat::kPcapng));
  }
  std::size_t before = 0;
  for (std::size_t at = 0; at < std::max(bytes[0].size(), bytes[1].size()); at += kPieceBytes) {
    for (std::uint32_t file = 0; file < 2; ++file) {
      if (at >= bytes[file].size()) continue;
      const std::string piece = bytes[file].substr(at, kPieceBytes);
      auto take = [&](const Packet& packet) {
        growing.take(file, packet, readers[file]->interfaces()[packet.interface_id].name);
      };
      readers[file]->feed(Bytes(reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size()),
                          PacketSink(take));
    }
    const check::Run now = growing.snapshot();
    EXPECT_GE(now.seen.size(), before);
    before = now.seen.size();
  }
  const check::Run whole = must_read(files);
  const check::Run grown = growing.finish();
  EXPECT_EQ(grown.files, whole.files);
  ASSERT_EQ(grown.seen.size(), whole.seen.size());
  for (std::size_t i = 0; i < whole.seen.size(); ++i) {
    EXPECT_EQ(grown.seen[i].place.file, whole.seen[i].place.file) << i;
    EXPECT_EQ(grown.seen[i].place.frame, whole.seen[i].place.frame) << i;
    EXPECT_EQ(grown.seen[i].place.time_us, whole.seen[i].place.time_us) << i;
    EXPECT_EQ(grown.taps[grown.seen[i].tap].name, whole.taps[whole.seen[i].tap].name) << i;
  }
  EXPECT_EQ(growing.finish().seen.size(), 0U);
}

TEST(Read, TwoSinksOfOneAddressAreTwoDevices) {
  const check::Run run = must_read({std::string(kFirmware) + "c_two_islands.pcapng"});
  const Identity who = identify(run, Options{});
  std::vector<std::uint16_t> islands;
  for (const Device& device : who.devices) {
    EXPECT_TRUE(device.known) << device.name;
    if (device.role != machine::Role::kSink) continue;
    islands.push_back(device.island);
    EXPECT_EQ(device.taps.size(), 1U);
    EXPECT_TRUE(device.radio);
  }
  EXPECT_EQ(islands, (std::vector<std::uint16_t>{11, 12}));
}

TEST(Read, ADamagedSerialFrameIsHeardByNobody) {
  const check::Run run =
      must_read({std::string(kFirmware) + "h10_hdlc_escape_and_bad_serial.pcapng"});
  int damaged = 0;
  for (const Observation& seen : run.seen) {
    if (seen.kind != Observation::Kind::kDamaged) continue;
    ++damaged;
    EXPECT_EQ(seen.broken, "WIRE-SERIAL-CRC"_rule);
  }
  EXPECT_EQ(damaged, 1);
}

TEST(Read, FilesOfOneRunShareTheirClock) {
  const std::string log = "conformance/check/tests/testdata/b_reliable.app.rtr";
  const check::Run run = must_read({std::string(kFirmware) + "b_reliable.pcapng", log});
  ASSERT_EQ(run.nodes.size(), 3U);
  for (std::size_t i = 1; i < run.seen.size(); ++i) {
    EXPECT_LE(run.seen[i - 1].place.time_us, run.seen[i].place.time_us);
  }
  // moteJoined comes between ack_join and serial_joined.
  std::int64_t ack_us = 0, told_us = 0, report_us = 0;
  for (const Observation& seen : run.seen) {
    const bool serial = seen.kind == Observation::Kind::kSerial;
    if (seen.frame.type == am::kAckJoin && ack_us == 0) ack_us = seen.place.time_us;
    if (seen.kind == Observation::Kind::kNotice && told_us == 0) told_us = seen.place.time_us;
    if (serial && report_us == 0) report_us = seen.place.time_us;
  }
  EXPECT_LT(ack_us, told_us);
  EXPECT_LT(told_us, report_us);
}

TEST(Read, AMessageWithoutBytesMayComeFirst) {
  const std::string_view stream("\x55\x20\x08\x00\xff\xff\x00\x00\x00\x00\x02", 11);
  const check::Run run = must_read("stream", stream);
  ASSERT_EQ(run.seen.size(), 1U);
  EXPECT_TRUE(run.seen[0].frame.payload.empty());
}

TEST(Read, WhatCannotBeReadSaysWhy) {
  std::string error;
  EXPECT_FALSE(read({"no/such/file.pcapng"}, error));
  EXPECT_NE(error.find("no/such/file.pcapng"), std::string::npos);
  RunReader reader;
  EXPECT_FALSE(reader.add_bytes("x", "%rtr 1\nnonsense", error));
  EXPECT_NE(error.find("x:2"), std::string::npos) << error;
}

TEST(Read, ALogAloneIsARun) {
  constexpr const char* kLog = R"(%rtr 1  %profile paper  %tick us
%node m2 mote id=2
%node sA sink id=1 island=11

case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1000 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @200000 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
)";
  const check::Run run = must_read("log", kLog);
  Options options{.start_cold = true};
  const Report report = judge(run, options);
  bool early = false;
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::kFail) continue;
    EXPECT_EQ(finding.requirement, "J8-PERIOD"_rule) << finding.text;
    EXPECT_EQ(finding.place.offset_bytes, 8U);  // The line.
    early = true;
  }
  EXPECT_TRUE(early);
}

// A capture of a serial line, with or without flags of direction.
class SerialCapture {
 public:
  explicit SerialCapture(std::optional<bool> flags_of_mote) : flags_of_mote_(flags_of_mote) {
    file_ = reader_.open("line");
  }
  /// Adds a packet of the mote, or of the host.
  void add(bool of_mote, std::int32_t kind, std::initializer_list<int> payload, int type = 28) {
    std::vector<std::uint8_t> bytes{0, 0xFF, 0xFF, 0, 0, 0, 0, static_cast<std::uint8_t>(type)};
    for (const int byte : payload) bytes.push_back(static_cast<std::uint8_t>(byte));
    bytes[5] = static_cast<std::uint8_t>(payload.size());
    if (kind == kSerialAck) bytes.clear();
    Packet packet{
        .framing = Framing::kHdlc, .bytes = Bytes(bytes.data(), bytes.size()), .kind = kind};
    if (serial_kind_has_seq(kind)) packet.serial_seq = 7;
    packet.time_ns = 1'000'000 * ++count_;
    if (flags_of_mote_) {
      packet.direction = of_mote == *flags_of_mote_ ? Direction::kOutbound : Direction::kInbound;
    }
    reader_.take(file_, packet, "serial:1");
  }
  /// Returns the ways of all: "d" to the mote, "u" from it.
  std::string ways() {
    run_ = reader_.finish();
    std::string out;
    for (const Observation& seen : run_.seen) out += seen.to_mote ? "d" : "u";
    return out;
  }
  const check::Run& run() const { return run_; }

 private:
  std::optional<bool> flags_of_mote_;
  RunReader reader_;
  check::Run run_;
  std::uint32_t file_ = 0;
  std::int64_t count_ = 0;
};

// A host sends a message, and the mote hands it back.
void add_echo(SerialCapture& line) {
  const std::initializer_list<int> message = {0, 12, 0, 2, 0, 11, 255, 253, 0, 0, 5, 2, 3, 5};
  line.add(false, kSerialPacketAck, message);
  line.add(true, kSerialAck, {});
  line.add(true, kSerialPacketNoAck, message);
}

TEST(Read, ThePacketsKindShowsItsWay) {
  SerialCapture line({});
  add_echo(line);
  EXPECT_EQ(line.ways(), "duu");
  SerialCapture unnumbered({});  // Then the message decides.
  unnumbered.add(false, kSerialPacketNoAck, {0, 12, 0, 2, 0, 11, 255, 253, 0, 0, 5, 2, 3, 5});
  unnumbered.add(true, kSerialPacketNoAck, {0, 11, 255, 253, 0, 11, 0, 2, 0, 0, 5, 2, 3, 5});
  // What another island sends to that of the line goes down it.
  unnumbered.add(false, kSerialPacketNoAck, {0, 11, 0, 4, 0, 12, 0, 5, 0, 0, 6, 2, 3, 5});
  unnumbered.add(true, kSerialPacketNoAck, {0, 12, 0, 5, 0, 11, 0, 4, 0, 0, 7, 2, 3, 5});
  EXPECT_EQ(unnumbered.ways(), "dudu");
}

TEST(Read, FlagsOfTheCapturingHostAreTurned) {
  for (const bool of_mote : {true, false}) {
    SerialCapture line(of_mote);
    add_echo(line);
    EXPECT_EQ(line.ways(), "duu") << of_mote;
    EXPECT_EQ(line.run().facts.size(), of_mote ? 0U : 1U);
  }
  SerialCapture sink_only(false);
  sink_only.add(true, kSerialPacketNoAck, {0, 11, 255, 253, 0, 11, 0, 2, 0, 0, 5, 2, 3, 5});
  EXPECT_EQ(sink_only.ways(), "u");
}

TEST(Read, MistakesOfALogAreAllSaidBeforeAFrameThatCannotBe) {
  const std::string log =
      "%rtr 1\n%node m2 mote id=2\ncase log\n"
      "@0 m2 > rA am=2->1 join_request(seq_num=* mote_type=1 transducers=1 actuators=1)\n";
  std::string error;
  EXPECT_FALSE(RunReader().add_bytes("x", log, error));
  EXPECT_EQ(error.substr(0, 5), "x:4: ") << error;
  EXPECT_FALSE(RunReader().add_bytes("x", log + "@0 m2 > rA *\nnonsense\n", error));
  EXPECT_EQ(error.substr(0, 4), "x:6:") << error;
}

TEST(Read, ALogThatEndsWithinALineIsTakenUpToThat) {
  constexpr const char* kLog = R"(%rtr 1  %profile paper
%node m2 mote id=2
case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @5 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 trans)";
  for (const char* end : {"", "\n"}) {
    RunReader reader;
    std::string error;
    const bool taken = reader.add_bytes("log", std::string(kLog) + end, error);
    EXPECT_EQ(taken, *end == 0) << error;
    if (!taken) continue;
    const check::Run run = reader.finish();
    EXPECT_TRUE(run.cut);
    EXPECT_EQ(run.seen.size(), 1U);
  }
}

}  // namespace
}  // namespace rubric::check::read_test
