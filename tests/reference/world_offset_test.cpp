// SPDX-License-Identifier: Apache-2.0
// Property P6: difference between images of a cell near the origin and far away, for cells of 1 mm to 10 km. With
// IBR_PRINT_FIGURES, the test prints the table of libibr/docs/numerics.md.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "ibr/metrics.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Scales the world by `size` about the origin, then moves it by `offset`.
Camera moved(Camera camera, double size, glm::dvec3 offset) {
  camera.pose.position = offset + size * camera.pose.position;
  return camera;
}

SyntheticScene moved(SyntheticScene place, double size, glm::dvec3 offset) {
  for (Node& node : place.scene.nodes) node.camera = moved(node.camera, size, offset);
  for (Cell& cell : place.scene.cells)
    for (float& rho : cell.mesh.inverseDistance) rho = float(rho / size);
  return place;
}

struct Apart {
  double px = 0;     // largest displacement of a vertex in the image
  double share = 0;  // share of pixels that differ by more than one 8-bit level
  double psnr = 0;
};

// Largest displacement of the vertices, with camera positions rounded to doubles.
double largestShift(const Scene& here, const Scene& there, const Camera& view, const Camera& viewThere, double size) {
  double largest = 0;
  for (std::size_t p = 0; p < here.cells[0].mesh.vertexCount(); ++p) {
    const auto a = vertexPosition(here, here.cells[0], p), b = vertexPosition(there, there.cells[0], p);
    if (!a || !b) continue;
    const auto seen = [](const Camera& camera, glm::dvec3 x, double scale) {
      return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (x - camera.pose.position) / scale);
    };
    const auto first = seen(view, *a, 1), second = seen(viewThere, *b, size);
    if (first && second) largest = std::max(largest, glm::distance(*first, *second));
  }
  return largest;
}

}  // namespace

TEST_CASE("the picture is the same at any distance from the origin and cell size", "[N5][P6]") {
  const SyntheticScene here = makeScene(place(3));
  const Camera view = cameraAt({0.42, 0.27, 0.13}, 0.04);
  const Image8 expected = Stage(testDevice(), here).render(view, withTiers());
  const bool print = std::getenv("IBR_PRINT_FIGURES");
  if (print) std::printf("| cell | offset | vertex, px | pixels off by more than a level | PSNR, dB |\n");
  for (const double size : {1e-3, 1e-1, 1.0, 1e2, 1e4})
    for (const double offset : {0.0, 1e3, 1e5, 1e6, 1e7}) {
      const glm::dvec3 away = offset * glm::dvec3(1, -0.8, 0.3);
      const SyntheticScene there = moved(here, size, away);
      const Camera viewThere = moved(view, size, away);
      const Image8 picture = Stage(testDevice(), there).render(viewThere, withTiers());
      const Apart apart{largestShift(here.scene, there.scene, view, viewThere, size),
                        difference(picture, expected, 1).shareAbove, psnr(picture, expected)};
      if (print)
        std::printf("%s\n", fmt::format("| {:g} m | {:g} m | {:.1e} | {:.2e} | {:.1f} |", size, offset, apart.px,
                                        apart.share, apart.psnr)
                                .c_str());
      INFO("cells of " << size << " m, " << offset << " m away");
      // A double holds a position to 2⁻⁵³ of its distance. The image moves by that error divided by the cell size.
      const double grain = 2.3e-16 * offset / size;
      CHECK(apart.px < 1e-3 + 4000 * grain);
      CHECK(apart.share < 2e-3);
      CHECK(apart.psnr > 50);
    }
}
