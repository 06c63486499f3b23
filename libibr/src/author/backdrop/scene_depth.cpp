// SPDX-License-Identifier: Apache-2.0
#include "author/backdrop/scene_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/geometry/mean_frame.h"
#include "image/raster.h"

namespace ibr {
namespace {

// Inverse depth is linear over the picture of a flat triangle.
ImageF depthInCell(const Cell& cell, std::size_t member, const Intrinsics& stored, glm::ivec2 size) {
  const MorphMesh& mesh = cell.mesh;
  const glm::dvec2 scale(double(size.x) / stored.width, double(size.y) / stored.height);
  std::vector<double> inverseDepth(mesh.pointCount());
  for (std::size_t p = 0; p < inverseDepth.size(); ++p)
    inverseDepth[p] = double(mesh.inverseDistance[p]) /
                      (double(mesh.ratio[member][p]) * -unproject(stored, glm::dvec2(mesh.match[member][p])).z);
  ImageF depth(size.x, size.y, 1, kUnknownDepth);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.tier[t] != kTierAgrees) continue;
    const glm::uvec3 corner = mesh.triangles[t];
    const auto at = [&](int k) { return scale * glm::dvec2(mesh.match[member][corner[k]]); };
    forPixelsIn(at(0), at(1), at(2), size.x, size.y, [&](int x, int y, const glm::dvec3& weights) {
      double w = 0;
      for (int k = 0; k < 3; ++k) w += weights[k] * inverseDepth[corner[k]];
      float& value = depth.pixel(x, y)[0];
      value = std::max(value, float(std::max(w, 0.0)));
    });
  }
  return depth;
}

ImageF depthInCell(const Cell& cell, std::size_t member, const Camera& photograph, const Camera& face) {
  constexpr double kBeside = 0.05;  // cosine of the angle to the axis from which on a vertex is not before the face
  const MorphMesh& mesh = cell.mesh;
  const glm::dquat toFace = glm::conjugate(face.pose.rotation) * photograph.pose.rotation;
  struct Vertex {
    glm::dvec2 pixel{0};
    double inverseDepth = -1;  // −1: not before the face
  };
  std::vector<Vertex> vertices(mesh.pointCount());
  for (std::size_t p = 0; p < vertices.size(); ++p) {
    const glm::dvec3 direction = toFace * unproject(photograph.intrinsics, glm::dvec2(mesh.match[member][p]));
    const auto pixel = direction.z < -kBeside ? project(face.intrinsics, direction) : std::nullopt;
    if (pixel) vertices[p] = {*pixel, double(mesh.inverseDistance[p]) / (double(mesh.ratio[member][p]) * -direction.z)};
  }
  ImageF depth(face.intrinsics.width, face.intrinsics.height, 1, kUnknownDepth);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = [&](int k) -> const Vertex& { return vertices[mesh.triangles[t][k]]; };
    if (mesh.tier[t] != kTierAgrees || at(0).inverseDepth < 0 || at(1).inverseDepth < 0 || at(2).inverseDepth < 0)
      continue;
    forPixelsIn(at(0).pixel, at(1).pixel, at(2).pixel, depth.width, depth.height,
                [&](int x, int y, const glm::dvec3& weights) {
                  const double w =
                      weights.x * at(0).inverseDepth + weights.y * at(1).inverseDepth + weights.z * at(2).inverseDepth;
                  float& value = depth.pixel(x, y)[0];
                  value = std::max(value, float(std::max(w, 0.0)));
                });
  }
  return depth;
}

// Inverse depths by pixel, in any order.
class Samples {
 public:
  Samples(int width, int height) : width_(width), height_(height) {}

  void add(glm::dvec2 at, double inverseDepth) {
    if (at.x >= 0 && at.y >= 0 && at.x < width_ && at.y < height_)
      samples_.emplace_back(int(at.y) * width_ + int(at.x), float(inverseDepth));
  }
  ImageF medians() && {
    std::sort(samples_.begin(), samples_.end());
    ImageF result(width_, height_, 1, kUnknownDepth);
    for (std::size_t first = 0, last = 0; first < samples_.size(); first = last) {
      while (last < samples_.size() && samples_[last].first == samples_[first].first) ++last;
      result.values[std::size_t(samples_[first].first)] = samples_[(first + last - 1) / 2].second;
    }
    return result;
  }

 private:
  int width_, height_;
  std::vector<std::pair<int, float>> samples_;
};

}  // namespace

ImageF depthInScene(const Scene& scene, std::uint32_t node, glm::ivec2 size) {
  std::vector<ImageF> maps;
  for (const Cell& cell : scene.cells) {
    const auto found = std::find(cell.members.begin(), cell.members.end(), node);
    if (found != cell.members.end())
      maps.push_back(
          depthInCell(cell, std::size_t(found - cell.members.begin()), scene.nodes[node].camera.intrinsics, size));
  }
  return maps.empty() ? ImageF(size.x, size.y, 1, kUnknownDepth) : medianDepth(maps);
}

ImageF depthInScene(const Scene& scene, std::uint32_t node, const Camera& face) {
  std::vector<ImageF> maps;
  for (const Cell& cell : scene.cells) {
    const auto found = std::find(cell.members.begin(), cell.members.end(), node);
    if (found != cell.members.end())
      maps.push_back(depthInCell(cell, std::size_t(found - cell.members.begin()), scene.nodes[node].camera, face));
  }
  return maps.empty() ? ImageF(face.intrinsics.width, face.intrinsics.height, 1, kUnknownDepth) : medianDepth(maps);
}

ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points) {
  Samples samples(camera.intrinsics.width, camera.intrinsics.height);
  for (const glm::dvec3& point : points) {
    const double w = inverseDepth(camera, point);
    const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
    if (at && w > 0 && std::isfinite(w)) samples.add(*at, w);
  }
  return std::move(samples).medians();
}

ImageF medianDepth(std::span<const ImageF> maps) {
  ImageF result(maps[0].width, maps[0].height, 1, kUnknownDepth);
  std::vector<float> values;
  for (std::size_t at = 0; at < result.values.size(); ++at) {
    values.clear();
    for (const ImageF& map : maps)
      if (map.values[at] >= 0) values.push_back(map.values[at]);
    if (values.empty()) continue;
    const auto middle = values.begin() + std::ptrdiff_t((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    result.values[at] = *middle;
  }
  return result;
}

}  // namespace ibr
