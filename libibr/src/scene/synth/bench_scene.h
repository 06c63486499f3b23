// SPDX-License-Identifier: Apache-2.0
// Generated scenes of the shapes that [T] table 2 measured, for `ibr bench`: so many cells, so many triangles, three
// photographs a cell. Nothing is on disk; photographs are made one at a time, when they are asked for.
//
// All photographs are taken at three spots 0.5 m apart, in the middle of a sphere with a fine pattern on its inside.
// Stitched: each cell looks another way, so that together they fill a wide view and overlap as in the paper's frames.
// Stacked: every cell fills a narrow view. A cell's exposure is its own, so that there is something to map.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

struct BenchShape {
  const char* name;
  int cells;
  int columns, rows;  // of quads in a cell's mesh
  bool stacked;
  bool panoramas;  // of 2048×1024; else pinholes of 1280×960
  double fovY;     // of pinholes, radians: so wide that cells overlap as much as in the paper's frames
};

/// stitched-5, stitched-12, stitched-30, stacked-5, stacked-12, stacked-30, panorama-1, panorama-3.
std::span<const BenchShape> benchShapes();

/// nullptr where there is none of this name.
const BenchShape* findBenchShape(std::string_view name);

/// The same on every machine. `detail` scales the photographs' sides, 0 < detail <= 1: for tests.
Scene makeBenchScene(const BenchShape& shape, double detail = 1.0);

/// A photograph of such a scene: RGBA, and its levels down to 1×1, each filtered.
std::vector<Image8> benchPhotograph(const Scene& scene, std::size_t node);

/// Where the bench looks from: inside of every cell, a different way each time. fovY is 1 rad (stacked: 0.6).
std::vector<Camera> benchViews(const BenchShape& shape, int count, int width, int height);

}  // namespace ibr
