// SPDX-License-Identifier: Apache-2.0
// What ibr build is given: a folder of photographs, videos, or several of both.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/author/video.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// Returns the folder that a build reads photographs from. A single folder is returned as it is. Otherwise frames of
/// the videos are extracted to ".photographs" in the scene's folder (ibr/author/video.h), where folders become links.
/// `options`: of the extraction, without video and folder. Shows progress. Throws Error.
std::filesystem::path photographsOf(const std::vector<std::string>& sources, const std::filesystem::path& scene,
                                    const VideoOptions& options, const Context& context);

}  // namespace ibr::app
