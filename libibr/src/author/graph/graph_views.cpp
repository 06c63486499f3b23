// SPDX-License-Identifier: Apache-2.0
#include "author/graph/graph_views.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <numeric>

#include "author/graph/capture_sites.h"
#include "author/graph/view_relations.h"

namespace ibr {
namespace {

// The smaller of the horizontal and vertical fields of view, radians.
double smallerFieldOfView(const Intrinsics& k) {
  if (k.model == CameraModel::equirectangular) return std::numbers::pi;
  return std::min(std::atan(k.cx / k.fx) + std::atan((k.width - k.cx) / k.fx),
                  std::atan(k.cy / k.fy) + std::atan((k.height - k.cy) / k.fy));
}

void findCaptureSites(Views& views) {
  std::vector<Camera> cameras;
  for (const View& view : views.list) cameras.push_back(view.camera);
  const std::vector<std::uint32_t> site = ibr::findCaptureSites(cameras);
  std::vector<double> count;
  for (std::size_t i = 0; i < views.size(); ++i) {
    views.list[i].site = site[i];
    if (site[i] == count.size()) {  // sites are numbered in the order of their first view
      count.push_back(0);
      views.siteCentre.emplace_back(0.0);
    }
    views.siteCentre[site[i]] += cameras[i].pose.position;
    ++count[site[i]];
  }
  for (std::size_t s = 0; s < count.size(); ++s) views.siteCentre[s] /= count[s];
}

}  // namespace

Views viewsOf(const PosedModel& model, double thetaDegrees) {
  std::vector<std::uint32_t> byName(model.images.size());
  std::iota(byName.begin(), byName.end(), 0u);
  std::sort(byName.begin(), byName.end(),
            [&](std::uint32_t a, std::uint32_t b) { return model.images[a].name < model.images[b].name; });
  Views views;
  for (const std::uint32_t i : byName) {
    const PosedImage& image = model.images[i];
    View view{image.name, i, image.camera, viewAxis(image.camera.pose)};
    view.theta = thetaDegrees > 0 ? glm::radians(thetaDegrees) : 0.5 * smallerFieldOfView(image.camera.intrinsics);
    view.panorama = image.camera.intrinsics.model == CameraModel::equirectangular;
    views.list.push_back(std::move(view));
  }
  findCaptureSites(views);
  views.lattice = findLattice(views.siteCentre);
  return views;
}

double axisAngle(const Views& views, std::uint32_t a, std::uint32_t b) {
  return views[a].panorama && views[b].panorama ? 0.0 : angleBetween(views[a].axis, views[b].axis);
}

std::vector<glm::dvec3> cornersOf(const Views& views, std::span<const std::uint32_t> simplex) {
  std::vector<glm::dvec3> corners;
  for (const std::uint32_t i : simplex) corners.push_back(views[i].camera.pose.position);
  return corners;
}

std::vector<glm::dvec3> siteCentresOf(const Views& views, std::span<const std::uint32_t> group) {
  std::vector<glm::dvec3> positions;
  for (const std::uint32_t i : group) positions.push_back(views.siteCentre[views[i].site]);
  return positions;
}

}  // namespace ibr
