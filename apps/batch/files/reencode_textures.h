// SPDX-License-Identifier: Apache-2.0
// Re-encodes a scene's textures in another format.
#pragma once

#include "ibr/gpu_scene.h"

namespace ibr::app {

/// Returns a source that decodes the stored textures and encodes them as a build would: photographs with masks as BC7
/// if BC1 is requested. Reading throws Error as a scene's own textures do.
TextureSource encodedAs(TextureFormat format);

}  // namespace ibr::app
