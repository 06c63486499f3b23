// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "htm/weights.h"
#include "ibr/htm.h"
#include "scene/scene_faults.h"

namespace ibr {
namespace {

void checkInput(const HtmBounds& bounds, const HtmPlanInput& input) {
  Faults faults(1);
  checkCamera(input.view, "view", faults);
  const std::vector<Fault> found = faults.take();
  if (!found.empty()) fail(ErrorCode::invalidInput, "{} {}", found[0].field, found[0].message);
  check(input.view.intrinsics.model == CameraModel::pinhole, ErrorCode::invalidInput,
        "view.intrinsics: the camera model must be pinhole");
  const HtmSettings& s = input.settings;
  const auto inRange = [](const char* name, bool holds, double value) {
    check(holds, ErrorCode::invalidInput, "settings.{} is {}", name, value);
  };
  inRange("gamma (1 to 1000)", s.gamma >= 1 && s.gamma <= 1000, s.gamma);
  inRange("weightCut (0 to below 1)", s.weightCut >= 0 && s.weightCut < 1, s.weightCut);
  inRange("depthTolerance (above 0)", s.depthTolerance > 0 && std::isfinite(s.depthTolerance), s.depthTolerance);
  inRange("smoothingSeconds (0 or more)", s.smoothingSeconds >= 0, s.smoothingSeconds);
  for (int c = 0; c < 3; ++c) inRange("background (finite)", std::isfinite(s.background[c]), s.background[c]);
  check(std::isfinite(input.dtSeconds), ErrorCode::invalidInput, "dtSeconds {} must be finite", input.dtSeconds);
  check(finite(bounds.middle), ErrorCode::invalidInput, "bounds.middle is not finite");
  check(bounds.radius > 0 && std::isfinite(bounds.radius), ErrorCode::invalidInput,
        "bounds.radius {} must be positive and finite", bounds.radius);
}

void checkState(const std::vector<double>& logWeights) {
  for (std::size_t i = 0; i < logWeights.size(); ++i)
    check(std::isfinite(logWeights[i]) && logWeights[i] <= 0, ErrorCode::invalidInput,
          "state.logWeights[{}] {} must be finite and at most 0", i, logWeights[i]);
}

glm::dvec3 directionOf(const Pose& pose, const HtmBounds& bounds, HtmDirection direction) {
  const glm::dvec3 towards = 0.5 * bounds.middle - 0.5 * pose.position;  // halves: their difference is always finite
  // The direction towards the middle is undefined within a thousandth of the radius.
  const bool aimed = direction == HtmDirection::middle && glm::length(towards) > 0.5e-3 * bounds.radius;
  return aimed ? towards : viewAxis(pose);
}

// Share of the way to its target that a weight moves in this frame.
double smoothingShare(const HtmPlanInput& input) {
  if (input.settings.smoothingSeconds == 0) return 1;
  return 1 - std::exp(-std::max(input.dtSeconds, 0.0) / input.settings.smoothingSeconds);
}

}  // namespace

HtmBounds htmBounds(const HtmModel& model) {
  const TriangleMesh& mesh = model.surface.mesh;
  if (mesh.triangles.empty()) return {};
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  const auto eachCorner = [&](const auto& visit) {
    for (const glm::uvec3& triangle : mesh.triangles)
      for (int c = 0; c < 3; ++c) visit(mesh.positions[triangle[c]]);
  };
  eachCorner([&](const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  HtmBounds bounds{0.5 * low + 0.5 * high, 0};
  eachCorner([&](const glm::dvec3& p) { bounds.radius = std::max(bounds.radius, glm::length(p - bounds.middle)); });
  if (!(bounds.radius > 0)) bounds.radius = 1;  // all corners coincide
  return bounds;
}

HtmFramePlan planHtmFrame(const HtmModel& model, const HtmBounds& bounds, const HtmPlanInput& input,
                          const HtmPlanState& state) {
  HtmFramePlan plan;
  planHtmFrame(model, bounds, input, state, plan);
  return plan;
}

void planHtmFrame(const HtmModel& model, const HtmBounds& bounds, const HtmPlanInput& input, const HtmPlanState& state,
                  HtmFramePlan& plan) {
  checkInput(bounds, input);
  const std::size_t count = model.cameras.size();
  const bool continues = state.logWeights.size() == count;
  if (continues) checkState(state.logWeights);

  std::array<glm::dvec3, kMaxHtmCameraCount> directions;
  std::array<double, kMaxHtmCameraCount> targets;
  for (std::size_t i = 0; i < count; ++i)
    directions[i] = directionOf(model.cameras[i].camera.pose, bounds, input.settings.direction);
  htmLogWeights(std::span(directions).first(count), directionOf(input.view.pose, bounds, input.settings.direction),
                input.settings.gamma, std::span(targets).first(count));
  std::vector<double>& logs = plan.next.logWeights;  // may be state.logWeights
  logs.resize(count);
  if (continues) {
    const double share = smoothingShare(input);
    for (std::size_t i = 0; i < count; ++i) logs[i] = std::lerp(state.logWeights[i], targets[i], share);
    const double largest = *std::ranges::max_element(logs);
    for (double& log : logs) log -= largest;
  } else {
    std::ranges::copy_n(targets.begin(), std::ptrdiff_t(count), logs.begin());
  }

  plan.view = input.view;
  plan.settings = input.settings;
  plan.bounds = bounds;
  plan.cameras.clear();
  for (std::uint32_t i = 0; i < count; ++i)
    if (!(input.settings.exclude >> i & 1)) plan.cameras.push_back({i, logs[i], 0});
  std::ranges::sort(plan.cameras, [](const PlannedHtmCamera& a, const PlannedHtmCamera& b) {
    return a.logWeight != b.logWeight ? a.logWeight > b.logWeight : a.camera < b.camera;
  });
  const double best = plan.cameras.empty() ? 0 : plan.cameras.front().logWeight;
  double rest = -std::numeric_limits<double>::infinity();  // summed from the smallest, so that nothing underflows
  for (std::size_t k = plan.cameras.size(); k-- > 0;) {
    double& log = plan.cameras[k].logWeight;
    log -= best;
    plan.cameras[k].logRemainingWeight = rest;
    rest = log + std::log1p(std::exp(rest - log));
  }
}

HtmPlanState transferHtmState(const HtmModel& model, const HtmModel& before, const HtmPlanState& state) {
  if (state.logWeights.size() != before.cameras.size() || state.logWeights.empty()) return {};
  std::map<std::string_view, double> known;
  for (std::size_t i = 0; i < before.cameras.size(); ++i) known.emplace(before.cameras[i].name, state.logWeights[i]);
  const double least = *std::ranges::min_element(state.logWeights);
  double largest = -std::numeric_limits<double>::infinity();
  HtmPlanState next;
  for (const HtmCamera& camera : model.cameras) {
    const auto found = known.find(camera.name);
    next.logWeights.push_back(found != known.end() ? found->second : least);
    if (found != known.end()) largest = std::max(largest, found->second);
  }
  if (std::isinf(largest)) return {};
  for (double& log : next.logWeights) log -= largest;
  return next;
}

HtmModel unoptimisedModel(const HtmModel& model) {
  HtmModel baseline = model;
  if (model.source) baseline.surface = *model.source;
  for (HtmCamera& camera : baseline.cameras)
    if (camera.given) camera.camera = *std::exchange(camera.given, std::nullopt);
  baseline.complements.clear();
  baseline.source.reset();
  return baseline;
}

}  // namespace ibr
