// `rubric decode` and `rubric check` read the same of any bytes: whether a packet is readable, by
// which rule it is not, whose message it is, and each field that check uses. Compared over every
// capture, every corpus file of the fuzzers in every format, and 100,000 generated frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/tests/testing.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/framer.h"
#include "codec/frame_generator/known_protocols.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/frame.h"
#include "conformance/check/input/read.h"
#include "conformance/check/input/read_packet.h"
#include "conformance/check/message.h"
#include "conformance/check/observation.h"
#include "conformance/check/storage.h"
#include "conformance/check/tests/failures.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
namespace {

namespace fs = std::filesystem;
using Kind = Observation::Kind;
using reflect::Decoded;

// Rules of what is around a message. Whoever breaks one is heard by nobody; a fault within the
// message is its sender's.
bool is_around(ReqId rule) {
  constexpr ReqId kAround[] = {"WIRE-AM-DISPATCH"_rule,   "WIRE-AM-HEADER"_rule,
                               "WIRE-AM-LENGTH"_rule,     "WIRE-RADIO-HEADER"_rule,
                               "WIRE-RADIO-NETWORK"_rule, "WIRE-RADIO-LENGTH"_rule};
  return std::ranges::find(kAround, rule) != std::end(kAround);
}

/// Compares packets, and counts what they were.
class Comparer {
 public:
  void packet(const Packet& packet) {
    packet_ = &packet;
    decoder_.decode(packet, frame_);
    seen_ = Observation();
    const bool kept = observe_packet(packet, storage_, seen_);
    ++packets_;
    compare(kept);
  }

  /// All packets that the bytes hold in that format.
  void bytes(const std::string& bytes, InputFormat format, Framing hex) {
    ReaderOptions options{.hex_framing = hex};
    const std::unique_ptr<Reader> reader = make_reader(format, options);
    ASSERT_TRUE(reader);
    auto take = [&](const Packet& packet) { this->packet(packet); };
    reader->feed(testing::view(bytes), PacketSink(take));
    reader->finish(PacketSink(take));
  }

  long packets() const { return packets_; }
  long count(const std::string& what) const {
    const auto found = counts_.find(what);
    return found == counts_.end() ? 0 : found->second;
  }
  void print(const char* of) const {
    std::printf("%s: %ld packets", of, packets_);
    for (const auto& [what, count] : counts_) std::printf(", %s %ld", what.c_str(), count);
    std::printf("\n");
  }

 private:
  void met(const char* what) { ++counts_[what]; }

  std::string shown() const {
    return testing::to_hex(packet_->bytes) + ", framing " +
           std::to_string(static_cast<int>(packet_->framing)) +
           ", decode: " + std::string(reflect::fault_name(frame_.error.fault)) + " at " +
           std::to_string(frame_.error.offset_bytes) + " by " +
           reflect::requirement(frame_.error.requirement).id;
  }

  void compare(bool kept) {
    const Error& error = frame_.error;
    // A message that is cut short may break a rule of its own first.
    const std::size_t came = packet_->bytes.size() - tinyos::AmHeaderView::kMaxSizeBytes;
    const bool lies =
        packet_->framing != Framing::kRadio && frame_.am.present && frame_.am.length != came;
    if (packet_->error.fault != Fault::kNone || is_around(error.requirement) || lies) {
      met("damaged");
      ASSERT_TRUE(kept && seen_.kind == Kind::kDamaged) << shown();
      ASSERT_NE(error.fault, Fault::kNone) << shown();
      ASSERT_EQ(seen_.broken, error.requirement) << shown();
      return;
    }
    const Decoded& decoded = frame_.decoded;
    const bool serial_ack = packet_->framing == Framing::kHdlc &&
                            packet_->kind == static_cast<std::int32_t>(tinyos::SerialKind::kAck);
    const bool radio_ack =
        decoded.path_count() == 1 && std::string_view(decoded.message()->id) == "mac_ack";
    if (serial_ack || radio_ack) {
      met("link acks");
      ASSERT_TRUE(kept && seen_.kind == Kind::kLinkAck) << shown();
      const std::int64_t number = serial_ack ? packet_->serial_seq : number_of(0, {"dsn"});
      ASSERT_EQ(seen_.has_dsn ? seen_.dsn : kAbsent, number) << shown();
      return;
    }
    if (decoded.node_count() == 0) {
      met("opaque");
      ASSERT_FALSE(kept) << shown();
      return;
    }
    headers(kept);
    message();
  }

  void headers(bool kept) {
    const bool radio = packet_->framing == Framing::kRadio;
    ASSERT_TRUE(kept && seen_.kind == (radio ? Kind::kRadio : Kind::kSerial)) << shown();
    const reflect::ActiveMessage& am = frame_.am;
    ASSERT_TRUE(am.present) << shown();
    ASSERT_EQ(seen_.frame.dest, am.dest) << shown();
    ASSERT_EQ(seen_.frame.src, am.src) << shown();
    ASSERT_EQ(seen_.frame.type, am.type) << shown();
    ASSERT_EQ(seen_.frame.payload.size(), am.length) << shown();
    ASSERT_TRUE(equal(seen_.frame.payload, packet_->bytes.from(packet_->bytes.size() - am.length)));
    const std::int32_t dsn = radio ? frame_.mac.dsn : packet_->serial_seq;
    ASSERT_EQ(seen_.has_dsn ? seen_.dsn : kAbsent, dsn) << shown();
    if (!radio) return;
    const std::int64_t fcf = number_of(0, {"mac", "fcf"});
    constexpr auto kAsks = static_cast<std::int64_t>(tinyos::FrameControlPart::kAckRequest);
    ASSERT_EQ(seen_.ack_request, (fcf & kAsks) != 0) << shown();
    ASSERT_EQ(seen_.pan, number_of(0, {"mac", "destpan"})) << shown();
  }

  // Of the fields below `node` by name; -1 where there is none.
  std::int64_t number_of(std::size_t node, const std::vector<const char*>& path) const {
    for (const char* name : path) {
      node = frame_.decoded.child(node, name);
      if (node == 0) return -1;
    }
    return frame_.decoded[node].value;
  }
  void same(std::int64_t ours, std::size_t node, const std::vector<const char*>& path) {
    ASSERT_EQ(ours, number_of(node, path)) << path.back() << " of " << shown();
  }
  void same(machine::Address ours, std::size_t node, const char* name) {
    same(ours.pid, node, {name, "pid"});
    same(ours.devid, node, {name, "devid"});
  }
  void same(const machine::Descriptor& ours, std::size_t node, const char* name) {
    same(ours.mote_type, node, {name, "mote_type"});
    same(ours.transducers, node, {name, "transducers"});
    same(ours.actuators, node, {name, "actuators"});
  }

  // Node of the innermost message of that name; 0 if decode found none.
  std::size_t node_of(std::string_view id) const {
    for (std::size_t i = frame_.decoded.node_count(); i-- > 1;) {
      const reflect::Type* const type = frame_.decoded[i].type;
      if (type != nullptr && id == type->id) return i;
    }
    return 0;
  }

  void message() {
    const Bytes payload = seen_.frame.payload;
    Request request;
    Reply reply;
    AckJoin ack;
    switch (seen_.frame.type) {
      case am::kJoin:
        if (!readable(parse_request(payload, request), "join_request")) return;
        same(request.seq_num, node_, {"seq_num"});
        return same(request.descriptor, node_, "mote_desc");
      case am::kJoinReply:
        if (!readable(parse_reply(payload, reply), "join_reply")) return;
        same(reply.island, node_, {"island_addr"});
        same(reply.mote, node_, {"mote_addr"});
        same(reply.time_ms, node_, {"cur_time"});
        return same(reply.seq_num, node_, {"seq_num"});
      case am::kAckJoin:
        if (!readable(parse_ack_join(payload, ack), "ack_join")) return;
        same(ack.dest, node_, "dest");
        same(ack.src, node_, "src");
        same(ack.seq_num, node_, {"seq_num"});
        return same(ack.descriptor, node_, "mote_desc");
      case am::kConfig: return config();
      case am::kNet: return net();
      default: met("not looked into"); return;
    }
  }

  // Whether both could read it; a difference is a failure.
  bool readable(bool ours, const char* id) {
    node_ = frame_.malformed() ? 0 : node_of(id);
    met(ours ? id : "unreadable messages");
    EXPECT_EQ(ours, node_ != 0) << id << " of " << shown();
    return ours && node_ != 0;
  }

  void config() {
    if (seen_.kind != Kind::kSerial) return met("not looked into");
    const std::int32_t island = set_island_id(seen_.frame);
    if (!readable(rubicon::ConfigView::parse(seen_.frame.payload).has_value(), "config")) {
      ASSERT_EQ(island, -1) << shown();
      return;
    }
    constexpr auto kSet = static_cast<std::int64_t>(rubicon::CommandCode::kSetIslandId);
    const std::int64_t value = number_of(node_, {"value"});
    const bool usable = !machine::is_reserved(static_cast<std::uint16_t>(value));
    ASSERT_EQ(island, number_of(node_, {"type"}) == kSet && usable ? value : -1) << shown();
  }

  // Check reads the header of a net_msg that breaks a rule, as it judges who sent it.
  void net() {
    Net net;
    const bool whole = parse_net(seen_.frame.payload, net);
    const Error& error = frame_.error;
    const ReqId rule = error.requirement;
    if (rule == "WIRE-NET-NBYTES"_rule && error.fault == Fault::kOutOfRange) {
      met("nbytes out of range");
      ASSERT_TRUE(whole && !net.sound && !NetAt::NbytesAt::allows(net.nbytes)) << shown();
    } else if (rule == "WIRE-NET-PAYLOAD"_rule) {
      met("nbytes beyond the message");
      ASSERT_TRUE(whole && !net.sound && NetAt::NbytesAt::allows(net.nbytes)) << shown();
    } else if (rule == "WIRE-NET-RELIABLE"_rule && error.fault == Fault::kOutOfRange) {
      met("reliable out of range");
      ASSERT_TRUE(!whole || !NetAt::ReliableAt::allows(net.reliable)) << shown();
    } else if (error.fault != Fault::kNone) {
      met("unreadable messages");
      ASSERT_EQ(error.fault, Fault::kTruncated) << shown();
      ASSERT_FALSE(whole) << shown();
    } else {
      ASSERT_TRUE(whole && net.sound && NetAt::ReliableAt::allows(net.reliable)) << shown();
      sound(net);
    }
  }

  void sound(const Net& net) {
    met("net_msg");
    const std::size_t node = node_of("net_msg");
    ASSERT_NE(node, 0U) << shown();
    same(net.dest, node, "dest");
    same(net.src, node, "src");
    same(net.reliable, node, {"reliable"});
    same(net.seq_num, node, {"seq_num"});
    same(net.nbytes, node, {"nbytes"});
    const std::size_t app = frame_.decoded.child(node, "payload");
    same(net.trans_id, app, {"trans_id"});
    same(net.app_id, app, {"app_id"});
    ASSERT_EQ(frame_.decoded[app].size, net.payload.size()) << shown();
    ASSERT_TRUE(equal(net.payload,
                      packet_->bytes.sub(frame_.decoded[app].offset, frame_.decoded[app].size)));
    report(net);
    acked(net);
  }

  // A node takes fewer bodies for acks than decode shows as such (decision 108).
  void acked(const Net& net) {
    const std::int32_t number = machine::acked_seq_num(net.body());
    const std::size_t deployed = node_of("rubicon_ack");
    const std::size_t node = deployed != 0 ? deployed : node_of("rubicon_ack_seq_only");
    constexpr auto kType = static_cast<std::int64_t>(rubicon::AmType::kLearningNotification);
    const bool other = deployed != 0 && number_of(deployed, {"type"}) != kType;
    if (!net.is_ack() || number < 0 || other) return;
    met("acks");
    same(number, node, {"seq_num"});
  }

  void report(const Net& net) {
    SerialJoined joined;
    const bool ours = parse_serial_joined(net, joined);
    constexpr auto kType = static_cast<std::int64_t>(rubicon::AmType::kSerialJoined);
    const std::size_t node = node_of("serial_joined");
    ASSERT_EQ(ours, node != 0 && number_of(node, {"msg_type"}) == kType) << shown();
    if (!ours) return;
    met("serial_joined");
    same(joined.address.pid, node, {"island_addr"});
    same(joined.address.devid, node, {"mote_addr"});
    same(joined.descriptor.mote_type, node, {"mote_type"});
    same(joined.descriptor.transducers, node, {"transducers"});
    same(joined.descriptor.actuators, node, {"actuators"});
  }

  const reflect::FrameDecoder decoder_{rubicon::tables::kProtocol};
  RunStorage storage_;
  reflect::Frame frame_;
  Observation seen_;
  const Packet* packet_ = nullptr;
  std::size_t node_ = 0;
  long packets_ = 0;
  std::map<std::string, long> counts_;
};

std::vector<std::string> files_of(const char* folder) {
  std::vector<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) out.push_back(entry.path().string());
  }
  return out;
}

// The values of `"key":"..."`; the captures' JSON lines have the bytes of frames in them.
std::string hex_lines(const std::string& text, const std::string& key) {
  std::string out;
  const std::string before = '"' + key + '"';
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    const std::size_t begin = text.find('"', at + before.size()) + 1;
    at = text.find('"', begin);
    out += text.substr(begin, at - begin) + '\n';
  }
  return out;
}

TEST(OneReader, OfEveryCapture) {
  Comparer all;
  std::map<std::string, int> files;
  for (const std::string& path : files_of("spec/captures")) {
    const std::string bytes = testing::read_file(path);
    const std::string suffix = path.substr(path.rfind('.'));
    ++files[suffix];
    if (suffix == ".pcapng") all.bytes(bytes, InputFormat::kPcapng, Framing::kSf);
    if (suffix == ".bin") all.bytes(bytes, InputFormat::kHdlc, Framing::kSf);
    if (suffix == ".sfstream") all.bytes(bytes, InputFormat::kSf, Framing::kSf);
    if (!path.ends_with(".sf.jsonl")) continue;  // Other JSON lines have no frames.
    const bool firmware = bytes.find("\"sf\"") != std::string::npos;
    all.bytes(hex_lines(bytes, firmware ? "sf" : "hex"), InputFormat::kHex, Framing::kSf);
  }
  all.print("captures");
  EXPECT_GE(files[".pcapng"], 13);
  EXPECT_GE(files[".bin"], 17);
  EXPECT_GT(files[".sfstream"], 10);
  EXPECT_GT(all.count("net_msg"), 500);
  for (const char* what : {"join_request", "join_reply", "ack_join", "serial_joined", "config",
                           "acks", "link acks", "damaged", "nbytes out of range"}) {
    EXPECT_GT(all.count(what), 0) << what;
  }
}

// Whatever a corpus is for: its files are read as each format, and whole as one frame.
TEST(OneReader, OfEveryCorpusFile) {
  Comparer all;
  const std::vector<std::string> files = files_of("fuzz/corpora");
  for (const std::string& path : files) {
    const std::string bytes = testing::read_file(path);
    for (const InputFormat format :
         {InputFormat::kHdlc, InputFormat::kSf, InputFormat::kPcap, InputFormat::kPcapng}) {
      all.bytes(bytes, format, Framing::kSf);
    }
    for (const Framing hex : {Framing::kSf, Framing::kRadio, Framing::kHdlc, Framing::kBare}) {
      all.bytes(bytes, InputFormat::kHex, hex);
    }
    Packet packet{.bytes = testing::view(bytes)};
    for (const Framing framing : {Framing::kSf, Framing::kRadio}) {
      packet.framing = framing;
      all.packet(packet);
    }
  }
  all.print("corpora");
  EXPECT_GE(files.size(), 290U);
  for (const char* what : {"net_msg", "join_request", "join_reply", "ack_join", "acks", "config",
                           "link acks", "damaged", "opaque", "not looked into"}) {
    EXPECT_GT(all.count(what), 0) << what;
  }
}

TEST(OneReader, Of100000GeneratedFrames) {
  constexpr long kFrames = 100'000;
  Comparer all;
  const reflect::RouteTable& routes = rubicon::messages::kRoutes;
  generate::FrameGenerator messages(rubicon::tables::kProtocol, routes, 13);
  generate::FrameGenerator acks(tinyos::tables::kProtocol, generate::kLinkAckRoutes, 14);
  generate::Random& random = messages.random();
  generate::Framer framer(InputFormat::kPcapng, random);
  using Fcf = tinyos::MacHeaderLayout::FcfAt;
  for (long i = 0; all.packets() < kFrames; ++i) {
    const bool ack = i % 20 == 7;
    generate::FrameGenerator& generator = ack ? acks : messages;
    const reflect::RouteTable& of = generator.routes();
    const reflect::Route& route = of.routes[random.below(of.count)];
    generate::Generated made =
        random.chance(0.5) ? generator.valid(route) : generator.near_valid(route);
    generate::Framed framed;
    if (i % 10 != 0 || !framer.broken(generator.valid(route), false, framed)) {
      framed = framer.sound(std::move(made));
    }
    // Frame controls of any other kind: security, other addresses, acks, reserved types.
    if (framed.packet.framing == Framing::kRadio && framed.bytes.size() >= Fcf::kEnd &&
        random.chance(0.2)) {
      const auto bit = static_cast<std::uint16_t>(1U << random.below(16));
      Fcf::store(framed.bytes.data(), Fcf::load(framed.bytes.data()) ^ bit);
    }
    if (random.chance(0.1)) framed.bytes.resize(random.below(framed.bytes.size() + 1));
    if (random.chance(0.1)) framed.bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
    all.packet(framed.view());
  }
  all.print("generated");
  EXPECT_EQ(all.packets(), kFrames);
  for (const char* what :
       {"net_msg", "join_request", "join_reply", "ack_join", "serial_joined", "config", "acks",
        "link acks", "damaged", "opaque", "unreadable messages", "nbytes out of range",
        "nbytes beyond the message", "reliable out of range", "not looked into"}) {
    EXPECT_GT(all.count(what), 100) << what;
  }
}

// Without a DSN, or with information elements (IEEE 802.15.4-2015), all that follows lies
// elsewhere.
TEST(OneReader, AFrameOfTheNewerHeaderIsOpaque) {
  constexpr const char* kAir =
      "41 a9 22 00 01 00 02 00 3f 0e 02 58 01 00 43 01\n"
      "41 aa 01 22 00 01 00 05 00 3f 0e 03 e8 02 00 07 01\n";
  Comparer all;
  all.bytes(kAir, InputFormat::kHex, Framing::kRadio);
  EXPECT_EQ(all.count("opaque"), 2);
}

// A frame with the security bit says nothing to who has no key: neither does its plain look.
TEST(OneReader, ASecuredFrameIsOpaque) {
  constexpr const char* kAir =
      "41 88 01 22 00 01 00 05 00 3f 0e 03 e8 02 00 07 01\n"
      "49 88 02 22 00 01 00 05 00 3f 1d 00 0c 00 01 00 0c 00 05 03 e9 02 00 07 01\n";
  Comparer all;
  all.bytes(kAir, InputFormat::kHex, Framing::kRadio);
  EXPECT_EQ(all.count("join_request"), 1);
  EXPECT_EQ(all.count("opaque"), 1);
  RunReader reader;
  const std::uint32_t file = reader.open("air");
  ReaderOptions as{.hex_framing = Framing::kRadio};
  auto take = [&](const Packet& packet) { reader.take(file, packet, {}); };
  const std::string_view air = kAir;
  make_reader(InputFormat::kHex, as)
      ->feed(Bytes(reinterpret_cast<const std::uint8_t*>(air.data()), air.size()), take);
  const check::Run run = reader.finish();
  EXPECT_EQ(run.seen.size(), 1U);
  // Nothing is known of the request's reply, and nothing more is said.
  const Report report = judge(run, complete());
  EXPECT_EQ(report.verdict, Verdict::kInconclusive);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].requirement, "J3-REPLY"_rule);
}

}  // namespace
}  // namespace rubric::check
