// SPDX-License-Identifier: Apache-2.0
// Independent jobs over threads, with progress and cancelling from the thread that waits.
#pragma once

#include <cstddef>
#include <functional>

namespace ibr {

/// Calls job(0) … job(count − 1), each once, from `threads` threads of its own. `report(done)` is called from this
/// thread after jobs have finished and now and then between; when it returns false, no further job starts, those that
/// run are waited for, and the result is false. The first exception of a job (by its number) is thrown again, likewise.
bool runJobs(std::size_t count, int threads, const std::function<void(std::size_t)>& job,
             const std::function<bool(std::size_t done)>& report);

/// Threads for jobs that take up to `bytesEach` of memory: as many as `wanted` (0: as there are cores), but no more
/// than `memory` bytes hold (0: half of what this process may have, memoryLimit), and at least one.
int threadsFor(int wanted, double bytesEach, double memory = 0);

/// Bytes that work may take: as many as are wanted, or for 0 half of what this process may have.
double memoryBudget(double wanted);

}  // namespace ibr
