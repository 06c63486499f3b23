// SPDX-License-Identifier: Apache-2.0
#include "runtime/planner.h"

#include <utility>

#include "ibr/error.h"

namespace ibr::python {
namespace {

std::shared_ptr<const Scene> checked(std::shared_ptr<const Scene> scene) {
  for (const auto& [field, message] : validate(*scene, 1))
    throw Error(ErrorCode::invalidInput, "scene." + field + ": " + message);
  return scene;
}

}  // namespace

Planner::Planner(std::shared_ptr<const Scene> scene)
    : scene_(checked(std::move(scene))), bounds_(sceneBounds(*scene_)) {}

ScenePlan Planner::plan(std::vector<Camera> views, const RenderSettings& settings, double dtSeconds,
                        const ScenePlan* previous) const {
  if (previous && previous->scene != scene_)
    throw Error(ErrorCode::invalidInput, "previous: is a plan of another scene");
  return {planFrame(*scene_, bounds_, {std::move(views), settings, dtSeconds},
                    previous ? previous->plan.next : PlanState{}),
          scene_};
}

}  // namespace ibr::python
