// Makes one call of the C library fail, for tests (faults_test.py). Preloaded with LD_PRELOAD.
//
// FAIL_CALL names the call: open, read, write, rename, fsync, connect, accept or malloc; FAIL_AT
// says which one after the begin of main(), counted from 1; FAIL_ERRNO is what it fails with, and
// with 0 the program is killed there. When the program exits or calls _exit, FAIL_COUNT, a file,
// has how many there were, and after it the numbers of those that came from a new place: with
// malloc a place is a call stack, which is listed at its 1st, 4th, 16th, 64th ... call.
//
// With FAIL_LIST, a file of ascending numbers, each of these calls fails in a process of its own, a
// copy of this one at that place, which goes on to its end while this one waits. It works on a copy
// of FAIL_FOLDER, which has the same name; so only what is in that folder may be written. FAIL_TALK
// is a socket: the number and the copy's wait status go there as a line, and this one goes on when
// a byte comes back. The program must have one thread and no children.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <unwind.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr unsigned kPatienceS = 30;  // Of a copy.

std::atomic<bool> armed{false};
std::atomic<long> count{0};
const char* call = "";
long fail_at = 0;
int fail_errno = 0;
std::vector<long> list;  // Of FAIL_LIST, the next one last.
int talk = -1;

// A stack as a number, and how often malloc was called from it. Arrays, as nothing may allocate
// while allocations are counted.
struct Stack {
  std::uint64_t id;
  unsigned calls;
};
std::array<Stack, 1 << 16> stacks;
std::array<long, 1 << 17> new_places;
std::size_t places = 0;
std::mutex noting;

std::uint64_t this_stack() {
  std::uint64_t id = 0;
  const auto add = [](_Unwind_Context* frame, void* sum) {
    auto& out = *static_cast<std::uint64_t*>(sum);
    out = (out ^ _Unwind_GetIP(frame)) * 0x9e3779b97f4a7c15;
    out ^= out >> 29;
    return _URC_NO_REASON;
  };
  _Unwind_Backtrace(add, &id);
  return id;
}

void note_place(long number) {
  const std::lock_guard lock{noting};
  bool is_new = true;
  if (std::strcmp(call, "malloc") == 0) {
    const std::uint64_t id = this_stack();
    std::size_t at = id % stacks.size();
    while (stacks[at].calls != 0 && stacks[at].id != id) at = (at + 1) % stacks.size();
    stacks[at].id = id;
    const unsigned calls = ++stacks[at].calls;
    is_new = (calls & (calls - 1)) == 0 && (calls & 0x55555555) != 0;
  }
  if (!is_new) return;
  if (places == new_places.size() / 2) std::abort();  // Then the stacks may be full, too.
  new_places[places++] = number;
}

// Gives the process places of its own in all files that it reads and writes, and makes the
// descriptors of files of one folder lead to the same files of another.
void move_files(const std::string& from, const std::string& to) {
  for (const fs::directory_entry& open : fs::directory_iterator("/proc/self/fd")) {
    const int fd = std::stoi(open.path().filename().native());
    const std::string file = fs::read_symlink(open.path()).native();
    if (!fs::is_regular_file(open.path())) continue;
    const bool moves = file.rfind(from + "/", 0) == 0;
    const std::string path = moves ? to + file.substr(from.size()) : open.path().native();
    const int flags = ::fcntl(fd, F_GETFL) & ~(O_CREAT | O_EXCL | O_TRUNC);
    const int copy = ::open(path.c_str(), flags);
    ::lseek(copy, ::lseek(fd, 0, SEEK_CUR), SEEK_SET);
    ::dup3(copy, fd, (::fcntl(fd, F_GETFD) & FD_CLOEXEC) != 0 ? O_CLOEXEC : 0);
    ::close(copy);
  }
}

// Returns true in a copy of the process and, after its end, false in the process.
bool is_copy() {
  armed = false;
  const int error = errno;
  const std::string folder = std::getenv("FAIL_FOLDER");
  const std::string kept = folder + ".kept";
  fs::rename(folder, kept);
  fs::copy(kept, folder);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::close(talk);
    move_files(kept, folder);
    ::alarm(kPatienceS);
    return true;
  }
  int status = 0;
  ::waitpid(pid, &status, 0);
  ::dprintf(talk, "%ld %d\n", count.load(), status);
  char go = 0;
  if (pid < 0 || ::recv(talk, &go, 1, 0) != 1) std::abort();
  fs::remove_all(folder);
  fs::rename(kept, folder);
  errno = error;
  armed = true;
  return false;
}

// Returns whether this call has to fail.
bool fails(const char* name) {
  if (!armed || std::strcmp(name, call) != 0) return false;
  const long number = ++count;
  if (fail_at == 0 && list.empty() && talk < 0) note_place(number);
  if (list.empty()) {
    if (number != fail_at) return false;
  } else {
    if (number != list.back()) return false;
    list.pop_back();
    if (!is_copy()) return false;
  }
  if (fail_errno == 0) std::raise(SIGKILL);
  errno = fail_errno;
  return true;
}

void write_count() {
  if (!armed.exchange(false)) return;
  const char* const path = std::getenv("FAIL_COUNT");
  if (path == nullptr) return;
  const long fd = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  const auto put = [fd](long number) {
    char text[24];
    ::syscall(SYS_write, fd, text, std::snprintf(text, sizeof text, "%ld\n", number));
  };
  put(count);
  for (std::size_t place = 0; place < places; ++place) put(new_places[place]);
  ::syscall(SYS_close, fd);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

using Main = int(int, char**, char**);
Main* real_main;

int armed_main(int argc, char** argv, char** environment) {
  const auto text = [](const char* name, const char* without) {
    const char* const value = std::getenv(name);
    return value == nullptr ? without : value;
  };
  call = text("FAIL_CALL", "");
  fail_at = std::atol(text("FAIL_AT", "0"));
  fail_errno = std::atoi(text("FAIL_ERRNO", "5"));
  std::ifstream numbers{text("FAIL_LIST", "")};
  for (long number = 0; numbers >> number;) list.insert(list.begin(), number);
  talk = std::atoi(text("FAIL_TALK", "-1"));
  armed = true;
  const int code = real_main(argc, argv, environment);
  write_count();
  return code;
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);

int __libc_start_main(Main* main, int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  return next<decltype(__libc_start_main)>("__libc_start_main")(armed_main, argc, argv, init, fini,
                                                                rtld_fini, stack_end);
}

void* malloc(std::size_t size) { return fails("malloc") ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t number, std::size_t size) {
  return fails("malloc") ? nullptr : __libc_calloc(number, size);
}
void* realloc(void* old, std::size_t size) {
  return fails("malloc") ? nullptr : __libc_realloc(old, size);
}

int open(const char* path, int flags, ...) {
  if (fails("open")) return -1;
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
std::FILE* fopen(const char* path, const char* mode) {
  return fails("open") ? nullptr : next<decltype(fopen)>("fopen")(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) {
  return fails("open") ? nullptr : next<decltype(fopen)>("fopen64")(path, mode);
}
ssize_t read(int fd, void* bytes, std::size_t size) {
  return fails("read") ? -1 : ::syscall(SYS_read, fd, bytes, size);
}
ssize_t write(int fd, const void* bytes, std::size_t size) {
  return fails("write") ? -1 : ::syscall(SYS_write, fd, bytes, size);
}
int rename(const char* from, const char* to) noexcept {
  return fails("rename") ? -1 : static_cast<int>(::syscall(SYS_rename, from, to));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  return fails("rename")
             ? -1
             : static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}
int fsync(int fd) { return fails("fsync") ? -1 : static_cast<int>(::syscall(SYS_fsync, fd)); }
int fdatasync(int fd) {
  return fails("fsync") ? -1 : static_cast<int>(::syscall(SYS_fdatasync, fd));
}
int syncfs(int fd) noexcept {
  return fails("fsync") ? -1 : static_cast<int>(::syscall(SYS_syncfs, fd));
}
int connect(int fd, const sockaddr* to, socklen_t size) {
  return fails("connect") ? -1 : next<decltype(connect)>("connect")(fd, to, size);
}
int accept(int fd, sockaddr* from, socklen_t* size) {
  return fails("accept") ? -1 : next<decltype(accept)>("accept")(fd, from, size);
}
int accept4(int fd, sockaddr* from, socklen_t* size, int flags) {
  return fails("accept") ? -1 : next<decltype(accept4)>("accept4")(fd, from, size, flags);
}
void _exit(int code) {
  write_count();
  ::syscall(SYS_exit_group, code);
  __builtin_unreachable();
}
}
