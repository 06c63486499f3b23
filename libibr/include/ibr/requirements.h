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

/// Parts that a Renderer allocates and compiles for a scene and options.
struct Requirements {
  // From the scene alone.
  std::array<std::uint32_t, 5> cellsByMemberCount{};  // cells by number of members: 2 lines, 3 triangles, 4 tetrahedra
  std::uint32_t cells = 0;                            // number of cells
  std::uint32_t pinholes = 0, panoramas = 0;          // number of photographs of the CameraModel
  std::uint32_t mixedCells = 0;                       // number of cells with pinholes and panoramas
  std::uint32_t masked = 0;                           // number of photographs with a mask
  bool gains = false;                                 // some photographs have a gain other than 1
  std::uint32_t gatherable = 0;  // number of photographs with a backdrop, evidence in its mesh, and a depth texture

  // From the scene and the renderer's options.
  bool depthOrder = false, painterOrder = false;  // depthOrder: cells with a depth test; painterOrder: cells without it
  bool dissolve = false;                          // opacities below 1 are drawn
  bool noise = false;                             // blue noise, for dithering and dissolving
  bool crossFadeOrders = false;                   // a second canvas for the previous draw order
  bool fill = false, depth = false;     // fill: holes are filled; depth: targets with a DepthTarget are supported
  bool multiview = false;               // a canvas for both views, if the device draws them in one pass
  bool buffers = false, floor = false;  // buffers: Renderer::recordBuffers; floor: RenderSettings::floor
  bool hiddenArea = false;              // RendererOptions::hiddenArea is used
  bool gather = false;                  // a vote and its images
  std::vector<Overlay> overlays;        // overlays, each once, without Overlay::none
  // colourTables: tables for colour mapping; colourSequence: the paper's sequence of colour mapping
  bool colourTables = false, colourSequence = false;
  std::uint32_t maxDrawItems = 0;  // maximum number of cells that an image draws, fading ones included
};

/// Derives the requirements. Pure. Precondition: validate(scene) is empty.
IBR_API Requirements requirementsOf(const Scene& scene, const RendererOptions& options);

/// Replaces the part that depends on the options; keeps the part from the scene alone. Pure.
IBR_API Requirements withOptions(Requirements scene, const RendererOptions& options);

/// A part of the renderer, whether it runs, and why; for people.
struct StageExplanation {
  std::string name;  // the part
  bool runs;         // true: the renderer has the part
  std::string why;   // the reason
};

/// Explains which parts a renderer has, in a fixed order. Pure.
IBR_API std::vector<StageExplanation> explain(const Requirements& requirements, const RendererOptions& options);

}  // namespace ibr
