// SPDX-License-Identifier: Apache-2.0
// `ibr info` of a harmonised model, and of a sequence of models.
#pragma once

#include <string>

#include "batch/command.h"

namespace ibr::app {

ExitCode showModel(const std::string& path, const Context& context);
ExitCode showSequence(const std::string& path, const Context& context);

}  // namespace ibr::app
