// SPDX-License-Identifier: Apache-2.0
#include "base/check.h"
#include "base/vulkan/submit.h"
#include "ibr/gpu_scene.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

void streamAll(const Device& device, GpuScene& scene, const FramePlan& plan, std::uint64_t& frame) {
  if (!scene.needsStreaming()) return;
  GpuScene::StreamStatus streamed;
  do {
    const std::uint64_t completed = frame++;
    submitAndWait(device, [&](VkCommandBuffer commands) { streamed = scene.stream(commands, plan, frame, completed); });
    check(streamed.failed == 0, ErrorCode::io, "{} photographs or depth textures of this view could not be read",
          streamed.failed);
    Streamer* const streamer = stateOf(scene).streamer.get();
    if (streamer && streamed.waiting > 0 && streamed.uploadedBytes == 0) streamer->finishJob();
  } while (streamed.waiting > 0);
}

}  // namespace ibr
