// Whatever a process does to us fails its case by a rule, in bounded time, and the next case
// passes. What does not even answer `hello` is an error.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/targets/attachment.h"
#include "conformance/test/targets/process_testing.h"

namespace rubric::targets {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;
using std::chrono::milliseconds;

constexpr milliseconds kStepTimeout{600};
constexpr milliseconds kStartTimeout{20'000};  // An interpreter's start on a busy host.
constexpr milliseconds kFaultMax{6000};        // Once it has started.

struct Fault {
  const char* name;
  const char* reason;     ///< A part of the error.
  bool at_hello = false;  ///< The case does not begin: it is an error, and no verdict.
};
const Fault kFaults[] = {
    {"killed", "was killed by signal 9"},
    {"crashed", "was killed by signal 6"},
    {"stopped", "gave no answer in time"},
    {"hung", "gave no answer in time"},
    {"hung_ignoring_sigterm", "gave no answer in time"},
    {"half_a_line", "did not end its line of 3 bytes in time"},
    {"half_a_line_then_end", "ended with status 0, in the middle of a line of 3 bytes"},
    {"long_line", "wrote a line of more than 65535 bytes"},
    {"endless_line", "wrote a line of more than 65535 bytes"},
    {"not_utf8", "byte 0xc3 at column 6 is not printable ASCII"},
    {"nul_bytes", "byte 0x00 at column 5 is not printable ASCII"},
    {"carriage_return", "byte 0x0d at column 7 is not printable ASCII"},
    {"exit_with_words", "ended with status 3"},
    {"exit_0", "ended with status 0"},
    {"child_keeps_output", "gave no answer in time"},
    {"closed_output", "closed its standard output"},
    {"closed_input", "closed its standard output or input"},
    {"garbage", "given 'lorem ipsum dolor'"},
    {"empty_line", "given ''"},
    {"endless_notes", "an answer of more than 10000 lines"},
    {"endless_frames", "an answer of more than 10000 lines"},
    {"done_before_its_time", "done at 99999999, expected 0"},
    {"bad_hex", "'0000zz' is not an even number of hex digits"},
    {"ready_again", "expected tx, up, next, note or `done`, given 'ready'"},
    {"unknown_event", "'exploded' is not a message"},
    {"false_next", "it wrote something at 500 after `next -`"},
    {"refuses_time", "unsupported `until 0`: time"},
    {"unasked", "something follows the closing line"},
    {"ends_at_reset", "ended with status 5"},
    {"hangs_at_reset", "gave no answer in time"},
    {"babbles_at_reset", "given 'done 0'"},
    {"newer_version", "speaks version 2 of the protocol", true},
    {"no_version", "is not a version, such as rct/1", true},
    {"no_roles", "it says no roles=", true},
    {"unknown_role", "'toaster' is not a role", true},
    {"no_name", "lacks its name or version", true},
    {"http", "expected `hello`, given 'HTTP/1.1 400 Bad Request'", true},
    {"refused_hello", "unsupported", true},
};

class BrokenAdapters : public testing::Test {
 protected:
  BrokenAdapters() {
    std::string pattern = (std::filesystem::temp_directory_path() / "rubric-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    for (trace::Parsed& file : runner::load_cases("conformance/cases")) {
      if (file.file.find("j1.request")) file_ = std::move(file);
    }
  }
  ~BrokenAdapters() override { std::filesystem::remove_all(folder_); }

  std::string flag() const { return (folder_ / "flag").string(); }
  void raise_flag() const { std::ofstream(flag()) << "1"; }
  std::unique_ptr<Attachment> adapter(const char* fault) const {
    return attach(fmt::format("test -e {1} || exec {2}; "
                              "exec python3 conformance/test/targets/faulty_adapter.py {0} {1} {2}",
                              fault, flag(), RUBRIC_MACHINE_ADAPTER),
                  {kStepTimeout, kStartTimeout});
  }
  // Makes an adapter do something unasked, and waits until it is done.
  void do_it_now(std::string_view fault) const {
    std::ofstream(flag() + ".now") << "1";
    pid_t pid = 0;
    EXPECT_TRUE(comes([&] { return bool(std::ifstream(flag() + ".done") >> pid); }));
    if (fault == "ends_unasked") {
      EXPECT_TRUE(comes([&] { return is_dead(pid); }));
    }
    std::filesystem::remove(flag() + ".now");
    std::filesystem::remove(flag() + ".done");
  }
  CaseResult run(Attachment& attachment) const {
    return runner::run_case(file_.file, *file_.file.find("j1.request"),
                            [&](const trace::NodeHeader&) { return attachment.target(); });
  }

  std::filesystem::path folder_;
  trace::Parsed file_;
};

bool no_child_is_left() { return ::waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD; }

TEST_F(BrokenAdapters, FailTheirCaseAlone) {
  std::size_t faults = 0;
  std::size_t passes_after = 0;
  for (const Fault& fault : kFaults) {
    SCOPED_TRACE(fault.name);
    raise_flag();
    const auto attachment = adapter(fault.name);
    if (!fault.at_hello) attachment->identity();
    const auto before = std::chrono::steady_clock::now();
    const CaseResult broken = run(*attachment);
    EXPECT_LT(std::chrono::steady_clock::now() - before,
              fault.at_hello ? kStartTimeout + kFaultMax : kFaultMax);
    EXPECT_EQ(broken.verdict, fault.at_hello ? CaseVerdict::kError : CaseVerdict::kFail);
    ASSERT_EQ(broken.failures.size(), 1U);
    EXPECT_EQ(broken.failures[0].requirements.empty(), fault.at_hello)
        << "every verdict names a rule";
    EXPECT_NE(broken.reason.find(fault.reason), std::string::npos) << broken.reason;
    const std::string words = attachment->take_stderr();
    const std::string_view name = fault.name;
    if (name == "exit_with_words") {
      EXPECT_EQ(words, "out of cheese\n");
    } else if (name == "endless_notes") {
      EXPECT_TRUE(words.ends_with(" more notes)\n") && words.size() <= 65536U);
    } else {
      EXPECT_EQ(words, "");
    }
    const CaseResult after = run(*attachment);
    EXPECT_EQ(after.verdict, CaseVerdict::kPass) << after.reason;
    EXPECT_LT(std::chrono::steady_clock::now() - before, kStartTimeout + kFaultMax);
    faults += broken.verdict >= CaseVerdict::kFail;
    passes_after += after.verdict == CaseVerdict::kPass;
  }
  EXPECT_TRUE(no_child_is_left());
  std::printf("faults of an attachment: %zu, told by their case: %zu, next case passed: %zu\n",
              std::size(kFaults), faults, passes_after);
}

TEST_F(BrokenAdapters, NoiseOnStandardErrorIsAllowed) {
  raise_flag();
  const auto attachment = adapter("noisy");
  EXPECT_EQ(run(*attachment).verdict, CaseVerdict::kPass);
  const std::string words = attachment->take_stderr();
  EXPECT_EQ(words.size(), 65536U);
  EXPECT_TRUE(words.ends_with("noise\nthe last words\n"));
  EXPECT_EQ(attachment->take_stderr(), "");
}

TEST_F(BrokenAdapters, CommandThatDoesNotRun) {
  const auto attachment = attach("exec /no/such/program", {});
  EXPECT_THROW(attachment->identity(), runner::TargetBroken);
  EXPECT_NE(attachment->take_stderr().find("/no/such/program"), std::string::npos);
  const CaseResult result = run(*attachment);
  EXPECT_EQ(result.verdict, CaseVerdict::kError);
  EXPECT_NE(result.reason.find("ended with status 127"), std::string::npos) << result.reason;
  EXPECT_TRUE(no_child_is_left());
}

TEST_F(BrokenAdapters, AnEndBetweenCasesDoesNotFailTheNext) {
  const auto attachment = attach("exec " RUBRIC_MACHINE_ADAPTER, {});
  EXPECT_EQ(run(*attachment).verdict, CaseVerdict::kPass);
  siginfo_t info{};  // Its only child.
  std::ifstream children(fmt::format("/proc/self/task/{}/children", ::getpid()));
  pid_t child = 0;
  ASSERT_TRUE(children >> child);
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(attachment->take_mishaps().empty());
  EXPECT_EQ(run(*attachment).verdict, CaseVerdict::kPass);
  const std::vector<Mishap> mishaps = attachment->take_mishaps();  // But it is reported.
  ASSERT_EQ(mishaps.size(), 1U);
  EXPECT_EQ(mishaps[0].text, "was killed by signal 9 (Killed)");
  EXPECT_TRUE(mishaps[0].broke);
  attachment->finish();
  EXPECT_TRUE(attachment->take_mishaps().empty());
}

// An adapter that passes the case, and does something when nothing is asked.
TEST_F(BrokenAdapters, WhatHappensOutsideOfCasesIsReported) {
  struct Odd {
    const char* fault;
    const char* text;
    bool broke;
  };
  const Odd odd[] = {
      {"speaks_unasked", "wrote 'note by the way'", true},
      {"half_a_line_unasked", "did not end its line of 4 bytes in time", true},
      {"ends_unasked", "ended with status 7", true},
      {"bad_status_at_bye", "ended with status 7", false},
      {"killed_at_bye", "was killed by signal 9 (Killed)", false},
      {"speaks_at_bye", "wrote something that was not asked for", false},
      {"hangs_at_bye", "did not end within 600 ms", false},
  };
  for (const Odd& one : odd) {
    SCOPED_TRACE(one.fault);
    raise_flag();
    const auto attachment = adapter(one.fault);
    EXPECT_EQ(run(*attachment).verdict, CaseVerdict::kPass);
    if (one.broke) do_it_now(one.fault);
    attachment->finish();
    const std::vector<Mishap> mishaps = attachment->take_mishaps();
    ASSERT_EQ(mishaps.size(), 1U);
    EXPECT_EQ(mishaps[0].text, one.text);
    EXPECT_EQ(mishaps[0].broke, one.broke);
    EXPECT_EQ(mishaps[0].stderr_text, "last words\n");
    EXPECT_EQ(run(*attachment).verdict, CaseVerdict::kPass) << "it can be started again";
    attachment->finish();
    EXPECT_TRUE(attachment->take_mishaps().empty());
  }
  EXPECT_TRUE(no_child_is_left());
}

TEST_F(BrokenAdapters, DishonestOnesAreFound) {
  const auto dishonest = attach(
      "while read -r line; do case $line in hello*) echo hello rct/1 yes_man 1 roles=mote;; "
      "bye) exit;; *) echo done 0;; esac; done",
      {});
  EXPECT_EQ(dishonest->identity().name, "yes_man");
  EXPECT_EQ(dishonest->honesty(),
            "line 1 of the answer to `frobnicate 17 radio`: expected `unsupported`, given "
            "'done 0'");
  EXPECT_EQ(attach(RUBRIC_MACHINE_ADAPTER, {})->honesty(), "");
  EXPECT_EQ(attach("machine", {})->honesty(), "");
}

// Time that did not pass is no silence.
TEST_F(BrokenAdapters, RealTimeIsMeasuredByOurClock) {
  const auto jumper = attach(
      "while read -r word time rest; do case $word in "
      "hello) echo hello rct/1 jumper 1 roles=mote time=real;; reset) echo ready;; bye) exit;; "
      "until) echo done $time;; *) echo done $time;; esac; done",
      {});
  const trace::Parsed silent = trace::parse(
      "%rtr 1\n%node m5 mote id=5 iut\ncase silent\n @0..3000 m5 !> rA * [J1-CALLED]\n", "a.rtr");
  jumper->identity();
  const auto before = std::chrono::steady_clock::now();
  const CaseResult result =
      runner::run_case(silent.file, silent.file.cases.at(0),
                       [&](const trace::NodeHeader&) { return jumper->target(); });
  EXPECT_EQ(result.verdict, CaseVerdict::kFail);
  EXPECT_NE(result.reason.find("it says that 3000 ticks have passed"), std::string::npos)
      << result.reason;
  EXPECT_LT(std::chrono::steady_clock::now() - before, kFaultMax);
}

// A machine that answers in real time: when the time has come.
TEST_F(BrokenAdapters, RealTimeAdapterIsWaitedFor) {
  const auto patient = attach(
      "while read -r word time rest; do case $word in "
      "hello) echo hello rct/1 patient 1 roles=mote time=real;; reset) echo ready;; bye) exit;; "
      "until) sleep 1.1; echo done $time;; *) echo done $time;; esac; done",
      {milliseconds(500), milliseconds(20000)});  // Beside the time that is to pass.
  const trace::Parsed silent = trace::parse(
      "%rtr 1\n%node m5 mote id=5 iut\ncase silent\n @0..1024 m5 !> rA * [J1-CALLED]\n", "a.rtr");
  const CaseResult result =
      runner::run_case(silent.file, silent.file.cases.at(0),
                       [&](const trace::NodeHeader&) { return patient->target(); });
  EXPECT_EQ(result.verdict, CaseVerdict::kPass) << result.reason;
}

// One node forgets what it was asked to be, one takes any parameter, one states it and is not so.
TEST_F(BrokenAdapters, ANodeIsHeldToWhatItIsAskedFor) {
  const auto files = runner::load_cases("conformance/cases");
  struct Row {
    const char* name;
    const char* parameter;
    trace::ParameterId id;
    const char* rule;
    CaseVerdict verdict = CaseVerdict::kFail;
  };
  for (const auto& [name, parameter, id, rule, verdict] : {
           Row{"j3.full_list_as_stated", "members", trace::ParameterId::kMembers, "J6-ADD"},
           Row{"j8.limit_as_stated", "join_requests", trace::ParameterId::kJoinRequests,
               "J8-LIMIT"},
           Row{"j4.few_as_stated", "ack_joins", trace::ParameterId::kAckJoins, "J4-FEW",
               CaseVerdict::kWeak},
       }) {
    SCOPED_TRACE(name);
    const auto file = std::ranges::find_if(
        files, [&](const trace::Parsed& one) { return one.file.find(name) != nullptr; });
    ASSERT_NE(file, files.end());
    const auto run = [&](const std::string& filter, const trace::Statement& stated) {
      Options options{.stated = stated};
      const auto node =
          attach(fmt::format("sed -u {} | {}", filter, RUBRIC_MACHINE_ADAPTER), options);
      return runner::run_case(file->file, *file->file.find(name),
                              [&](const trace::NodeHeader&) { return node->target(); });
    };
    EXPECT_EQ(run("-n p", {}).verdict, CaseVerdict::kPass);
    const CaseResult forgets = run(fmt::format("'s/ {}=2$//'", parameter), {});
    EXPECT_EQ(forgets.verdict, verdict);
    EXPECT_TRUE(std::ranges::any_of(forgets.failures, [&](const runner::Failure& failure) {
      return failure.requirements == std::vector<std::string>{rule};
    }));
    const CaseResult takes_all = run(fmt::format("'s/ {}=.*//'", parameter), {});
    EXPECT_EQ(takes_all.verdict, CaseVerdict::kSkip);
    EXPECT_TRUE(takes_all.not_built);
    EXPECT_NE(takes_all.reason.find("takes whatever it is told"), std::string::npos);
    EXPECT_EQ(run("-n p", {{id, 2}}).verdict, verdict) << "It is built otherwise.";
  }
}

// A node that no `reset` can give other buffers passes where it is not asked for them.
TEST_F(BrokenAdapters, ANodeIsAskedForTheBuffersThatItStates) {
  const auto run = [](const std::string& says, const trace::Statement& stated) {
    const trace::Parsed one =
        trace::parse("%rtr 1\n%node m5 mote id=5" + says +
                         " iut\ncase silent\n @0..1024 m5 !> rA * [J1-CALLED]\n",
                     "a.rtr");
    Options options{.stated = stated};
    const auto node =
        attach("sed -u '/buffers=/s/^reset/resize/' | " RUBRIC_MACHINE_ADAPTER, options);
    return runner::run_case(one.file, one.file.cases.at(0),
                            [&](const trace::NodeHeader&) { return node->target(); });
  };
  const trace::Statement eight = {{trace::ParameterId::kBuffers, 8}};
  EXPECT_EQ(run("", {}).verdict, CaseVerdict::kPass);
  EXPECT_EQ(run("", eight).verdict, CaseVerdict::kPass);
  EXPECT_EQ(run(" buffers=8", eight).verdict, CaseVerdict::kPass);
  for (const CaseResult& other : {run(" buffers=8", {}), run(" buffers=4", eight)}) {
    EXPECT_EQ(other.verdict, CaseVerdict::kSkip);
    EXPECT_TRUE(other.not_built);
    EXPECT_NE(other.reason.find("it is not built with buffers="), std::string::npos);
  }
}

TEST_F(BrokenAdapters, RolesThatItDoesNotPlayAreSkipped) {
  const auto sink = attach(
      "while read -r line; do case $line in "
      "hello*) echo hello rct/1 only_sink 1 roles=sink;; bye) exit;; "
      "*) echo unsupported;; esac; done",
      {});
  const CaseResult result = run(*sink);
  EXPECT_EQ(result.verdict, CaseVerdict::kSkip);
  EXPECT_EQ(result.reason, "only_sink plays no mote");
}

}  // namespace
}  // namespace rubric::targets
