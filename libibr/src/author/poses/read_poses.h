// SPDX-License-Identifier: Apache-2.0
// Poses for a build, from wherever its options say.
#pragma once

#include "ibr/author.h"

namespace ibr {

/// The file or folder that poses are read from. Throws Error{invalidInput} where the options name several.
std::filesystem::path posesFile(const BuildOptions& options);

/// What stands there.
PosedModel readPoses(const BuildOptions& options, const LogCallback& log);

}  // namespace ibr
