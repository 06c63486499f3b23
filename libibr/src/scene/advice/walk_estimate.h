// SPDX-License-Identifier: Apache-2.0
// How well the photographs would show a walk between them, estimated from poses and distances, without drawing.
//
// A walk is a set of stands: the photographs' places, points between neighbours, the middles of cells, and corners that
// a grid lacks, and beside a row that nothing leads aside from. From a stand one looks as the photographs around it
// look; what they see (points of their depth grids) is shown as well as the photograph allows that sees it from the
// nearest direction: f(α) = exp(−α / kAngle), α the angle at the point between stand and photograph. Fitted to the
// coverage of 104 cells of five photograph sets, α that from the cell's middle at the middle distance: 0.65·f(α), with
// a mean error of 0.09. The sum over stands is submodular in the set of photographs: taking the best further one again
// and again comes within 1 − 1/e of the best set (Nemhauser et al. 1978).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/advice/site_graph.h"

namespace ibr {

/// Share that is shown well of what lies at angle α, radians.
double shownAt(double angle);

/// From a place of a row, a step to either side of it (or above and below, where one looks aside from the row).
std::vector<glm::dvec3> besideRow(const Scene& scene, const Places& places, std::uint32_t place);

struct Stand {
  glm::dvec3 position{0.0};
  std::vector<std::uint32_t> places;  // that it lies among, ascending
  double weight = 1;
  std::optional<std::uint32_t> place = std::nullopt;  // that it is
};

class WalkEstimate {
 public:
  /// All outlive the object.
  WalkEstimate(const Scene& scene, const std::vector<PhotographDepth>& depths, const Places& places);

  std::size_t standCount() const { return stands_.size(); }
  const Stand& stand(std::size_t s) const { return stands_[s].stand; }
  /// 0 to 1; 1 where the stand sees nothing whose distance is known.
  double shown(std::size_t stand) const;
  /// The mean over stands, weighted.
  double shown() const;
  struct Worst {
    std::uint32_t node;
    double shown;
  };
  /// The photograph whose look is shown least from there, and how much of it; nullopt where the stand sees next to
  /// nothing.
  std::optional<Worst> leastShown(std::size_t stand) const;
  /// Of a point among some places, as if it were a stand.
  double shownFrom(glm::dvec3 position, const std::vector<std::uint32_t>& places) const;

  /// What a further photograph near some places would add to the sum of shown(stand) × weight.
  double gain(const Camera& camera, const std::vector<std::uint32_t>& places) const;
  /// Counts it as taken.
  void add(const Camera& camera, const std::vector<std::uint32_t>& places);

 private:
  struct Point {
    glm::dvec3 ray;      // from the stand to the point; a direction where it is at infinity
    bool far;            // at infinity
    std::uint32_t node;  // that sees it
    float shown;
  };
  struct Known {
    Stand stand;
    std::vector<Point> points;
  };

  void placeStands();
  Known look(Stand stand) const;
  double angleAt(const Point& point, glm::dvec3 stand, const Camera& camera) const;
  bool sees(std::uint32_t node, glm::dvec3 target, bool far) const;
  template <class Visit>
  void visitNear(const Camera& camera, const std::vector<std::uint32_t>& places, const Visit& visit) const;

  const Scene& scene_;
  const std::vector<PhotographDepth>& depths_;
  const Places& places_;
  std::vector<Known> stands_;
  std::vector<std::vector<std::uint32_t>> standsOf_;  // of each place
};

}  // namespace ibr
