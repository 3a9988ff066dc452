// For a whole program: LD_PRELOAD=libpackmpi_io_faults.so, and
//   IO_FAULTS_FOLDER   prefix of the paths that count
//   IO_FAULTS_KIND     number of a Fault
//   IO_FAULTS_CALL     which call fails
//   IO_FAULTS_RANK     on which rank of Open MPI's; all if it is not set
//   IO_FAULTS_REPORT   prefix of a file PREFIX.RANK that is made when a call fails
#include "support/io_faults.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

using packmpi::testing::Fault;

enum class Call { write, other, read };
enum class Use : std::uint8_t { none, reading, writing };

std::atomic<Fault> fault = Fault::none;
std::atomic<long> calls = 0, wanted = 0, failed = 0;
std::array<char, 4096> folder{};
std::array<std::atomic<Use>, 4096> uses{};  // of the descriptors
bool recording = false;
std::string record;
std::array<std::string, 4096> names{};  // of the descriptors, while recording

void note(const char* what, const std::string& name) {
  if (recording) record += std::string(what) + ' ' + name + '\n';
}

/// Without the folder; the folder itself is ".".
std::string short_name(const char* path) {
  const std::size_t prefix = std::strlen(folder.data());
  if (std::strlen(path) <= prefix) return ".";
  return path + prefix + (path[prefix] == '/' ? 1 : 0);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

void report() {
  const char* prefix = std::getenv("IO_FAULTS_REPORT");
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  if (prefix == nullptr || rank == nullptr) return;
  const std::string path = std::string(prefix) + "." + rank;
  const int fd = next<int(const char*, int, ...)>("open")(path.c_str(), O_WRONLY | O_CREAT, 0644);
  if (fd >= 0) next<int(int)>("close")(fd);
}

bool counts(Fault now, Call call) {
  if (now == Fault::read_error) return call == Call::read;
  if (now == Fault::short_write) return call == Call::write;
  return now != Fault::none && call != Call::read;
}

/// Whether this call is the one; then errno is set.
bool fails(Call call) {
  const Fault now = fault;
  if (!counts(now, call)) return false;
  const long number = ++calls;
  if (wanted == 0 || number < wanted || (number > wanted && now != Fault::disk_full)) return false;
  if (failed++ == 0) report();
  errno = now == Fault::no_space || now == Fault::disk_full ? ENOSPC : EIO;
  return true;
}

Use use_of(int fd) {
  return fd >= 0 && fd < static_cast<int>(uses.size()) ? uses[static_cast<std::size_t>(fd)].load() : Use::none;
}

void set_use(int fd, Use use) {
  if (fd >= 0 && fd < static_cast<int>(uses.size())) uses[static_cast<std::size_t>(fd)] = use;
}

void note_use(const char* what, int fd) {
  if (use_of(fd) == Use::writing) note(what, names[static_cast<std::size_t>(fd)]);
}

bool below(const char* path) {
  return folder[0] != '\0' && std::strncmp(path, folder.data(), std::strlen(folder.data())) == 0;
}

/// Opening `path` by `real`, for reading or writing.
template <class Real>
int opening_unnamed(const char* path, int flags, Real real) {
  if (!below(path) || (flags & O_DIRECTORY) != 0) {  // the folder itself: only its fsync can fail
    const int fd = real();
    set_use(fd, below(path) || (folder[0] != '\0' && path == std::string(folder.data())) ? Use::writing : Use::none);
    return fd;
  }
  const Use use = (flags & O_ACCMODE) == O_RDONLY ? Use::reading : Use::writing;
  if (fails(use == Use::reading ? Call::read : Call::other)) return -1;
  const int fd = real();
  set_use(fd, use);
  return fd;
}

template <class Real>
int opening(const char* path, int flags, Real real) {
  const int fd = opening_unnamed(path, flags, real);
  if (recording && use_of(fd) != Use::none) names[static_cast<std::size_t>(fd)] = short_name(path);
  if (recording && (flags & O_TRUNC) != 0) note_use("write", fd);
  return fd;
}

/// Writing by `real`, or half of it by `half`.
template <class Real, class Half>
ssize_t writing(int fd, Real real, Half half) {
  note_use("write", fd);
  if (use_of(fd) != Use::writing || !fails(Call::write)) return real();
  return fault == Fault::short_write ? half() : -1;
}

template <class Real>
auto reading(int fd, Real real) -> decltype(real()) {
  return use_of(fd) != Use::none && fails(Call::read) ? -1 : real();
}

template <class Real>
int changing(int fd, Real real) {
  return use_of(fd) == Use::writing && fails(Call::other) ? -1 : real();
}

mode_t mode_of(int flags, va_list more) { return (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0; }

/// All but the last part, or half of the only one.
template <class Real>
ssize_t fewer(const iovec* parts, int count, Real real) {
  if (count > 1) return real(parts, count - 1);
  const iovec half{parts->iov_base, parts->iov_len / 2};
  return real(&half, 1);
}

template <class Open>
FILE* opening_stream(const char* path, const char* mode, Open* real) {
  const int flags = mode[0] == 'r' && std::strchr(mode, '+') == nullptr ? O_RDONLY : O_WRONLY;
  FILE* file = nullptr;
  (void)opening(path, flags, [&] {
    file = real(path, mode);
    return file == nullptr ? -1 : fileno(file);
  });
  return file;
}

[[gnu::constructor]] void arm_from_environment() {
  const char* where = std::getenv("IO_FAULTS_FOLDER");
  const char* kind = std::getenv("IO_FAULTS_KIND");
  const char* call = std::getenv("IO_FAULTS_CALL");
  const char* rank = std::getenv("IO_FAULTS_RANK");
  const char* mine = std::getenv("OMPI_COMM_WORLD_RANK");
  if (where == nullptr || kind == nullptr || call == nullptr || mine == nullptr) return;
  if (rank != nullptr && std::strcmp(rank, mine) != 0) return;
  io_faults_arm(where, static_cast<Fault>(std::atoi(kind)), std::atol(call));
}

}  // namespace

extern "C" {

void io_faults_arm(const char* where, Fault kind, long call) {
  std::strncpy(folder.data(), where, folder.size() - 1);
  calls = 0;
  failed = 0;
  wanted = call;
  fault = kind;
}

long io_faults_disarm() {
  fault = Fault::none;
  return failed;
}

void io_faults_record(const char* where) {
  std::strncpy(folder.data(), where, folder.size() - 1);
  record.clear();
  recording = true;
}

const char* io_faults_recorded() {
  recording = false;
  return record.c_str();
}

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = mode_of(flags, more);
  va_end(more);
  static auto* const real = next<int(const char*, int, ...)>("open");
  return opening(path, flags, [&] { return real(path, flags, mode); });
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = mode_of(flags, more);
  va_end(more);
  static auto* const real = next<int(const char*, int, ...)>("open64");
  return opening(path, flags, [&] { return real(path, flags, mode); });
}

int __open_2(const char* path, int flags) { return open(path, flags); }      // NOLINT(bugprone-reserved-identifier)
int __open64_2(const char* path, int flags) { return open64(path, flags); }  // NOLINT(bugprone-reserved-identifier)

FILE* fopen(const char* path, const char* mode) {
  static auto* const real = next<FILE*(const char*, const char*)>("fopen");
  return opening_stream(path, mode, real);
}

FILE* fopen64(const char* path, const char* mode) {
  static auto* const real = next<FILE*(const char*, const char*)>("fopen64");
  return opening_stream(path, mode, real);
}

ssize_t write(int fd, const void* data, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return writing(
      fd, [&] { return real(fd, data, size); }, [&] { return real(fd, data, size / 2); });
}

ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  return writing(
      fd, [&] { return real(fd, data, size, at); }, [&] { return real(fd, data, size / 2, at); });
}

ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) { return pwrite(fd, data, size, at); }

ssize_t writev(int fd, const iovec* parts, int count) {
  static auto* const real = next<ssize_t(int, const iovec*, int)>("writev");
  return writing(
      fd, [&] { return real(fd, parts, count); },
      [&] { return fewer(parts, count, [&](const iovec* some, int n) { return real(fd, some, n); }); });
}

ssize_t pwritev(int fd, const iovec* parts, int count, off_t at) {
  static auto* const real = next<ssize_t(int, const iovec*, int, off_t)>("pwritev");
  return writing(
      fd, [&] { return real(fd, parts, count, at); },
      [&] { return fewer(parts, count, [&](const iovec* some, int n) { return real(fd, some, n, at); }); });
}

ssize_t pwritev64(int fd, const iovec* parts, int count, off64_t at) { return pwritev(fd, parts, count, at); }

size_t fwrite(const void* data, size_t size, size_t count, FILE* file) {
  static auto* const real = next<size_t(const void*, size_t, size_t, FILE*)>("fwrite");
  note_use("write", fileno(file));
  if (use_of(fileno(file)) != Use::writing || !fails(Call::write)) return real(data, size, count, file);
  return fault == Fault::short_write ? real(data, size, count / 2, file) : 0;
}

ssize_t read(int fd, void* data, size_t size) {
  static auto* const real = next<ssize_t(int, void*, size_t)>("read");
  return reading(fd, [&] { return real(fd, data, size); });
}

ssize_t pread(int fd, void* data, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, void*, size_t, off_t)>("pread");
  return reading(fd, [&] { return real(fd, data, size, at); });
}

ssize_t pread64(int fd, void* data, size_t size, off64_t at) { return pread(fd, data, size, at); }
ssize_t __read_chk(int fd, void* data, size_t size, size_t) {  // NOLINT(bugprone-reserved-identifier)
  return read(fd, data, size);
}
ssize_t __pread_chk(int fd, void* data, size_t size, off_t at, size_t) {  // NOLINT(bugprone-reserved-identifier)
  return pread(fd, data, size, at);
}
ssize_t __pread64_chk(int fd, void* data, size_t size, off64_t at, size_t) {  // NOLINT(bugprone-reserved-identifier)
  return pread(fd, data, size, at);
}

int fallocate(int fd, int mode, off_t at, off_t size) {
  note_use("write", fd);
  static auto* const real = next<int(int, int, off_t, off_t)>("fallocate");
  return changing(fd, [&] { return real(fd, mode, at, size); });
}

int fallocate64(int fd, int mode, off64_t at, off64_t size) { return fallocate(fd, mode, at, size); }

int ftruncate(int fd, off_t size) noexcept {
  note_use("write", fd);
  static auto* const real = next<int(int, off_t)>("ftruncate");
  return changing(fd, [&] { return real(fd, size); });
}

int ftruncate64(int fd, off64_t size) noexcept { return ftruncate(fd, size); }

int fsync(int fd) {
  note_use("fsync", fd);
  static auto* const real = next<int(int)>("fsync");
  return changing(fd, [&] { return real(fd); });
}

int close(int fd) {
  static auto* const real = next<int(int)>("close");
  const Use use = use_of(fd);
  set_use(fd, Use::none);
  const bool told = use == Use::writing && fails(Call::other);
  const int number = errno;
  const int closed = real(fd);
  if (!told) return closed;
  errno = number;
  return -1;
}

int dup3(int from, int to, int flags) {
  static auto* const real = next<int(int, int, int)>("dup3");
  const int fd = real(from, to, flags);
  if (fd >= 0) set_use(to, use_of(from));
  return fd;
}

int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  if (below(to)) note("rename", short_name(to));
  return below(to) && fails(Call::other) ? -1 : real(from, to);
}
}
