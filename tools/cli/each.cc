#include "tools/cli/each.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <glob.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include "codec/text/files.h"
#include "codec/text/packed.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"

namespace rubric::cli {
namespace {

namespace fs = std::filesystem;

// The exit codes of runs, the least grave first.
constexpr int kGraver[] = {kExitClean, kExitIncomplete, kExitFindings, kExitInput,
                           kExitUsage, kExitOutput,     kExitBroken};

constexpr std::string_view kLineBegin = R"({"schema":"rubric.each/1",)";
constexpr std::size_t kAheadMax = 4096;    // Results that wait for an earlier one.
constexpr std::size_t kRunsThatShare = 8;  // To read all specs takes as long as some runs.
// What is taken of a folder.
constexpr std::string_view kExtensions[] = {".pcap",     ".pcapng", ".bin", ".sf",
                                            ".sfstream", ".hex",    ".rtr"};

// FNV-1a: the same everywhere and always.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

struct Shard {
  std::uint64_t part = 1;
  std::uint64_t of = 1;
};

Shard parse_shard(const std::string& text) {
  Shard out;
  if (text.empty()) return out;
  const char* const end = text.data() + text.size();
  const auto part = std::from_chars(text.data(), end, out.part);
  const bool slash = part.ec == std::errc() && part.ptr != end && *part.ptr == '/';
  const auto of = slash ? std::from_chars(part.ptr + 1, end, out.of) : part;
  if (!slash || of.ec != std::errc() || of.ptr != end || out.part == 0 || out.part > out.of) {
    throw UsageError("--shard", fmt::format("expected K/N as in 2/8, given '{}'", text));
  }
  return out;
}

// A file, and the name that decides of which shard it is: its place in the folder that was given.
struct OneRun {
  std::string file;
  std::string name;
  bool of_all = false;  // A folder that cannot be read, or is not there, may hold each shard's.
};

bool is_wanted(const fs::path& file) {
  const fs::path plain = text::name_unpacked(file.native());
  const std::string extension = plain.extension().string();
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension) !=
         std::end(kExtensions);
}

// What cannot be looked at, a folder too, is a run that cannot be read: it is not passed over.
void add_folder(const fs::path& top, std::vector<OneRun>& out) {
  const auto add = [&](const fs::path& path, bool folder) {
    out.push_back({path.string(), path.lexically_relative(top).string(), folder});
  };
  std::vector<fs::path> folders = {top};
  while (!folders.empty()) {
    const fs::path folder = std::move(folders.back());
    folders.pop_back();
    std::error_code error;
    fs::directory_iterator entry(folder, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
      std::error_code unknown;
      if (entry->symlink_status(unknown).type() == fs::file_type::directory) {
        folders.push_back(entry->path());
      } else if (is_wanted(entry->path()) &&
                 (entry->is_regular_file(unknown) || !entry->exists(unknown))) {
        add(entry->path(), false);
      }
    }
    if (error) add(folder, true);
  }
}

void add_pattern(const std::string& pattern, std::vector<OneRun>& out) {
  glob_t found{};
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      const std::string path = found.gl_pathv[i];
      std::error_code ignored;
      if (fs::is_directory(path, ignored)) {
        add_folder(path, out);
      } else {
        out.push_back({path, fs::path(path).filename().string()});
      }
    }
  }
  ::globfree(&found);
}

std::vector<OneRun> runs_of(const std::vector<std::string>& names, const Shard& shard) {
  std::vector<OneRun> all;
  for (const std::string& name : names) {
    std::error_code ignored;
    const std::size_t before = all.size();
    if (fs::is_directory(name, ignored)) {
      add_folder(name, all);
    } else if (fs::exists(name, ignored)) {
      all.push_back({name, fs::path(name).filename().string()});
    } else if (name.find_first_of("*?[") == name.npos) {
      all.push_back({name, name, true});  // It may have been a folder.
    } else {
      add_pattern(name, all);
    }
    if (all.size() == before) throw UsageError("FILE", "'" + name + "' holds no runs");
  }
  std::vector<OneRun> out;
  std::set<std::string> once;
  for (OneRun& run : all) {
    const bool mine = run.of_all || hash_of(run.name) % shard.of == shard.part - 1;
    if (mine && once.insert(run.file).second) out.push_back(std::move(run));
  }
  std::sort(out.begin(), out.end(),
            [](const OneRun& a, const OneRun& b) { return a.file < b.file; });
  return out;
}

// Returns what the result of a run depends on: the program, the settings, and which file it was.
// Empty if it is not there.
std::string key_of(const EachJob& job, const std::string& file) {
  struct stat is {};
  struct stat program {};
  if (::stat(file.c_str(), &is) != 0 || ::stat("/proc/self/exe", &program) != 0) return {};
  const std::string text = fmt::format("{}.{}\n{}\n{}\n{}\n{}\n{}.{:09}", program.st_size,
                                       program.st_mtim.tv_sec, job.command, job.settings, file,
                                       is.st_size, is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
  return fmt::format("{:016x}", hash_of(text));
}

// Reads a file to its end. Throws std::system_error, which says `name`.
std::string rest_of(int fd, const std::string& name) {
  std::string out;
  char bytes[65536];
  for (ssize_t count = 0; (count = ::read(fd, bytes, sizeof bytes)) != 0;) {
    if (count > 0) out.append(bytes, static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), name);
  }
  return out;
}

// The results of earlier commands: a line each, {"key":"0123456789abcdef","run":{...}}. A line that
// a kill cut short, or of another schema, counts for nothing.
class State {
 public:
  explicit State(const std::string& path) : path_(path) {
    if (path.empty()) return;
    fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    struct stat is {};
    if (fd_ < 0 || ::fstat(fd_, &is) != 0) {
      exit_with(cannot_write(std::system_error(errno, std::generic_category(), path)));
    }
    // Others have no end, or forget.
    if (!S_ISREG(is.st_mode)) throw UsageError("--resume", path + " is not a file");
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      throw UsageError("--resume", path + " is in use by another command");
    }
    read(path);
  }
  ~State() {
    if (fd_ >= 0) ::close(fd_);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  const std::string* find(const std::string& key) const {
    const auto at = known_.find(key);
    return at == known_.end() ? nullptr : &at->second;
  }

  void add(const std::string& key, const std::string& line) {
    if (fd_ < 0 || key.empty() || failed_) return;
    failed_ = !is_written(path_, text::write_all(fd_, kBefore + key + kBetween + line + "}\n"));
  }
  // Returns whether a result could not be written.
  bool failed() const { return failed_; }

 private:
  static constexpr std::size_t kKeyChars = 16;
  inline static const std::string kBefore = R"({"key":")";
  inline static const std::string kBetween = R"(","run":)";

  void read(const std::string& path) {
    const std::string text = rest_of(fd_, path);
    const std::size_t head = kBefore.size() + kKeyChars + kBetween.size();
    std::size_t at = 0;
    for (std::size_t end = 0; (end = text.find('\n', at)) != text.npos; at = end + 1) {
      const std::string_view line = std::string_view(text).substr(at, end - at);
      if (line.size() < head + 3 || !line.starts_with(kBefore) || !line.ends_with("}}") ||
          line.substr(kBefore.size() + kKeyChars, kBetween.size()) != kBetween ||
          !line.substr(head).starts_with(kLineBegin)) {
        if (at == 0) throw UsageError("--resume", path + " holds something else");
        continue;
      }
      known_[std::string(line.substr(kBefore.size(), kKeyChars))] =
          line.substr(head, line.size() - head - 1);
    }
    if (at == 0 && !text.empty() && !text.starts_with(kBefore.substr(0, text.size()))) {
      throw UsageError("--resume", path + " holds something else");
    }
    if (at < text.size()) text::write_all(fd_, "\n");  // After a line that was cut short.
  }

  const std::string path_;
  int fd_ = -1;
  bool failed_ = false;
  std::map<std::string, std::string> known_;
};

int memory_file() {
  const int fd = ::memfd_create("rubric-run", MFD_CLOEXEC);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
  return fd;
}

std::string content_of(int fd) {
  ::lseek(fd, 0, SEEK_SET);
  std::string out = rest_of(fd, "the result of a run");
  ::close(fd);
  return out;
}

class Runs {
 public:
  Runs(const EachOptions& options, const EachJob& job, std::vector<OneRun> runs, Output& output)
      : job_(job),
        runs_(std::move(runs)),
        state_(options.resume),
        output_(output),
        jobs_(options.jobs != 0 ? options.jobs
                                : std::max(1U, std::thread::hardware_concurrency())) {}

  // Returns the exit code.
  int go(const EachRun& run) {
    std::size_t next = 0;
    while (next_line_ < runs_.size() && good_) {
      const bool room = children_.size() < jobs_ && next < next_line_ + kAheadMax;
      if (next == runs_.size() || !room) {
        wait();
        continue;
      }
      const std::size_t i = next++;
      const std::string key = key_of(job_, runs_[i].file);
      if (const std::string* const line = key.empty() ? nullptr : state_.find(key)) {
        ++known_;
        finish(i, *line);
      } else {
        start(i, key, run);
      }
    }
    for (const auto& [pid, child] : children_) ::kill(pid, SIGTERM);
    while (!children_.empty()) wait();
    return sum();
  }

 private:
  struct Child {
    std::size_t run = 0;
    std::string key;
    int members_fd = -1;
    int error_fd = -1;
  };

  void start(std::size_t i, const std::string& key, const EachRun& run) {
    if (!std::exchange(prepared_, true) && runs_.size() >= kRunsThatShare) job_.prepare();
    Child child{i, key, memory_file(), memory_file()};
    output_.flush();  // Else both processes would write what waits.
    std::fflush(nullptr);
    pid_t pid = 0;
    while ((pid = ::fork()) < 0 && errno == EAGAIN && !children_.empty()) wait();
    if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (pid > 0) {
      children_[pid] = child;
      return;
    }
    // This is the run's own process. What belongs to the others is not unwound.
    ::dup2(child.error_fd, STDERR_FILENO);
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(nothing, STDOUT_FILENO);
    std::string members;
    int code = kExitBroken;
    try {
      code = run(runs_[i].file, members);
    } catch (const Ending& ending) {
      if (code_of(ending) >= 0) code = code_of(ending);
      if (code_of(ending) < 0) text::print(stderr, "{}\n", ending.what());
    } catch (const std::exception& error) {
      text::print(stderr, "{}\n", error.what());
    }
    if (text::write_all(child.members_fd, members) != 0) code = kExitOutput;
    std::fflush(nullptr);
    ::_exit(code);
  }

  void wait() {
    int status = 0;
    const pid_t pid = ::waitpid(-1, &status, 0);
    const auto at = children_.find(pid);
    if (at == children_.end()) return;
    const Child child = at->second;
    children_.erase(at);
    std::string members = content_of(child.members_fd);
    std::string error = content_of(child.error_fd);
    const bool killed = !WIFEXITED(status);
    if (killed) {
      members.clear();
      error += fmt::format("was killed by signal {}\n", WTERMSIG(status));
    }
    while (error.ends_with('\n')) error.pop_back();
    std::string line = fmt::format(R"({}"file":{},"exit_code":{})", kLineBegin,
                                   text::json_string(runs_[child.run].file),
                                   killed ? kExitBroken : WEXITSTATUS(status));
    if (!members.empty()) line += "," + members;
    if (!error.empty()) line += R"(,"error":)" + text::json_string(error);
    line += '}';
    // What broke may go well the next time.
    const bool lasts = !killed && (WEXITSTATUS(status) == 0 || !members.empty());
    if (lasts && good_) state_.add(child.key, line);
    finish(child.run, line);
  }

  // Writes the lines whose turn it is.
  void finish(std::size_t i, std::string line) {
    waiting_[i] = std::move(line);
    for (auto at = waiting_.begin(); at != waiting_.end() && at->first == next_line_;
         at = waiting_.erase(at), ++next_line_) {
      ++counts_[code_in(at->second)];
      output_.buffer().append(at->second + "\n");
      good_ = output_.flush() && good_;
    }
  }

  static int code_in(std::string_view line) {
    constexpr std::string_view kName = R"("exit_code":)";
    int code = 0;
    // The name of the file comes before it, but there its quotes are escaped.
    const std::size_t at = line.find(kName) + kName.size();
    std::from_chars(line.data() + at, line.data() + line.size(), code);
    return code;
  }

  int sum() {
    std::string ends;
    int gravest = 0;
    const auto rank = [&](int code) {
      return std::find(std::begin(kGraver), std::end(kGraver), code) - std::begin(kGraver);
    };
    for (const auto& [code, count] : counts_) {
      ends += fmt::format("{} {} ended with {}", ends.empty() ? ":" : ",", count, code);
      if (rank(code) > rank(gravest)) gravest = code;
    }
    text::print(stderr, "rubric {}: {}{}{}\n", job_.command, text::counted(next_line_, "run"),
                known_ == 0 ? "" : fmt::format(" ({} known by --resume)", known_), ends);
    return !output_.finish() || state_.failed() ? kExitOutput : gravest;
  }

  const EachJob& job_;
  const std::vector<OneRun> runs_;
  State state_;
  Output& output_;
  const std::size_t jobs_;
  std::map<pid_t, Child> children_;
  std::map<std::size_t, std::string> waiting_;  // By run: lines of which an earlier one is missing.
  std::size_t next_line_ = 0;
  std::map<int, std::size_t> counts_;  // By exit code.
  std::size_t known_ = 0;
  bool good_ = true;
  bool prepared_ = false;
};

}  // namespace

void add_each_options(Command& command, EachOptions& options) {
  command.add_flag("--each", options.each,
                   "Take each FILE as a run of its own, and folders and patterns of such; print a "
                   "line of JSON (rubric.each/1) for each");
  command
      .add_option("--jobs", options.jobs,
                  "With --each, take this many runs at a time (default: cores)")
      .between(std::uint64_t{1}, std::uint64_t{256});  // Each takes two descriptors.
  command.add_option(
      "--resume", options.resume,
      "With --each, keep results in this file, and skip runs whose results are there");
  command.add_option("--shard", options.shard,
                     "With --each, take only part K of N, divided by the files' names: K/N");
}

void check_each(const EachOptions& options) {
  if (options.each) return;
  if (options.jobs != 0) throw UsageError("--jobs", "goes with --each");
  if (!options.resume.empty()) throw UsageError("--resume", "goes with --each");
  if (!options.shard.empty()) throw UsageError("--shard", "goes with --each");
}

int each(const EachOptions& options, const EachJob& job, const std::vector<std::string>& names,
         const std::string& out, const EachRun& run) {
  std::vector<OneRun> runs = runs_of(names, parse_shard(options.shard));
  std::vector<std::string> files;
  for (const OneRun& one : runs) files.push_back(one.file);
  keep_apart("--resume", options.resume, files);
  Output output(out, Output::Mode::kWhole);  // Only now: what is wrong costs no file.
  return Runs(options, job, std::move(runs), output).go(run);
}

}  // namespace rubric::cli
