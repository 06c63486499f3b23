// SPDX-License-Identifier: Apache-2.0
#include "author/match/quadtree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace ibr {
namespace {

constexpr double kMinMatchedShare = 0.5;  // matched share of a smallest block for a vertex

class Quadtree {
 public:
  Quadtree(const Image8& good, std::span<const ImageF> positions, const BlockSizes& sizes)
      : good_(good), positions_(positions), sizes_(sizes), width_(good.width), height_(good.height) {}

  std::vector<glm::ivec2> run() {
    for (int y = 0; y < height_; y += sizes_.largest)
      for (int x = 0; x < width_; x += sizes_.largest) visit(x, y, sizes_.largest);
    return std::move(vertices_);
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }

  void visit(int x0, int y0, int size) {
    const int x1 = std::min(x0 + size, width_), y1 = std::min(y0 + size, height_);
    if (x0 >= x1 || y0 >= y1) return;
    int good = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) good += good_.values[at(x, y)];
    if (good == 0) return;
    const int area = (x1 - x0) * (y1 - y0);
    const bool whole = good == area;
    if (size > sizes_.smallest ? !whole || !affine(x0, y0, x1, y1) : size > sizes_.atEdges && !whole) {
      const int half = size / 2;
      for (const glm::ivec2 part : {glm::ivec2(0, 0), {half, 0}, {0, half}, {half, half}})
        visit(x0 + part.x, y0 + part.y, half);
      return;
    }
    if (good < kMinMatchedShare * area) return;
    // Twice the centre, to stay in whole numbers.
    const glm::ivec2 centre(x0 + x1 - 1, y0 + y1 - 1);
    glm::ivec2 best(0);
    int least = -1;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        if (!good_.values[at(x, y)]) continue;
        const glm::ivec2 off = 2 * glm::ivec2(x, y) - centre;
        const int distance = off.x * off.x + off.y * off.y;
        if (least < 0 || distance < least) least = distance, best = {x, y};
      }
    vertices_.push_back(best);
  }

  // True if the positions of every member in a fully matched block fit an affine map (least squares) of the pixel.
  bool affine(int x0, int y0, int x1, int y1) const {
    constexpr int kStride = 2;
    const glm::dvec2 centre(0.5 * (x0 + x1 - 1), 0.5 * (y0 + y1 - 1));
    glm::dmat3 normal(0.0);
    for (int y = y0; y < y1; y += kStride)
      for (int x = x0; x < x1; x += kStride) {
        const glm::dvec3 p(x - centre.x, y - centre.y, 1.0);
        normal += glm::outerProduct(p, p);
      }
    const glm::dmat3 inverse = glm::inverse(normal);
    for (const ImageF& position : positions_) {
      glm::dvec3 right[2]{};
      for (int y = y0; y < y1; y += kStride)
        for (int x = x0; x < x1; x += kStride)
          for (std::size_t c = 0; c < 2; ++c)
            right[c] += glm::dvec3(x - centre.x, y - centre.y, 1.0) * double(position.values[2 * at(x, y) + c]);
      const glm::dvec3 fit[2] = {inverse * right[0], inverse * right[1]};
      for (int y = y0; y < y1; y += kStride)
        for (int x = x0; x < x1; x += kStride) {
          const glm::dvec3 p(x - centre.x, y - centre.y, 1.0);
          const double ex = glm::dot(fit[0], p) - double(position.values[2 * at(x, y)]);
          const double ey = glm::dot(fit[1], p) - double(position.values[2 * at(x, y) + 1]);
          if (ex * ex + ey * ey > sizes_.affine * sizes_.affine) return false;
        }
    }
    return true;
  }

  const Image8& good_;
  std::span<const ImageF> positions_;
  const BlockSizes& sizes_;
  int width_, height_;
  std::vector<glm::ivec2> vertices_;
};

}  // namespace

std::vector<glm::ivec2> meshVertices(const Image8& good, std::span<const ImageF> positions, const BlockSizes& sizes) {
  return Quadtree(good, positions, sizes).run();
}

}  // namespace ibr
