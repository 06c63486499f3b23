// SPDX-License-Identifier: Apache-2.0
#include "render/plan/exposure_plan.h"

#include <cmath>
#include <glm/exponential.hpp>

namespace ibr {
namespace {

// Returns the log of the target exposure; nullopt if nothing is drawn.
std::optional<glm::dvec3> wantedExposure(const Scene& scene, const FramePlan& plan) {
  glm::dvec3 sum(0.0);
  if (plan.cells.empty() || plan.settings.composition == Composition::gathered) {
    constexpr double kNearest = 0.01;  // in capture spacings²; avoids a division by zero
    double weights = 0;
    for (const PlannedPhotograph& photograph : plan.photographs) {
      const double distance = photograph.distance / plan.gather.spacing, near = 1 / (kNearest + distance * distance),
                   weight = std::sqrt(photograph.share) * near * near;
      weights += weight;
      sum -= weight * glm::log(scene.nodes[photograph.node].gain);
    }
    if (weights > 0) return sum / weights;
    return std::nullopt;
  }
  const std::vector<std::uint32_t>& members = scene.cells[plan.cells[0].cell].members;
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::size_t v = 0; v < plan.views.size(); ++v)
      sum -= plan.cells[0].view[v].blend[i] / double(plan.views.size()) * glm::log(scene.nodes[members[i]].gain);
  return sum;
}

}  // namespace

glm::dvec3 plannedExposure(const Scene& scene, double seconds, const PlanState& state, FramePlan& plan) {
  const RenderSettings& settings = plan.settings;
  plan.next.exposure = std::nullopt;
  if (settings.exposure != Exposure::adapted) return glm::dvec3(1.0);
  std::optional<glm::dvec3> wanted = wantedExposure(scene, plan);
  if (wanted == glm::dvec3(0.0) && !state.exposure) wanted = std::nullopt;  // no gains: nothing to adapt to
  plan.next.exposure = wanted ? wanted : state.exposure;
  if (wanted && state.exposure && settings.exposureSeconds > 0)
    plan.next.exposure = *wanted + std::exp(-seconds / settings.exposureSeconds) * (*state.exposure - *wanted);
  return glm::exp(plan.next.exposure.value_or(glm::dvec3(0.0)));
}

}  // namespace ibr
