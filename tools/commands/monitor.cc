#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "codec/lines/broken.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"
#include "conformance/check/input/read_packet.h"
#include "conformance/check/judge/follow.h"
#include "conformance/check/judge/watch.h"
#include "conformance/check/report/words.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input_threads.h"
#include "tools/cli/output.h"
#include "tools/cli/terminal.h"
#include "tools/commands/check_options.h"
#include "tools/commands/commands.h"
#include "tools/commands/monitor/board.h"
#include "tools/commands/run/wall_clock.h"
#include "tools/commands/space/mqtt_space.h"
#include "tools/commands/space/space_url.h"

namespace rubric::tools {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kMonitorTick{100};
constexpr std::chrono::milliseconds kDrawEvery{500};
constexpr std::chrono::milliseconds kMonitorJudgesEvery{1000};
constexpr int kMonitorShare = 10;  // Judging takes a tenth of the time at most.
constexpr std::int64_t kMonitorSettleUs =
    1'500'000;  // A finding that has held for so long is told.

struct MonitorOptions {
  std::vector<std::string> sources;
  std::string profile = "paper";
  std::string credentials;
  std::uint32_t silent_after_s = 30;
  bool reconnect = false;
};

constexpr const char* kMonitorFooter =
    "At a terminal the table of nodes is redrawn, with the last news below it; elsewhere news are\n"
    "lines: who joined, readings, who is silent or has gone, findings of the live check. Frames "
    "of\n"
    "lines are judged as by 'rubric check', tuples are not. The table is printed at the end.\n"
    "HEARD is how long ago; REPEATS are radio frames that were sent once more.\n"
    "Examples:\n"
    "  rubric monitor zep:17754\n"
    "  rubric monitor sf@localhost:9002 --profile deployed\n"
    "  rubric monitor mqtt://localhost:1883/rubicon\n"
    "Exit codes: 0 Ctrl-C ended it, 1 a node broke a rule, 64 usage, 66 a source cannot be had.";

bool is_space_url(const std::string& text) {
  return text.starts_with("mqtt://") || text.starts_with("mqtts://");
}

// Shows the board at a terminal, or prints its news.
class Screen {
 public:
  Screen() : drawn_(::isatty(STDOUT_FILENO) != 0), output_(STDOUT_FILENO) {
    if (drawn_) put("\x1b[?1049h");  // A screen of its own, so that the former one comes back.
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  ~Screen() { leave(); }

  void leave() {
    if (std::exchange(drawn_, false)) put("\x1b[?1049l");
    output_.flush();
  }

  void show(monitor::Board& board) {
    const std::vector<std::string> news = board.take_news();
    if (!drawn_) {
      for (const std::string& line : news) print(line);
    } else if (steady_clock::now() >= next_) {
      next_ = steady_clock::now() + kDrawEvery;
      draw(board);
    }
    output_.flush();
  }

  void print(std::string_view line) { put(text::harmless(line) + '\n'); }
  bool open() const { return output_.open(); }
  bool finish() { return output_.finish(); }

 private:
  void put(std::string_view text) { output_.buffer().append(text); }

  void draw(const monitor::Board& board) {
    const std::size_t screen = cli::screen_columns(STDOUT_FILENO);
    const std::size_t width = screen != 0 ? screen : cli::columns(0, STDOUT_FILENO);
    const std::size_t height = cli::rows(STDOUT_FILENO);
    std::vector<std::string> lines = board.table(run::wall_ms());
    const std::size_t news = height / 3;
    if (lines.size() + news + 2 > height) {
      const std::size_t more = lines.size() + news + 3 - height;
      lines.resize(lines.size() - more);
      lines.push_back(fmt::format("and {}", text::counted(more, "node")));
    }
    lines.emplace_back();
    for (std::string& line : board.last_news(height - lines.size() - 1)) {
      lines.push_back(std::move(line));
    }
    std::string text = "\x1b[H";
    for (const std::string& line : lines) text += clipped(line, width) + "\x1b[K\n";
    put(text + "\x1b[J");
  }

  // At most so many characters, none of them cut.
  static std::string clipped(const std::string& line, std::size_t width) {
    const std::string safe = text::harmless(line);
    std::size_t at = 0;
    for (std::size_t shown = 0; at < safe.size() && shown < width; ++shown) {
      at += std::max<std::size_t>(1, text::utf8_length(std::string_view(safe).substr(at)));
    }
    return safe.substr(0, at);
  }

  bool drawn_;
  cli::Output output_;
  steady_clock::time_point next_{};
};

// Judges the frames of lines while they come.
class LiveCheck {
 public:
  explicit LiveCheck(const CheckOptions& options)
      : judged_(oracle_options(options)),
        follow_(align_options(options), judged_, check::horizon_us(judged_)),
        watch_(kMonitorSettleUs) {
    for (const std::string& name : options.input.files) follow_.open(name);
  }

  void take(const Packet& packet, std::size_t source, std::string_view interface_name) {
    follow_.take(static_cast<std::uint32_t>(source), packet, interface_name);
    fresh_ = true;
  }

  void tell(monitor::Board& board) {
    const auto before = steady_clock::now();
    if (fresh_ && before >= next_) {
      fresh_ = false;
      follow_.judge();
      const auto now = steady_clock::now();
      next_ = now +
              std::max<steady_clock::duration>(kMonitorJudgesEvery, kMonitorShare * (now - before));
    }
    const std::int64_t now_us = before.time_since_epoch() / std::chrono::microseconds(1);
    for (const check::Change& change : watch_.update(follow_.report(), now_us)) {
      const check::Finding& finding = change.finding;
      if (finding.severity == check::Severity::kNote) continue;
      const bool withdrawn = change.what == check::Change::What::kWithdrawn;
      board.add_news(fmt::format("{}{} {}: {}", withdrawn ? "WITHDRAWN " : "",
                                 text::in_capitals(report::severity_name(finding.severity)),
                                 report::heading_text(follow_.run(), finding),
                                 withdrawn ? change.why : finding.text),
                     run::wall_ms());
    }
  }

  // Judges what is left. Returns the last line.
  std::string finish() {
    if (!follow_.judge()) return "Check: " + follow_.why();
    const check::Report& report = follow_.report();
    return fmt::format("Check: {}, {}, {}", report::verdict_name(report.verdict),
                       text::counted(report.frames, "frame"),
                       text::counted(report.findings.size(), "finding"));
  }
  bool failed() const { return follow_.report().verdict == check::Verdict::kFail; }

 private:
  const check::Options judged_;
  check::Follow follow_;
  check::Watch watch_;
  bool fresh_ = false;
  steady_clock::time_point next_{};
};

class Monitor {
 public:
  explicit Monitor(const MonitorOptions& options)
      : board_(std::int64_t{options.silent_after_s} * 1000) {
    CheckOptions judged;
    judged.profile = options.profile;
    judged.input.reconnect = options.reconnect;
    for (const std::string& source : options.sources) {
      if (!is_space_url(source)) {
        judged.input.files.push_back(source);
        continue;
      }
      spaces_.push_back(space::watch_mqtt(source, options.credentials));
      spaces_.back()->subscribe("#");
    }
    input_ = judged.input;
    if (!input_.files.empty()) check_.emplace(judged);
  }

  int run() {
    lines::stop_on_signals();
    Screen screen;
    bool failed = false;
    if (input_.files.empty()) {
      while (!lines::stop_requested() && screen.open()) {
        ::usleep(std::chrono::microseconds(kMonitorTick).count());
        step(screen);
      }
    } else {
      cli::InputThreads input(input_);
      const auto take = [this](const Packet& packet, std::size_t source, std::string_view name,
                               std::uint64_t) { see(packet, source, name); };
      while (input.take(steady_clock::now() + kMonitorTick, take)) {
        step(screen);
        if (!screen.open()) lines::request_stop();
      }
      failed = input.failed();
    }
    return finish(screen, failed);
  }

 private:
  void see(const Packet& packet, std::size_t source, std::string_view interface_name) {
    check_->take(packet, source, interface_name);
    check::RunStorage storage;
    check::Observation seen;
    if (check::observe_packet(packet, storage, seen)) board_.take(seen, run::wall_ms());
  }

  void step(Screen& screen) {
    for (const auto& space : spaces_) {
      for (const space::Tuple& tuple : space->take()) board_.take(tuple, run::wall_ms());
    }
    if (check_) check_->tell(board_);
    board_.look(run::wall_ms());
    screen.show(board_);
  }

  int finish(Screen& screen, bool failed) {
    screen.leave();
    for (const std::string& line : board_.take_news()) screen.print(line);
    for (const std::string& line : board_.table(run::wall_ms())) screen.print(line);
    if (check_) screen.print(check_->finish());
    if (!screen.finish()) return cli::kExitOutput;
    if (failed) return cli::kExitInput;
    return check_ && check_->failed() ? cli::kExitFindings : cli::kExitClean;
  }

  monitor::Board board_;
  cli::InputOptions input_;
  std::optional<LiveCheck> check_;
  std::vector<std::unique_ptr<space::Space>> spaces_;
};

int run_monitor(const MonitorOptions& options) {
  try {
    return Monitor(options).run();
  } catch (const lines::Broken& broken) {
    text::print(stderr, "rubric monitor: {}\n", broken.what());
    return cli::kExitInput;
  } catch (const std::invalid_argument& mistake) {
    throw cli::UsageError("--credentials", mistake.what());
  }
}

std::string is_source(const std::string& text) {
  try {
    if (is_space_url(text)) {
      space::parse_mqtt(text);
      return {};
    }
    if (lines::parse_address(text)) return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "'" + text + "': expected a line such as sf@HOST:PORT or zep:PORT, or mqtt://HOST";
}

}  // namespace

void add_monitor(cli::Command& app) {
  auto options = std::make_shared<MonitorOptions>();
  cli::Command& sub = app.add_subcommand(
      "monitor", "Watch islands: who is there, last readings, joins, losses, findings");
  sub.footer(kMonitorFooter);
  sub.add_option("SOURCE", options->sources,
                 "Lines: sf@HOST:PORT, zep:PORT, serial@DEVICE:BAUD; tuple spaces: "
                 "mqtt://HOST:PORT/ROOT")
      .check(is_source)
      .required();
  sub.add_option("--profile", options->profile, "Judge by the rules of paper or deployed")
      .one_of({"paper", "deployed"});
  sub.add_option("--silent-after", options->silent_after_s,
                 "Report a node of a line as silent after this many seconds without a message; 0: "
                 "never")
      .between(0, 86'400);
  sub.add_option("--credentials", options->credentials,
                 "Read user=, password=, ca=, cert= and key= for the broker from this file; else "
                 "RUBRIC_MQTT_USER and RUBRIC_MQTT_PASSWORD are taken");
  sub.add_flag("--reconnect", options->reconnect, "Open a line again when it comes back");
  sub.exit_code_of([options] { return run_monitor(*options); });
}

}  // namespace rubric::tools
