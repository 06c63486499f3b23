// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include "author/htm/htm_adjacency.h"
#include "author/htm/htm_robust_weight.h"
#include "author/pixels/cv_view.h"
#include "base/check.h"
#include "base/parallel.h"

namespace ibr {

std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3& a = mesh.positions[t.x];
    const glm::dvec3 across = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    for (int k = 0; k < 3; ++k) normals[t[k]] += across;
  }
  for (glm::dvec3& normal : normals)
    if (const double length = glm::length(normal); length > 0) normal /= length;
  return normals;
}

namespace {

// One match of a vertex: a displacement of 1 along the normal moves the image by `along` px.
struct Claim {
  glm::dvec2 along, match;
  glm::dvec3 information;
};
double product(const glm::dvec2& a, const glm::dvec3& w, const glm::dvec2& b) {
  return a.x * (w.x * b.x + w.y * b.y) + a.y * (w.y * b.x + w.z * b.y);
}

// Returns for each vertex the cameras that see it on an outline of the mesh, or of a part of the mesh.
std::vector<CameraSet> outlinesOf(const TriangleMesh& mesh, std::span<const HtmView> views) {
  std::vector<CameraSet> outlines(mesh.positions.size(), 0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const glm::dvec3 centre = PinholeView(views[i].camera).centre();
    std::vector<CameraSet> front(mesh.positions.size(), 0), back = front;  // cameras that see a front (back) face there
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3& a = mesh.positions[t.x];
      const glm::dvec3 normal = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
      for (int k = 0; k < 3; ++k) (glm::dot(normal, centre - a) > 0 ? front : back)[t[k]] = 1;
    }
    for (std::size_t v = 0; v < outlines.size(); ++v) outlines[v] |= (front[v] & back[v]) << i;
  }
  return outlines;
}

// Returns the claims of each vertex's pairs. Matches at an outline without a mask are half
// background and are left out.
std::vector<std::vector<Claim>> claimsOf(const TriangleMesh& mesh, std::span<const HtmView> views,
                                         std::span<const CameraSet> members, std::span<const CameraSet> outlines,
                                         std::span<const VertexMatch> matches) {
  constexpr double kMinCosine = 0.26;
  const std::size_t n = mesh.positions.size(), cameras = views.size();
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  std::vector<PinholeView> pinholes;
  for (const HtmView& view : views) pinholes.emplace_back(view.camera);
  std::vector<std::vector<Claim>> claims(n);
  CameraSet unmasked = 0;
  for (std::size_t i = 0; i < cameras; ++i) unmasked |= CameraSet(views[i].mask.empty()) << i;
  for (std::size_t v = 0; v < n; ++v) {
    const CameraSet mute = outlines[v] & unmasked;
    for (std::size_t j = 0; j < cameras; ++j) {
      if (!((members[v] & ~mute) >> j & 1)) continue;
      const glm::dvec3 away = mesh.positions[v] - pinholes[j].centre();
      const double distance = glm::length(away), cosine = -glm::dot(normals[v], away) / distance;
      if (!(cosine > kMinCosine)) continue;
      // Intersection of camera j's ray with the surface after the surface moves out by a small step.
      const double step = 1e-4 * distance;
      const glm::dvec3 moved = mesh.positions[v] - away * (step / (distance * cosine));
      for (std::size_t i = 0; i < cameras; ++i) {
        const VertexMatch& match = matches[(i * cameras + j) * n + v];
        if (i == j || (mute >> i & 1) || match.information == glm::vec3(0.0f)) continue;
        const auto here = pinholes[i].seen(mesh.positions[v]), there = pinholes[i].seen(moved);
        if (here && there)
          claims[v].push_back(
              {(there->pixel - here->pixel) / step, glm::dvec2(match.displacement), glm::dvec3(match.information)});
      }
    }
  }
  return claims;
}

// Signed distance to the mask's border, px, negative inside; empty without a mask.
cv::Mat distanceToBorder(const Image8& mask) {
  if (mask.empty()) return {};
  cv::Mat object, background, inside, outside;
  cv::threshold(cvView(mask), object, 127, 255, cv::THRESH_BINARY);
  cv::bitwise_not(object, background);
  if (cv::countNonZero(object) == 0 || cv::countNonZero(background) == 0) return {};
  cv::distanceTransform(object, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(background, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return outside - inside;
}

// Information of a measurement across an outline only.
glm::dvec3 across(const glm::dvec2& outwards, double worth) {
  return worth * glm::dvec3(outwards.x * outwards.x, outwards.x * outwards.y, outwards.y * outwards.y);
}

struct OutlineClaim {
  std::size_t vertex;
  Claim claim;
};

// Claims of a view's outlines: a vertex on the mesh's outline is drawn to the mask's border if that is near. Without a
// mask the true outline is unknown: the vertex is held where it is.
std::vector<OutlineClaim> outlineClaims(const TriangleMesh& mesh, const HtmView& view, std::size_t camera,
                                        std::span<const CameraSet> outlines) {
  constexpr double kMaxBorderPx = 12, kBorderInformation = 40;  // px; 1 / px²
  const cv::Mat distance = distanceToBorder(view.mask);
  std::vector<OutlineClaim> outlined;
  if (distance.empty() && !view.mask.empty()) return outlined;
  const PinholeView pinhole(view.camera);
  const MeshRaster raster = rasterised(mesh, view.camera);
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  for (std::size_t v = 0; v < outlines.size(); ++v) {
    const auto here = outlines[v] >> camera & 1 ? pinhole.seen(mesh.positions[v]) : std::nullopt;
    if (!here || !raster.shows(here->pixel, here->depth, 5e-3)) continue;
    const glm::dvec2 p = here->pixel;
    const double step = 1e-4 * here->depth;
    const auto moved = pinhole.seen(mesh.positions[v] + normals[v] * step);
    if (!moved) continue;
    const glm::dvec2 along = (moved->pixel - p) / step;
    if (view.mask.empty()) {
      if (const double length = glm::length(along); length > 0)
        outlined.push_back({v, {along, glm::dvec2(0), across(along / length, kBorderInformation)}});
      continue;
    }
    if (!(p.x >= 4 && p.y >= 4 && p.x < distance.cols - 4 && p.y < distance.rows - 4)) continue;  // near image border
    const int x = int(p.x), y = int(p.y);
    const double off = distance.at<float>(y, x);
    glm::dvec2 outwards(distance.at<float>(y, x + 2) - distance.at<float>(y, x - 2),
                        distance.at<float>(y + 2, x) - distance.at<float>(y - 2, x));
    const double length = glm::length(outwards);
    if (std::abs(off) > kMaxBorderPx || !(length > 0)) continue;
    outwards /= length;
    outlined.push_back({v, {along, -off * outwards, across(outwards, kBorderInformation)}});
  }
  return outlined;
}

}  // namespace

std::vector<double> normalDisplacements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ShapeOptions& options, const ProgressCallback& progress) {
  constexpr std::size_t kSweeps = 100;
  const auto wanted = [&](std::size_t done) {
    return !progress || progress({"adjusting the shape", done, views.size() + kSweeps});
  };
  constexpr const char* kStopped = "cancelled while adjusting the shape";
  const std::size_t n = mesh.positions.size();
  const Lists neighbours = neighboursOfVertices(mesh);
  const std::vector<CameraSet> outlines = outlinesOf(mesh, views);
  std::vector<std::vector<Claim>> claims = claimsOf(mesh, views, members, outlines, matches);
  std::vector<std::vector<OutlineClaim>> outlined(views.size());
  double mostPixels = 0;
  for (const HtmView& view : views)
    mostPixels = std::max(mostPixels, double(view.camera.intrinsics.width) * view.camera.intrinsics.height);
  constexpr double kBytesPerPixel = 24;  // memory of distances, masks and the rasterised mesh
  const bool finished = runJobs(
      views.size(), threadsFor(options.threads, mostPixels * kBytesPerPixel),
      [&](std::size_t i) { outlined[i] = outlineClaims(mesh, views[i], i, outlines); }, wanted);
  check(finished, ErrorCode::cancelled, kStopped);
  for (const std::vector<OutlineClaim>& ofView : outlined)
    for (const OutlineClaim& o : ofView) claims[o.vertex].push_back(o.claim);
  std::vector<double> scale(n, 0), displacement(n, 0);  // scale: px² per unit²
  double typical = 0, known = 0;
  for (std::size_t v = 0; v < n; ++v) {
    for (const Claim& claim : claims[v]) scale[v] += glm::dot(claim.along, claim.along) / double(claims[v].size());
    if (!claims[v].empty()) typical += scale[v], ++known;
  }
  if (known == 0) return displacement;
  typical /= known;
  for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
    check(wanted(views.size() + sweep), ErrorCode::cancelled, kStopped);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t v = sweep % 2 == 0 ? k : n - 1 - k;
      double weight = 0, side = 0;
      for (const Claim& claim : claims[v]) {
        const glm::dvec2 off = claim.match - claim.along * displacement[v];
        const double trust = sweep < kSweeps / 4 ? 1.0 : robustWeight(claim.information, off, options.outlierPx);
        weight += trust * product(claim.along, claim.information, claim.along);
        side += trust * product(claim.along, claim.information, claim.match);
      }
      const double smooth = options.smoothness * (claims[v].empty() ? typical : scale[v]);
      for (const std::uint32_t u : neighbours[v]) weight += smooth, side += smooth * displacement[u];
      if (weight > 0) displacement[v] = side / weight;
    }
  }
  return displacement;
}

TriangleMesh displaced(const TriangleMesh& mesh, std::span<const double> displacements) {
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  TriangleMesh moved = mesh;
  for (std::size_t v = 0; v < moved.positions.size(); ++v) moved.positions[v] += normals[v] * displacements[v];
  const auto normalOf = [](const TriangleMesh& m, const glm::uvec3& t) {
    return glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]);
  };
  for (bool turned = true; turned;) {
    turned = false;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 before = normalOf(mesh, t), after = normalOf(moved, t);
      if (before == after || glm::dot(before, after) >= 0.5 * glm::length(before) * glm::length(after)) continue;
      for (int k = 0; k < 3; ++k) {
        turned = turned || moved.positions[t[k]] != mesh.positions[t[k]];
        moved.positions[t[k]] = mesh.positions[t[k]];
      }
    }
  }
  return moved;
}

}  // namespace ibr
