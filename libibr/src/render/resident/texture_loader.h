// SPDX-License-Identifier: Apache-2.0
// Textures of a scene's photographs from their source, in the form that texture arrays need.
#pragma once

#include <cstdint>
#include <stop_token>
#include <utility>

#include "ibr/gpu_scene.h"
#include "render/resident/texture_arrays.h"

namespace ibr {

/// Several threads may call it at a time if the source allows this.
class TextureLoader {
 public:
  TextureLoader() = default;
  /// `source` empty: reads the nodes' textureFile. The scene must outlive the object.
  TextureLoader(const Scene& scene, TextureSource source) : scene_(&scene), source_(std::move(source)) {}

  /// Format of a photograph's texture: from the header of its file, or from the smallest level of the source.
  TextureFormat format(std::uint32_t node, const std::stop_token& stop) const;

  /// Reads a texture for an array of the class, and decodes it where the class has another format. Throws Error
  /// (io; invalidInput for levels, sizes or formats that do not fit), Error{cancelled} once `stop` is requested.
  Texture load(std::uint32_t node, const TextureArrayClass& arrayClass, const std::stop_token& stop) const;

 private:
  Texture read(std::uint32_t node, std::uint32_t firstLevel, const std::stop_token& stop) const;

  const Scene* scene_ = nullptr;
  TextureSource source_;
};

}  // namespace ibr
