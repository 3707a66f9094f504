// Property: lines of rct/1 from anywhere break neither end. Each command to the adapter's end gets
// an answer that the runner's end accepts; each output that the runner's end takes is written again
// as an equal line.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/rct_answer.h"
#include "conformance/test/targets/serve.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;
using targets::AnswerReader;
using targets::Asked;
using targets::Ticks;

constexpr Ticks kStepMax = 20'000;  // The machine's clock may tick at each of them.

bool take(AnswerReader& reader, std::string_view line) {
  try {
    return reader.take(line);
  } catch (const runner::TargetBroken& error) {
    require(false, error.what());
  }
  return false;
}

/// The reference machine behind the adapter's end, and a runner that asks it.
class Adapter {
 public:
  void ask(std::string_view command) {
    const Asked asked = asked_by(command);
    if (asked.to > now_ && asked.to - now_ > kStepMax) return;
    const std::string answer = server_.answer(command);
    if (server_.ended()) return require(answer.empty(), "`bye` is not answered");
    require(answer.ends_with('\n'), "an answer ends with its line");
    // No runner turns the clock back; the result must be no worse than wrong.
    const bool anew = asked.closing == "ready";
    if (!anew && asked.to < now_) lost_ = true;
    if (anew || !lost_) read(answer, asked);
  }
  bool ended() const { return server_.ended(); }

 private:
  // Returns a runner's expectation of it.
  Asked asked_by(std::string_view command) const {
    targets::Words words(command);
    const std::string_view word = words.next();
    Asked asked;
    asked.command = command;
    asked.from = now_;
    asked.to = now_;
    if (word == "hello") asked.closing = "hello";
    if (word == "reset") asked.closing = "ready";
    if (word == "hello" || word == "reset" || word == "bye") return asked;
    asked.to = targets::number_of(words.next(), targets::kTicksMax).value_or(now_);
    asked.passes_time = word == "until";
    return asked;
  }

  void read(std::string_view answer, const Asked& asked) {
    AnswerReader reader(asked);
    bool closed = false;
    try {
      while (!answer.empty()) {
        require(!closed, "nothing follows the closing line");
        const std::size_t end = answer.find('\n');
        closed = take(reader, answer.substr(0, end));
        answer.remove_prefix(end + 1);
      }
    } catch (const runner::Unsupported&) {
      require(answer.find('\n') + 1 == answer.size(), "a refusal is one line");
      return;
    }
    require(closed, "an answer is closed");
    if (asked.closing == "hello") targets::read_hello(reader.closing());
    if (asked.closing == "ready") {
      now_ = 0;
      lost_ = false;
    }
    if (asked.closing == "done") now_ = reader.answer().done;
  }

  runner::SubjectTarget target_{std::make_unique<runner::Machine>()};
  targets::Server server_{target_, targets::machine_identity()};
  Ticks now_ = 0;
  bool lost_ = false;
};

/// A runner's end that takes any lines.
class Runner {
 public:
  Runner() {
    asked_.command = "until 500";
    asked_.to = 500;
    asked_.passes_time = true;
    start();
  }

  void hear(std::string_view line) {
    const std::size_t before = reader_->answer().outputs.size();
    bool closed = true;
    try {
      closed = reader_->take(line);
    } catch (const runner::TargetBroken&) {
    } catch (const runner::Unsupported&) {
    }
    if (reader_->answer().outputs.size() > before) written_again(reader_->answer().outputs.back());
    if (closed) start();
  }

 private:
  void start() { reader_.emplace(asked_); }

  void written_again(const targets::Output& output) const {
    const std::string line = targets::output_line(output);
    AnswerReader reader(asked_);
    require(!take(reader, line), "an output that was read is written as a line that is read");
    require(targets::output_line(reader.answer().outputs.at(0)) == line, "and says the same");
  }

  Asked asked_;
  std::optional<AnswerReader> reader_;
};

bool is_answer(std::string_view line) {
  for (const std::string_view word : {"tx ", "up ", "next ", "note", "done", "unsupported"}) {
    if (line.starts_with(word)) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  Adapter adapter;
  Runner runner;
  while (!text.empty() && !adapter.ended()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    is_answer(line) ? runner.hear(line) : adapter.ask(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  try {
    targets::read_hello(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const runner::TargetBroken&) {
  }
  return 0;
}
