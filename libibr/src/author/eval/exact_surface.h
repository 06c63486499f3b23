// SPDX-License-Identifier: Apache-2.0
// The surface of a place whose depth is known, as a photograph sees it: every depth view's surface is brought into the
// photograph, nearest first.
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

#include "ibr/accuracy.h"
#include "ibr/camera.h"
#include "ibr/log.h"
#include "ibr/scene.h"

namespace ibr {

/// A point, or with w = 0 a direction.
using Homogeneous = glm::dvec4;

/// A surface point a pixel, where a view has seen one.
class ExactSurface {
 public:
  /// Of a pinhole.
  ExactSurface(const Camera& camera, std::span<const DepthView> truth);

  const Camera& camera() const { return camera_; }
  int width() const { return width_; }
  int height() const { return height_; }

  struct Sample {
    glm::dvec2 pixel;
    Homogeneous point;
  };
  /// nullopt where it is not known, or something may stand before it.
  std::optional<Sample> at(glm::ivec2 pixel) const;

  /// Where the camera sees a point, if it is before it; inside the picture or not, hidden or not.
  std::optional<glm::dvec2> seen(const Homogeneous& point) const;
  /// Whether it is inside the picture and nothing stands before it.
  bool sees(const Homogeneous& point) const;

  /// The surface at a pixel's fraction: a plane through what is known around it.
  std::optional<Homogeneous> between(glm::dvec2 pixel) const;

 private:
  struct Pixel {
    glm::vec2 where{0.0f};
    float inverseDepth = -1;  // along the axis
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
  void forAround(int x, int y, Visit&& visit) const;
  bool hidden(int x, int y, double inverseDepth) const;
  void add(const DepthView& view);

  Camera camera_;
  glm::dmat3 toCamera_;
  int width_, height_;
  std::vector<Pixel> pixels_;
};

/// One for each node that a cell of pinholes alone has as its member; nullopt for the others. Throws as
/// matchAccuracy().
std::vector<std::optional<ExactSurface>> exactSurfaces(const Scene& scene, std::span<const DepthView> truth,
                                                       int threads, const ProgressCallback& progress);

/// The surfaces of a cell's members; empty for a cell with a panorama.
std::vector<const ExactSurface*> surfacesOf(const Scene& scene, const Cell& cell,
                                            const std::vector<std::optional<ExactSurface>>& surfaces);

/// job(c) for each cell, as the stage's progress. Throws Error{cancelled}.
void forEachCell(const Scene& scene, std::string_view stage, int threads, const ProgressCallback& progress,
                 const std::function<void(std::size_t)>& job);

}  // namespace ibr
