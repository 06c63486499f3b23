// SPDX-License-Identifier: Apache-2.0
// Simple ways to show a scene's photographs from elsewhere, so that figures of the morph have something to be compared
// with. All run on the CPU. Needs ibr::author.
//
// Pictures are RGBA of the view's size: alpha 255 where something is shown, 0 and black elsewhere.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

struct BaselineOptions {
  std::uint64_t cacheBytes = std::uint64_t(256) << 20;  // of decoded photographs that are kept; at least one is
  int threads = 0;                                      // 0 = all cores
};

/// One thread at a time. Besides the photographs it keeps two depth maps of at most 512 × 512 floats for each
/// photograph that was used (Node::depthFile; without, depth is infinite); a picture takes about 60 bytes a pixel while
/// it is made.
class Baselines {
 public:
  /// The scene and its stored photographs must outlive it. Throws Error{unsupported} where a node is no pinhole, or has
  /// a mask, which none of them heeds, Error{invalidInput} without nodes.
  explicit Baselines(const Scene& scene, const BaselineOptions& options = {});
  Baselines(Baselines&&) noexcept;
  ~Baselines();

  /// From here on photographs are shown with their gains times `exposure`, of linear light (FramePlan::exposure), as a
  /// renderer shows them; nullopt, as before the first call: as they are.
  void expose(const std::optional<glm::dvec3>& exposure);

  /// The photograph taken nearest to the view (distance over the median distance of what it shows, plus the angle
  /// between the axes), by the homography of a plane across the view at the median depth of its matches; at infinity
  /// where it has none. Throws Error where a photograph cannot be read, as the others do.
  Image8 nearest(const Camera& view);

  /// Unstructured lumigraph (Buehler, Bosse, McMillan, Gortler, Cohen 2001): the four best photographs a pixel, by
  /// angle and resolution, projected onto their depth (lumigraph.h).
  Image8 lumigraph(const Camera& view);

  /// Photographs of one cell by the homographies of one plane across the view at the cell's median depth, in a
  /// weighted sum where several are seen: a cross-fade without morphing. Precondition: a weight >= 0 each.
  Image8 crossFade(const Camera& view, const Cell& cell, std::span<const double> weights);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
