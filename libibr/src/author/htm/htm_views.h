// SPDX-License-Identifier: Apache-2.0
// Cameras of a harmonised model with their images, and the mesh projected into each: [H]'s projected meshes M̂_i.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ibr/camera.h"
#include "ibr/htm_model.h"
#include "ibr/image.h"

namespace ibr {

/// Projects world points to pixels, in double precision.
class PinholeView {
 public:
  /// Precondition: a pinhole.
  explicit PinholeView(const Camera& camera);

  struct Seen {
    glm::dvec2 pixel;
    double depth;  // along the viewing axis, > 0
  };
  /// nullopt for points that are not in front of the camera; pixels may lie outside the image.
  std::optional<Seen> seen(const glm::dvec3& world) const;
  glm::dvec3 point(glm::dvec2 pixel, double depth) const;
  const glm::dvec3& centre() const { return centre_; }
  const Intrinsics& intrinsics() const { return k_; }
  /// True if a bilinear sample at the pixel reads no pixel outside the image.
  bool inside(glm::dvec2 pixel) const {
    return pixel.x >= 0.5 && pixel.y >= 0.5 && pixel.x <= k_.width - 0.5 && pixel.y <= k_.height - 0.5;
  }

 private:
  Intrinsics k_;
  glm::dmat3 toCamera_, toWorld_;
  glm::dvec3 centre_;
};

/// Face index and depth at each pixel's centre.
struct MeshRaster {
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);
  Image<std::uint32_t> face;  // kNone: no face
  ImageF depth;               // along the viewing axis, world units; infinite without a face

  /// True if a point seen at `pixel`, `depth` lies on or in front of the nearest surface around, to `tolerance` of its
  /// depth. Also true if no face is around, so everywhere outside the image and at infinite pixels.
  bool shows(glm::dvec2 pixel, double depth, double tolerance = 2e-3) const;
};
/// Rasterises the mesh. Faces with a corner that is not in front of the camera are left out.
MeshRaster rasterised(const TriangleMesh& mesh, const Camera& camera);

struct HtmView {
  Camera camera;
  Image8 picture;  // RGB, of the camera's size
  Image8 mask;     // 1 channel, same size, >= 128: the object; empty: the object may be anywhere
};

/// A view with the mesh rasterised into it, at one scale. Copies share the images.
struct ProjectedMesh {
  PinholeView view;
  std::shared_ptr<const Image8> picture, mask;  // never null; at full size the HtmView's own, not owned
  MeshRaster raster;

  /// nullopt if a world point is outside the image or the mask, or hidden by the mesh.
  std::optional<glm::dvec2> visible(const glm::dvec3& world) const;
  /// True if the mask, clamped to its border, has the object at the pixel.
  bool masked(glm::dvec2 pixel) const;
};

/// `halvings`: number of times that images and masks are halved first. With 0 the result refers to the views' own
/// images: the views must outlive the result and all its copies. `threads`: 0 for all cores.
std::vector<ProjectedMesh> projectedMeshes(const TriangleMesh& mesh, std::span<const HtmView> views, int halvings = 0,
                                           int threads = 1);
std::vector<ProjectedMesh> projectedMeshes(const TriangleMesh& mesh, std::vector<HtmView>&& views, int halvings = 0,
                                           int threads = 1) = delete;

}  // namespace ibr
