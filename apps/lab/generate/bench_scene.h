// SPDX-License-Identifier: Apache-2.0
// Generates scenes of the shapes measured in [T] table 2, for `ibr-lab bench`: cells, triangles, three photographs per
// cell. Nothing is on disk; photographs are generated one at a time, on request.
//
// All photographs are taken at three spots 0.5 m apart, in the middle of a sphere with a fine pattern on its inside.
// Stitched: each cell has another viewing direction; together they fill a wide view and overlap as in the paper's
// frames. Stacked: every cell fills a narrow view. Each cell has its own exposure, so that colour mapping has work.
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
  double fovY;     // of pinholes, radians: so wide that cells overlap as in the paper's frames
};

/// Names: stitched-5, stitched-12, stitched-30, stacked-5, stacked-12, stacked-30, panorama-1, panorama-3.
std::span<const BenchShape> benchShapes();

/// Returns nullptr if no shape has the name.
const BenchShape* findBenchShape(std::string_view name);

/// The same on every machine. `detail` scales the photographs' width and height, 0 < detail <= 1: for tests.
Scene makeBenchScene(const BenchShape& shape, double detail = 1.0);

/// Renders a photograph of such a scene: RGBA, and mip levels down to 1×1, each filtered.
std::vector<Image8> benchPhotograph(const Scene& scene, std::size_t node);

/// Cameras of the bench: inside every cell, each with another direction. fovY is 1 rad (stacked: 0.6).
std::vector<Camera> benchViews(const BenchShape& shape, int count, int width, int height);

}  // namespace ibr
