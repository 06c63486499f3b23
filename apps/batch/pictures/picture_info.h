// SPDX-License-Identifier: Apache-2.0
// `ibr info` of a picture.
#pragma once

#include <filesystem>

#include "batch/command.h"

namespace ibr::app {

/// Its size, the texts in it, and where ibr has drawn it how to draw it again. Throws Error.
ExitCode showPicture(const std::filesystem::path& file, const Context& context);

}  // namespace ibr::app
