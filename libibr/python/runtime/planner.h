// SPDX-License-Identifier: Apache-2.0
// Plans of a scene's frames. A plan belongs to its scene: a renderer or a later plan of another scene refuses it.
#pragma once

#include <memory>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr::python {

struct ScenePlan {
  FramePlan plan;
  std::shared_ptr<const Scene> scene;
};

/// Plans on the CPU. Const functions are thread-safe.
class Planner {
 public:
  /// Throws Error{invalidInput} if validate(scene) finds a fault.
  explicit Planner(std::shared_ptr<const Scene> scene);

  /// `previous`: the frame before, or null. Throws Error{invalidInput} as planFrame, and for another scene's plan.
  ScenePlan plan(std::vector<Camera> views, const RenderSettings& settings, double dtSeconds,
                 const ScenePlan* previous) const;

  const std::shared_ptr<const Scene>& scene() const { return scene_; }

 private:
  std::shared_ptr<const Scene> scene_;
  SceneBounds bounds_;
};

}  // namespace ibr::python
