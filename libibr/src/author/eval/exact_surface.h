// SPDX-License-Identifier: Apache-2.0
// Surface that a photograph sees in a scene of known depth. The surfaces of all depth views are projected into the
// photograph; the nearest one wins.
#pragma once

#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ibr/camera.h"
#include "ibr/lab/accuracy.h"
#include "ibr/log.h"
#include "ibr/scene.h"

namespace ibr {

/// World point, homogeneous; a direction if w = 0.
using Homogeneous = glm::dvec4;

/// One surface point per pixel, where a depth view has seen one.
class ExactSurface {
 public:
  /// `camera`: a pinhole.
  ExactSurface(const Camera& camera, std::span<const ExactDepthView> truth);

  const Camera& camera() const { return camera_; }
  int width() const { return width_; }
  int height() const { return height_; }

  struct Sample {
    glm::dvec2 pixel;
    Homogeneous point;
  };
  /// Surface point of a pixel; nullopt where unknown or possibly occluded.
  std::optional<Sample> at(glm::ivec2 pixel) const;

  /// Projection of a point in front of the camera, inside the image or not, occluded or not; else nullopt.
  std::optional<glm::dvec2> seen(const Homogeneous& point) const;
  /// True if the point is inside the image and unoccluded.
  bool sees(const Homogeneous& point) const;

  /// Surface point at a sub-pixel position, on a plane fitted to the known pixels around.
  std::optional<Homogeneous> between(glm::dvec2 pixel) const;

 private:
  struct Pixel {
    glm::vec2 where{0.0f};
    float inverseDepth = -1;  // along the axis, 1 / world unit
    bool front = false;
    bool known() const { return inverseDepth >= 0; }
  };
  struct Projected {
    glm::dvec2 pixel;
    double inverseDepth;
  };

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  bool inside(glm::dvec2 p) const { return p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_; }
  std::optional<Projected> projected(const Homogeneous& point) const;
  double tolerance(double inverseDepth) const;
  Homogeneous point(glm::dvec2 pixel, double inverseDepth) const;
  template <class Visit>
  void forNeighbours(int x, int y, Visit&& visit) const;
  bool hidden(int x, int y, double inverseDepth) const;
  void add(const ExactDepthView& view);

  Camera camera_;
  glm::dmat3 toCamera_;
  int width_, height_;
  std::vector<Pixel> pixels_;
};

/// Surfaces of all nodes that are members of cells of pinholes only; nullopt for other nodes. Throws as
/// matchAccuracy().
std::vector<std::optional<ExactSurface>> exactSurfaces(const Scene& scene, std::span<const ExactDepthView> truth,
                                                       int threads, const ProgressCallback& progress);

/// The surfaces of a cell's members; empty for a cell with a panorama.
std::vector<const ExactSurface*> surfacesOf(const Scene& scene, const Cell& cell,
                                            const std::vector<std::optional<ExactSurface>>& surfaces);

/// Calls job(c) for each cell, with the stage's progress. Throws Error{cancelled}.
void forEachCell(const Scene& scene, std::string_view stage, int threads, const ProgressCallback& progress,
                 const std::function<void(std::size_t)>& job);

}  // namespace ibr
