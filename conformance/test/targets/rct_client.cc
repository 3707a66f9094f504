#include "conformance/test/targets/rct_client.h"

#include <fmt/format.h>

#include <utility>

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using std::chrono::steady_clock;

constexpr lines::Milliseconds kGrace{500};  // From `bye` to the end, if nobody asks about it.
constexpr lines::Milliseconds kAtOnce{0};

}  // namespace

RctClient::~RctClient() {
  if (!broken_) end(kGrace);
}

const Identity& RctClient::hello() {
  if (greeted_) return identity_;
  Asked asked{.command = fmt::format("hello rct/{}", kRctVersion), .closing = "hello"};
  try {
    identity_ = read_hello(converse(asked, options_.start_timeout).closing());
  } catch (const runner::Unsupported& error) {
    give_up();
    throw TargetBroken(fmt::format("unsupported: {}", error.what()));
  } catch (const TargetBroken&) {
    give_up();
    throw;
  }
  greeted_ = true;
  return identity_;
}

Answer RctClient::ask(const Asked& asked, lines::Milliseconds longer) {
  try {
    return converse(asked, options_.step_timeout + longer).answer();
  } catch (const TargetBroken& error) {
    if (asked.closing == "ready") throw runner::BrokenAtReset(error.what());
    throw;
  }
}

std::string RctClient::honesty() {
  Asked asked{.command = "frobnicate 17 radio", .closing = "unsupported"};
  try {
    converse(asked, options_.step_timeout);
  } catch (const runner::Unsupported&) {
    return {};
  } catch (const TargetBroken& error) {
    return error.what();
  }
  return "";
}

void RctClient::give_up() {
  broken_ = true;
  process_->kill();
}

std::string RctClient::unasked() {
  if (broken_ || (!process_->has_output() && !process_->closed())) return {};
  std::string what;
  try {
    what = "wrote " + shown(process_->read_line(steady_clock::now() + kAtOnce));
  } catch (const TargetBroken& error) {  // It ended, or did not end its line.
    what = error.what();
  }
  give_up();
  return what;
}

void RctClient::say_bye() {
  if (broken_ || said_bye_) return;
  said_bye_ = true;
  try {
    process_->write("bye\n", steady_clock::now() + kGrace);
  } catch (const TargetBroken&) {  // end() reports how it ended.
  }
}

std::string RctClient::end(lines::Milliseconds grace) {
  if (broken_) return {};
  say_bye();
  broken_ = true;
  return process_->end(grace);
}

std::string RctClient::take_stderr() {
  std::string out = std::exchange(notes_, {});
  const std::uint64_t left_out = std::exchange(notes_left_out_, 0);
  if (left_out != 0) out += fmt::format("({} more notes)\n", left_out);
  return out + process_->take_stderr();
}

AnswerReader RctClient::converse(const Asked& asked, lines::Milliseconds timeout) {
  if (broken_) throw TargetBroken("it broke before");
  const lines::SteadyTime deadline = steady_clock::now() + timeout;
  AnswerReader reader(asked);
  bool reading = false;  // Errors in lines have their number.
  try {
    if (process_->has_output()) throw TargetBroken("something was written before it was asked");
    process_->write(asked.command + '\n', deadline);
    while (true) {
      const std::string line = process_->read_line(deadline);
      reading = true;
      const bool closed = reader.take(line);
      reading = false;
      if (closed) break;
    }
    if (process_->has_output()) throw TargetBroken("something follows the closing line");
  } catch (const TargetBroken& error) {
    give_up();
    keep_notes(reader);
    if (reading) throw;
    throw TargetBroken(fmt::format("`{}`: {}", asked.command, error.what()));
  } catch (const runner::Unsupported&) {
    keep_notes(reader);
    throw;
  }
  keep_notes(reader);
  return reader;
}

void RctClient::keep_notes(const AnswerReader& reader) {
  notes_left_out_ += reader.answer().notes_left_out;
  for (const std::string& note : reader.answer().notes) {
    const std::string line = "note " + note + '\n';
    if (notes_.size() + line.size() > kNotesBytesMax) {
      ++notes_left_out_;
    } else {
      notes_ += line;
    }
  }
}

}  // namespace rubric::targets
