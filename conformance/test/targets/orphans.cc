#include "conformance/test/targets/orphans.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string_view>

#include "codec/text/files.h"
#include "conformance/test/targets/groups.h"

extern char** environ;

namespace rubric::targets {
namespace {

constexpr std::string_view kMark = "RUBRIC_ADAPTER=";
constexpr int kRounds = 1000;  // Of a millisecond and more.

void pause_ms(int ms) { ::poll(nullptr, 0, ms); }

// Returns the children of this process, those that it adopted among them.
std::vector<pid_t> children() {
  std::vector<pid_t> out;
  const std::unique_ptr<DIR, int (*)(DIR*)> tasks(::opendir("/proc/self/task"), ::closedir);
  if (!tasks) return out;
  while (const dirent* const task = ::readdir(tasks.get())) {
    std::ifstream file(fmt::format("/proc/self/task/{}/children", task->d_name));
    for (pid_t pid = 0; file >> pid;) out.push_back(pid);
  }
  return out;
}

enum class Whose : unsigned char { kOurs, kAnothers, kNobodys, kUnknown };

// Returns nothing of a process that ends meanwhile.
std::string file_of(pid_t pid, std::string_view name) {
  std::string text;
  text::read_file(fmt::format("/proc/{}/{}", pid, name), text);
  return text;
}

Whose whose(pid_t pid, const std::string& mark) {
  std::string text = file_of(pid, "environ");
  if (text.empty()) {
    // Both are empty in the middle of exec(), and when it is dead; the first alone without one.
    if (file_of(pid, "cmdline").empty()) return Whose::kUnknown;
    text = file_of(pid, "environ");
  }
  const auto holds = [&](std::string_view word) {
    return text.starts_with(word) || text.find('\0' + std::string(word)) != text.npos;
  };
  if (holds(mark + '\0')) return Whose::kOurs;
  return holds(kMark) ? Whose::kAnothers : Whose::kNobodys;
}

}  // namespace

MarkedEnvironment::MarkedEnvironment() {
  static std::atomic<unsigned> next = 0;
  static const bool reaps = ::prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) == 0;
  (void)reaps;
  texts_.push_back(fmt::format("{}{}.{}", kMark, ::getpid(), next++));
  for (char** word = environ; *word != nullptr; ++word) {
    if (!std::string_view(*word).starts_with(kMark)) texts_.emplace_back(*word);
  }
  for (std::string& text : texts_) words_.push_back(text.data());
  words_.push_back(nullptr);
}

void end_orphans(const std::string& mark) {
  for (int round = 0; round < kRounds; ++round) {
    bool any = false;
    for (const pid_t pid : children()) {
      const GroupsNow groups = groups_now(pid);
      if (groups.is_leader || groups.starting) continue;
      const Whose its = whose(pid, mark);
      if (its == Whose::kAnothers || (its == Whose::kNobodys && groups.any)) continue;
      if (its != Whose::kUnknown) ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, WNOHANG);
      any = true;
    }
    if (!any) return;
    pause_ms(1);
  }
}

// Handlers may call all that is called here.
void end_all_children() {
  char path[64] = "/proc/self/task/";
  std::size_t end = std::char_traits<char>::length(path);
  char digits[16];
  std::size_t count = 0;
  for (pid_t rest = ::getpid(); rest > 0; rest /= 10) {
    digits[count++] = static_cast<char>('0' + rest % 10);
  }
  while (count > 0) path[end++] = digits[--count];
  for (const char c : std::string_view("/children")) path[end++] = c;
  for (int round = 0; round < 20; ++round) {
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    char text[4096];
    const ssize_t size = ::read(fd, text, sizeof text);
    ::close(fd);
    bool any = false;
    pid_t pid = 0;
    for (ssize_t i = 0; i < size; ++i) {
      if (text[i] >= '0' && text[i] <= '9') {
        pid = pid * 10 + (text[i] - '0');
        continue;
      }
      if (pid > 0) any = ::kill(pid, SIGKILL) == 0 || any;
      if (pid > 0) ::waitpid(pid, nullptr, WNOHANG);
      pid = 0;
    }
    if (!any) return;
    pause_ms(2);
  }
}

}  // namespace rubric::targets
