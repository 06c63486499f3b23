// SPDX-License-Identifier: Apache-2.0
// Options of harmonising, for all commands that build harmonised models.
#pragma once

#include <memory>

#include "ibr/author/htm.h"
#include "ibr/device.h"
#include "shared/cli/cli_fwd.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct HtmBuildChoices {
  HtmBuildOptions build;
  bool matchOnDevice = false;
};

/// Declares all options except the files.
void declareHtmBuildOptions(CLI::App& app, HtmBuildChoices& choices);

/// Sets in `build` the threads of the common options and the chosen search. If a device searches, it is returned and
/// must live as long as `build` is used. Throws the errors of Device::create.
std::unique_ptr<Device> prepare(HtmBuildOptions& build, const HtmBuildChoices& choices, const Context& context);

/// Returns the options with the threads of the common options.
HtmOptions withThreads(HtmOptions options, const Context& context);

}  // namespace ibr::app
