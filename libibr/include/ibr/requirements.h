// SPDX-License-Identifier: Apache-2.0
// Derives from a scene and options exactly those parts that a Renderer must allocate and compile.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ibr/export.h"
#include "ibr/renderer.h"

namespace ibr {

struct Requirements {
  // From the scene alone.
  std::array<std::uint32_t, 5> cellsByMemberCount{};  // cells by number of members: 2 lines, 3 triangles, 4 tetrahedra
  std::uint32_t cells = 0;
  std::uint32_t pinholes = 0, panoramas = 0;  // photographs
  std::uint32_t mixedCells = 0;               // cells with pinholes and panoramas
  std::uint32_t masked = 0;                   // photographs with a mask
  bool gains = false;                         // some photographs have a gain other than 1
  std::uint32_t gatherable = 0;               // photographs with a backdrop, evidence in its mesh, and a depth texture

  // From the scene and the renderer's options.
  bool depthOrder = false, painterOrder = false;  // cells are drawn with a depth test, without
  bool dissolve = false;                          // opacities below 1
  bool noise = false;                             // blue noise, for dithering and dissolving
  bool crossFadeOrders = false;                   // a second canvas
  bool fill = false, depth = false;               // holes are filled; targets with a DepthTarget
  bool multiview = false;                         // a canvas for both views, if the device draws them in one pass
  bool buffers = false, floor = false;            // Renderer::recordBuffers; RenderSettings::floor
  bool hiddenArea = false;                        // RendererOptions::hiddenArea is used
  bool gather = false;                            // a vote and its images
  std::vector<Overlay> overlays;
  bool colourTables = false, colourSequence = false;  // colour mapping; the paper's sequence of it
  std::uint32_t maxDrawItems = 0;                     // of an image
};

/// Pure. Precondition: validate(scene) is empty.
IBR_API Requirements requirementsOf(const Scene& scene, const RendererOptions& options);

/// Replaces the part that depends on the options; keeps the part from the scene alone. Pure.
IBR_API Requirements withOptions(Requirements scene, const RendererOptions& options);

/// A part of the renderer, whether it runs, and why; for people.
struct StageExplanation {
  std::string name;
  bool runs;
  std::string why;
};
IBR_API std::vector<StageExplanation> explain(const Requirements& requirements, const RendererOptions& options);

}  // namespace ibr
