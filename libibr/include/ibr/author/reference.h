// SPDX-License-Identifier: Apache-2.0
// Reference implementations on the CPU, in double precision, to compare scenes and devices with. Needs ibr::author.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "ibr/frame_plan.h"
#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// A view that ReferenceRenderer composed.
struct ReferenceView {
  Image8 picture;       // RGBA; alpha as AlphaContent::tier, 0 in holes
  ImageF inverseDepth;  // inverse depth along the view's axis of the surface with the largest weight, 1 / world unit
};

/// Composes views as Composition::gathered does, from the scene's files. Keeps the textures of a view's photographs
/// until the next view. One thread at a time uses it.
class ReferenceRenderer {
 public:
  /// Makes a renderer of a scene. `threads`: of the CPU; 0: all cores. Precondition: isGatherable(scene). The scene and
  /// its files must outlive this object.
  ReferenceRenderer(const Scene& scene, int threads);
  ~ReferenceRenderer();  // frees host memory

  /// Composes a view. The vote has the view's size; magnified photographs are interpolated by cubic splines. Holes in
  /// the depth are filled from around, and so are colours that no photograph shows. Throws Error for a file that cannot
  /// be read, and as planFrame does.
  ReferenceView compose(const Camera& view, Exposure exposure);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns true if the scene's photographs have confirmed depth.
bool isGatherable(const Scene& scene);

/// A device's difference from the reference implementation of the cell pass, over the pixels that show one tier of one
/// cell with all their neighbours, and lie on no triangle's edge: on other pixels rasterisation may differ.
struct ReferenceDifference {
  double compared = 0;       // share of the image's pixels that were compared
  double meanLevels = 0;     // mean over R, G, B, 8-bit levels; NaN if nothing is compared
  double largestLevels = 0;  // maximum over R, G, B, 8-bit levels
  double beyondBound = 0;    // share of the values with errors above the bound from the texture filter's precision
};

/// Fractional bits of a device's rasteriser and texture filter: VkPhysicalDeviceLimits' subPixelPrecisionBits,
/// subTexelPrecisionBits and mipmapPrecisionBits.
struct DevicePrecision {
  // Fractional bits. subPixelBits: of pixels; subTexelBits: of texels; mipmapBits: of mip levels
  unsigned subPixelBits, subTexelBits, mipmapBits;
};

/// Measures the difference of `picture`, a device's image of the plan's first view with trilinear filters. `textures`:
/// RGBA mip levels of each node's photograph.
ReferenceDifference differenceFromReference(const Scene& scene, const std::vector<std::vector<Image8>>& textures,
                                            const FramePlan& plan, const Image8& picture,
                                            const DevicePrecision& precision);

/// Returns the colour table of one channel ([T] §2.5.3, eq. 18), as shaders compute it: maps the levels of histogram
/// `from` to those of `to`. Both count the same, positive number of pixels.
std::array<std::uint8_t, 256> colourTable(const std::array<std::uint32_t, 256>& from,
                                          const std::array<std::uint32_t, 256>& to);

}  // namespace ibr
