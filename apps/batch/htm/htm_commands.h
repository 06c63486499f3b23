// SPDX-License-Identifier: Apache-2.0
// The commands of `ibr htm`.
#pragma once

#include "batch/command.h"

namespace ibr::app {

extern const Command kHtmBuildCommand, kHtmSequenceCommand, kHtmRenderCommand, kHtmEvalCommand;

}  // namespace ibr::app
