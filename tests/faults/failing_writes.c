// SPDX-License-Identifier: Apache-2.0
// Library for LD_PRELOAD: the N-th call that creates or writes a file fails as on a full disk. N comes from the
// environment variable IBR_FAIL_WRITE and starts at 0. Counted calls use paths below IBR_FAIL_BELOW or their
// descriptors: open for writing, write, close after writing, rename, mkdir. After a failure, the file IBR_FAIL_REPORT
// contains "failed CALL PATH".
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { kMost = 1024 };
static atomic_int calls;
static char watched[kMost];

static int below(const char* path) {
  const char* folder = getenv("IBR_FAIL_BELOW");
  return folder && strncmp(path, folder, strlen(folder)) == 0;
}

static int fails(const char* call, const char* path) {
  const char* wanted = getenv("IBR_FAIL_WRITE");
  if (!wanted || atomic_fetch_add(&calls, 1) != atoi(wanted)) return 0;
  int (*real)(const char*, int, ...) = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, "open");
  const int fd = real(getenv("IBR_FAIL_REPORT"), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dprintf(fd, "failed %s %s", call, path);
  close(fd);
  errno = ENOSPC;
  return 1;
}

static int opened(const char* name, const char* path, int flags, unsigned mode) {
  int (*real)(const char*, int, ...) = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, name);
  const int writes = (flags & O_ACCMODE) != O_RDONLY && below(path);
  if (writes && fails("open", path)) return -1;
  const int fd = real(path, flags, mode);
  if (writes && fd >= 0 && fd < kMost) watched[fd] = 1;
  return fd;
}

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const unsigned mode = flags & O_CREAT ? va_arg(more, unsigned) : 0;
  va_end(more);
  return opened("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const unsigned mode = flags & O_CREAT ? va_arg(more, unsigned) : 0;
  va_end(more);
  return opened("open64", path, flags, mode);
}

ssize_t write(int fd, const void* bytes, size_t size) {
  ssize_t (*real)(int, const void*, size_t) = (ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
  if (fd >= 0 && fd < kMost && watched[fd]) {
    if (fails("write", "")) return -1;
  }
  return real(fd, bytes, size);
}

int close(int fd) {
  int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "close");
  if (fd >= 0 && fd < kMost && watched[fd]) {
    watched[fd] = 0;
    if (fails("close", "")) {
      real(fd);
      errno = ENOSPC;
      return -1;
    }
  }
  return real(fd);
}

int rename(const char* from, const char* to) {
  int (*real)(const char*, const char*) = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  return below(to) && fails("rename", to) ? -1 : real(from, to);
}

int mkdir(const char* path, mode_t mode) {
  int (*real)(const char*, mode_t) = (int (*)(const char*, mode_t))dlsym(RTLD_NEXT, "mkdir");
  return below(path) && fails("mkdir", path) ? -1 : real(path, mode);
}
