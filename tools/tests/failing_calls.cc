// Makes one call of the C library fail, for tests (faults_test.py). Preloaded with LD_PRELOAD.
//
// FAIL_CALL names the call: open, read, write, rename, fsync, connect, accept or malloc; FAIL_AT
// says which one after the begin of main(), counted from 1; FAIL_ERRNO is what it fails with, and
// with 0 the program is killed there. How many there were goes to FAIL_COUNT, a file, when the
// program exits or calls _exit.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<bool> armed{false};
std::atomic<long> count{0};
const char* call = "";
long fail_at = 0;
int fail_errno = 0;

// Returns whether this call has to fail.
bool fails(const char* name) {
  if (!armed || std::strcmp(name, call) != 0 || ++count != fail_at) return false;
  if (fail_errno == 0) std::raise(SIGKILL);
  errno = fail_errno;
  return true;
}

void write_count() {
  if (!armed.exchange(false)) return;
  const char* const path = std::getenv("FAIL_COUNT");
  if (path == nullptr) return;
  char text[24];
  const int size = std::snprintf(text, sizeof text, "%ld\n", count.load());
  const long fd = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::syscall(SYS_write, fd, text, size);
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
