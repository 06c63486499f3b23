// SPDX-License-Identifier: Apache-2.0
#include "batch/files/reencode_textures.h"

#include "ibr/texture.h"

namespace ibr::app {

TextureSource encodedAs(TextureFormat format) {
  return [format](const Scene& scene, std::size_t node, int firstLevel) {
    const Node& photograph = scene.nodes[node];
    const bool alpha = format == TextureFormat::bc1 && !photograph.maskFile.empty();
    return encodeTexture(decodeTexture(readKtx2(scene.folder / photograph.textureFile, firstLevel)),
                         alpha ? TextureFormat::bc7 : format);
  };
}

}  // namespace ibr::app
