// SPDX-License-Identifier: Apache-2.0
// The photographs of a model as the image graph uses them: sorted by name, with their capture sites.
//
// All planning of cells uses this order, so that the order of a model's images has no effect.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "author/geometry/simplex.h"
#include "author/graph/lattice.h"
#include "ibr/author/poses.h"

namespace ibr {

struct View {
  std::string name;
  std::uint32_t image = 0;  // index into PosedModel::images
  Camera camera;
  glm::dvec3 axis{0.0};    // viewing direction
  double theta = 0;        // max angle to the axis of a photograph in the same cell, radians
  bool panorama = false;   // covers all directions
  std::uint32_t site = 0;  // capture_sites.h
};

struct Views {
  std::vector<View> list;
  std::vector<glm::dvec3> siteCentre;
  std::optional<Lattice> lattice;  // of the capture sites

  std::size_t size() const { return list.size(); }
  const View& operator[](std::size_t i) const { return list[i]; }
  bool sameKind(std::uint32_t a, std::uint32_t b) const { return list[a].panorama == list[b].panorama; }
};

/// `thetaDegrees`: 0 selects half of each photograph's smaller field of view.
Views viewsOf(const PosedModel& model, double thetaDegrees);

/// Angle between the axes of two views, radians; 0 for panoramas.
double axisAngle(const Views& views, std::uint32_t a, std::uint32_t b);

/// Camera centres of the views of a simplex.
std::vector<glm::dvec3> cornersOf(const Views& views, std::span<const std::uint32_t> simplex);

/// Centres of the views' capture sites.
std::vector<glm::dvec3> siteCentresOf(const Views& views, std::span<const std::uint32_t> group);

}  // namespace ibr
