#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "codec/lines/broken.h"
#include "codec/lines/capture_file.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"
#include "conformance/node/node.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/write_options.h"
#include "tools/commands/commands.h"
#include "tools/commands/run/json_application.h"
#include "tools/commands/run/serial_end.h"
#include "tools/commands/run/virtual_radio.h"

namespace rubric::tools {
namespace {

using node::Line;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

struct RunOptions {
  std::string role;
  std::optional<std::uint64_t> id;
  std::optional<std::uint64_t> island;
  std::string radio = "zep:17754";
  std::string serial;
  std::string sink = "sf@localhost:9002";
  std::string app;
  cli::WriteOptions write;
  std::uint32_t type = 1;
  std::uint32_t transducers = 1;
  std::uint32_t actuators = 1;
  std::uint32_t loss_percent = 0;
  std::optional<std::uint64_t> seed;
};

constexpr const char* kRunFooter =
    "The nodes of a virtual air may start in any order; the first at a port passes frames on to "
    "the\n"
    "others. Watch it with 'rubric decode zep:17754' or Wireshark.\n"
    "Events come on stdout as JSON lines: joined, mote_joined, received, ack_received, syn_data. "
    "With\n"
    "--app - calls are read from stdin, and its end ends the run; see 'rubric run' in the book.\n"
    "Examples:\n"
    "  rubric run sink --island 11 --serial sf-server:9002\n"
    "  rubric run base-station --island 11 --sink sf@localhost:9002\n"
    "  rubric run mote --id 5\n"
    "Exit codes: 0 Ctrl-C or stdin ended it, 64 usage, 66 a port is taken, or the capture could\n"
    "not be written.";

constexpr milliseconds kMoment{5};        // While there are two lines to look at.
constexpr milliseconds kLongest{100};     // Until Ctrl-C is seen.
constexpr milliseconds kJoinAgain{1000};  // After a refusal.
constexpr std::uint16_t kDeviceMax = 0xFFFC;

// A node with its lines, until the user stops it.
class RunningNode : public node::Driver {
 public:
  explicit RunningNode(const RunOptions& options)
      : options_(options), node_(*this, application_), started_(steady_clock::now()) {
    if (!options.write.path.empty()) {
      capture_.emplace(options.write.path, options.write.growing(),
                       cli::rotation_of(options.write));
      if (!capture_->open()) throw lines::Broken("the capture cannot be written");
    }
    const auto seed = static_cast<std::uint32_t>(options.seed.value_or(std::random_device{}()));
    setup_.role = options.role == "sink"           ? node::Role::kSink
                  : options.role == "base-station" ? node::Role::kBaseStation
                                                   : node::Role::kMote;
    setup_.id = static_cast<std::uint16_t>(options.id.value_or(node::kSinkId));
    setup_.island = static_cast<std::uint16_t>(options.island.value_or(0));
    setup_.channels = node::AnySizes::kChannels;
    setup_.last_seq_num = static_cast<std::uint16_t>(std::mt19937(seed)() % 60'000);
    setup_.slack = 1;
    if (setup_.role != node::Role::kBaseStation) open_radio(seed);
    open_serial();
  }

  int run() {
    lines::stop_on_signals();
    node_.start(setup_);
    if (is_mote() && options_.app != "-") join();
    while (!lines::stop_requested() && !ended_ && application_.has_reader()) step();
    return capture_ && !capture_->finish() ? cli::kExitInput : cli::kExitClean;
  }

  void transmit(Line line, Bytes packet, bool link_ack) override {
    if (line == Line::kRadio && radio_) return radio_->send(packet, link_ack);
    if (line == Line::kSerial && serial_) {
      const std::vector<std::uint8_t> bytes(packet.begin(), packet.end());
      keep_serial(bytes, !is_sink());
      serial_->send(bytes);
    }
    node_.sent(line, false);
  }

 private:
  bool is_mote() const { return setup_.role == node::Role::kMote; }
  bool is_sink() const { return setup_.role == node::Role::kSink; }
  node::Ticks ticks() const {
    const auto us =
        std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now() - started_);
    return static_cast<node::Ticks>(us.count() * 1024 / 1'000'000);
  }

  void open_radio(std::uint32_t seed) {
    run::VirtualRadio::User user;
    user.listens = [this] { return node_.interface_is_on(Line::kRadio); };
    user.heard = [this](Bytes packet) {
      catch_up();
      node_.received(Line::kRadio, packet);
    };
    user.sent = [this](bool acked) {
      catch_up();
      node_.sent(Line::kRadio, acked);
    };
    user.on_air = [this](const Packet& packet) {
      if (capture_) capture_->write(packet, "radio");
    };
    user.twin = [this] {
      if (!is_mote() || warned_) return;  // All sinks have the same id.
      report::print(stderr, "rubric: another mote on this air has the id {}, too\n", setup_.id);
      warned_ = true;
    };
    const lines::Address air = *lines::parse_address(options_.radio);
    radio_.emplace(run::VirtualRadio::Settings{setup_.id, options_.loss_percent / 100.0, seed},
                   air.at, std::move(user));
    radio_->open();
    if (air.at.port == 0) report::print(stderr, "rubric: zep:{}\n", radio_->port());
  }

  void open_serial() {
    if (setup_.role == node::Role::kBaseStation) {
      serial_.emplace(lines::required_address(options_.sink));
    } else if (!options_.serial.empty()) {
      serial_.emplace(static_cast<std::uint16_t>(
          std::stoul(options_.serial.substr(options_.serial.find(':') + 1))));
    }
  }

  void keep_serial(const std::vector<std::uint8_t>& bytes, bool inbound) {
    if (!capture_) return;
    Packet packet;
    packet.framing = Framing::kSf;
    packet.direction = inbound ? Direction::kInbound : Direction::kOutbound;
    packet.bytes = Bytes(bytes.data(), bytes.size());
    packet.time_ns =
        std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    capture_->write(packet, "serial:1");
  }

  // Lets the node do what is due; returns when it wants to run next.
  lines::SteadyTime catch_up() {
    const node::Ticks now = ticks();
    node::Ticks due = 0;
    const lines::SteadyTime latest = steady_clock::now() + kLongest;
    if (!node_.run(now, due)) return latest;
    const std::int64_t left_ticks = static_cast<std::int32_t>(due - now);
    const milliseconds left(std::max<std::int64_t>(0, left_ticks) * 1000 / 1024 + 1);
    return std::min(latest, steady_clock::now() + left);
  }

  void join() {
    node::Descriptor descriptor;
    descriptor.mote_type = static_cast<rubicon::MoteType>(options_.type);
    descriptor.transducers =
        rubicon::TransducerMask(static_cast<std::uint16_t>(options_.transducers));
    descriptor.actuators = rubicon::ActuatorMask(static_cast<std::uint8_t>(options_.actuators));
    catch_up();
    node_.join(descriptor);
  }

  void step() {
    lines::SteadyTime until = catch_up();
    if (is_mote() && options_.app != "-") {
      if (application_.take_refusal()) join_at_ = steady_clock::now() + kJoinAgain;
      if (steady_clock::now() >= join_at_) {
        join_at_ = lines::SteadyTime::max();
        join();
      }
    }
    if (serial_) {
      const bool opened = serial_->open();
      if (opened && setup_.role == node::Role::kBaseStation) node_.set_island(setup_.island);
      until = std::min(until, steady_clock::now() + kMoment);
    }
    const int calls = options_.app == "-" ? STDIN_FILENO : -1;
    if (radio_) {
      radio_->run(until, calls);
    } else {
      pollfd input{calls, POLLIN, 0};
      ::poll(&input, 1, static_cast<int>(kMoment.count()));
    }
    hear_serial();
    if (calls >= 0) read_calls();
  }

  void hear_serial() {
    while (serial_ && serial_->is_open()) {
      const std::vector<std::uint8_t> packet = serial_->receive(steady_clock::now());
      if (packet.empty()) return;
      keep_serial(packet, is_sink());
      catch_up();
      node_.received(Line::kSerial, Bytes(packet.data(), packet.size()));
    }
  }

  void read_calls() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) <= 0) return;
    char room[4096];
    const ssize_t size = ::read(STDIN_FILENO, room, sizeof room);
    if (size <= 0) {
      ended_ = ended_ || size == 0 || errno != EINTR;
      return;
    }
    input_.append(room, static_cast<std::size_t>(size));
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = input_.find('\n', begin)) != input_.npos; begin = end + 1) {
      catch_up();
      application_.call(input_.substr(begin, end - begin), node_);
    }
    input_.erase(0, begin);
    constexpr std::size_t kLineMax = 65'536;
    if (input_.size() > kLineMax) input_.clear();
  }

  const RunOptions& options_;
  run::JsonApplication application_;
  node::SizedNode<node::AnySizes> node_;
  node::Setup setup_{};
  lines::SteadyTime started_;
  std::optional<run::VirtualRadio> radio_;
  std::optional<run::SerialEnd> serial_;
  std::optional<lines::CaptureFile> capture_;
  lines::SteadyTime join_at_ = lines::SteadyTime::max();
  std::string input_;  // Of stdin, not yet a whole line.
  bool ended_ = false;
  bool warned_ = false;
};

void check_run(const RunOptions& options) {
  const bool mote = options.role == "mote";
  const bool sink = options.role == "sink";
  if (mote && !options.id) throw cli::UsageError("--id", "a mote needs one");
  if (mote && (*options.id <= node::kSinkId || *options.id > kDeviceMax)) {
    throw cli::UsageError("--id", "of a mote is from 2 to 65532");
  }
  if (sink && options.id.value_or(node::kSinkId) != node::kSinkId) {
    throw cli::UsageError("--id", "of a sink is 1");
  }
  if (!mote && !options.island) throw cli::UsageError("--island", "is needed by a " + options.role);
  if (mote && options.island)
    throw cli::UsageError("--island", "a mote gets its island by joining");
  if (!options.write.path.empty()) cli::check_write(options.write, {}, true);
  if (!sink && !options.serial.empty()) throw cli::UsageError("--serial", "only a sink has one");
}

int run_node(const RunOptions& options) {
  check_run(options);
  try {
    return RunningNode(options).run();
  } catch (const lines::Broken& broken) {
    report::print(stderr, "rubric: {}\n", broken.what());
  } catch (const std::system_error& error) {
    report::print(stderr, "rubric: {}\n", error.what());
  }
  return cli::kExitInput;
}

std::string is_radio(const std::string& text) {
  try {
    const auto address = lines::parse_address(text);
    if (address && address->kind == lines::Address::Kind::kAir) return {};
  } catch (const std::invalid_argument&) {
  }
  return "'" + text + "': expected zep:PORT or zep:HOST:PORT";
}

std::string is_server(const std::string& text) {
  const std::string_view begin = "sf-server:";
  const std::string port = text.starts_with(begin) ? text.substr(begin.size()) : "";
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == port.npos;
  return digits && std::stoul(port) <= 65'535 ? "" : "'" + text + "': expected sf-server:PORT";
}

std::string is_line(const std::string& text) {
  try {
    lines::required_address(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

void add_run(cli::Command& app) {
  auto options = std::make_shared<RunOptions>();
  cli::Command& sub = app.add_subcommand("run", "Run a mote, a sink or a base station on this PC");
  sub.footer(kRunFooter);
  sub.add_option("ROLE", options->role, "mote, sink or base-station")
      .one_of({"mote", "sink", "base-station"})
      .required();
  sub.add_option("--id", options->id, "Id of a mote, from 2 to 65532");
  sub.add_option("--island", options->island, "Island of a sink or base station").between(0, 65532);
  sub.add_option("--radio", options->radio, "Virtual air of a mote or sink; port 0 is a free one")
      .check(is_radio, "zep:PORT")
      .show_default();
  sub.add_option("--serial", options->serial,
                 "A sink's serial line: a serial forwarder at this port of the host, 0 a free one, "
                 "for one program at a time")
      .check(is_server, "sf-server:PORT");
  sub.add_option("--sink", options->sink, "A base station's line to its sink")
      .check(is_line)
      .show_default();
  sub.add_option("--app", options->app, "Read calls as JSON lines from stdin; a mote joins by one")
      .one_of({"-"});
  sub.add_option("--type", options->type, "Type of a mote that joins by itself")
      .between(0, 255)
      .show_default();
  sub.add_option("--transducers", options->transducers, "Its transducers, as a number of bits")
      .between(0, 65535)
      .show_default();
  sub.add_option("--actuators", options->actuators, "Its actuators, as a number of bits")
      .between(0, 255)
      .show_default();
  sub.add_option("--loss", options->loss_percent, "Lose so many percent of the frames that come")
      .between(0, 100)
      .show_default();
  sub.add_option("--seed", options->seed, "Seed of waits, losses and the first number");
  cli::add_write_options(sub, options->write, "Keep all frames in this pcapng file", true);
  sub.exit_code_of([options] { return run_node(*options); });
}

}  // namespace rubric::tools
