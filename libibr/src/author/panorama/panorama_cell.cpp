// SPDX-License-Identifier: Apache-2.0
#include "author/panorama/panorama_cell.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "author/cgal/delaunay.h"
#include "author/geometry/simplex.h"
#include "author/match/ranges.h"
#include "author/match/vertices.h"
#include "author/mesh/label.h"
#include "author/panorama/panorama_faces.h"
#include "author/photographs/masks.h"

namespace ibr {
namespace {

constexpr double kFov = kMatchedFaceFov;            // field of view of a face; matches count within 90°
constexpr double kFacePixels = 2e6;                 // maximum pixels of a matched face
constexpr double kNearest = 1.0, kFarthest = 20.0;  // range of assumed points, in units of the members' max distance

struct Face {
  std::vector<MatchView> views;  // of the members, parallel
  DenseMatch match;              // around the members' mean centre, parallel too

  glm::dquat rotation() const { return match.frame.pose.rotation; }
  // Projects a world direction into a face with this face's orientation.
  std::optional<glm::dvec2> pixel(glm::dvec3 direction) const {
    const Intrinsics& k = match.frame.intrinsics;
    const auto at = project(k, glm::conjugate(rotation()) * direction);
    if (!at || at->x < 0 || at->y < 0 || at->x > k.width || at->y > k.height) return std::nullopt;
    return at;
  }
  // Cosine of the angle to the axis: a direction belongs to the cube face with the largest one.
  double towards(glm::dvec3 direction) const { return glm::dot(viewAxis(match.frame.pose), direction); }
};

struct Vertices {
  std::vector<glm::dvec3> direction;         // from the mean centre, unit
  std::vector<std::vector<glm::dvec3>> ray;  // for each member, unit, world
  std::vector<RangeFit> range;

  std::size_t count() const { return direction.size(); }
  std::vector<glm::uvec3> triangulate() const { return delaunaySphere(direction); }
  bool folded(const glm::uvec3& t) const {
    const auto turnsOver = [&](const std::vector<glm::dvec3>& d) {
      constexpr double kMinSolidAngle = 1e-9;  // rad²
      return !(glm::determinant(glm::dmat3(d[t.x], d[t.y], d[t.z])) > kMinSolidAngle);
    };
    return turnsOver(direction) || std::any_of(ray.begin(), ray.end(), turnsOver);
  }
  void keepOnly(const std::vector<bool>& keep) {
    ibr::keepOnly(direction, keep);
    for (auto& list : ray) ibr::keepOnly(list, keep);
    ibr::keepOnly(range, keep);
  }
};

class Maker {
 public:
  Maker(std::span<const PanoramaView> views, std::span<const glm::dvec3> points, const MatchOptions& options)
      : views_(views) {
    std::vector<glm::dvec3> places;
    for (const PanoramaView& view : views) {
      places.push_back(view.camera.pose.position);
      centre_ += view.camera.pose.position / double(views.size());
    }
    for (const glm::dvec3 point : points) distances_.push_back(glm::distance(point, centre_));
    if (distances_.empty()) distances_ = {kNearest * longestEdge(places), kFarthest * longestEdge(places)};
    // The cube has the first member's orientation, so that floor and sky fill a face each.
    for (const glm::dquat turn : cubeRotations())
      faces_.push_back(matched(views[0].camera.pose.rotation * turn, options));
  }

  CellMesh run() {
    collect();
    triangles_ = triangulateAndRepair(vertices_);
    return labelled();
  }

 private:
  Face matched(glm::dquat rotation, const MatchOptions& options) const {
    Face face;
    for (const PanoramaView& view : views_) {
      const Intrinsics intrinsics = faceIntrinsics(matchedFaceSide(view.picture.width), kFov);
      const glm::dquat turn = glm::conjugate(view.camera.pose.rotation) * rotation;
      MatchView& seen = face.views.emplace_back();
      seen.camera = {intrinsics, {view.camera.pose.position, rotation}};
      seen.picture = PanoramaSampler(view.picture).view(intrinsics, turn);
      if (!view.mask.empty()) seen.mask = binaryMask(PanoramaSampler(view.mask).view(intrinsics, turn));
    }
    std::vector<glm::dvec3> onAxis;  // points at the depths' range, along the face's axis
    for (const double distance : distances_) onAxis.push_back(centre_ + distance * (rotation * glm::dvec3(0, 0, -1)));
    face.match = matchViews(face.views, onAxis, options);
    return face;
  }

  void collect() {
    vertices_.ray.resize(views_.size());
    for (const Face& face : faces_) {
      const MatchedVertices found = matchedVertices(face.views, face.match);
      std::vector<Camera> cameras;
      for (const MatchView& view : face.views) cameras.push_back(view.camera);
      const RangePrior levels{0, kPriorLevels * double(face.match.inverseDepthStep)};
      for (std::size_t v = 0; v < found.frame.size(); ++v) {
        const glm::dvec3 inFace = unproject(face.match.frame.intrinsics, glm::dvec2(found.frame[v]));
        if (std::max(std::abs(inFace.x), std::abs(inFace.y)) > -inFace.z) continue;
        std::vector<glm::dvec2> pixels;
        for (std::size_t i = 0; i < views_.size(); ++i) {
          pixels.emplace_back(found.matched[i][v]);
          vertices_.ray[i].push_back(face.rotation() * unproject(cameras[i].intrinsics, pixels[i]));
        }
        vertices_.direction.push_back(face.rotation() * inFace);
        vertices_.range.push_back(
            triangulate(face.match.frame, cameras, pixels, {found.inverseDepth[v], levels.deviation}, kNoisePx));
      }
    }
  }

  // Labels all triangles; triangles that leave the face of their centre count as disagreeing.
  std::vector<TriangleLabel> labels() const {
    TriangleLabel unseen;
    unseen.off = 1;
    std::vector<TriangleLabel> all(triangles_.size(), unseen);
    for (const Face& face : faces_) {
      std::vector<glm::uvec3> inside;
      std::vector<std::size_t> number;
      std::vector<glm::vec2> frame(vertices_.count());
      std::vector<std::vector<glm::vec2>> member(views_.size(), frame);
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const glm::uvec3& corner = triangles_[t];
        if (cubeFaceTowards(middle(corner)) != &face || !place(face, corner, frame, member)) continue;
        inside.push_back(corner);
        number.push_back(t);
      }
      const std::vector<TriangleLabel> found = labelTriangles(face.views, face.match, frame, member, inside);
      for (std::size_t i = 0; i < found.size(); ++i) all[number[i]] = found[i];
    }
    return all;
  }

  glm::dvec3 middle(const glm::uvec3& t) const {
    return vertices_.direction[t.x] + vertices_.direction[t.y] + vertices_.direction[t.z];
  }
  const Face* cubeFaceTowards(glm::dvec3 direction) const {
    return &*std::max_element(faces_.begin(), faces_.end(), [&](const Face& a, const Face& b) {
      return a.towards(direction) < b.towards(direction);
    });
  }
  // Projects the corners into a face's images; returns false if a corner is outside.
  bool place(const Face& face, const glm::uvec3& corner, std::vector<glm::vec2>& frame,
             std::vector<std::vector<glm::vec2>>& member) const {
    for (int k = 0; k < 3; ++k) {
      const unsigned v = corner[k];
      const auto at = face.pixel(vertices_.direction[v]);
      if (!at) return false;
      frame[v] = glm::vec2(*at);
      for (std::size_t i = 0; i < views_.size(); ++i) {
        const Intrinsics& intrinsics = face.views[i].camera.intrinsics;
        const auto seen = project(intrinsics, glm::conjugate(face.rotation()) * vertices_.ray[i][v]);
        if (!seen || seen->x < 0 || seen->y < 0 || seen->x > intrinsics.width || seen->y > intrinsics.height)
          return false;
        member[i][v] = glm::vec2(*seen);
      }
    }
    return true;
  }

  CellMesh labelled() const {
    CellMesh result;
    MorphMesh& mesh = result.mesh;
    const std::vector<TriangleLabel> label = labels();
    double covered = 0, weighted = 0;
    for (const Tier tier : {kTierConsistent, kTierRejected})
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const glm::uvec3& corner = triangles_[t];
        const bool agrees = label[t].agrees() && !vertices_.folded(corner);
        if (agrees != (tier == kTierConsistent)) continue;
        mesh.triangles.push_back(corner);
        mesh.tier.push_back(tier);
        mesh.ecc.push_back(label[t].ecc);
        if (!agrees) continue;
        const auto& d = vertices_.direction;
        const double size = solidAngle(d[corner.x], d[corner.y], d[corner.z]);
        covered += size;
        weighted += size * double(label[t].ecc);
      }
    result.quality.coverage = std::min(covered / (4 * std::numbers::pi), 1.0);  // of the sphere; rounding may exceed 1
    if (covered > 0) result.quality.ecc = weighted / covered;

    mesh.match.resize(views_.size());
    mesh.ratio.resize(views_.size());
    std::vector<double> residuals;
    for (std::size_t v = 0; v < vertices_.count(); ++v) {
      const RangeFit& range = vertices_.range[v];
      mesh.inverseDistance.push_back(float(range.inverseDistance));
      mesh.uncertainty.push_back(float(range.uncertainty));
      residuals.push_back(range.residualPx);
      for (std::size_t i = 0; i < views_.size(); ++i) {
        const Camera& camera = views_[i].camera;
        mesh.ratio[i].push_back(float(range.ratio[i]));
        mesh.match[i].emplace_back(
            *project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * vertices_.ray[i][v]));
      }
    }
    if (!residuals.empty()) {
      const auto half = residuals.begin() + std::ptrdiff_t(residuals.size() / 2);
      std::nth_element(residuals.begin(), half, residuals.end());
      result.quality.residualPx = *half;
    }
    return result;
  }

  std::span<const PanoramaView> views_;
  glm::dvec3 centre_{0.0};
  std::vector<double> distances_;
  std::vector<Face> faces_;
  Vertices vertices_;
  std::vector<glm::uvec3> triangles_;
};

}  // namespace

int matchedFaceSide(int panoramaWidth) {
  return std::min(faceSize(panoramaWidth, kFov), int(std::sqrt(kFacePixels)));
}

CellMesh makePanoramaCell(std::span<const PanoramaView> views, std::span<const glm::dvec3> points,
                          const MatchOptions& options) {
  return Maker(views, points, options).run();
}

}  // namespace ibr
