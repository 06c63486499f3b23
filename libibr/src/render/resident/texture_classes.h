// SPDX-License-Identifier: Apache-2.0
// Classes of a scene's photographs and depth textures: those that can share texture arrays.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "ibr/gpu_scene.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

/// Groups the nodes by format and size. Finds formats in jobs, and waits for them. Throws Error (unsupported for
/// photographs that exceed the device's image size; cancelled; as the loader).
std::vector<TextureArrayClass> classify(const Device& device, const TextureLoader& loader,
                                        const std::vector<std::uint32_t>& nodes, JobQueue& jobs,
                                        const std::stop_token& stop);
/// Groups depth textures of the nodes by size, as classify().
std::vector<TextureArrayClass> classifyDepths(const TextureLoader& loader, const std::vector<std::uint32_t>& nodes,
                                              JobQueue& jobs, const std::stop_token& stop);

/// Changes classes of photographs to RGBA8 as the options and the device require; logs the reason. `otherBytes`: part
/// of the budget that is not available to photographs.
void decodeBlocks(const Device& device, const GpuSceneOptions& options, std::uint64_t otherBytes,
                  std::vector<TextureArrayClass>& classes);

/// Returns the classes with photographs of at most `side` px, and depth textures of at most a quarter of that.
std::vector<TextureArrayClass> reduced(std::vector<TextureArrayClass> classes, std::uint32_t side);

/// Bytes of all textures; a device may add alignment.
std::uint64_t totalBytes(std::span<const TextureArrayClass> classes);

}  // namespace ibr
