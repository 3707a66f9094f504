#include "conformance/test/targets/process.h"

#include <gtest/gtest.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <vector>

#include "conformance/test/runner/target.h"
#include "conformance/test/targets/process_testing.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using std::chrono::steady_clock;

lines::SteadyTime in(int ms) { return steady_clock::now() + lines::Milliseconds(ms); }

template <class Action>
std::string broken_by(Action action) {
  try {
    action();
  } catch (const TargetBroken& error) {
    return error.what();
  }
  return "";
}

TEST(Process, LinesGoBothWays) {
  const auto cat = Process::run("cat");
  cat->write("one\ntwo\n", in(5000));
  EXPECT_EQ(cat->read_line(in(5000)), "one");
  EXPECT_TRUE(cat->has_output());
  EXPECT_EQ(cat->read_line(in(5000)), "two");
  EXPECT_FALSE(cat->has_output());
  EXPECT_FALSE(cat->closed());
  EXPECT_EQ(cat->end(lines::Milliseconds(5000)), "");
}

TEST(Process, LongestLine) {
  const auto cat = Process::run("cat");
  const std::string longest(Process::kLineBytesMax, 'x');
  // More than a pipe holds: both ends must be served at once for cat to go on.
  cat->write(longest + '\n', in(5000));
  EXPECT_EQ(cat->read_line(in(5000)), longest);
  cat->write(longest + "x\n", in(5000));
  EXPECT_EQ(broken_by([&] { cat->read_line(in(5000)); }), "wrote a line of more than 65535 bytes");
}

TEST(Process, WritingToAProcessThatDoesNotReadEndsInTime) {
  const auto sleeper = Process::run("exec sleep 1000");
  const auto before = steady_clock::now();
  const std::string wrong =
      broken_by([&] { sleeper->write(std::string(1'000'000, 'x'), in(200)); });
  EXPECT_EQ(wrong, "does not read its standard input");
  EXPECT_LT(steady_clock::now() - before, lines::Milliseconds(3000));
}

TEST(Process, SlowReaderIsWaitedFor) {
  const auto slow = Process::run("sleep 0.2; wc -c");
  slow->write(std::string(1'000'000, 'x'), in(10000));
  EXPECT_FALSE(slow->has_output());
}

TEST(Process, WholeGroupIsKilled) {
  const auto parent = Process::run("trap '' TERM; sleep 1000 & echo $!; wait");
  const int child = std::stoi(parent->read_line(in(5000)));
  EXPECT_FALSE(is_dead(child));
  parent->kill();
  EXPECT_TRUE(comes([&] { return is_dead(child); }));
}

// Children that leave the session, by the way of daemons or without an environment, end as well.
TEST(Process, WhatLeavesTheSessionIsKilled) {
  const auto parent = Process::run(
      "setsid sh -c 'echo $$; exec sleep 1000' & wait_for=$!;"
      "setsid sh -c 'setsid sh -c \"trap : TERM; echo \\$\\$; sleep 1000; sleep 1000\" &' &"
      "env -i /usr/bin/setsid sh -c 'echo $$; exec sleep 1000' & cat");
  const auto other = Process::run("setsid sh -c 'echo $$; exec sleep 1000' & cat");
  const int others = std::stoi(other->read_line(in(5000)));
  std::vector<int> left;
  for (int i = 0; i < 3; ++i) left.push_back(std::stoi(parent->read_line(in(5000))));
  parent->kill();
  const auto dead = [&] { return std::count_if(left.begin(), left.end(), is_dead); };
  EXPECT_GE(dead(), 2);  // Whose the one without an environment is nobody knows, so far.
  EXPECT_FALSE(is_dead(others));
  other->kill();
  EXPECT_TRUE(is_dead(others));
  EXPECT_EQ(dead(), 3);
}

TEST(Process, EndSaysHowItEnded) {
  EXPECT_EQ(Process::run("cat; exit 0")->end(lines::Milliseconds(5000)), "");
  EXPECT_EQ(Process::run("cat; exit 2")->end(lines::Milliseconds(5000)), "ended with status 2");
  EXPECT_EQ(Process::run("cat; kill -KILL $$")->end(lines::Milliseconds(5000)),
            "was killed by signal 9 (Killed)");
  EXPECT_EQ(Process::run("cat; echo and one more thing")->end(lines::Milliseconds(5000)),
            "wrote something that was not asked for");
  EXPECT_EQ(Process::run("trap '' TERM; sleep 1000")->end(lines::Milliseconds(50)),
            "did not end within 50 ms");
}

TEST(Process, StandardErrorIsKeptBeyondTheEnd) {
  const auto process = Process::run("echo words >&2; kill -TERM $$");
  EXPECT_EQ(broken_by([&] { process->read_line(in(5000)); }),
            "was killed by signal 15 (Terminated)");
  EXPECT_EQ(process->take_stderr(), "words\n");
  EXPECT_EQ(broken_by([&] { process->write("x", in(100)); }), "its standard input is closed");
}

TEST(Process, CopyRunsItsBody) {
  const auto copy = Process::copy([](int in_fd, int out_fd) {
    char bytes[16];
    const ssize_t size = ::read(in_fd, bytes, sizeof bytes);
    return size > 0 && ::write(out_fd, bytes, static_cast<std::size_t>(size)) == size ? 7 : 1;
  });
  copy->write("hello\n", in(5000));
  EXPECT_EQ(copy->read_line(in(5000)), "hello");
  EXPECT_EQ(broken_by([&] { copy->read_line(in(5000)); }), "ended with status 7");
}

TEST(Process, SignalsOfOurOwnDoNotHurt) {
  struct sigaction count {};
  struct sigaction before {};
  static volatile std::sig_atomic_t counted = 0;
  count.sa_handler = [](int) { counted = counted + 1; };  // No SA_RESTART: EINTR everywhere.
  ASSERT_EQ(::sigaction(SIGALRM, &count, &before), 0);
  itimerval timer{{0, 3000}, {0, 3000}};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &timer, nullptr), 0);
  const auto slow = Process::run("sleep 0.2; echo here; sleep 0.1");
  EXPECT_EQ(slow->read_line(in(5000)), "here");
  EXPECT_EQ(slow->end(lines::Milliseconds(5000)), "");
  timer = {};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &timer, nullptr), 0);
  ASSERT_EQ(::sigaction(SIGALRM, &before, nullptr), 0);
  EXPECT_GT(counted, 10);
}

}  // namespace
}  // namespace rubric::targets
