// SPDX-License-Identifier: Apache-2.0
// Estimates from poses and distances, without drawing, how well the photographs show a walk between them.
//
// A walk is a set of viewpoints: the capture sites, points between neighbours, the middles of cells, missing corners of
// a grid, and points beside a row (SiteGraph::row). The viewing directions at a viewpoint are those of the
// photographs around it. A point of their depth grids counts as shown by the photograph with the nearest direction to
// the point: f(α) = exp(−α / kAngle), with α the angle at the point between viewpoint and photograph. Fitted to the
// coverage of 104 cells of five photograph sets, with α from the cell's middle at the middle distance: 0.65·f(α), mean
// error 0.09. The sum over viewpoints is submodular in the photographs, so a greedy choice is within 1 − 1/e of the
// best set (Nemhauser et al. 1978).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/advice/site_graph.h"

namespace ibr {

/// Share that is shown well of a surface at angle α, radians.
double shownAt(double angle);

/// Positions one step to either side of a row's site (above and below, if the photographs look aside from the row).
std::vector<glm::dvec3> rowSideSteps(const Scene& scene, const SiteGraph& sites, std::uint32_t site);

struct Viewpoint {
  glm::dvec3 position{0.0};
  std::vector<std::uint32_t> sites;  // sites around the viewpoint, ascending
  double weight = 1;
  std::optional<std::uint32_t> site = std::nullopt;  // the site at the viewpoint
};

class WalkEstimate {
 public:
  /// The arguments must outlive the object.
  WalkEstimate(const Scene& scene, const std::vector<DepthGrid>& depths, const SiteGraph& sites);

  std::size_t viewpointCount() const { return viewpoints_.size(); }
  const Viewpoint& viewpoint(std::size_t s) const { return viewpoints_[s].viewpoint; }
  /// Shown share at a viewpoint, 0 to 1; 1 if the viewpoint sees nothing of known distance.
  double shown(std::size_t viewpoint) const;
  /// Weighted mean over the viewpoints.
  double shown() const;
  struct Worst {
    std::uint32_t node;
    double shown;
  };
  /// The photograph whose viewing direction is shown least at the viewpoint, and its shown share; nullopt if the
  /// viewpoint sees next to nothing.
  std::optional<Worst> worstShown(std::size_t viewpoint) const;
  /// Shown share at any position among some sites, as if a viewpoint were there.
  double shownFrom(glm::dvec3 position, const std::vector<std::uint32_t>& sites) const;

  /// Increase of the sum of shown(viewpoint) × weight by a further photograph near some sites.
  double gain(const Camera& camera, const std::vector<std::uint32_t>& sites) const;
  /// Adds the photograph.
  void add(const Camera& camera, const std::vector<std::uint32_t>& sites);

 private:
  struct Point {
    glm::dvec3 ray;      // from the viewpoint to the point; a direction for points at infinity
    bool far;            // at infinity
    std::uint32_t node;  // photograph that sees the point
    float shown;
  };
  struct SampledViewpoint {
    Viewpoint viewpoint;
    std::vector<Point> points;
  };

  void addViewpoints();
  SampledViewpoint look(Viewpoint viewpoint) const;
  double angleAt(const Point& point, glm::dvec3 viewpoint, const Camera& camera) const;
  bool sees(std::uint32_t node, glm::dvec3 target, bool far) const;
  template <class Visit>
  void visitNear(const Camera& camera, const std::vector<std::uint32_t>& sites, const Visit& visit) const;

  const Scene& scene_;
  const std::vector<DepthGrid>& depths_;
  const SiteGraph& siteGraph_;
  std::vector<SampledViewpoint> viewpoints_;
  std::vector<std::vector<std::uint32_t>> viewpointsOf_;  // of each site
};

}  // namespace ibr
