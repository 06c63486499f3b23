// SPDX-License-Identifier: Apache-2.0
// Runs independent jobs on threads; the waiting thread reports progress and can cancel.
#pragma once

#include <cstddef>
#include <functional>

namespace ibr {

/// Calls job(0) … job(count − 1) once each, on `threads` new threads. Calls `report(done)` on the calling thread after
/// jobs finish and periodically. When report returns false, no further job starts, running jobs are waited for, and the
/// result is false. A job's exception has the same effect; the first one (by job number) is thrown again.
bool runJobs(std::size_t count, int threads, const std::function<void(std::size_t)>& job,
             const std::function<bool(std::size_t done)>& report);

/// Number of threads for jobs of up to `bytesEach` bytes each: `wanted` (0: number of cores), limited by `memory` bytes
/// in total (0: half of memoryLimit), at least one.
int threadsFor(int wanted, double bytesEach, double memory = 0);

/// Memory budget in bytes: `wanted`, or for 0 half of memoryLimit().
double memoryBudget(double wanted);

}  // namespace ibr
