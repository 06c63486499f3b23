// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <random>
#include <utility>

#include "base/check.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ~Descriptor() { close(); }
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }
  bool close() {
    const int fd = std::exchange(fd_, -1);
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

struct OpenFile {
  Descriptor descriptor;
  std::uint64_t size;
};

OpenFile openRegular(const fs::path& path) {
  // O_NONBLOCK: opening a pipe must not wait for a writer.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  check(fd >= 0, ErrorCode::io, "{}: cannot be opened: {}", path.string(), std::strerror(errno));
  Descriptor descriptor(fd);
  struct stat status {};
  check(::fstat(fd, &status) == 0, ErrorCode::io, "{}: {}", path.string(), std::strerror(errno));
  check(S_ISREG(status.st_mode), ErrorCode::io, "{}: is not a regular file", path.string());
  return {std::move(descriptor), std::uint64_t(status.st_size)};
}

template <class Container>
Container readBytes(const OpenFile& file, const fs::path& path, std::uint64_t size) {
  Container bytes;
  bytes.resize(size);
  for (std::uint64_t done = 0; done < size;) {
    const ssize_t n = ::read(file.descriptor.get(), bytes.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    check(n >= 0, ErrorCode::io, "{}: cannot be read: {}", path.string(), std::strerror(errno));
    check(n > 0, ErrorCode::io, "{}: ended after {} of {} bytes", path.string(), done, size);
    done += std::uint64_t(n);
  }
  return bytes;
}

template <class Container>
Container readWhole(const fs::path& path, std::uint64_t limit) {
  const OpenFile file = openRegular(path);
  check(file.size <= limit, ErrorCode::invalidInput, "{}: {} bytes, more than the limit of {}", path.string(),
        file.size, limit);
  return readBytes<Container>(file, path, file.size);
}

}  // namespace

std::vector<std::byte> readFile(const fs::path& path, std::uint64_t limit) {
  return readWhole<std::vector<std::byte>>(path, limit);
}

std::string readTextFile(const fs::path& path, std::uint64_t limit) {
  return readWhole<std::string>(path, limit);
}

std::vector<std::byte> readFileStart(const fs::path& path, std::size_t bytes) {
  const OpenFile file = openRegular(path);
  return readBytes<std::vector<std::byte>>(file, path, std::min<std::uint64_t>(bytes, file.size));
}

InputFile::InputFile(const fs::path& path) : path_(path) {
  OpenFile file = openRegular(path);
  descriptor_ = file.descriptor.release();
  size_ = file.size;
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void InputFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::pread(descriptor_, &bytes[done], bytes.size() - done, ::off_t(offset + done));
    if (n < 0 && errno == EINTR) continue;
    check(n >= 0, ErrorCode::io, "{}: cannot be read: {}", path_.string(), std::strerror(errno));
    check(n > 0, ErrorCode::io, "{}: ends after {} bytes; another program may still be writing it", path_.string(),
          offset + done);
    done += std::size_t(n);
  }
}

void writeFile(const fs::path& path, std::span<const std::byte> bytes) {
  // A device or pipe cannot be replaced by renaming; the bytes are written in place.
  std::error_code ignored;
  const auto kind = fs::status(path, ignored).type();
  const bool inPlace = kind == fs::file_type::character || kind == fs::file_type::fifo;
  // Threads, processes and machines that share a folder may write the same file at the same time. Process numbers
  // differ only within a machine, hence the random number.
  static const unsigned process = std::random_device()();
  static std::atomic<unsigned> drafts = 0;
  const fs::path draft =
      inPlace ? path : fs::path(path.string() + fmt::format(".{}-{:08x}.{}.tmp", ::getpid(), process, ++drafts));
  auto giveUp = [&](int error) {
    if (!inPlace) fs::remove(draft, ignored);
    fail(ErrorCode::io, "{}: cannot be written: {}", path.string(), std::strerror(error));
  };
  Descriptor file(::open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  check(file.get() >= 0, ErrorCode::io, "{}: cannot be written: {}", path.string(), std::strerror(errno));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) giveUp(n < 0 ? errno : ENOSPC);
    done += std::size_t(n);
  }
  if (!file.close()) giveUp(errno);
  if (!inPlace && ::rename(draft.c_str(), path.c_str()) != 0) giveUp(errno);
}

void writeFile(const fs::path& path, std::string_view text) {
  writeFile(path, std::as_bytes(std::span(text.data(), text.size())));
}

void makeFolders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  check(!error, ErrorCode::io, "{}: the folder cannot be created: {}", folder.string(), error.message());
}

void checkFolderWritable(const fs::path& folder) {
  std::error_code ignored;
  fs::path there = fs::absolute(folder);
  while (!fs::exists(there, ignored) && there.has_parent_path() && there != there.parent_path())
    there = there.parent_path();
  check(fs::is_directory(there, ignored), ErrorCode::io, "{}: the folder cannot be created: {} is not a folder",
        folder.string(), there.string());
  check(::access(there.c_str(), W_OK) == 0, ErrorCode::io, "{}: cannot be written: {}", there.string(),
        std::strerror(errno));
}

double folderBytes(const fs::path& folder) {
  std::error_code error;
  double bytes = 0;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && !at->is_symlink(ignored)) bytes += double(at->file_size(ignored));
  }
  return bytes;
}

fs::path pathBelow(const fs::path& folder, const fs::path& relative) {
  const fs::path normal = relative.lexically_normal();
  check(relative.is_relative() && !normal.empty() && normal != "." && *normal.begin() != "..", ErrorCode::invalidInput,
        "{}: leads outside the folder {}", relative.string(), folder.string());
  return folder / relative;
}

fs::path pathInside(const fs::path& folder, const fs::path& relative) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error);
  const fs::path path = error ? fs::path() : fs::weakly_canonical(root / relative, error);
  check(!error, ErrorCode::invalidInput, "{}: is not a valid path in {}: {}", relative.string(), folder.string(),
        error.message());
  const auto [rootEnd, unused] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  check(relative.is_relative() && rootEnd == root.end() && path != root, ErrorCode::invalidInput,
        "{}: leads outside the folder {}", relative.string(), folder.string());
  return path;
}

}  // namespace ibr
