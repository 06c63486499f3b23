// SPDX-License-Identifier: Apache-2.0
// Reads the poses of a build from the source that its options name.
#pragma once

#include "ibr/author/build.h"

namespace ibr {

/// Returns the file or folder of the poses. Throws Error{invalidInput} if the options name several.
std::filesystem::path posesFile(const BuildOptions& options);

/// Reads the poses from that file or folder.
PosedModel readPoses(const BuildOptions& options, const LogCallback& log);

}  // namespace ibr
