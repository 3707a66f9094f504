// The machine on each kind of real line, on this host: rules that it keeps pass, those that it
// breaks fail, those that the line does not show are inconclusive, and a line that breaks is an
// error.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include "codec/lines/forwarder.h"
#include "codec/lines/serial.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/targets/attachment.h"
#include "conformance/test/targets/line_testing.h"

namespace rubric::targets {
namespace {

using runner::CaseVerdict;
using std::chrono::steady_clock;

const Options kOptions{lines::Milliseconds(4000), lines::Milliseconds(5000)};

// Short ones; conformance/cases/serial_line.rtr has the full set.
constexpr const char* kData = "payload.trans_id=connless payload.app_id=mockup payload.payload=x01";
constexpr const char* kAck =
    "payload.trans_id=rubicon_ack payload.app_id=mockup payload.body.seq_num";
constexpr const char* kCases = R"(%rtr 1
%profile paper

case sink.ack
%node sA sink id=1 island=11 iut
a: 20       sA <  serA am=0->1 net_msg(dest=11:1 src=11:null reliable=1 seq_num=7 {0})
   a+0..300 sA >  serA net_msg(dest=11:null src=11:1 reliable=0 {1}=7 ...)  [T2-ACK]
   a+0..400 sA !> serA *  [T2-ONCE]

case sink.new_island
%node sA sink id=1 island=11 iut
   20       sA <  serA am=0->1 config(type=set_island_id value=12)
a: 310      sA <  serA am=0->1 net_msg(dest=12:1 src=12:null reliable=1 seq_num=8 {0})
   a+0..300 sA >  serA net_msg(dest=12:null src=12:1 reliable=0 {1}=8 ...)  [N9-SET]

case sink.app
%node sA sink id=1 island=11 iut
a: 20       sA <  serA am=0->1 net_msg(dest=11:1 src=11:null reliable=0 seq_num=9 {0})
   a+0..300 sA >  app  received(src=11:null app_id=mockup data=x01)  [T1-DELIVER]

case base_station.ack
%node bA base_station island=11 iut
a: 20       bA <  serA am=0->all net_msg(dest=11:null src=11:5 reliable=1 seq_num=77 {0})
   a+0..300 bA >  serA net_msg(dest=11:5 src=11:null reliable=0 {1}=77 ...)  [T2-ACK]
   a+0..400 bA !> serA *  [T2-ONCE]

case two_nodes
%node sA sink id=1 island=11 iut
%node bA base_station island=11 iut
   20       sA !> serA *  [T2-ONCE]

case mote.silent
%node m5 mote id=5 iut
   @0..20   m5 !> rA *  [J1-CALLED]

case mote.silent_everywhere
%node m5 mote id=5 iut
   @0..20   m5 !> * *  [J1-CALLED]
)";

const trace::Parsed& cases() {
  static const std::string text = fmt::format(fmt::runtime(kCases), kData, kAck);
  static const trace::Parsed parsed = trace::parse(text, "serial_line.rtr");
  return parsed;
}

runner::CaseResult run(Attachment& attachment, const char* name) {
  return runner::run_case(cases().file, *cases().file.find(name),
                          [&](const trace::NodeHeader&) { return attachment.target(); });
}
void expect(CaseVerdict verdict, Attachment& attachment, const char* name) {
  const runner::CaseResult result = run(attachment, name);
  EXPECT_EQ(runner::verdict_text(result.verdict), runner::verdict_text(verdict))
      << name << ": " << result.reason << '\n'
      << runner::explain(result, "serial_line.rtr");
}

// A sink whose acks have a wrong number.
class WrongAcks : public runner::Machine {
 public:
  void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) override {
    Machine::step(now, event, actions);
    machine::Actions honest = actions;
    actions.clear();
    for (const machine::Action& action : honest.all()) {
      if (action.what != machine::Action::What::kTransmit) continue;
      machine::Transmit& changed = actions.transmit(action.requirement);
      changed = honest.transmit_of(action);
      changed.payload[12 + 2 + 1] ^= 1;  // In the ack's body.
    }
  }
};

// Writes all the time, as debugging aids do.
class Talker {
 public:
  explicit Talker(std::unique_ptr<lines::PacketLine> line)
      : line_(std::move(line)), thread_([this] { talk(); }) {}
  ~Talker() {
    stop_ = true;
    thread_.join();
  }

 private:
  void talk() {
    while (!stop_) {
      try {
        line_->open(steady_clock::now() + lines::Milliseconds(10));
        line_->send(trace::packet_of({0xFFFF, 5, 0, 100, {'h', 'i'}}),
                    steady_clock::now() + lines::Milliseconds(10));
      } catch (const runner::TargetBroken&) {  // The other end is not there yet, or gone.
      }
      std::this_thread::sleep_for(lines::Milliseconds(1));
    }
  }

  std::unique_ptr<lines::PacketLine> line_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(RealTime, CasesAreWhole) {
  ASSERT_TRUE(cases().ok()) << cases().errors();
  for (const trace::Case& one : cases().file.cases) {  // The machine in virtual time passes.
    const auto machine = attach("machine", {});
    EXPECT_EQ(run(*machine, one.name.c_str()).verdict, CaseVerdict::kPass) << one.name;
  }
}

TEST(RealTime, SinkBehindAForwarder) {
  const std::uint16_t port = free_port();
  const RealNode sink(forwarder_at(port), config_of(machine::Role::kSink, 3));
  const auto attachment = attach(fmt::format("sf:127.0.0.1:{}", port), kOptions);
  EXPECT_TRUE(attachment->identity().real_time);
  EXPECT_EQ(attachment->identity().roles, std::vector{machine::Role::kSink});
  for (int round = 0; round < 2; ++round) {  // A new island is none of the next case.
    expect(CaseVerdict::kPass, *attachment, "sink.ack");
    expect(CaseVerdict::kPass, *attachment, "sink.new_island");
  }
  expect(CaseVerdict::kInconclusive, *attachment, "sink.app");
  expect(CaseVerdict::kSkip, *attachment, "base_station.ack");
  expect(CaseVerdict::kSkip, *attachment, "mote.silent");
  expect(CaseVerdict::kSkip, *attachment, "two_nodes");
  EXPECT_EQ(sink.lives(), 1);
  EXPECT_EQ(attachment->honesty(), "");
}

// The rules do not cover a mote's line: nothing passes there, nothing fails, whatever comes.
TEST(RealTime, MoteBehindAForwarder) {
  const std::uint16_t port = free_port();
  const Talker mote(forwarder_at(port));
  const auto attachment = attach(fmt::format("sf:127.0.0.1:{}:mote", port), kOptions);
  EXPECT_EQ(attachment->identity().name, "mote_behind_forwarder");
  EXPECT_EQ(attachment->identity().roles, std::vector{machine::Role::kMote});
  expect(CaseVerdict::kInconclusive, *attachment, "mote.silent");
  expect(CaseVerdict::kInconclusive, *attachment, "mote.silent_everywhere");
  EXPECT_EQ(run(*attachment, "mote.silent_everywhere").reason,
            "the target does not show app and peis and radio and serial");
  expect(CaseVerdict::kSkip, *attachment, "sink.ack");
}

TEST(RealTime, BrokenSinkBehindAForwarder) {
  const std::uint16_t port = free_port();
  const RealNode sink(forwarder_at(port), config_of(machine::Role::kSink, 3),
                      std::make_unique<WrongAcks>());
  const auto attachment = attach(fmt::format("sf:127.0.0.1:{}", port), kOptions);
  expect(CaseVerdict::kFail, *attachment, "sink.ack");
}

TEST(RealTime, BaseStationThatConnects) {
  const std::uint16_t port = free_port();
  const auto attachment = attach(fmt::format("sf-server:{}", port), kOptions);
  const RealNode station(forwarder_to(port), config_of(machine::Role::kBaseStation, 11));
  expect(CaseVerdict::kPass, *attachment, "base_station.ack");
  expect(CaseVerdict::kPass, *attachment, "base_station.ack");
  expect(CaseVerdict::kSkip, *attachment, "sink.ack");
  EXPECT_EQ(station.lives(), 1);
}

TEST(RealTime, BaseStationThatIsStartedAnew) {
  const std::uint16_t port = free_port();
  const auto attachment = attach(fmt::format("sf-server:{}:restart", port), kOptions);
  // A script that starts the node may look first whether the port is open.
  std::thread script([port] {
    lines::connect_tcp({"127.0.0.1", port}, steady_clock::now() + kOptions.step_timeout);
  });
  const RealNode station(forwarder_to(port), config_of(machine::Role::kBaseStation, 11));
  for (int round = 0; round < 3; ++round) {
    expect(CaseVerdict::kPass, *attachment, "base_station.ack");
  }
  script.join();
  EXPECT_EQ(station.lives(), 3);
}

// Each case would wait for the start of one that has died for good.
TEST(RealTime, ABaseStationThatDoesNotComeBackIsAwaitedInOneCase) {
  const Options options{lines::Milliseconds(700), lines::Milliseconds(3000)};
  const std::uint16_t port = free_port();
  const auto attachment = attach(fmt::format("sf-server:{}:restart", port), options);
  const machine::Config config = config_of(machine::Role::kBaseStation, 11);
  const auto await_absent = [&] {
    const auto before = steady_clock::now();
    const runner::CaseResult result = run(*attachment, "base_station.ack");
    EXPECT_EQ(result.verdict, CaseVerdict::kError);
    EXPECT_EQ(result.reason, fmt::format("nobody connects to 127.0.0.1:{}", port));
    return steady_clock::now() - before;
  };
  {
    const RealNode mortal(forwarder_to(port), config, std::make_unique<runner::Machine>(), {}, 1);
    expect(CaseVerdict::kPass, *attachment, "base_station.ack");
  }
  EXPECT_GE(await_absent(), options.start_timeout);
  EXPECT_LT(await_absent(), options.start_timeout);
  const RealNode back(forwarder_to(port), config);
  for (int round = 0; round < 2; ++round) {
    expect(CaseVerdict::kPass, *attachment, "base_station.ack");
  }
}

TEST(RealTime, SerialLineThroughTcp) {
  const std::uint16_t port = free_port();
  std::unique_ptr<MoteEnd> end = mote_at(port);
  MoteEnd& mote = *end;
  const RealNode sink(std::move(end), config_of(machine::Role::kSink, 3));
  const auto attachment = attach(fmt::format("serial:tcp:127.0.0.1:{}", port), kOptions);
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
  expect(CaseVerdict::kPass, *attachment, "sink.new_island");
  mote.deaf_to = 1;  // It is sent again.
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
  mote.deaf_to = 1000;
  const runner::CaseResult deaf = run(*attachment, "sink.ack");
  EXPECT_EQ(deaf.verdict, CaseVerdict::kError);  // Already when it is reset.
  EXPECT_EQ(deaf.reason, "the node does not confirm packets on its serial line");
  mote.deaf_to = 0;
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
}

// A packet that is lost or doubled on the way says nothing about the node.
TEST(RealTime, ADamagedSerialLineDecidesNothing) {
  const std::uint16_t port = free_port();
  std::unique_ptr<MoteEnd> end = mote_at(port);
  MoteEnd& mote = *end;
  const RealNode sink(std::move(end), config_of(machine::Role::kSink, 3));
  const auto attachment = attach(fmt::format("serial:tcp:127.0.0.1:{}", port), kOptions);
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
  mote.frames_damaged = 1;  // Its ack.
  runner::CaseResult result = run(*attachment, "sink.ack");
  EXPECT_EQ(result.verdict, CaseVerdict::kInconclusive);
  EXPECT_EQ(result.reason,
            "its line may have lost or doubled something: a malformed frame came (wrong CRC)");
  EXPECT_TRUE(result.damaged);
  mote.unconfirmed = 3;  // The message, after the islands.
  result = run(*attachment, "sink.ack");
  EXPECT_EQ(result.verdict, CaseVerdict::kInconclusive);
  EXPECT_EQ(result.reason,
            "its line may have lost or doubled something: a packet was confirmed late, and sent "
            "again");
  EXPECT_TRUE(result.damaged);
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
}

TEST(RealTime, SerialDevice) {
  const Terminal terminal;
  const RealNode sink(terminal.mote_end(), config_of(machine::Role::kSink, 3));
  const auto attachment = attach(fmt::format("serial:{}:telosb", terminal.name()), kOptions);
  expect(CaseVerdict::kPass, *attachment, "sink.ack");
  expect(CaseVerdict::kPass, *attachment, "sink.new_island");
  const termios settings = terminal.settings();
  EXPECT_EQ(::cfgetispeed(&settings), B115200);
  EXPECT_EQ(settings.c_lflag & (ECHO | ICANON | ISIG), 0U);
}

TEST(RealTime, NothingListens) {
  const auto before = steady_clock::now();
  const Options hasty{lines::Milliseconds(200), lines::Milliseconds(200)};
  const std::uint16_t port = free_port();
  struct Absent {
    std::string target;
    std::string reason;
  };
  const Absent absent[] = {
      {fmt::format("sf-server:{}", port), fmt::format("nobody connects to 127.0.0.1:{}", port)},
      {fmt::format("sf:127.0.0.1:{}", port),
       fmt::format("cannot connect to 127.0.0.1:{}: Connection refused", port)},
      {fmt::format("serial:tcp:127.0.0.1:{}", port),
       fmt::format("cannot connect to 127.0.0.1:{}: Connection refused", port)},
      {"serial:/dev/no_such_line:57600",
       "/dev/no_such_line: cannot be opened: No such file or directory"},
      {"serial:/dev/null", "/dev/null: is not a serial line: Inappropriate ioctl for device"},
  };
  for (const Absent& one : absent) {
    const auto attachment = attach(one.target, hasty);
    const runner::CaseResult result = run(*attachment, "sink.ack");
    EXPECT_EQ(result.verdict, CaseVerdict::kError) << one.target;
    EXPECT_EQ(result.reason, one.reason);
    EXPECT_THROW(attachment->identity(), runner::TargetBroken);
  }
  EXPECT_LT(steady_clock::now() - before, lines::Milliseconds(6000));
}

// A node that is not there when we connect is not about to start.
TEST(RealTime, WhereNothingListensTheWaitIsShort) {
  const Options patient{lines::Milliseconds(200), lines::Milliseconds(60000)};
  const std::uint16_t port = free_port();
  const auto before = steady_clock::now();
  for (const char* target :
       {"sf:127.0.0.1:{}", "sf:127.0.0.1:{}:mote", "serial:tcp:127.0.0.1:{}"}) {
    const auto attachment = attach(fmt::format(fmt::runtime(target), port), patient);
    EXPECT_THROW(attachment->identity(), runner::TargetBroken);
  }
  EXPECT_LT(steady_clock::now() - before, lines::Milliseconds(20000));
}

// The other end of a forwarder's connection: writes the handshake and what a sink would, reads a
// while, writes the rest.
class Peer {
 public:
  Peer(std::uint16_t port, std::vector<std::uint8_t> script)
      : listener_({"127.0.0.1", port}), script_(std::move(script)), thread_([this] { serve(); }) {}
  ~Peer() { thread_.join(); }

 private:
  void serve() {
    try {
      lines::ByteStream stream = listener_.accept(steady_clock::now() + lines::Milliseconds(3000));
      const auto end = steady_clock::now() + lines::Milliseconds(600);
      stream.write(Bytes(script_.data(), 2), end);
      std::uint8_t room[512];
      const std::uint8_t alive[] = {22,   0, 0xFF, 0xFF, 0, 0, 14, 0, 28, 0, 11, 0xFF,
                                    0xFD, 0, 11,   0,    1, 0, 0,  0, 2,  3, 5};
      stream.write(Bytes(alive, sizeof alive), end);
      std::size_t heard = 0;  // The handshake, an island twice, a message, the stimulus.
      while (heard < 150 && steady_clock::now() < end) heard += stream.read(room, end);
      stream.write(Bytes(script_.data() + 2, script_.size() - 2), end);
    } catch (const runner::TargetBroken&) {  // We were left.
    }
  }

  lines::Listener listener_;
  const std::vector<std::uint8_t> script_;
  std::thread thread_;
};

TEST(RealTime, ForwardersThatBreak) {
  struct Bad {
    std::vector<std::uint8_t> bytes;
    const char* reason;
  };
  const Bad bad[] = {
      {{'H', 'T', 'T', 'P'},
       "the other end is not a serial forwarder's: it begins with 48 54, not "
       "with 55 20"},
      {{'U', 0x1F},
       "the other end is not a serial forwarder's: it begins with 55 1f, not with 55 20"},
      {{'U', ' '}, "the line broke: the other end closed it"},
      {{'U', ' ', 5, 0, 0}, "the line broke: the other end closed it"},
      {{'U', ' ', 0}, "a serial forwarder packet of no bytes"},
      {{'U', ' ', 3, 0, 1, 2}, "a packet of 3 bytes on the serial line is not an active message"},
  };
  for (const Bad& one : bad) {
    const std::uint16_t port = free_port();
    const Peer peer(port, one.bytes);
    const auto attachment = attach(fmt::format("sf:127.0.0.1:{}", port), kOptions);
    const runner::CaseResult result = run(*attachment, "sink.ack");
    // The case has begun or not when the line breaks.
    EXPECT_GE(result.verdict, CaseVerdict::kFail);
    EXPECT_LE(result.verdict, CaseVerdict::kError);
    EXPECT_EQ(result.reason, one.reason);
    // Who has gone is still known.
    if (result.verdict == CaseVerdict::kFail) {
      EXPECT_FALSE(attachment->identity().name.empty());
    }
  }
}

TEST(RealTime, TextThatMakesNoSense) {
  for (const char* target :
       {"", "  ", "sf:", "sf:host", "sf::9002", "sf:host:0", "sf:host:65536", "sf:host:1x",
        "sf-server:", "sf-server:x", "sf-server:0", "serial:", "serial:/dev/tty:fast",
        "serial::115200", "serial:tcp:host", "serial:/dev/tty:115201"}) {
    EXPECT_THROW(attach(target, {}), std::invalid_argument) << target;
  }
}

// Runs all golden traces that a serial line alone can decide.
TEST(RealTime, GoldenTracesOfALine) {
  const std::uint16_t port = free_port();
  const RealNode sink(forwarder_at(port), config_of(machine::Role::kSink, 3));
  const auto attachment = attach(fmt::format("sf:127.0.0.1:{}", port), kOptions);
  std::size_t passed = 0;
  std::size_t skipped = 0;
  for (const trace::Parsed& file : runner::load_cases("conformance/cases")) {
    if (!file.file_name.ends_with("serial_line.rtr")) continue;
    for (const trace::Case& one : file.file.cases) {
      const runner::CaseResult result = runner::run_case(
          file.file, one, [&](const trace::NodeHeader&) { return attachment->target(); });
      passed += result.verdict == CaseVerdict::kPass;
      skipped += result.verdict == CaseVerdict::kSkip;
      EXPECT_LT(result.verdict == CaseVerdict::kSkip ? CaseVerdict::kPass : result.verdict,
                CaseVerdict::kInconclusive)
          << runner::explain(result, file.file_name);
    }
  }
  EXPECT_GE(passed, 2U);   // A sink's,
  EXPECT_GE(skipped, 2U);  // and a base station's.
}

TEST(RealTime, ToleranceIsMeasured) {
  const runner::Tolerance host = tolerance_of_this_host();
  EXPECT_GE(host.late, 10U);
  EXPECT_EQ(host.early, host.late);
  EXPECT_EQ(tolerance_of_this_host().late, host.late);
}

}  // namespace
}  // namespace rubric::targets
