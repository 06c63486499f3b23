// SPDX-License-Identifier: Apache-2.0
#include "render/plan/occlusion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "render/plan/correction.h"
#include "render/plan/culling.h"

namespace ibr {

CoverMask::CoverMask(int width, int height, double marginPx)
    : width_(width),
      height_(height),
      columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      margin_(marginPx),
      covered_(std::size_t(columns_) * std::size_t(rows_)) {}

// Marks tiles that come within the margin of the edge, row by row.
void CoverMask::touch(const Edge& edge) {
  const glm::dvec2 a = edge.from.y < edge.to.y ? edge.from : edge.to, b = edge.from.y < edge.to.y ? edge.to : edge.from;
  const auto tile = [](double at, int count) {
    return int(std::clamp(std::floor(at / kTile), 0.0, double(count - 1)));
  };
  if (b.y + margin_ < 0 || a.y - margin_ > rows_ * kTile) return;
  for (int row = tile(a.y - margin_, rows_), last = tile(b.y + margin_, rows_); row <= last; ++row) {
    double left = std::min(a.x, b.x), right = std::max(a.x, b.x);
    if (b.y > a.y) {
      const auto xAt = [&](double y) { return a.x + (b.x - a.x) * std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0); };
      const double top = xAt(row * kTile - margin_), bottom = xAt((row + 1) * kTile + margin_);
      left = std::min(top, bottom);
      right = std::max(top, bottom);
    }
    if (right + margin_ < 0 || left - margin_ > columns_ * kTile) continue;
    for (int column = tile(left - margin_, columns_), end = tile(right + margin_, columns_); column <= end; ++column)
      touched_[index(column, row)] = true;
  }
}

// Counts a crossing in every row of tile centres that the edge passes: winding changes for all centres to its right.
void CoverMask::cross(const Edge& edge) {
  const double low = std::min(edge.from.y, edge.to.y), high = std::max(edge.from.y, edge.to.y);
  const auto firstCentre = [](double at, int count) {  // at or after the coordinate
    return int(std::clamp(std::ceil(at / kTile - 0.5), 0.0, double(count)));
  };
  for (int row = firstCentre(low, rows_); row < rows_ && (row + 0.5) * kTile < high; ++row) {
    const double share = ((row + 0.5) * kTile - edge.from.y) / (edge.to.y - edge.from.y);
    const int column = firstCentre(edge.from.x + share * (edge.to.x - edge.from.x), columns_);
    if (column < columns_) winding_[index(column, row)] += edge.from.y < edge.to.y ? 1 : -1;
  }
}

void CoverMask::add(std::span<const Edge> outline) {
  touched_.assign(covered_.size(), false);
  winding_.assign(covered_.size(), 0);
  for (const Edge& edge : outline) {
    touch(edge);
    cross(edge);
  }
  for (int row = 0; row < rows_; ++row)
    for (int column = 0, winding = 0; column < columns_; ++column) {
      winding += winding_[index(column, row)];
      if (winding != 0 && !touched_[index(column, row)]) covered_[index(column, row)] = true;
    }
}

std::vector<CoverMask::Rectangle> CoverMask::open() const {
  constexpr int kBlock = 8;  // tiles; one rectangle per block
  std::vector<Rectangle> rectangles;
  for (int y0 = 0; y0 < rows_; y0 += kBlock)
    for (int x0 = 0; x0 < columns_; x0 += kBlock) {
      int left = columns_, right = -1, top = rows_, bottom = -1;
      for (int y = y0; y < std::min(y0 + kBlock, rows_); ++y)
        for (int x = x0; x < std::min(x0 + kBlock, columns_); ++x)
          if (!covered(x, y)) {
            left = std::min(left, x), right = std::max(right, x);
            top = std::min(top, y), bottom = std::max(bottom, y);
          }
      if (right >= 0)
        rectangles.push_back({left * kTile - margin_, top * kTile - margin_,
                              std::min((right + 1) * kTile, width_) + margin_,
                              std::min((bottom + 1) * kTile, height_) + margin_});
    }
  return rectangles;
}

namespace {

// Cover of the cells drawn so far in one view, and the open rest of the image.
class ViewCover {
 public:
  ViewCover(const Scene& scene, const FramePlan& plan, std::size_t view)
      : scene_(scene),
        camera_(plan.views[view]),
        mask_(camera_.intrinsics.width, camera_.intrinsics.height,
              1.5 * std::max(1.0, 1.0 / plan.settings.renderScale)) {
    findOpen();
  }

  glm::dvec3 eye() const { return camera_.pose.position; }

  bool mayShow(const Cell& cell, const CellBounds& bounds, const Placement& placement) const {
    return std::ranges::any_of(open_, [&](const std::array<glm::dvec3, 4>& planes) {
      return mayBeVisible(scene_, cell, bounds, planes, placement);
    });
  }

  void draw(const Cell& cell, const CellBounds& bounds, const Placement& placement) {
    if (bounds.outline.empty() || !isInFront(cell, bounds, placement)) return;
    const auto& [weights, morph, eye, correction] = placement;
    const glm::dquat rotation = glm::conjugate(camera_.pose.rotation);
    glm::dvec3 shift(0.0);
    std::array<glm::dmat3, 4> toView;
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const Pose& pose = scene_.nodes[cell.members[i]].camera.pose;
      toView[i] = weights[i] * glm::mat3_cast(rotation * correction.rotation * glm::normalize(pose.rotation));
      shift += weights[i] * (pose.position - eye);
    }
    shift = rotation * corrected(correction, shift, eye);
    std::vector<glm::dvec2> pixels;
    for (const CellBounds::Corner& corner : bounds.corners) {
      glm::dvec3 d = morph == Morph::paper ? glm::dvec3(0.0) : double(corner.inverseDistance) * shift;
      for (std::size_t i = 0; i < cell.members.size(); ++i) {
        const glm::dvec3 q(corner.point[i]);
        d += toView[i] * (morph == Morph::paper ? glm::normalize(q) : q);
      }
      const Intrinsics& k = camera_.intrinsics;
      const glm::dvec2 at(k.cx - k.fx * d.x / d.z, k.cy + k.fy * d.y / d.z);
      if (!(std::abs(at.x) < 1e7 && std::abs(at.y) < 1e7)) return;
      pixels.push_back(at);
    }
    std::vector<CoverMask::Edge> outline;
    for (const glm::uvec2 edge : bounds.outline) outline.push_back({pixels[edge.x], pixels[edge.y]});
    mask_.add(outline);
    findOpen();
  }

 private:
  // True if all vertices are in front of the camera, by their bounding boxes: behind it, a projection is not a map.
  bool isInFront(const Cell& cell, const CellBounds& bounds, const Placement& placement) const {
    const glm::dvec3 backward = camera_.pose.rotation * glm::dvec3(0, 0, 1);
    const std::array<glm::dvec3, 4> planes{backward, backward, backward, backward};
    return !mayBeVisible(scene_, cell, bounds, planes, placement);
  }

  void findOpen() {
    open_.clear();
    for (const CoverMask::Rectangle& part : mask_.open()) {
      const Intrinsics& k = camera_.intrinsics;
      open_.push_back({});
      const double left = (part.left - k.cx) / k.fx, right = (part.right - k.cx) / k.fx;
      const double bottom = (k.cy - part.bottom) / k.fy, top = (k.cy - part.top) / k.fy;
      const std::array<glm::dvec3, 4> inward{
          {{1, 0, left}, {-1, 0, -right}, {0, 1, bottom}, {0, -1, -top}}};  // as render/plan/culling.cpp
      for (std::size_t p = 0; p < 4; ++p) open_.back()[p] = camera_.pose.rotation * inward[p];
    }
  }

  const Scene& scene_;
  Camera camera_;
  CoverMask mask_;
  std::vector<std::array<glm::dvec3, 4>> open_;  // planes of each open rectangle
};

}  // namespace

void markHidden(const Scene& scene, const SceneBounds& bounds, FramePlan& plan) {
  std::vector<ViewCover> views;
  for (std::size_t v = 0; v < plan.views.size(); ++v) views.emplace_back(scene, plan, v);
  const auto hidden = [&](const Cell& cell, const CellBounds& cellBounds, const auto& placementIn) {
    for (std::size_t v = 0; v < views.size(); ++v)
      if (views[v].mayShow(cell, cellBounds, placementIn(v))) return false;
    return true;
  };
  for (PlannedCell& planned : plan.cells) {  // cells that fade out are drawn too, but hide nothing
    const Cell& cell = scene.cells[planned.cell];
    const CellBounds& cellBounds = bounds.cells[planned.cell];
    const auto placementIn = [&](std::size_t v) {
      return Placement{planned.view[v].position, plan.settings.morph, views[v].eye(), planned.correction};
    };
    planned.hidden = hidden(cell, cellBounds, placementIn);
    if (planned.hidden || planned.opacity < 1 || isMasked(scene, cell)) continue;  // masks leave holes
    for (std::size_t v = 0; v < views.size(); ++v) views[v].draw(cell, cellBounds, placementIn(v));
  }
}

}  // namespace ibr
