// SPDX-License-Identifier: Apache-2.0
// Commands of `ibr-lab`.
#pragma once

#include "batch/command.h"

namespace ibr::app {

extern const Command kSynthCommand, kAccuracyCommand, kSweepCommand, kMatchersCommand, kLabBenchCommand,
    kLabStreamCommand;

}  // namespace ibr::app
