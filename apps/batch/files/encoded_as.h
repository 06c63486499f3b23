// SPDX-License-Identifier: Apache-2.0
// A scene's textures in another format than they are stored in.
#pragma once

#include "ibr/gpu_scene.h"

namespace ibr::app {

/// Decodes what is stored and encodes it, as a build would store it: photographs with masks as BC7 where BC1 is asked
/// for. Reading throws Error as a scene's own textures do.
TextureSource encodedAs(TextureFormat format);

}  // namespace ibr::app
