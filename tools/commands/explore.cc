#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "codec/text/json.h"
#include "codec/text/text.h"
#include "conformance/explore/counterexample.h"
#include "conformance/explore/search.h"
#include "conformance/generated/profiles.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/trace/print.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/quantity.h"
#include "tools/commands/commands.h"
#include "tools/commands/explore_transitions.h"

namespace rubric::tools {
namespace {

using explore::Mask;
using explore::Progress;
using explore::Result;
using explore::Scope;
using text::Json;

struct ExploreOptions {
  explore::Options network;
  std::string profile = "paper";
  std::string flaw;
  std::string scope = "join";
  std::string format = "text";
  std::string out;
  std::string memory;
  std::string weakness_out;
  std::vector<std::string> properties;
  TransitionOptions transitions;
  bool reboot = false;
  bool no_symmetry = false;
  bool no_partial_order = false;
  unsigned requests = 0;  // 0: as the profile says.
  unsigned acks = 0;
};

std::string explore_footer() {
  std::string text = "For RUBICON alone, whose reference machine it explores.\nProperties:\n";
  for (const auto& p : explore::properties()) {
    text += fmt::format("  {:<19} {}\n", p.name, p.sentence);
  }
  text += "Flaws of release 1.0:\n";
  for (const auto& flaw : flaws::all()) {
    text += fmt::format("  {:<19} {}\n", flaw.name, flaw.description);
  }
  return text +
         "Symmetry keeps one of all states that differ only in which mote or sink is which.\n"
         "Partial order takes one mote's steps before the next one's where they are independent.\n"
         "Both are checked first, and keep verdicts and the lengths of traces;\n"
         "\"stand for\" counts the states without symmetry.\n"
         "Time is abstract: a timer that is set may fire at any moment. Where nothing is broken,\n"
         "the run also fails if something that must be possible was never reached.\n"
         "Examples:\n"
         "  rubric explore --sinks 2 --loss --dup\n"
         "  rubric explore --motes 3 --sinks 2 --loss --dup --no-partial-order\n"
         "  rubric explore --calls 2 --loss --flaw accepts_wrong_seq --out broken.rtr\n"
         "  rubric explore --transitions --part join --format dot | dot -Tsvg -o join.svg\n"
         "Exit codes: 0 all properties hold, 1 one is broken or something was never reached,\n"
         "3 a limit was met first or the flaw was never triggered, 64 usage, 74 the trace cannot "
         "be "
         "written.";
}

[[noreturn]] void usage(const std::string& what) { throw cli::UsageError(what); }

template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& entry : table) names.emplace_back(entry.name);
  return names;
}

machine::Profile chosen_profile(const ExploreOptions& options) {
  return machine::find_profile(options.profile)->profile;
}

// Returns the meaning of the options' words.
explore::Options resolve(const ExploreOptions& options) {
  explore::Options network = options.network;
  network.symmetry = !options.no_symmetry;
  network.partial_order = !options.no_partial_order;
  network.memory_max_bytes = cli::parse_quantity(options.memory).value_or(cli::Quantity{}).bytes;
  network.profile = chosen_profile(options);
  if (options.requests != 0) {
    network.profile.join_requests_max = static_cast<std::uint8_t>(options.requests);
  }
  if (options.acks != 0) network.profile.ack_join_max = static_cast<std::uint8_t>(options.acks);
  network.scope = options.scope == "full" ? Scope::kFull : Scope::kJoin;
  if (network.motes + network.sinks > static_cast<int>(explore::kNodesMax)) {
    usage(fmt::format("at most {} motes and sinks together", explore::kNodesMax));
  }
  if (options.reboot) network.reboots = std::max<std::uint8_t>(network.reboots, 1);
  // Messages that are heard again are answered with new numbers: without a limit there is no end.
  const bool endless = network.scope == Scope::kFull && network.dup && network.dups == 0;
  if (endless) network.dups = 1;
  if (const flaws::Flaw* const flaw = flaws::find(options.flaw)) {
    if (flaw->seen == flaws::Seen::kTime) {
      usage(fmt::format("flaw {} shows only where time runs; time is abstract here", flaw->name));
    }
    if (flaw->seen == flaws::Seen::kMessages && network.scope != Scope::kFull) {
      usage(fmt::format("flaw {} shows only in messages: give --scope full", flaw->name));
    }
    network.step = flaw->step;
  }
  if (!options.properties.empty()) network.properties = 0;
  for (const std::string& name : options.properties) {
    network.properties |= explore::bit(*explore::property_named(name));
  }
  return network;
}

// Returns the names in a mask, in order.
template <class Table, class Key>
std::vector<std::string> names_in(Mask mask, const Table& table, Key key) {
  std::vector<std::string> names;
  for (const auto& entry : table) {
    if ((mask & explore::bit(key(entry))) != 0) names.emplace_back(entry.name);
  }
  return names;
}
std::vector<std::string> property_names(Mask mask) {
  return names_in(mask, explore::properties(), [](const auto& p) { return p.property; });
}
std::vector<std::string> goal_names(Mask mask) {
  return names_in(mask, explore::goals(), [](const auto& g) { return g.goal; });
}

struct Verdict {
  const char* text = "";
  int exit_code = cli::kExitClean;
  Mask never = 0;     ///< Goals that should have been reached.
  std::string limit;  ///< Why nothing was decided, or the search ended before its time.
};

// Returns options that would make more happen in the network.
std::string ways_to_widen(const explore::Options& network) {
  std::vector<std::string> ways;
  const auto way = [&](bool open, const char* words) {
    if (open) ways.emplace_back(words);
  };
  way(!network.loss, "--loss");
  way(!network.dup, "--dup");
  way(!network.reorder, "--reorder");
  way(network.calls < 2, "--calls 2");
  way(network.motes < 2, "--motes 2");
  way(network.sinks < 2, "--sinks 2");
  way(network.scope != Scope::kFull, "--scope full");
  if (ways.empty()) return "a larger network";
  return fmt::format("{}", fmt::join(ways, ", "));
}

Verdict judge(const ExploreOptions& options, const explore::Options& network,
              const Result& result) {
  if (result.violation) {
    const bool early = *result.limit != '\0';  // Perhaps a shorter way lies where it did not look.
    return {"broken", cli::kExitFindings, 0,
            early ? fmt::format("the search ended early: {}", result.limit) : ""};
  }
  if (!result.complete) return {"inconclusive", cli::kExitIncomplete, 0, result.limit};
  if (!options.flaw.empty() && !result.step_acted) {
    return {"inconclusive", cli::kExitIncomplete, 0,
            fmt::format("flaw {} never acted in this network; widen it by some of: {}",
                        options.flaw, ways_to_widen(network))};
  }
  const Mask never = explore::expected_goals(network) & ~result.goals;
  if (never != 0) return {"vacuous", cli::kExitFindings, never, {}};
  return {"holds", cli::kExitClean, 0, {}};
}

std::string first_broken(const Result& result) {
  return property_names(result.violation->violated).front();
}

std::string text_of(const Result& result, const Verdict& verdict) {
  const Progress& p = result.progress;
  const double seconds = std::max(p.seconds, 1e-9);
  std::string out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "states       {}\n", p.states);
  if (result.by_mote) {
    out +=
        "order        one mote's steps before the next one's (--no-partial-order: every order)\n";
  } else if (result.represented_states != p.states) {
    fmt::format_to(to, "stand for    {} states, motes and sinks exchanged\n",
                   result.represented_states);
  }
  fmt::format_to(to, "transitions  {}\ndepth        {}\n", p.transitions, p.depth);
  fmt::format_to(to,
                 "time         {:.2f} s: {:.2f} million states/s, {:.2f} million transitions/s\n",
                 p.seconds, static_cast<double>(p.states) / seconds / 1e6,
                 static_cast<double>(p.transitions) / seconds / 1e6);
  fmt::format_to(to,
                 "memory       {:.1f} MB, {} bytes a state; {} states of single nodes, "
                 "{} frames\n",
                 static_cast<double>(result.memory_bytes) / 1e6, result.memory_per_state_bytes,
                 result.node_states, result.frames);
  if (result.omission_probability == 0) {
    out += "missed       none: every state was kept whole\n";
  } else {
    fmt::format_to(to, "missed       a state at most with probability {:.1e}\n",
                   result.omission_probability);
  }
  if (result.liveness_states != 0) {
    fmt::format_to(to, "liveness     {} states, {} parts in which something may wait for ever\n",
                   result.liveness_states, result.liveness_parts);
  }
  fmt::format_to(to, "reached      {}\n", fmt::join(goal_names(result.goals), ", "));
  if (result.known_weak_states != 0) {
    fmt::format_to(to,
                   "known        in {} states at rest a rebooted mote cannot join, since its sink\n"
                   "             still lists it (spec/membership.md)\n",
                   result.known_weak_states);
  }
  for (const auto& goal : explore::goals()) {
    if ((verdict.never & explore::bit(goal.goal)) == 0) continue;
    fmt::format_to(to, "never        {}: {}\n", goal.name, goal.sentence);
  }
  for (const auto& property : explore::properties()) {
    const Mask broken = result.violation ? result.violation->violated : 0;
    if ((broken & explore::bit(property.property)) == 0) continue;
    fmt::format_to(to, "broken       {}: {}\n", property.name, property.sentence);
  }
  if (result.violation && result.violation->loop) {
    const std::size_t loop = *result.violation->loop;
    fmt::format_to(to, "for ever     after {} moves, by a loop of {} moves that is fair\n", loop,
                   result.violation->moves.size() - loop);
  }
  if (!result.complete && !result.violation) {
    fmt::format_to(to, "proved       no property is broken in fewer than {} moves\n", p.depth);
  }
  fmt::format_to(to, "verdict      {}{}{}\n", verdict.text, verdict.limit.empty() ? "" : ": ",
                 verdict.limit);
  return out;
}

std::string json_of(const ExploreOptions& options, const Result& result, const Verdict& verdict,
                    const std::string& trace) {
  const Progress& p = result.progress;
  const Json out = Json::object(
      {{"schema", "rubric.explore/1"},
       {"verdict", verdict.text},
       {"profile", options.profile},
       {"flaw", Json::or_null(options.flaw)},
       {"limit", Json::or_null(verdict.limit)},
       {"broken", Json::array(property_names(result.violation ? result.violation->violated : 0))},
       {"reached", Json::array(goal_names(result.goals))},
       {"never", Json::array(goal_names(verdict.never))},
       {"states", p.states},
       {"represented_states", result.represented_states},
       {"by_mote", result.by_mote},
       {"transitions", p.transitions},
       {"depth", p.depth},
       {"seconds", Json::raw(fmt::format("{:.3f}", p.seconds))},
       {"memory_bytes", result.memory_bytes},
       {"memory_per_state_bytes", result.memory_per_state_bytes},
       {"node_states", result.node_states},
       {"frames", result.frames},
       {"known_weak_states", result.known_weak_states},
       {"omission_probability", Json::raw(fmt::format("{:e}", result.omission_probability))},
       {"liveness_states", result.liveness_states},
       {"liveness_parts", result.liveness_parts},
       {"trace", Json::or_null(trace)}},
      "\n ");
  return out.text() + '\n';
}

// A line on stderr that is redrawn twice a second; nothing if that is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted) : active_(wanted && isatty(2) != 0) {}
  void show(const Progress& p) {
    if (!active_ || p.seconds < next_) return;
    next_ = p.seconds + 0.5;
    drawn_ = true;
    fmt::print(stderr, "\rdepth {}, {:.1f} million states, {:.1f} million waiting, {:.0f} s \033[K",
               p.depth, static_cast<double>(p.states) / 1e6, static_cast<double>(p.waiting) / 1e6,
               p.seconds);
  }
  void clear() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
  }

 private:
  bool active_;
  bool drawn_ = false;
  double next_ = 1;
};

std::string trace_text(explore::Nodes& nodes, const ExploreOptions& options,
                       const explore::Path& path, const std::string& name) {
  std::string note = fmt::format("Found by rubric explore: {} motes, {} sinks, profile {}",
                                 nodes.options().motes, nodes.options().sinks, options.profile);
  if (!options.flaw.empty()) note += ", flaw " + options.flaw;
  return trace::print(explore::counterexample(nodes, path, {options.profile, name, note}));
}

void run_explore(const ExploreOptions& options) {
  if (options.transitions.wanted) {
    const flaws::Flaw* const flaw = flaws::find(options.flaw);
    return print_transitions(options.transitions,
                             {options.profile, chosen_profile(options), options.flaw,
                              flaw == nullptr ? machine::step : flaw->step},
                             options.format, options.out);
  }
  if (!options.weakness_out.empty()) {
    cli::keep_apart("--out-known", options.weakness_out, {options.out});
  }
  if (options.format == "dot") usage("--format dot draws --transitions");
  const auto nodes = std::make_unique<explore::Nodes>(resolve(options));
  ProgressLine line(options.format == "text");
  const Result result =
      explore::explore(*nodes, [&](const Progress& progress) { line.show(progress); });
  line.clear();
  const Verdict verdict = judge(options, nodes->options(), result);
  std::string text;
  if (result.violation) {
    text = trace_text(*nodes, options, *result.violation, "explore." + first_broken(result));
  }
  bool good = true;
  const bool in_file = !options.out.empty() && options.out != "-";
  if (!text.empty() && in_file) good = cli::write_file(options.out, text);
  if (result.known_weakness && !options.weakness_out.empty()) {
    const std::string weakness =
        trace_text(*nodes, options, *result.known_weakness, "explore.known_weakness");
    good = cli::write_file(options.weakness_out, weakness) && good;
  }
  // A trace on stdout is printed alone, so that it can be piped on.
  const bool trace_alone = options.format == "text" && !text.empty() && !in_file;
  if (options.format == "json") {
    good = cli::write_file("-", json_of(options, result, verdict, text)) && good;
  } else if (trace_alone) {
    text::print_harmless(stderr, text_of(result, verdict));
    good = cli::write_file("-", text) && good;
  } else {
    good = cli::write_file("-", text_of(result, verdict)) && good;
  }
  if (!good) cli::exit_with(cli::kExitOutput);
  if (verdict.exit_code != cli::kExitClean) cli::exit_with(verdict.exit_code);
}

void add_faults(cli::Command& sub, ExploreOptions& options) {
  explore::Options& n = options.network;
  sub.add_flag("--loss", n.loss, "Let frames and link acks be lost");
  sub.add_flag("--dup", n.dup, "Let frames be heard again");
  sub.add_flag("--reorder", n.reorder, "Let frames of one sender overtake each other");
  sub.add_flag("--collide", n.collide, "Let frames destroy each other");
  sub.add_flag("--reboot", options.reboot, "Let each mote lose its memory once");
  sub.add_flag("--prompt", n.prompt, "Let no frame outlive a timer");
  sub.add_flag("--busy", n.busy, "Make the end of each transmission a step of its own");
  sub.add_option(
         "--dups", n.dups,
         "Let this many frames in all be heard again, 0: any number (default: 0; scope full: 1)")
      .between(0, 200);
  sub.add_option("--in-flight", n.in_flight, "Let this many copies of one frame be in flight")
      .between(1, 4);
}

void add_bounds(cli::Command& sub, ExploreOptions& options) {
  explore::Options& n = options.network;
  sub.add_option("--calls", n.calls, "Let each mote call joinIsland this many times").between(1, 8);
  sub.add_option("--sends", n.sends, "Let each node send this many messages, in full scope")
      .between(0, 4);
  sub.add_option("--requests", options.requests,
                 "Let a call send this many join_requests (default: the profile's)")
      .between(1, 20);
  sub.add_option("--acks", options.acks,
                 "Let a join send this many ack_joins (default: the profile's)")
      .between(1, 20);
  sub.add_option("--max-states", n.states_max, "Stop, inconclusive, at this many states; 0: never")
      .check(cli::whole_number);
  const auto size = [](const std::string& text) {
    const auto quantity = cli::parse_quantity(text);
    return quantity && quantity->bytes != 0 ? "" : "expected a size as in 2G, given " + text;
  };
  sub.add_option("--memory", options.memory,
                 "Stop, inconclusive, before the process takes more than this (k, M, G)")
      .check(size, "SIZE");
  sub.add_flag("--exact", n.exact,
               "Do not take states for one that differ in nothing that matters");
  sub.add_flag("--no-symmetry", options.no_symmetry,
               "Do not take states for one that differ in which mote or sink is which");
  sub.add_flag("--no-partial-order", options.no_partial_order,
               "Take the steps of all motes in every order, even where they are independent");
  sub.add_flag("--liveness", n.liveness,
               "Then look for calls and reliable messages that never end though timers fire and "
               "frames that are sent again and again are heard");
  n.threads = std::max(1U, std::thread::hardware_concurrency());
  sub.add_option("--threads", n.threads, "Run this many threads").between(1, 64);
}

}  // namespace

void add_explore(cli::Command& app) {
  auto options = std::make_shared<ExploreOptions>();
  cli::Command& sub =
      app.add_subcommand("explore", "Try everything that can happen in a small network");
  sub.footer(explore_footer());
  sub.add_option("--motes", options->network.motes, "Explore this many motes")
      .between(1, int{explore::kMotesMax});
  sub.add_option("--sinks", options->network.sinks,
                 "Explore this many sinks, all in range of all motes")
      .between(1, int{explore::kSinksMax});
  add_faults(sub, *options);
  sub.add_option("--scope", options->scope,
                 "Explore joins alone: join; and messages of members: full")
      .one_of({"join", "full"});
  sub.add_option("--property", options->properties, "Check only these (default: all)")
      .check(cli::expect_one_of(names_of(explore::properties())));
  sub.add_option("--flaw", options->flaw,
                 "Give the machine this flaw of release 1.0; one that needs an old reply shows "
                 "with --calls 2, one that needs messages with --scope full")
      .check(cli::expect_one_of(names_of(flaws::all())));
  sub.add_option("--profile", options->profile, "Keep to paper or deployed")
      .one_of(names_of(machine::kProfiles));
  add_bounds(sub, *options);
  sub.add_option("--format", options->format,
                 "Print text or json; transitions also as dot (Graphviz)")
      .one_of({"text", "json", "dot"});
  sub.add_option("-o,--out", options->out,
                 "Write the shortest trace to this file (default: stdout)");
  add_transition_options(sub, options->transitions);
  sub.add_option("--out-known", options->weakness_out,
                 "Write the shortest way to a known weakness to this file");
  sub.callback([options] { run_explore(*options); });
}

}  // namespace rubric::tools
