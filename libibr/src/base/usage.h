// SPDX-License-Identifier: Apache-2.0
// Memory limits and usage of this process, in bytes; processor time, in seconds. Linux.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace ibr {

/// Memory that this process may use: the machine's memory, or less if a control group or the address space limit
/// (ulimit -v) is lower.
double memoryLimit();

/// Resident memory of this process: current and peak.
double residentMemory();
double peakMemory();

/// Bytes that this process has read from files and written to files so far, also from and to the page cache; 0 where
/// the kernel does not count them.
double readBytes();
double writtenBytes();
/// Processor time of all threads of this process so far, s.
double cpuSeconds();

/// Processor time of the calling thread, s.
double threadSeconds();

/// Lowest limit of the control groups that a process is in; nullopt if none is set. `membership`: contents of
/// /proc/self/cgroup. `root`: mount point of the control groups (/sys/fs/cgroup), version 2 or 1.
std::optional<double> cgroupMemoryLimit(const std::filesystem::path& root, std::string_view membership);

}  // namespace ibr
