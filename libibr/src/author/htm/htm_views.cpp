// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_views.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "author/pixels/cv_view.h"
#include "base/parallel.h"
#include "base/raster.h"

namespace ibr {

PinholeView::PinholeView(const Camera& camera)
    : k_(camera.intrinsics),
      toCamera_(glm::mat3_cast(glm::conjugate(camera.pose.rotation))),
      toWorld_(glm::mat3_cast(camera.pose.rotation)),
      centre_(camera.pose.position) {}

std::optional<PinholeView::Seen> PinholeView::seen(const glm::dvec3& world) const {
  const glm::dvec3 p = toCamera_ * (world - centre_);
  if (!(p.z < 0)) return std::nullopt;
  return Seen{{k_.cx - k_.fx * p.x / p.z, k_.cy + k_.fy * p.y / p.z}, -p.z};
}

glm::dvec3 PinholeView::point(glm::dvec2 pixel, double depth) const {
  return centre_ + toWorld_ * (depth * glm::dvec3((pixel.x - k_.cx) / k_.fx, (k_.cy - pixel.y) / k_.fy, -1.0));
}

MeshRaster rasterised(const TriangleMesh& mesh, const Camera& camera) {
  const PinholeView view(camera);
  const int width = camera.intrinsics.width, height = camera.intrinsics.height;
  MeshRaster raster{{width, height, 1, MeshRaster::kNone}, {width, height, 1, std::numeric_limits<float>::infinity()}};
  std::vector<std::optional<PinholeView::Seen>> seen;
  seen.reserve(mesh.positions.size());
  for (const glm::dvec3& position : mesh.positions) seen.push_back(view.seen(position));
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto &a = seen[mesh.triangles[f].x], &b = seen[mesh.triangles[f].y], &c = seen[mesh.triangles[f].z];
    if (!a || !b || !c) continue;
    const glm::dvec3 inverse(1 / a->depth, 1 / b->depth, 1 / c->depth);
    forTrianglePixels(a->pixel, b->pixel, c->pixel, width, height, [&](int x, int y, const glm::dvec3& at) {
      const float depth = float(1 / (at.x * inverse.x + at.y * inverse.y + at.z * inverse.z));
      float& nearest = raster.depth.pixel(x, y)[0];
      if (!(depth < nearest)) return;
      nearest = depth;
      raster.face.pixel(x, y)[0] = std::uint32_t(f);
    });
  }
  return raster;
}

namespace {

// Returns the pixel of a row or column that contains a coordinate. Far, infinite and NaN coordinates map outside: a
// point just in front of the camera projects 10¹⁰ px away and farther.
int pixelOf(double at, int size) {
  return int(std::floor(std::fmin(std::fmax(at, -2.0), size + 1.0)));
}

}  // namespace

bool MeshRaster::shows(glm::dvec2 pixel, double at, double tolerance) const {
  // Farthest of the four neighbouring pixels with a face: a slanted surface is as deep as its far side.
  const int x = pixelOf(pixel.x - 0.5, depth.width), y = pixelOf(pixel.y - 0.5, depth.height);
  float farthest = 0;
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx)
      if (x + dx >= 0 && y + dy >= 0 && x + dx < depth.width && y + dy < depth.height)
        if (const float here = depth.pixel(x + dx, y + dy)[0]; std::isfinite(here)) farthest = std::max(farthest, here);
  return farthest == 0 || at <= double(farthest) * (1 + tolerance);
}

bool ProjectedMesh::masked(glm::dvec2 pixel) const {
  if (mask->empty()) return true;
  const int x = std::clamp(pixelOf(pixel.x, mask->width), 0, mask->width - 1),
            y = std::clamp(pixelOf(pixel.y, mask->height), 0, mask->height - 1);
  return mask->pixel(x, y)[0] >= 128;
}

std::optional<glm::dvec2> ProjectedMesh::visible(const glm::dvec3& world) const {
  const auto seen = view.seen(world);
  if (!seen || !view.inside(seen->pixel) || !masked(seen->pixel) || !raster.shows(seen->pixel, seen->depth))
    return std::nullopt;
  return seen->pixel;
}

namespace {

// Returns the image itself, not owned, or a smaller copy.
std::shared_ptr<const Image8> halved(const Image8& image, int halvings) {
  if (halvings == 0 || image.empty()) return {std::shared_ptr<const Image8>(), &image};
  auto small = std::make_shared<Image8>(std::max(1, image.width >> halvings), std::max(1, image.height >> halvings),
                                        image.channels);
  cv::Mat out = cvView(*small);
  cv::resize(cvView(image), out, out.size(), 0, 0, cv::INTER_AREA);
  return small;
}

}  // namespace

std::vector<ProjectedMesh> projectedMeshes(const TriangleMesh& mesh, std::span<const HtmView> views, int halvings,
                                           int threads) {
  std::vector<Camera> cameras;
  std::vector<ProjectedMesh> projected;
  double mostPixels = 0;
  for (const HtmView& view : views) {
    auto picture = halved(view.picture, halvings);
    cameras.push_back({resized(view.camera.intrinsics, picture->width, picture->height), view.camera.pose});
    mostPixels = std::max(mostPixels, double(picture->width) * picture->height);
    projected.push_back({PinholeView(cameras.back()), std::move(picture), halved(view.mask, halvings), {}});
  }
  const double bytes = double(mesh.positions.size()) * sizeof(std::optional<PinholeView::Seen>) +
                       mostPixels * (sizeof(std::uint32_t) + sizeof(float));
  runJobs(
      views.size(), threadsFor(threads, bytes),
      [&](std::size_t i) { projected[i].raster = rasterised(mesh, cameras[i]); }, [](std::size_t) { return true; });
  return projected;
}

}  // namespace ibr
