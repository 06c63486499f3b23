// SPDX-License-Identifier: Apache-2.0
// Textures of a scene's photographs and their depth from their sources, in the form that texture arrays need.
#pragma once

#include <cstdint>
#include <stop_token>
#include <utility>

#include "ibr/gpu_scene.h"
#include "render/resident/stream_items.h"
#include "render/resident/texture_arrays.h"

namespace ibr {

/// Several threads may call it at a time if the sources allow this.
class TextureLoader {
 public:
  TextureLoader() = default;
  /// Empty sources: reads the nodes' textureFile and depthFile. The scene must outlive the object.
  TextureLoader(const Scene& scene, TextureSource source, TextureSource depthSource)
      : scene_(&scene), items_(scene), source_(std::move(source)), depthSource_(std::move(depthSource)) {}

  const Scene& scene() const noexcept { return *scene_; }
  const StreamItems& items() const noexcept { return items_; }

  /// Format of a photograph's texture: from the header of its file, or from the smallest level of the source.
  TextureFormat format(std::uint32_t node, const std::stop_token& stop) const;
  /// Size of a photograph's depth texture, which is read where it comes from a source.
  VkExtent2D depthExtent(std::uint32_t node, const std::stop_token& stop) const;

  /// Reads the texture of a photograph or its depth for an array of the class, and decodes it where the class has
  /// another format. Throws Error
  /// (io; invalidInput for levels, sizes or formats that do not fit), Error{cancelled} once `stop` is requested.
  Texture load(std::uint32_t item, const TextureArrayClass& arrayClass, const std::stop_token& stop) const;

 private:
  Texture read(std::uint32_t node, std::uint32_t firstLevel, const std::stop_token& stop) const;
  Texture loadDepth(std::uint32_t node, const TextureArrayClass& arrayClass, const std::stop_token& stop) const;

  const Scene* scene_ = nullptr;
  StreamItems items_;
  TextureSource source_, depthSource_;
};

}  // namespace ibr
