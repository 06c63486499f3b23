// SPDX-License-Identifier: Apache-2.0
// Options of harmonising, for all commands that build harmonised models.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "ibr/device.h"
#include "ibr/htm_author.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct HtmBuildChoices {
  HtmBuildOptions build;
  bool matchOnDevice = false;
};

/// All but the files.
void declareHtmBuildOptions(CLI::App& app, HtmBuildChoices& choices);

/// Gives `build` the threads of the common options and the search that was chosen. Where a device searches it is
/// returned, and must live as long as `build` is used. Throws what Device::create throws.
std::unique_ptr<Device> prepare(HtmBuildOptions& build, const HtmBuildChoices& choices, const Context& context);

/// The same with the threads of the common options.
HtmOptions withThreads(HtmOptions options, const Context& context);

}  // namespace ibr::app
