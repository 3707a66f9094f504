// A signal that ends a program ends what it has attached, whatever that does against it.
#include "conformance/test/targets/groups.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "codec/text/files.h"
#include "conformance/test/targets/process.h"
#include "conformance/test/targets/process_testing.h"

namespace rubric::targets {
namespace {

using std::chrono::steady_clock;

constexpr const char* kStubborn =
    "trap '' TERM INT HUP QUIT; sleep 1000 & echo $!; echo $$; while :; do sleep 1000; done";

lines::SteadyTime soon() { return steady_clock::now() + std::chrono::seconds(20); }

// A program with attached processes: `body` runs in it, and writes lines to us.
class Program {
 public:
  using Say = std::function<void(const std::string&)>;
  explicit Program(const std::function<void(const Say&)>& body) {
    int fds[2];
    if (::pipe(fds) != 0) throw std::runtime_error("no pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(fds[0]);
      body([&](const std::string& line) {
        const std::string text = line + '\n';
        if (::write(fds[1], text.data(), text.size()) < 0) ::_exit(9);
      });
      ::_exit(0);
    }
    ::close(fds[1]);
    in_ = ::fdopen(fds[0], "r");
  }
  ~Program() {
    if (!ended_) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, &status_, 0);
    }
    std::fclose(in_);
  }

  pid_t number() {
    int out = 0;
    return std::fscanf(in_, "%d", &out) == 1 ? out : 0;
  }
  void send(int signal, bool group = false) const { ::kill(group ? -pid_ : pid_, signal); }
  bool runs() { return ::waitpid(pid_, &status_, WNOHANG) == 0; }
  /// Returns the signal that ended it; -1 if it does not end.
  int ending_signal() { return ends() && WIFSIGNALED(status_) ? WTERMSIG(status_) : -1; }
  int exit_code() { return ends() && WIFEXITED(status_) ? WEXITSTATUS(status_) : -1; }

 private:
  bool ends() {
    ended_ = comes([&] { return ::waitpid(pid_, &status_, WNOHANG) == pid_; });
    return ended_;
  }

  pid_t pid_ = -1;
  std::FILE* in_ = nullptr;
  int status_ = 0;
  bool ended_ = false;
};

void attach_stubborn(const Program::Say& say) {
  const auto child = Process::run(kStubborn);
  say(child->read_line(soon()));
  say(child->read_line(soon()));
  child->read_line(soon());  // It hangs.
}

TEST(Groups, EndWithEachSignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    SCOPED_TRACE(signal);
    Program program([](const Program::Say& say) {
      end_groups_on_signals();
      attach_stubborn(say);
    });
    const pid_t grandchild = program.number();
    const pid_t child = program.number();
    ASSERT_GT(child, 0);
    EXPECT_FALSE(is_dead(child));
    program.send(signal);
    EXPECT_EQ(program.ending_signal(), signal);
    EXPECT_TRUE(comes([&] { return is_dead(child) && is_dead(grandchild); }));
  }
}

TEST(Groups, WhatLeftItsSessionEndsToo) {
  Program program([](const Program::Say& say) {
    end_groups_on_signals();
    const auto child = Process::run("setsid sh -c 'echo $$; exec sleep 1000'");
    say(child->read_line(soon()));
    child->read_line(soon());  // It hangs.
  });
  const pid_t left = program.number();
  ASSERT_GT(left, 0);
  program.send(SIGTERM);
  EXPECT_EQ(program.ending_signal(), SIGTERM);
  EXPECT_TRUE(comes([&] { return is_dead(left); }));
}

TEST(Groups, IgnoredSignalsStayIgnored) {
  Program program([](const Program::Say& say) {
    ::signal(SIGHUP, SIG_IGN);  // nohup does the same.
    end_groups_on_signals();
    attach_stubborn(say);
  });
  program.number();
  const pid_t child = program.number();
  ASSERT_GT(child, 0);
  program.send(SIGHUP);
  std::this_thread::sleep_for(lines::Milliseconds(300));
  EXPECT_TRUE(program.runs());
  EXPECT_FALSE(is_dead(child));
  program.send(SIGTERM);
  EXPECT_EQ(program.ending_signal(), SIGTERM);
  EXPECT_TRUE(comes([&] { return is_dead(child); }));
}

// Whichever of the processes SIGKILL ends, and where it ends a group of them, all ends.
TEST(Groups, KilledProgramsLeaveNothing) {
  enum class Whom { kProgram, kWorker, kGroup };
  for (const Whom whom : {Whom::kProgram, Whom::kWorker, Whom::kGroup}) {
    SCOPED_TRACE(static_cast<int>(whom));
    Program program([](const Program::Say& say) {
      ::setpgid(0, 0);
      guard_children();
      end_groups_on_signals();
      const auto child = Process::run(
          "trap '' TERM; setsid sh -c 'echo $$; exec sleep 1000' &"
          "env -i /usr/bin/setsid sh -c 'echo $$; exec sleep 1000' & cat");
      say(std::to_string(::getpid()));
      for (int i = 0; i < 2; ++i) say(child->read_line(soon()));
      child->read_line(soon());  // It hangs.
    });
    const pid_t worker = program.number();
    const pid_t left[] = {program.number(), program.number()};
    ASSERT_GT(left[1], 0);
    EXPECT_FALSE(is_dead(left[0]) || is_dead(left[1]));
    if (whom == Whom::kWorker)
      ::kill(worker, SIGKILL);
    else
      program.send(SIGKILL, whom == Whom::kGroup);
    EXPECT_EQ(program.ending_signal(), SIGKILL);
    EXPECT_TRUE(comes([&] { return is_dead(worker) && is_dead(left[0]) && is_dead(left[1]); }));
  }
}

TEST(Groups, GuardsEndAsWhatTheyGuard) {
  Program program([](const Program::Say&) {
    guard_children();
    ::_exit(7);
  });
  EXPECT_EQ(program.exit_code(), 7);
}

// Counts processes with this in their command line.
std::size_t count_with(const std::string& words) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::string text;
    text::read_file(entry.path() / "cmdline", text);
    count += text.find(words) != std::string::npos;
  }
  return count;
}

// While several threads start and end children all the time none is forgotten.
TEST(Groups, ProcessesThatAreStartingEndToo) {
  for (int round = 0; round < 5; ++round) {
    const std::string mark = fmt::format("1000.{}{}", ::getpid(), round);
    Program program([&](const Program::Say& say) {
      end_groups_on_signals();
      std::vector<std::thread> threads;
      for (int i = 0; i < 3; ++i) {
        threads.emplace_back([&] {
          while (true) {
            const auto stubborn = Process::run("trap '' TERM; echo; sleep " + mark);
            if (round % 2 == 0) stubborn->read_line(soon());
            const auto cat = Process::run("cat");
          }
        });
      }
      say("1");
      for (std::thread& one : threads) one.join();
    });
    ASSERT_EQ(program.number(), 1);
    EXPECT_TRUE(comes([&] { return count_with(mark) > 0; }));
    program.send(SIGTERM);
    EXPECT_EQ(program.ending_signal(), SIGTERM);
    EXPECT_TRUE(comes([&] { return count_with(mark) == 0; }));
  }
}

TEST(Groups, CopiesEndAlone) {
  Program program([](const Program::Say& say) {
    end_groups_on_signals();
    const auto stubborn = Process::run(kStubborn);
    stubborn->read_line(soon());
    say(stubborn->read_line(soon()));
    const auto copy = Process::copy([](int, int out_fd) {
      const std::string text = std::to_string(::getpid()) + "\n";
      if (::write(out_fd, text.data(), text.size()) < 0) return 1;
      ::pause();
      return 0;
    });
    const pid_t pid = std::stoi(copy->read_line(soon()));
    ::kill(pid, SIGTERM);
    try {
      copy->read_line(soon());
    } catch (const std::exception& error) {
      say(std::string(error.what()).find("signal 15") != std::string::npos ? "15" : "0");
    }
    ::pause();
  });
  const pid_t child = program.number();
  ASSERT_GT(child, 0);
  EXPECT_EQ(program.number(), 15) << "by the signal itself";
  EXPECT_FALSE(is_dead(child)) << "its parent's handler is none of the copy's";
  program.send(SIGINT);
  EXPECT_EQ(program.ending_signal(), SIGINT);
  EXPECT_TRUE(comes([&] { return is_dead(child); }));
}

TEST(Groups, PlacesAreUsedAgain) {
  for (int i = 0; i < 5000; ++i) {
    GroupStart start;
    if (i % 2 == 0) forget_group(start.started(1'000'000'000));
  }
}

}  // namespace
}  // namespace rubric::targets
