// SPDX-License-Identifier: Apache-2.0
// Simple view synthesis from a scene's photographs, as baselines for the quality of the morph. All methods run on the
// CPU. Needs ibr::author.
//
// Images are RGBA of the view's size: alpha 255 where a photograph is shown, 0 and black elsewhere.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// Options of Baselines.
struct BaselineOptions {
  std::uint64_t cacheBytes = std::uint64_t(256) << 20;  // limit for decoded photographs; at least one is cached
  int threads = 0;                                      // threads of the CPU; 0: all cores
};

/// Renders baselines. One thread at a time uses an object. Holds the cached photographs and, for each photograph used,
/// two depth maps of floats in the size of Node::depthFile. Without a depth file, depth is infinite. Rendering an image
/// takes about 60 bytes a pixel.
class Baselines {
 public:
  /// Makes baselines of a scene. The scene and its stored photographs must outlive the object. Throws
  /// Error{unsupported} for a node that is no pinhole, or has a mask, since baselines ignore masks. Throws
  /// Error{invalidInput} for a scene without nodes.
  explicit Baselines(const Scene& scene, const BaselineOptions& options = {});
  Baselines(Baselines&&) noexcept;
  ~Baselines();  // frees the cached photographs and depth maps

  /// Sets the exposure of later images: photographs are multiplied by their gain and `exposure` in linear light
  /// (FramePlan::exposure), as in a renderer. nullopt, the initial value: photographs are unchanged.
  void setExposure(const std::optional<glm::dvec3>& exposure);

  /// Warps the photograph nearest to the view by the homography of a plane. Nearest: smallest sum of the distance, over
  /// the scene's median depth, and the angle between the axes. The plane is parallel to the view's image plane, at the
  /// median of the photograph's matched depth, or at infinity without any. Throws Error if a file cannot be read, as do
  /// lumigraph and crossFade.
  Image8 nearest(const Camera& view);

  /// Unstructured lumigraph (Buehler, Bosse, McMillan, Gortler, Cohen 2001): blends the four best photographs a pixel,
  /// by angle and resolution, projected onto a depth map of the view, merged from nearby photographs.
  Image8 lumigraph(const Camera& view);

  /// Cross-fade without morphing: weighted mean of a cell's photographs, warped by the homographies of one plane
  /// parallel to the view's image plane at the cell's median depth. Precondition: one weight >= 0 for each member.
  Image8 crossFade(const Camera& view, const Cell& cell, std::span<const double> weights);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
