// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/depth_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/raster.h"

namespace ibr {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

double percentile(std::vector<float> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Calls `hit(cell, inverse distance)` for each of the grid's cell centres that a triangle covers in a member's image.
// Triangles wider than half a panorama wrap around behind the camera and are skipped.
template <class Hit>
void rasterise(const MorphMesh& mesh, std::size_t member, std::size_t triangleCount, const Intrinsics& k,
               const DepthGrid& grid, const Hit& hit) {
  const glm::dvec2 scale(double(grid.columns) / k.width, double(grid.rows) / k.height);
  for (std::size_t t = 0; t < triangleCount; ++t) {
    const glm::uvec3 v = mesh.triangles[t];
    glm::dvec2 p[3];
    double inverse[3];
    for (int c = 0; c < 3; ++c) {
      p[c] = glm::dvec2(mesh.match[member][v[c]]) * scale;
      inverse[c] = mesh.inverseDistance[v[c]] / mesh.ratio[member][v[c]];
    }
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    if (k.model == CameraModel::equirectangular && right - left > 0.5 * grid.columns) continue;
    forTrianglePixels(p[0], p[1], p[2], grid.columns, grid.rows, [&](int x, int y, const glm::dvec3& w) {
      hit(std::size_t(y) * std::size_t(grid.columns) + std::size_t(x),
          std::max(0.0f, float(w[0] * inverse[0] + w[1] * inverse[1] + w[2] * inverse[2])));
    });
  }
}

DepthGrid emptyGrid(const Intrinsics& k, int longest) {
  DepthGrid grid;
  const double scale = double(longest) / std::max(k.width, k.height);
  grid.columns = std::max(1, int(std::lround(k.width * scale)));
  grid.rows = std::max(1, int(std::lround(k.height * scale)));
  const auto cells = std::size_t(grid.columns) * std::size_t(grid.rows);
  grid.inverseDistance.assign(cells, kUnknown);
  grid.agreed.assign(cells, false);
  return grid;
}

}  // namespace

glm::dvec2 DepthGrid::pixel(const Intrinsics& k, int column, int row) const {
  return {(column + 0.5) * k.width / columns, (row + 0.5) * k.height / rows};
}

float DepthGrid::at(const Intrinsics& k, glm::dvec2 pixel) const {
  const double x = std::floor(pixel.x * columns / k.width), y = std::floor(pixel.y * rows / k.height);
  if (!(x >= 0 && y >= 0 && x < columns && y < rows)) return kUnknown;
  return inverseDistance[std::size_t(y) * std::size_t(columns) + std::size_t(x)];
}

double DepthGrid::agreedShare() const {
  return double(std::ranges::count(agreed, true)) / double(std::max<std::size_t>(1, agreed.size()));
}

std::vector<DepthGrid> depthGrids(const Scene& scene, int longest) {
  std::vector<DepthGrid> grids;
  for (const Node& node : scene.nodes) grids.push_back(emptyGrid(node.camera.intrinsics, longest));
  const auto nearer = [](DepthGrid& grid) {
    return [&grid](std::size_t cell, float inverse) {
      float& known = grid.inverseDistance[cell];
      if (!(known >= inverse)) known = inverse;
    };
  };
  std::vector<bool> hasBackdrop(grids.size(), false);
  for (const Cell& backdrop : scene.backdrops) {
    const std::uint32_t n = backdrop.members[0];
    hasBackdrop[n] = !backdrop.mesh.triangles.empty();
    rasterise(backdrop.mesh, 0, backdrop.mesh.triangles.size(), scene.nodes[n].camera.intrinsics, grids[n],
              nearer(grids[n]));
  }
  for (const Cell& cell : scene.cells)
    for (std::size_t m = 0; m < cell.members.size(); ++m) {
      DepthGrid& grid = grids[cell.members[m]];
      const auto depth = nearer(grid);
      const bool known = hasBackdrop[cell.members[m]];
      rasterise(cell.mesh, m, cell.mesh.tier0Count(), scene.nodes[cell.members[m]].camera.intrinsics, grid,
                [&](std::size_t at, float inverse) {
                  grid.agreed[at] = true;
                  if (!known) depth(at, inverse);
                });
    }
  for (DepthGrid& grid : grids) {
    std::vector<float> known;
    for (const float inverse : grid.inverseDistance)
      if (!std::isnan(inverse)) known.push_back(inverse);
    grid.near = percentile(known, 0.9);
    grid.middle = percentile(std::move(known), 0.5);
  }
  return grids;
}

}  // namespace ibr
