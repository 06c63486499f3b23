// SPDX-License-Identifier: Apache-2.0
// How much memory there is, and what this process takes: bytes, s. Linux.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace ibr {

/// What this process may have at most: the machine's memory, or less where a control group or the limit of its address
/// space (ulimit -v) allows less.
double memoryLimit();

/// What it has now, and what it had at most.
double residentMemory();
double peakMemory();

/// Processor time of all its threads so far, s.
double processorSeconds();

/// The same of the calling thread alone.
double threadSeconds();

/// The least limit of the control groups that a process is in; nullopt where none is set. `membership`: what
/// /proc/self/cgroup says; `root`: where control groups are (/sys/fs/cgroup), of version 2 or 1.
std::optional<double> groupMemoryLimit(const std::filesystem::path& root, std::string_view membership);

}  // namespace ibr
