#include "tools/commands/check_live.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/lines/capture_file.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"
#include "conformance/check/judge/follow.h"
#include "conformance/check/judge/watch.h"
#include "conformance/check/observation.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input_threads.h"
#include "tools/cli/output.h"
#include "tools/cli/verdict.h"
#include "tools/commands/check_news.h"

namespace rubric::tools {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTick{100};
/// The least time between two judgements of a run, which also take a tenth of the time at most.
constexpr std::chrono::milliseconds kJudgeEvery{500};
constexpr int kJudgeShare = 10;
/// Time for data in buffers, beyond the time that a node may take and the skew of the taps.
constexpr std::int64_t kSettleUs = 1'000'000;
/// How long one file may be behind another that has the same.
constexpr std::int64_t kRefusedUs = 5'000'000;
constexpr std::int64_t kResponseUs = 292'969;  // 300 ticks, unless stated otherwise.

std::int64_t now_us() {
  return steady_clock::now().time_since_epoch() / std::chrono::microseconds(1);
}

// Returns how long frames are held: as long as rules may need them, and as the user says.
std::int64_t horizon_of(const CheckOptions& options, const check::Options& judged) {
  const double asked_us = options.keep_minutes.value_or(0) * 60e6;
  return std::max(check::horizon_us(judged), static_cast<std::int64_t>(asked_us));
}

// Writes the frames of lines in use as one capture, so that they have the numbers, offsets and
// interfaces of the file kept by --write.
class LineCapture {
 public:
  LineCapture() : reader_(make_reader(InputFormat::kPcapng)) { writer_.begin(bytes_); }

  template <class Take>
  void add(const Packet& packet, std::string_view interface_name, const Take& take) {
    writer_.write(packet, interface_name, bytes_);
    auto read = [&](const Packet& again) {
      take(again, reader_->interfaces()[again.interface_id].name);
    };
    reader_->feed(Bytes(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()),
                  PacketSink(read));
    bytes_.clear();
  }

 private:
  PcapngWriter writer_;
  std::unique_ptr<Reader> reader_;
  std::string bytes_;
};

class Session {
 public:
  explicit Session(const CheckOptions& options)
      : options_(options),
        input_(options.input),
        judged_(oracle_options(options)),
        expected_(expectations(options)),
        follow_(align_options(options), judged_, horizon_of(options, judged_)),
        watch_(kSettleUs + judged_.skew_us + judged_.response_us.value_or(kResponseUs)),
        news_(options) {
    name_files();
    if (options.write.path.empty()) return;
    cli::open_sources(input_);
    kept_.emplace(options.write.path, options.write.growing());
  }

  int run() {
    lines::stop_on_signals();
    news_.begin();
    bool failed = false;
    {
      cli::InputThreads input(input_);
      while (input.take(steady_clock::now() + kTick, [this](auto&&... it) { take(it...); })) {
        if (fresh_ && steady_clock::now() >= judge_next_) judge();
        report_news();
        if (!news_.open()) lines::request_stop();
      }
      failed = input.failed();
    }
    return finish(failed);
  }

 private:
  // Names files: lines are the first one, if there are any; the others follow in their order.
  void name_files() {
    std::string lines;
    for (const std::string& name : options_.input.files) {
      const bool line = lines::parse_address(name).has_value();
      file_of_.push_back(line ? 0 : UINT32_MAX);
      if (line) lines += (lines.empty() ? "" : " and ") + name;
    }
    if (!lines.empty()) names_.push_back(options_.write.path.empty() ? lines : options_.write.path);
    for (std::size_t i = 0; i < file_of_.size(); ++i) {
      if (file_of_[i] == 0) continue;
      file_of_[i] = static_cast<std::uint32_t>(names_.size());
      names_.push_back(options_.input.files[i]);
    }
    has_lines_ = !lines.empty();
    for (const std::string& name : names_) follow_.open(name == "-" ? "stdin" : name);
  }

  void take(const Packet& packet, std::size_t source, std::string_view interface_name,
            std::uint64_t number) {
    fresh_ = true;
    const std::uint32_t file = file_of_[source];
    if (!has_lines_ || file != 0) return follow_.take(file, packet, interface_name, number);
    if (kept_) kept_->write(packet, interface_name);
    lines_.add(packet, interface_name, [this](const Packet& again, std::string_view name) {
      follow_.take(0, again, name);
    });
  }

  void judge() {
    const steady_clock::time_point before = steady_clock::now();
    fresh_ = false;
    judged_once_ = true;
    refused_.clear();
    if (!follow_.judge()) refused_ = follow_.why();
    const steady_clock::time_point after = steady_clock::now();
    judge_next_ =
        after + std::max<steady_clock::duration>(kJudgeEvery, kJudgeShare * (after - before));
  }

  void report_news() {
    if (!judged_once_) return;
    if (refused_.empty()) {
      refused_us_ = 0;
    } else if (refused_us_ == 0) {
      refused_us_ = now_us();
    } else if (!refused_told_ && now_us() - refused_us_ > kRefusedUs) {
      text::print(stderr, "rubric check: {}\n", refused_);
      refused_told_ = true;
    }
    for (const check::Change& change : watch_.update(follow_.report(), now_us())) {
      news_.report(follow_.run(), judged_, change, expected_);
    }
    news_.flush();
  }

  int finish(bool failed) {
    // A source that cannot be had costs no file.
    bool written = !kept_ || (failed && !kept_->is_started()) || kept_->finish();
    judge();
    if (!refused_.empty()) cli::unreadable(refused_);
    report::Outcome outcome = report::compare(follow_.run(), judged_, follow_.report(), expected_);
    outcome.input_missing = failed;
    const bool again = !has_lines_ || !options_.write.path.empty();
    written = news_.report({follow_.run(), judged_, follow_.report(), expected_, outcome},
                           again ? names_ : std::vector<std::string>()) &&
              written;
    return written ? outcome.exit_code() : cli::kExitOutput;
  }

  const CheckOptions& options_;
  cli::InputOptions input_;
  const check::Options judged_;
  const report::KnownFailures expected_;
  check::Follow follow_;
  check::Watch watch_;
  CheckNews news_;
  std::vector<std::uint32_t> file_of_;  // By source: its file of the run.
  std::vector<std::string> names_;      // The run's files.
  bool has_lines_ = false;              // They are file 0.
  LineCapture lines_;
  std::optional<lines::CaptureFile> kept_;
  bool fresh_ = false;  // Something came since the run was judged.
  steady_clock::time_point judge_next_{};
  bool judged_once_ = false;
  std::string refused_;          // Why the files are no run; empty: they are.
  std::int64_t refused_us_ = 0;  // Since when.
  bool refused_told_ = false;
};

}  // namespace

bool is_live(const CheckOptions& options) {
  if (options.input.follow) return true;
  const auto& files = options.input.files;
  return std::any_of(files.begin(), files.end(), [](const std::string& name) {
    return lines::parse_address(name).has_value();
  });
}

int check_live(const CheckOptions& options) {
  const auto& files = options.input.files;
  bool lines = false;
  std::set<std::string> once;
  for (const std::string& name : files) {
    if (!once.insert(name).second) throw cli::UsageError("FILE", name + " is there twice");
    if (lines::parse_address(name)) {
      lines = true;
    } else if (is_log(name)) {
      throw cli::UsageError("FILE", name +
                                        " is a log; it goes with a run that is over, as "
                                        "with the capture that --write keeps");
    }
  }
  if (!options.frames.empty()) {
    throw cli::UsageError("--frames", "which frames can be told when the run is over");
  }
  if (!options.write.path.empty() && !lines) {
    throw cli::UsageError("--write", "none of the sources is a line in use");
  }
  keep_outputs_apart(options);
  if (!options.write.path.empty()) cli::keep_apart("--write", options.write.path, {options.out});
  cli::check_write(options.write, files, true);
  return Session(options).run();
}

}  // namespace rubric::tools
