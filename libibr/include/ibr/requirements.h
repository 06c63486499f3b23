// SPDX-License-Identifier: Apache-2.0
// What a scene asks of a renderer (NUMERICS §4): a Renderer allocates and compiles what stands here, and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

struct Requirements {
  // Of the scene.
  std::array<std::uint32_t, 5> cellsOf{};  // cells of so many members: lines, triangles, tetrahedra
  std::uint32_t cells = 0;
  std::uint32_t pinholes = 0, panoramas = 0;  // photographs
  std::uint32_t mixedCells = 0;               // with photographs of both kinds
  std::uint32_t masked = 0;                   // photographs with a mask
  bool severalExposures = true;               // unknown is several
  bool gains = false;                         // there are photographs whose gain is not 1
  std::uint32_t gatherable = 0;               // photographs with a backdrop, evidence in its mesh, and a depth texture

  // With a renderer's options.
  bool depthOrder = false, painters = false;  // cells are drawn with depth, without
  bool dissolve = false;
  bool noise = false;         // blue noise, for what is dithered or dissolves
  bool switchMixing = false;  // a second canvas
  bool fill = false, depth = false;
  bool multiview = false;  // a canvas for both eyes, where the device draws them at once
  bool buffers = false, floor = false;
  bool hiddenArea = false;  // there are pixels that nobody sees
  bool gather = false;      // a vote and its images
  std::vector<Overlay> overlays;
  bool colourTables = false, colourSequence = false;  // tables at all; the paper's way to them
  std::uint32_t steps = 0;                            // draws of a picture, at most
};

/// Pure. Precondition: validate(scene) is empty.
Requirements requirementsOf(const Scene& scene, const RendererOptions& options);

/// The same for a scene whose own part is known.
Requirements withOptions(Requirements scene, const RendererOptions& options);

/// A part of the renderer, whether it is there, and why: for people.
struct StageReason {
  std::string name;
  bool runs;
  std::string why;
};
std::vector<StageReason> explain(const Requirements& requirements, const RendererOptions& options);

}  // namespace ibr
