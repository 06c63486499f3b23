// SPDX-License-Identifier: Apache-2.0
#include "scene/capture_spacing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/median.h"
#include "base/stop.h"

namespace ibr {

double captureSpacing(std::span<const Camera> cameras, const std::stop_token& stop) {
  double extent = 0;
  for (const Camera& camera : cameras)
    extent = std::max(extent, glm::distance(camera.pose.position, cameras[0].pose.position));
  std::vector<double> nearest;
  for (const Camera& a : cameras) {
    checkStop(stop, "computing the capture spacing");
    double best = std::numeric_limits<double>::infinity();
    for (const Camera& b : cameras)
      if (const double d = glm::distance(a.pose.position, b.pose.position); d > 1e-6 * extent) best = std::min(best, d);
    if (std::isfinite(best)) nearest.push_back(best);
  }
  return nearest.empty() ? 1.0 : median(std::move(nearest));
}

}  // namespace ibr
