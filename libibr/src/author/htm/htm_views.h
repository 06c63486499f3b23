// SPDX-License-Identifier: Apache-2.0
// The cameras of a harmonised model with their pictures, and how each sees a mesh: [H]'s projected meshes M̂_i.
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

/// World points to pixels, in double precision.
class PinholeView {
 public:
  /// Precondition: a pinhole.
  explicit PinholeView(const Camera& camera);

  struct Seen {
    glm::dvec2 pixel;
    double depth;  // along the viewing axis, > 0
  };
  /// nullopt for points that are not before the camera; pixels may lie outside the picture.
  std::optional<Seen> seen(const glm::dvec3& world) const;
  glm::dvec3 point(glm::dvec2 pixel, double depth) const;
  const glm::dvec3& centre() const { return centre_; }
  const Intrinsics& intrinsics() const { return k_; }
  /// Whether a bilinear sample there needs no pixel from outside.
  bool inside(glm::dvec2 pixel) const {
    return pixel.x >= 0.5 && pixel.y >= 0.5 && pixel.x <= k_.width - 0.5 && pixel.y <= k_.height - 0.5;
  }

 private:
  Intrinsics k_;
  glm::dmat3 toCamera_, toWorld_;
  glm::dvec3 centre_;
};

/// Which face of a mesh each pixel's centre shows, and how deep.
struct MeshRaster {
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);
  Image<std::uint32_t> face;  // kNone: no face
  ImageF depth;               // along the viewing axis, world units; infinite where no face is

  /// Whether a point seen at `pixel`, `depth` lies on or before the nearest surface around, to `tolerance` of its
  /// depth; yes where no face is around, so everywhere outside the picture, at infinite pixels too.
  bool shows(glm::dvec2 pixel, double depth, double tolerance = 2e-3) const;
};
/// Faces with a corner that is not before the camera are left out.
MeshRaster rasterised(const TriangleMesh& mesh, const Camera& camera);

struct HtmView {
  Camera camera;
  Image8 picture;  // RGB, of the camera's size
  Image8 mask;     // 1 channel, of the same size, >= 128: the object; or empty: everything may be
};

/// A view with the mesh drawn into it, at one scale. Copies share the pictures.
struct ProjectedMesh {
  PinholeView view;
  std::shared_ptr<const Image8> picture, mask;  // never null; at full size those of the HtmView itself, not owned
  MeshRaster raster;

  /// nullopt where a world point is outside the picture or the mask, or hidden by the mesh.
  std::optional<glm::dvec2> visible(const glm::dvec3& world) const;
  /// Whether the mask has the object there, or nearest to there where that is outside the picture.
  bool masked(glm::dvec2 pixel) const;
};

/// `halvings`: how often pictures and masks are halved first. Where that is 0 the views' own are referred to: they must
/// outlive what is returned and all its copies. `threads`: 0 for all cores.
std::vector<ProjectedMesh> projectedMeshes(const TriangleMesh& mesh, std::span<const HtmView> views, int halvings = 0,
                                           int threads = 1);
std::vector<ProjectedMesh> projectedMeshes(const TriangleMesh& mesh, std::vector<HtmView>&& views, int halvings = 0,
                                           int threads = 1) = delete;

}  // namespace ibr
