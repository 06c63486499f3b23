// SPDX-License-Identifier: Apache-2.0
// Plans a frame of a synthetic scene with the planning library alone.
#include <cstdio>

#include "ibr/frame_plan.h"
#include "lab/generate/synthetic.h"

#ifdef VULKAN_CORE_H_
#error planning includes Vulkan
#endif

int main() {
  ibr::SyntheticOptions options;
  for (const double x : {-0.5, 0.5}) {
    ibr::Camera camera;
    camera.intrinsics = ibr::pinholeFromFov(64, 48, 1);
    camera.pose.position = {x, 0, 0};
    options.cameras.push_back(camera);
  }
  options.planes = {{{0, 0, -5}, {1, 0, 0}, {0, 1, 0}, 20, 20, 1, 0.5}};
  const ibr::Scene scene = ibr::makeScene(options).scene;
  ibr::Camera view = options.cameras[0];
  view.pose.position.x = 0;
  const ibr::FramePlan plan = planFrame(scene, ibr::sceneBounds(scene), {{view}, {}});
  std::printf("%zu cells\n", plan.cells.size());
  return plan.cells.size() == 1 ? 0 : 1;
}
