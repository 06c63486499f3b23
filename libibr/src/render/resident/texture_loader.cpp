// SPDX-License-Identifier: Apache-2.0
#include "render/resident/texture_loader.h"

#include <algorithm>
#include <bit>
#include <string>

#include "base/check.h"
#include "image/ktx2_file.h"
#include "render/resident/depth_textures.h"

namespace ibr {

Texture TextureLoader::read(std::uint32_t node, std::uint32_t firstLevel, const std::stop_token& stop) const {
  if (source_) return source_(*scene_, node, int(firstLevel));
  return readKtx2(scene_->folder / scene_->nodes[node].textureFile, int(firstLevel), stop);
}

TextureFormat TextureLoader::format(std::uint32_t node, const std::stop_token& stop) const {
  if (!source_) return probeKtx2(scene_->folder / scene_->nodes[node].textureFile).format;
  const Intrinsics& k = scene_->nodes[node].camera.intrinsics;
  return read(node, std::uint32_t(std::bit_width(unsigned(std::max(k.width, k.height)))) - 1, stop).format;
}

VkExtent2D TextureLoader::depthExtent(std::uint32_t node, const std::stop_token& stop) const {
  const glm::ivec2 size = depthSize(*scene_, node, depthSource_, stop);
  return {std::uint32_t(size.x), std::uint32_t(size.y)};
}

Texture TextureLoader::loadDepth(std::uint32_t node, const TextureArrayClass& arrayClass,
                                 const std::stop_token& stop) const {
  Texture texture = readDepth(*scene_, node, depthSource_, stop);
  const std::string& name = scene_->nodes[node].name;
  check(std::uint32_t(texture.width) == arrayClass.extent.width &&
            std::uint32_t(texture.height) == arrayClass.extent.height &&
            texture.levels[0].size() == textureBytes(texture.format, texture.width, texture.height),
        ErrorCode::invalidInput, "{}: depth texture is {}x{} in {} bytes, not {}x{}", name, texture.width,
        texture.height, texture.levels[0].size(), arrayClass.extent.width, arrayClass.extent.height);
  check(!stop.stop_requested(), ErrorCode::cancelled, "{}: reading was stopped", name);
  return arrayClass.firstLevel > 0 ? reducedDepth(texture, arrayClass.firstLevel) : texture;
}

Texture TextureLoader::load(std::uint32_t item, const TextureArrayClass& arrayClass,
                            const std::stop_token& stop) const {
  const std::uint32_t node = items_.node(item);
  if (items_.isDepth(item)) return loadDepth(node, arrayClass, stop);
  Texture texture = read(node, arrayClass.firstLevel, stop);
  const std::string& name = scene_->nodes[node].name;
  const VkExtent2D extent = arrayClass.arrayExtent();
  check(texture.levels.size() == arrayClass.levels(), ErrorCode::invalidInput,
        "{}: texture has {} levels from level {} on, not {}", name, texture.levels.size(), arrayClass.firstLevel,
        arrayClass.levels());
  check(std::uint32_t(texture.width) == extent.width && std::uint32_t(texture.height) == extent.height,
        ErrorCode::invalidInput, "{}: texture level {} is {}x{}, not {}x{}", name, arrayClass.firstLevel, texture.width,
        texture.height, extent.width, extent.height);
  for (std::uint32_t l = 0; l < arrayClass.levels(); ++l) {
    const std::uint64_t bytes =
        textureBytes(texture.format, std::max(1, texture.width >> l), std::max(1, texture.height >> l));
    check(texture.levels[l].size() == bytes, ErrorCode::invalidInput, "{}: texture level {} has {} bytes, not {}", name,
          arrayClass.firstLevel + l, texture.levels[l].size(), bytes);
  }
  check(!stop.stop_requested(), ErrorCode::cancelled, "{}: reading was stopped", name);
  if (texture.format != arrayClass.format && arrayClass.format == TextureFormat::rgba8)
    texture = decodeTexture(texture);
  check(texture.format == arrayClass.format, ErrorCode::invalidInput,
        "{}: texture has format {} in one level, {} in another", name, textureFormatName(arrayClass.format),
        textureFormatName(texture.format));
  return texture;
}

}  // namespace ibr
