// SPDX-License-Identifier: Apache-2.0
// What the viewer has made beside it.
#pragma once

#include <filesystem>
#include <string>

#include "ibr/gpu_scene.h"
#include "viewer/control/job.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// Whether a folder holds photographs, in it or below.
bool holdsPhotographs(const std::filesystem::path& folder) noexcept;

/// A scene of a folder's photographs, beside it and with "-scene" behind its name: `ibr build` with the poses that the
/// folder holds (sparse/, sparse/0/ or transforms.json), else those that COLMAP estimates. A build that was stopped
/// there goes on.
JobPlan buildPlan(const std::filesystem::path& photographs);

/// Pictures of a camera path, NAME/frame_0000.png and so on for NAME.json, and a video of them, NAME.mp4: `ibr render`
/// with the place's settings, then ffmpeg where there is one. 3D video that plays begins with the path; where it stands
/// still it does so there.
JobPlan videoPlan(const OpenItem& place, const std::filesystem::path& cameraPath, const GpuSceneOptions& gpuScene,
                  const std::string& device);

}  // namespace ibr::app
