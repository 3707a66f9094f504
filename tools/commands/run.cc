#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>

#include "codec/lines/broken.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/text_file.h"
#include "tools/cli/write_options.h"
#include "tools/commands/commands.h"
#include "tools/commands/proxy/proxy.h"
#include "tools/commands/run/islands.h"
#include "tools/commands/run/json_application.h"
#include "tools/commands/run/line_output.h"
#include "tools/commands/run/mote_application.h"
#include "tools/commands/run/names.h"
#include "tools/commands/run/roll_call.h"
#include "tools/commands/run/station.h"
#include "tools/commands/space/gateway.h"
#include "tools/commands/space/mqtt_space.h"
#include "tools/commands/space/space_url.h"

namespace rubric::tools {
namespace {

struct RunOptions {
  std::string role;
  std::optional<std::uint64_t> id;
  std::optional<std::uint64_t> island;
  std::string radio = "zep:17754";
  std::string serial;
  std::string sink = "sf@localhost:9002";
  std::string app;
  cli::WriteOptions write;
  std::string log;
  std::string target;
  std::string type = "telosb_demo";
  std::string transducers = "light";
  std::string actuators = "led";
  std::uint32_t loss_percent = 0;
  std::optional<std::uint64_t> seed;
  std::string space;
  std::string credentials;
  std::uint32_t gone_after_s = 0;
  bool home_assistant = false;
  std::uint64_t listen = 0;
  std::string network;
  std::function<bool(const char* option)> is_given;

  bool is_mote() const { return role == "mote"; }
  bool is_sink() const { return role == "sink"; }
  bool is_proxy() const { return role == "proxy"; }
  bool is_base_station() const { return role == "base-station" || is_proxy(); }
  machine::Descriptor descriptor() const {
    machine::Descriptor out;
    out.mote_type = run::mote_type_of(type);
    out.transducers = run::transducers_of(transducers);
    out.actuators = run::actuators_of(actuators);
    return out;
  }
};

constexpr const char* kRunFooter =
    "The nodes of a virtual air may start in any order; the first at a port passes frames on to "
    "the\n"
    "others. Watch it with 'rubric decode zep:17754' or Wireshark.\n"
    "Events come on stdout as JSON lines: joined, mote_joined, mote_left, received, ack_received,\n"
    "syn_data. With --app - calls are read from stdin, and its end ends the run; see 'rubric run' "
    "in\n"
    "the book.\n"
    "Examples:\n"
    "  rubric run sink --island 11 --serial sf-server:9002\n"
    "  rubric run base-station --island 11 --sink sf@localhost:9002\n"
    "  rubric run mote --id 5 --app demo\n"
    "  rubric run islands.yaml --write run.pcapng --log run.rtr\n"
    "Exit codes: 0 Ctrl-C or stdin ended it, 64 usage, 66 a port is taken, 74 --write, --log or\n"
    "stdout could not be written.";

constexpr std::uint16_t kDeviceMax = 0xFFFC;
constexpr const char* kNoBroker = "needs a space at a broker (--space)";

run::StationSetup setup_of(const RunOptions& options) {
  run::StationSetup setup;
  setup.role = options.is_mote()   ? node::Role::kMote
               : options.is_sink() ? node::Role::kSink
                                   : node::Role::kBaseStation;
  setup.id = static_cast<std::uint16_t>(options.id.value_or(node::kSinkId));
  setup.island = static_cast<std::uint16_t>(options.island.value_or(0));
  setup.name = run::name_of(setup.role, setup.island, setup.id);
  setup.target = options.target;
  setup.loss = options.loss_percent / 100.0;
  setup.seed = static_cast<std::uint32_t>(options.seed.value_or(std::random_device{}()));
  setup.offered = options.serial;
  setup.gone_after_s = options.gone_after_s;
  setup.air = lines::parse_address(options.radio)->at;
  if (setup.role == node::Role::kBaseStation) setup.to = lines::required_address(options.sink);
  return setup;
}

void open_files(const RunOptions& options, const std::vector<trace::NodeHeader>& nodes,
                std::uint64_t seed, run::Keeper& keeper) {
  const bool opened =
      options.write.path.empty() || keeper.open_capture(options.write.path, options.write.growing(),
                                                        cli::rotation_of(options.write));
  if (!opened) cli::exit_with(cli::kExitOutput);
  if (options.log.empty()) return;
  try {
    keeper.open_log(options.log, options.write.growing(), nodes, seed);
  } catch (const std::system_error& error) {
    cli::exit_with(cli::cannot_write(error));
  }
}

// Ends what is kept, after the events. Returns the exit code.
int finish(const run::LineOutput& events, run::Keeper& keeper) {
  const bool kept = keeper.finish();
  return cli::is_written("-", events.error()) && kept ? cli::kExitClean : cli::kExitOutput;
}

// Reads lines:HOST:PORT.
std::optional<lines::HostPort> lines_network(const std::string& text) {
  constexpr std::string_view kBegin = "lines:";
  if (!text.starts_with(kBegin)) return std::nullopt;
  try {
    return lines::read_host_port(text.substr(kBegin.size()));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

int run_station(const RunOptions& options) {
  const run::StationSetup setup = setup_of(options);
  run::Keeper keeper;
  open_files(options, {run::header_of(setup)}, setup.seed, keeper);
  run::Station station(setup, keeper);
  if (setup.role != node::Role::kBaseStation) {
    text::print(stderr, "rubric: {}\n", station.air_address());
  }
  if (!setup.offered.empty()) {
    const std::string& name = station.serial_address();
    const bool server = name.starts_with("sf@");
    text::print(stderr, "rubric: {}{}\n", server ? "sf-server" : name,
                server ? name.substr(name.rfind(':')) : "");
  }
  const bool calls = options.app == "-";
  const auto events = std::make_shared<run::LineOutput>(STDOUT_FILENO, "stdout");
  run::JsonApplication lines({calls ? STDIN_FILENO : -1, events, ""});
  station.add(lines);
  std::optional<run::MoteApplication> mote;
  if (options.is_mote() && !calls) {
    station.add(mote.emplace(options.descriptor(), options.app == "demo"));
  }
  std::optional<run::RollCall> roll_call;
  if (options.is_base_station() && options.gone_after_s != 0) {
    station.add(roll_call.emplace(setup.island, std::chrono::seconds(options.gone_after_s)));
  }
  std::unique_ptr<space::Gateway> gateway;
  if (!options.space.empty()) {
    space::Gateway::Settings settings{setup.island, std::chrono::seconds(options.gone_after_s)};
    if (options.home_assistant) settings.home_assistant = space::parse_mqtt(options.space).root;
    gateway = std::make_unique<space::Gateway>(
        settings, space::open_mqtt(options.space, options.credentials, setup.island));
    station.add(*gateway);
    station.join_peers(*gateway);
  }
  std::optional<proxy::Proxy> proxy;
  if (options.is_proxy()) {
    proxy.emplace(setup.island, static_cast<std::uint16_t>(options.listen));
    if (!options.network.empty()) proxy->add_lines(*lines_network(options.network));
    text::print(stderr, "rubric: proxy at 127.0.0.1:{}\n", proxy->port());
    station.add(*proxy);
  }
  station.run(lines::stop_requested);
  return finish(*events, keeper);
}

// Refuses options that are for a broker where there is no space.
void check_broker(const RunOptions& options, const std::string& space) {
  for (const char* option : {"--home-assistant", "--credentials"}) {
    if (space.empty() && options.is_given(option)) throw cli::UsageError(option, kNoBroker);
  }
}

int run_file(const RunOptions& options) {
  std::string text;
  std::string error;
  if (!cli::read_file(options.role, text, error)) {
    text::print(stderr, "rubric: {}\n", error);
    return cli::kExitInput;
  }
  run::Ecology ecology = run::parse_ecology(text, options.role);
  if (!options.space.empty()) ecology.space = options.space;
  if (options.seed) ecology.seed = *options.seed;
  ecology.gone_after_s = options.gone_after_s;
  check_broker(options, ecology.space);
  ecology.home_assistant = options.home_assistant;
  run::Keeper keeper;
  open_files(options, run::nodes_of(ecology), ecology.seed, keeper);
  const auto events = std::make_shared<run::LineOutput>(STDOUT_FILENO, "stdout");
  run::run_ecology(ecology, options.credentials, keeper, events);
  return finish(*events, keeper);
}

void check_names(const RunOptions& options) {
  const char* option = "--type";
  try {
    run::mote_type_of(options.type);
    option = "--transducers";
    run::transducers_of(options.transducers);
    option = "--actuators";
    run::actuators_of(options.actuators);
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError(option, error.what());
  }
}

bool is_file(const std::string& role) { return role.ends_with(".yaml") || role.ends_with(".yml"); }

// What can be run, in the order of their bits in kUses.
constexpr const char* kKinds[] = {"mote", "sink", "base-station", "proxy", "file"};
enum Kind : unsigned { kMote = 1, kSink = 2, kBaseStation = 4, kProxy = 8, kFile = 16 };

// Which options are for what; those that are for all are not named.
constexpr struct {
  const char* option;
  unsigned kinds;
  const char* in_file;  // The part of a file that has a key of this name; null: none has.
} kUses[] = {
    {"--id", kMote | kSink, "mote"},
    {"--island", kSink | kBaseStation | kProxy, "island"},
    {"--radio", kMote | kSink, "island"},
    {"--serial", kSink, "island"},
    {"--sink", kBaseStation | kProxy, nullptr},
    {"--app", kMote | kSink | kBaseStation, "mote or island"},
    {"--target", kMote, "mote"},
    {"--type", kMote, "mote"},
    {"--transducers", kMote, "mote"},
    {"--actuators", kMote, "mote"},
    {"--loss", kMote | kSink, "file"},
    {"--space", kBaseStation | kProxy | kFile, nullptr},
    {"--home-assistant", kBaseStation | kProxy | kFile, nullptr},
    {"--credentials", kBaseStation | kProxy | kFile, nullptr},
    {"--gone-after", kSink | kBaseStation | kProxy | kFile, nullptr},
    {"--listen", kProxy, nullptr},
    {"--network", kProxy, nullptr},
};

// Refuses options that would do nothing.
void check_uses(const RunOptions& options) {
  const std::string what = is_file(options.role) ? "file" : options.role;
  unsigned kind = 1;
  for (const char* const* name = kKinds; *name != what; ++name) kind *= 2;
  for (const auto& use : kUses) {
    if ((use.kinds & kind) != 0 || !options.is_given(use.option)) continue;
    if (kind == kFile && use.in_file != nullptr) {
      throw cli::UsageError(use.option, fmt::format("write it in FILE.yaml, as '{}' of a {}",
                                                    use.option + 2, use.in_file));
    }
    std::string known;
    for (unsigned bit = 0; bit < std::size(kKinds); ++bit) {
      if ((use.kinds >> bit & 1U) != 0)
        known += (known.empty() ? "a " : " or ") + std::string(kKinds[bit]);
    }
    throw cli::UsageError(use.option, fmt::format("is for {}, not for a {}", known, what));
  }
}

void check_run(const RunOptions& options) {
  const bool mote = options.is_mote();
  if (mote && !options.id) throw cli::UsageError("--id", "a mote needs one");
  if (mote && (*options.id <= node::kSinkId || *options.id > kDeviceMax)) {
    throw cli::UsageError("--id", "of a mote is from 2 to 65532");
  }
  if (options.is_sink() && options.id.value_or(node::kSinkId) != node::kSinkId) {
    throw cli::UsageError("--id", "of a sink is 1");
  }
  if (!mote && !options.island) throw cli::UsageError("--island", "is needed by a " + options.role);
  if (!mote && options.app == "demo") throw cli::UsageError("--app", "the demo is a mote's");
  for (const char* option : {"--type", "--transducers", "--actuators"}) {
    if (options.app != "-" || !options.is_given(option)) continue;
    throw cli::UsageError(option,
                          "is for a mote that joins by itself; with --app - its call says it");
  }
  check_broker(options, options.space);
  check_names(options);
}

int run_node(const RunOptions& options) {
  check_uses(options);
  if (!is_file(options.role)) check_run(options);
  if (!options.write.path.empty()) cli::check_write(options.write, {}, true);
  cli::keep_apart("--log", options.log, {options.write.path});
  if (!options.log.empty()) cli::check_place("--log", options.log, options.write.force);
  if (options.write.force && options.write.path.empty() && options.log.empty()) {
    throw cli::UsageError("--force requires --write or --log");
  }
  std::signal(SIGPIPE, SIG_IGN);
  lines::stop_on_signals();
  try {
    return is_file(options.role) ? run_file(options) : run_station(options);
  } catch (const lines::Broken& broken) {
    text::print(stderr, "rubric: {}\n", broken.what());
  } catch (const std::system_error& error) {
    text::print(stderr, "rubric: {}\n", error.what());
  } catch (const cli::Ending&) {
    throw;
  } catch (const std::invalid_argument& mistake) {
    text::print(stderr, "rubric: {}\n", mistake.what());
    return cli::kExitUsage;
  } catch (const std::runtime_error& mistake) {
    text::print(stderr, "rubric: {}\n", mistake.what());
    return cli::kExitUsage;
  }
  return cli::kExitInput;
}

std::string is_role(const std::string& text) {
  for (const char* role : {"mote", "sink", "base-station", "proxy"}) {
    if (text == role) return {};
  }
  return is_file(text) ? ""
                       : "'" + text + "': expected mote, sink, base-station, proxy or FILE.yaml";
}

std::string is_space(const std::string& text) {
  try {
    space::parse_mqtt(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

std::string is_radio(const std::string& text) {
  try {
    const auto address = lines::parse_address(text);
    if (address && address->kind == lines::Address::Kind::kAir) return {};
  } catch (const std::invalid_argument&) {
  }
  return "'" + text + "': expected zep:PORT or zep:HOST:PORT";
}

std::string is_serial(const std::string& text) {
  if (text == "pty") return {};
  const std::string_view begin = "sf-server:";
  const std::string port = text.starts_with(begin) ? text.substr(begin.size()) : "";
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == port.npos;
  return digits && std::stoul(port) <= 65'535 ? ""
                                              : "'" + text + "': expected sf-server:PORT or pty";
}

std::string is_network(const std::string& text) {
  return lines_network(text) ? "" : "'" + text + "': expected lines:HOST:PORT";
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
  sub.add_option("WHAT", options->role,
                 "Run a mote, sink or base-station; a proxy, a base station at which programs "
                 "subscribe; or FILE.yaml, islands with all that is in them")
      .check(is_role, "mote|sink|base-station|proxy|FILE.yaml")
      .required();
  sub.add_option("--id", options->id, "Give a mote this id, from 2 to 65532");
  sub.add_option("--island", options->island, "Give a sink or base station this island")
      .between(1, 65532);
  sub.add_option("--radio", options->radio, "Use this virtual air; port 0 is a free one")
      .check(is_radio, "zep:PORT");
  sub.add_option(
         "--serial", options->serial,
         "Serve a sink's serial line to one program at a time: as a serial forwarder at this "
         "port of the host, 0 a free one, or as a pseudo-terminal, which stderr names")
      .check(is_serial, "sf-server:PORT|pty");
  sub.add_option("--sink", options->sink, "Reach a base station's sink by this line")
      .check(is_line);
  sub.add_option(
         "--app", options->app,
         "Read calls as JSON lines from stdin, with which a mote joins: -; or send a mote's "
         "readings: demo")
      .one_of({"-", "demo"});
  sub.add_option("--target", options->target,
                 "Run another implementation as the mote, in virtual time turned by the clock: a "
                 "command that speaks rct/1, such as firmware in a simulator, machine or "
                 "machine:FLAW, as for 'rubric test'");
  sub.add_option("--type", options->type,
                 "Give a mote that joins by itself this type, by name or number");
  sub.add_option("--transducers", options->transducers,
                 "Give it these transducers, separated by commas, or the number of their bits");
  sub.add_option("--actuators", options->actuators, "Give it these actuators, in the same form");
  sub.add_option("--loss", options->loss_percent, "Lose this many percent of the incoming frames")
      .between(0, 100);
  sub.add_option("--seed", options->seed, "Seed waits, losses and the first number")
      .between(std::uint64_t{0}, std::uint64_t{UINT32_MAX});
  cli::add_write_options(sub, options->write, "Keep all frames in this pcapng file", true, true);
  sub.add_option(
         "--space", options->space,
         "Publish a base station's island in the tuple space of this MQTT broker, mqtt:// or "
         "mqtts://, with its root of topics; other base stations there are its PEIS")
      .check(is_space, "mqtt://HOST:PORT/ROOT");
  sub.add_flag("--home-assistant", options->home_assistant,
               "Announce the sensors of motes to Home Assistant, below homeassistant/sensor");
  sub.add_option("--credentials", options->credentials,
                 "Read user=, password=, ca=, cert= and key= for the broker from this file; else "
                 "RUBRIC_MQTT_USER and RUBRIC_MQTT_PASSWORD are taken");
  sub.add_option(
         "--gone-after", options->gone_after_s,
         "Report mote_left after a mote was silent for this many seconds; a sink then lets it join "
         "anew, and in the space it is offline. A base station asks it before, by a reliable "
         "message without data, as it does not hear what goes to the sink; 0: never")
      .between(0, 86'400);
  sub.add_option(
         "--listen", options->listen,
         "Let programs of this host subscribe at this port of a proxy by JSON lines; 0: a free "
         "one, which stderr names")
      .between(0, 65'535);
  sub.add_option("--network", options->network,
                 "Attach a second network to a proxy, such as KNX, by lines of words at this port")
      .check(is_network, "lines:HOST:PORT");
  sub.add_option("--log", options->log,
                 "Write what the nodes were given and did to this .rtr file");
  options->is_given = [&sub](const char* name) { return sub.get_option(name).is_given(); };
  sub.exit_code_of([options] { return run_node(*options); });
}

}  // namespace rubric::tools
