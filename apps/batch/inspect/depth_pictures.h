// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include "ibr/scene.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// Writes for each photograph with a depth texture, at the texture's size: NAME.depth.png, NAME.confirmations.png and
/// NAME.consensus.png for people, and NAME.depth.exr with the values. All images of a scene use the same colour scales.
/// Returns the number of photographs written. Throws Error (io, invalidInput) that names the file.
std::size_t writeDepthPictures(const Scene& scene, const std::filesystem::path& folder, const Context& context);

}  // namespace ibr::app
