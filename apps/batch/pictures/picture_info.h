// SPDX-License-Identifier: Apache-2.0
// `ibr info` of an image file.
#pragma once

#include <filesystem>

#include "batch/command.h"

namespace ibr::app {

/// Prints the size and the text chunks; for images rendered by ibr also the command to render them again. Throws Error.
ExitCode showPicture(const std::filesystem::path& file, const Context& context);

}  // namespace ibr::app
