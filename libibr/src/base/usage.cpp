// SPDX-License-Identifier: Apache-2.0
#include "base/usage.h"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

std::string textOf(const fs::path& file) {  // files of /proc and /sys report no size
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::optional<double> firstNumber(std::string_view text) {
  const auto value = parseInt(text.substr(0, text.find_first_of(" \n")));
  return value && *value >= 0 ? std::optional(double(*value)) : std::nullopt;
}

}  // namespace

std::optional<double> cgroupMemoryLimit(const fs::path& root, std::string_view membership) {
  std::optional<double> lowest;
  while (!membership.empty()) {
    const std::string_view line = membership.substr(0, membership.find('\n'));
    membership.remove_prefix(std::min(membership.size(), line.size() + 1));
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string_view controllers = line.substr(first + 1, second - first - 1);
    const bool memory = fmt::format(",{},", controllers).find(",memory,") != std::string::npos;
    if (!controllers.empty() && !memory) continue;
    const fs::path top = memory ? root / "memory" : root;
    const char* const file = memory ? "memory.limit_in_bytes" : "memory.max";
    // Parent groups limit a group, too. Inside a container the root stands for the group itself.
    fs::path group = fs::path(line.substr(second + 1)).relative_path();
    for (bool last = false; !last; group = group.parent_path()) {
      last = group.empty();
      if (const auto limit = firstNumber(textOf(top / group / file)); limit && (!lowest || *limit < *lowest))
        lowest = limit;
    }
  }
  return lowest;
}

double memoryLimit() {
  double limit = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
  if (const auto group = cgroupMemoryLimit("/sys/fs/cgroup", textOf("/proc/self/cgroup")))
    limit = std::min(limit, *group);
  rlimit space{};
  if (::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
    limit = std::min(limit, double(space.rlim_cur));
  return limit;
}

double residentMemory() {
  const std::string pages = textOf("/proc/self/statm");  // numbers of memory pages: program size, then resident size
  const std::size_t at = pages.find(' ');
  if (at == pages.npos) return 0;
  return firstNumber(std::string_view(pages).substr(at + 1)).value_or(0) * double(::sysconf(_SC_PAGE_SIZE));
}

double peakMemory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

namespace {

// A line "name: number" of /proc/self/io.
double countedBytes(std::string_view name) {
  const std::string counts = textOf("/proc/self/io");
  const std::size_t at = counts.find(name);
  return at == counts.npos ? 0 : firstNumber(std::string_view(counts).substr(at + name.size())).value_or(0);
}

}  // namespace

double readBytes() {
  return countedBytes("rchar: ");
}

double writtenBytes() {
  return countedBytes("wchar: ");
}

double cpuSeconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double threadSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

}  // namespace ibr
