// SPDX-License-Identifier: Apache-2.0
#include "batch/files/colmap_views.h"

#include <fmt/format.h>

#include <glm/gtc/quaternion.hpp>

#include "base/file.h"

namespace fs = std::filesystem;

namespace ibr::app {

void writeColmapViews(const fs::path& folder, const std::vector<View>& views) {
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n",
              images = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n";
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto& [k, pose] = views[i].camera;
    cameras += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, k.width, k.height, k.fx, k.fy, k.cx, k.cy);
    // COLMAP's poses map world to camera with x right, y down, z forward: half a turn about x from ours.
    const glm::dquat q = glm::dquat(0, 1, 0, 0) * glm::conjugate(pose.rotation);
    const glm::dvec3 t = -(q * pose.position);
    images += fmt::format("{} {} {} {} {} {} {} {} {} {}\n\n", i + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z, i + 1,
                          views[i].name);
  }
  makeFolders(folder);
  writeFile(folder / "cameras.txt", cameras);
  writeFile(folder / "images.txt", images);
  writeFile(folder / "points3D.txt", std::string_view("# none\n"));
}

}  // namespace ibr::app
