// SPDX-License-Identifier: Apache-2.0
// Plans of background jobs: building a scene, rendering a video.
#pragma once

#include <filesystem>
#include <string>

#include "ibr/gpu_scene.h"
#include "viewer/control/job.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// Returns true for two or more photographs in the folder or its subfolders, among the first 10000 entries.
bool containsPhotographs(const std::filesystem::path& folder) noexcept;

/// Builds a scene with `ibr build` from a folder of photographs. The output folder lies beside the input and has
/// "-scene" appended to its name. Uses poses in the folder (sparse/, sparse/0/ or transforms.json), else COLMAP
/// estimates them. An interrupted build is resumed.
JobPlan buildPlan(const std::filesystem::path& photographs);

/// Renders a camera path NAME.json with `ibr render` and the scene's settings to NAME/frame_0000.png and so on. If
/// ffmpeg is available, also encodes NAME.mp4. Playing 3D video starts with the path; paused 3D video stays at its
/// current time.
JobPlan videoPlan(const OpenItem& item, const std::filesystem::path& cameraPath, const GpuSceneOptions& gpuScene,
                  const std::string& device);

}  // namespace ibr::app
