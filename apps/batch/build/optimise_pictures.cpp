// SPDX-License-Identifier: Apache-2.0
#include "batch/build/optimise_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/bilinear.h"
#include "base/file.h"
#include "base/raster.h"
#include "io/image_file.h"
#include "shared/draw/image_operations.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr std::uint8_t kBackgroundGrey = 32;  // grey level of pixels without a triangle
constexpr double kHeat = 0.6, kLine = 0.35;   // opacity
constexpr std::size_t kMaxCrops = 4;

// Morph to the midpoint of a cell's photographs, computed on the CPU.
class CentreMorph {
 public:
  CentreMorph(const Scene& scene, const Cell& cell, const std::vector<Image8>& photographs)
      : mesh_(cell.mesh), photographs_(photographs), panoramic_(isPanoramic(scene, cell)) {
    for (std::size_t p = 0; p < mesh_.vertexCount(); ++p) place_.push_back(placeOf(scene, cell, p));
  }

  Image8 picture() const {
    Image8 picture(width(), height(), 3, kBackgroundGrey);
    draw(picture, kTierRejected, 1);
    draw(picture, kTierConsistent, photographs_.size());
    return picture;
  }

  /// `star`: ECC of each point; NaN if undefined.
  Image8 heatMap(Image8 picture, const std::vector<float>& star) const {
    forTriangles(kTierConsistent, [&](const glm::uvec3& t) {
      glm::dvec3 bad;
      for (int k = 0; k < 3; ++k)
        bad[k] = std::isnan(star[t[k]]) ? 1.0 : std::clamp(1.0 - double(star[t[k]]), 0.0, 1.0);
      forPixels(t, [&](int x, int y, const glm::dvec3& w) {
        const double b = glm::dot(bad, w);
        mix(picture, x, y, {255, 255 * std::clamp(2 - 2 * b, 0.0, 1.0), 0}, kHeat * std::min(2 * b, 1.0));
      });
    });
    forTriangles(kTierConsistent, [&](const glm::uvec3& t) {
      for (int k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3]) line(picture, place_[t[k]], place_[t[(k + 1) % 3]]);
    });
    return picture;
  }

 private:
  static bool isPanoramic(const Scene& scene, const Cell& cell) {
    return scene.nodes[cell.members[0]].camera.intrinsics.model == CameraModel::equirectangular;
  }
  int width() const { return photographs_[0].width; }
  int height() const { return photographs_[0].height; }

  glm::dvec2 placeOf(const Scene& scene, const Cell& cell, std::size_t p) const {
    glm::dvec2 mean(0.0);
    glm::dvec3 direction(0.0);
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const Camera& camera = scene.nodes[cell.members[i]].camera;
      mean += glm::dvec2(mesh_.match[i][p]) / double(cell.members.size());
      direction += camera.pose.rotation * unproject(camera.intrinsics, glm::dvec2(mesh_.match[i][p]));
    }
    if (!panoramic_) return mean;
    const Camera& first = scene.nodes[cell.members[0]].camera;
    return project(first.intrinsics, glm::conjugate(first.pose.rotation) * direction).value_or(mean);
  }

  // Draws the mean colour of the first `members` photographs.
  void draw(Image8& picture, Tier tier, std::size_t members) const {
    forTriangles(tier, [&](const glm::uvec3& t) {
      forPixels(t, [&](int x, int y, const glm::dvec3& w) {
        glm::dvec3 colour(0.0);
        for (std::size_t i = 0; i < members; ++i) {
          const auto& m = mesh_.match[i];
          colour +=
              bilinear(photographs_[i], w.x * glm::dvec2(m[t.x]) + w.y * glm::dvec2(m[t.y]) + w.z * glm::dvec2(m[t.z]));
        }
        colour /= double(members);
        for (int c = 0; c < 3; ++c) picture.pixel(x, y)[std::size_t(c)] = std::uint8_t(colour[c] + 0.5);
      });
    });
  }

  // Visits the triangles of a tier, except those across a panorama's seam.
  template <class Visit>
  void forTriangles(Tier tier, Visit&& visit) const {
    for (std::size_t n = 0; n < mesh_.triangles.size(); ++n) {
      const glm::uvec3& t = mesh_.triangles[n];
      bool across = false;
      const auto look = [&](double a, double b, double c, int side) {
        across = across || std::max({a, b, c}) - std::min({a, b, c}) > 0.5 * side;
      };
      if (panoramic_) {
        look(place_[t.x].x, place_[t.y].x, place_[t.z].x, width());
        for (std::size_t i = 0; i < photographs_.size(); ++i)
          look(double(mesh_.match[i][t.x].x), double(mesh_.match[i][t.y].x), double(mesh_.match[i][t.z].x),
               photographs_[i].width);
      }
      if (mesh_.tier[n] == tier && !across) visit(t);
    }
  }
  template <class Visit>
  void forPixels(const glm::uvec3& t, Visit&& visit) const {
    forTrianglePixels(place_[t.x], place_[t.y], place_[t.z], width(), height(), visit);
  }

  static void mix(Image8& picture, int x, int y, const glm::dvec3& colour, double share) {
    const auto pixel = picture.pixel(x, y);
    for (int c = 0; c < 3; ++c) {
      std::uint8_t& value = pixel[std::size_t(c)];
      value = std::uint8_t(std::clamp(value + share * (colour[c] - value) + 0.5, 0.0, 255.0));
    }
  }
  void line(Image8& picture, glm::dvec2 from, glm::dvec2 to) const {
    const int steps = std::max(1, int(std::ceil(std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)))));
    for (int s = 0; s < steps; ++s) {
      const glm::ivec2 at(glm::floor(glm::mix(from, to, double(s) / steps)));
      if (at.x >= 0 && at.y >= 0 && at.x < width() && at.y < height()) mix(picture, at.x, at.y, glm::dvec3(0.0), kLine);
    }
  }

  const MorphMesh& mesh_;
  const std::vector<Image8>& photographs_;
  bool panoramic_;
  std::vector<glm::dvec2> place_;
};

// Returns the top-left corners of the squares with the largest differences, without overlap, largest first.
std::vector<glm::ivec2> changedMost(const Image8& a, const Image8& b, int side) {
  const int width = a.width, height = a.height;
  const std::size_t row = std::size_t(width) + 1;
  std::vector<std::uint64_t> sums(row * (std::size_t(height) + 1), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * row + std::size_t(x);
      std::uint64_t difference = 0;
      for (std::size_t c = 0; c < 3; ++c) difference += std::uint64_t(std::abs(a.pixel(x, y)[c] - b.pixel(x, y)[c]));
      sums[at + row + 1] = difference + sums[at + row] + sums[at + 1] - sums[at];
    }
  struct ChangedWindow {
    std::uint64_t changed;
    glm::ivec2 at;
  };
  std::vector<ChangedWindow> places;
  const int step = std::max(1, side / 8);
  for (int y = 0; y + side <= height; y += step)
    for (int x = 0; x + side <= width; x += step) {
      const std::size_t at = std::size_t(y) * row + std::size_t(x), down = std::size_t(side) * row;
      const auto right = std::size_t(side);
      places.push_back({sums[at + down + right] - sums[at + down] - sums[at + right] + sums[at], {x, y}});
    }
  std::ranges::stable_sort(places, std::greater<>{}, &ChangedWindow::changed);
  std::vector<glm::ivec2> chosen;
  for (const ChangedWindow& place : places) {
    if (chosen.size() == kMaxCrops || place.changed == 0) break;
    const auto near = [&](glm::ivec2 other) {
      const glm::ivec2 apart = glm::abs(place.at - other);
      return std::max(apart.x, apart.y) < side;
    };
    if (std::ranges::none_of(chosen, near)) chosen.push_back(place.at);
  }
  return chosen;
}

void paste(Image8& to, glm::ivec2 at, const Image8& from, glm::ivec2 corner, int side, int scale) {
  for (int y = 0; y < side * scale; ++y)
    for (int x = 0; x < side * scale; ++x)
      std::ranges::copy(from.pixel(corner.x + x / scale, corner.y + y / scale), to.pixel(at.x + x, at.y + y).begin());
}

Image8 crops(const Image8& before, const Image8& after) {
  constexpr int kShown = 360, kGap = 8;  // px
  const int side = std::min({std::clamp(before.width / 8, 64, 160), before.width, before.height});
  const int scale = std::max(1, kShown / side), shown = side * scale;
  const std::vector<glm::ivec2> places = changedMost(before, after, side);
  const int rows = std::max(1, int(places.size()));
  Image8 sheet(2 * shown + kGap, rows * (shown + kGap) - kGap, 3, 255);
  for (int r = 0; r < int(places.size()); ++r) {
    paste(sheet, {0, r * (shown + kGap)}, before, places[std::size_t(r)], side, scale);
    paste(sheet, {shown + kGap, r * (shown + kGap)}, after, places[std::size_t(r)], side, scale);
  }
  return sheet;
}

}  // namespace

void writeOptimisePictures(const Scene& before, const Scene& after, const OptimisedCell& facts,
                           const fs::path& folder) {
  std::vector<Image8> photographs;
  for (const std::uint32_t i : before.cells[facts.cell].members)
    photographs.push_back(readImage(pathInside(before.folder, before.nodes[i].imageFile)));
  const CentreMorph was(before, before.cells[facts.cell], photographs), is(after, after.cells[facts.cell], photographs);
  const Image8 first = was.picture(), second = is.picture();
  makeFolders(folder);
  const auto file = [&](const char* what) { return folder / fmt::format("cell{:03}_{}.png", facts.cell, what); };
  writeImage(file("before"), first);
  writeImage(file("after"), second);
  writeImage(file("heat"), sideBySide({was.heatMap(first, facts.summary.initialStarEcc),
                                       is.heatMap(second, facts.summary.finalStarEcc)}));
  writeImage(file("crops"), crops(first, second));
}

}  // namespace ibr::app
