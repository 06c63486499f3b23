// SPDX-License-Identifier: Apache-2.0
#include "render/passes/gather_parameters.h"

#include <algorithm>
#include <array>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>

#include "shared/cell.h"

namespace ibr {
namespace {

constexpr double kStepPx = 2;  // px of the photograph: 1 px at half its size

// Pixels per radian in the middle of a photograph.
double focalPx(const Intrinsics& k) {
  return k.model == CameraModel::pinhole ? k.fx : k.width / glm::two_pi<double>();
}

// Median; of an even number, the mean of the two middle values.
double medianOf(std::span<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

}  // namespace

shader::GatherView gatherView(const GpuScene::State& scene, const FramePlan& plan, std::size_t view,
                              VkExtent2D drawn) noexcept {
  const Camera& eye = plan.views[view];
  const Intrinsics& k = eye.intrinsics;
  const double spacing = plan.gather.spacing;
  const glm::dquat toView = glm::conjugate(eye.pose.rotation);
  shader::GatherView result{};
  const glm::dvec2 scale(double(drawn.width) / k.width, double(drawn.height) / k.height);
  result.projection = {float(2.0 * k.fx / k.width), float(2.0 * k.cx / k.width - 1.0), float(-2.0 * k.fy / k.height),
                       float(2.0 * k.cy / k.height - 1.0)};
  result.toRay = {float(1 / (scale.x * k.fx)), float(-1 / (scale.y * k.fy)), float(-k.cx / k.fx), float(k.cy / k.fy)};
  result.spacing = float(spacing);
  result.focalPx = float(k.fx * scale.x);
  result.detail = shader::kFinerDetail / float(plan.settings.textureScale);
  result.nearDistance = float(plan.nearDistance / spacing);
  result.maxTier = plan.settings.maxTier;
  std::array<double, shader::kMaxGathered> steps{};
  const std::size_t count = std::min(plan.photographs.size(), steps.size());
  result.count = std::uint32_t(count);
  for (std::size_t i = 0; i < count; ++i) {
    const PlannedPhotograph& planned = plan.photographs[i];
    const GpuScene::State::Mesh& mesh = scene.backdrops[planned.backdrop];
    const Camera& camera = mesh.cameras[0];
    const Intrinsics& own = camera.intrinsics;
    const glm::dquat toPhotograph = glm::conjugate(camera.pose.rotation);
    const glm::dvec3 between = (camera.pose.position - eye.pose.position) / spacing;
    const double distance = planned.distance / spacing, focal = focalPx(own);
    const GatherTextures::TextureSlots slots = scene.gather->place(i, planned.node);
    const glm::dvec3 gain = plan.settings.exposure == Exposure::off ? glm::dvec3(1.0) : plan.exposure * mesh.gains[0];
    steps[i] = kStepPx / focal;
    shader::GatherCandidate& c = result.candidate[i];
    c.toView = glm::mat3(glm::mat3_cast(toView * camera.pose.rotation));
    c.place = toView * between;
    c.toPhotograph = glm::mat3(glm::mat3_cast(toPhotograph * eye.pose.rotation));
    c.shift = toPhotograph * -between;
    c.focal = {float(own.fx / own.width), float(own.fy / own.height)};
    c.principal = {float(own.cx / own.width), float(own.cy / own.height)};
    c.aspect = float(double(own.height) / own.width);
    c.focalPx = float(focal);
    c.weight = float(planned.weight);
    c.voteWeight = float(planned.weight / (double(shader::kGatherNearness) + distance * distance));
    c.distanceCost = float(double(shader::kGatherDistanceCost) * distance);
    c.step = float(steps[i]);
    c.residual = float(plan.gather.residualPx / focal);
    c.depthScale = float(slots.depthScale * spacing);
    c.slot = slots.slot;
    c.layer = slots.layer;
    c.depthSlot = slots.depthSlot;
    c.depthLayer = slots.depthLayer;
    c.panorama = own.model == CameraModel::equirectangular;
    c.gain = gain;
    c.slope = glm::pow(gain, glm::dvec3(1 / 2.4));
  }
  if (count > 0) result.step = float(medianOf(std::span(steps).first(count)));
  return result;
}

}  // namespace ibr
