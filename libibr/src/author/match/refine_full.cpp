// SPDX-License-Identifier: Apache-2.0
#include "author/match/refine_full.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "author/geometry/mean_frame.h"
#include "author/photographs/masks.h"

namespace ibr {
namespace {

constexpr int kRadius = 5, kSide = 2 * kRadius + 1, kCount = kSide * kSide;  // px of the full-size photograph
constexpr int kSlopeRadius = 2;                                              // px of the frame
constexpr double kMaxSurfaceLevels = 4;                                      // maximum difference of depth, sweep steps
constexpr double kMaxMotionPx = 1.0;                                         // maximum motion of a match, view's px
constexpr double kPriorDeviationPx = 0.5;      // standard deviation of a match, px of the view
constexpr double kEpipolarDeviationPx = 0.02;  // the same across the epipolar line, for exact poses
constexpr double kNoise = 4.0;                 // grey levels
constexpr double kMinSpread = 2.0;             // minimum contrast, grey levels
constexpr double kConvergencePx = 0.01;        // px
constexpr int kMaxIterations = 10;

using Patch = std::array<glm::dvec2, kCount>;  // px
struct Values {
  std::array<double, kCount> grey;
  std::array<glm::dvec2, kCount> slope;
  double mean = 0, spread = 0;
};

// Samples grey values and their derivatives; returns false if part of the patch lies outside.
bool sample(const Image8& picture, const Patch& patch, glm::dvec2 shift, Values& values) {
  double sum = 0, square = 0;
  for (std::size_t k = 0; k < kCount; ++k) {
    const glm::dvec2 at = patch[k] + shift - 0.5;
    if (!(at.x >= 0 && at.y >= 0 && at.x < picture.width - 1 && at.y < picture.height - 1)) return false;
    const int x = int(at.x), y = int(at.y);
    const double fx = at.x - x, fy = at.y - y;
    const std::uint8_t* const p = &picture.values[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
    const double a = p[0], b = p[1], c = p[picture.width], e = p[picture.width + 1], mixed = a - b - c + e;
    values.grey[k] = a + fx * (b - a) + fy * (c - a) + fx * fy * mixed;
    values.slope[k] = {b - a + fy * mixed, c - a + fx * mixed};
    sum += values.grey[k];
    square += values.grey[k] * values.grey[k];
  }
  values.mean = sum / kCount;
  values.spread = std::sqrt(std::max(square / kCount - values.mean * values.mean, 0.0));
  return true;
}

class Refiner {
 public:
  Refiner(std::span<const MatchView> views, std::span<const Image8> full, const DenseMatch& match)
      : views_(views), full_(full), match_(match) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      maps_.push_back(frameToMember(match.frame, views[i].camera));
      scale_.emplace_back(double(full[i].width) / views[i].picture.width,
                          double(full[i].height) / views[i].picture.height);
    }
  }

  void vertex(MatchedVertices& vertices, std::size_t v) const {
    const glm::dvec2 pixel(vertices.frame[v]);
    const double w = vertices.inverseDepth[v];
    const glm::dvec2 slope = slopeAt(pixel, w);
    Patch patch;
    Values first, other;
    if (isIgnored(views_[0].mask, vertices.matched[0][v])) return;
    if (!place(0, pixel, w, slope, vertices.matched[0][v], patch) || !sample(full_[0], patch, {0, 0}, first) ||
        first.spread < kMinSpread)
      return;
    for (std::size_t i = 1; i < views_.size(); ++i) {
      const glm::dvec2 matched(vertices.matched[i][v]);
      if (isIgnored(views_[i].mask, matched) || !place(i, pixel, w, slope, matched, patch)) continue;
      const glm::dmat2 held = prior(i, glm::dvec2(vertices.matched[0][v]), w);
      glm::dvec2 shift(0), step(0), found(0);
      double least = INFINITY;
      for (int round = 0; round < kMaxIterations; ++round) {
        if (glm::length(shift / scale_[i]) > kMaxMotionPx || !sample(full_[i], patch, shift, other) ||
            other.spread < kMinSpread)
          break;
        const double error = solve(first, other, held, shift, step);
        if (!(error < least)) break;
        least = error;
        found = shift;
        if (glm::length(step) < kConvergencePx) break;
        shift += step;
      }
      vertices.matched[i][v] = glm::vec2(matched + found / scale_[i]);
    }
  }

 private:
  // Returns the gradient of the inverse depth to the right and down, from pixels on the same surface only.
  glm::dvec2 slopeAt(glm::dvec2 pixel, double w) const {
    const ImageF& depth = match_.inverseDepth;
    const double limit = kMaxSurfaceLevels * double(match_.inverseDepthStep);
    glm::dvec2 along(0), square(0);
    const int cx = int(pixel.x), cy = int(pixel.y);
    for (int y = std::max(cy - kSlopeRadius, 0); y <= std::min(cy + kSlopeRadius, depth.height - 1); ++y)
      for (int x = std::max(cx - kSlopeRadius, 0); x <= std::min(cx + kSlopeRadius, depth.width - 1); ++x) {
        const double off = double(depth.pixel(x, y)[0]) - w;
        if (std::abs(off) > limit) continue;
        const glm::dvec2 away = glm::dvec2(x + 0.5, y + 0.5) - pixel;
        along += off * away;
        square += away * away;
      }
    return {square.x > 0 ? along.x / square.x : 0, square.y > 0 ? along.y / square.y : 0};
  }

  // Builds the patch around `matched`, a position in the view, in px of the full-size photograph. Its sides are kSide
  // px of the first member's photograph.
  bool place(std::size_t i, glm::dvec2 pixel, double w, glm::dvec2 slope, glm::dvec2 matched, Patch& patch) const {
    const auto centre = maps_[i](pixel, w);
    if (!centre) return false;
    for (int k = 0; k < kCount; ++k) {
      const glm::dvec2 away = glm::dvec2(k % kSide - kRadius, k / kSide - kRadius) / scale_[0];
      const auto at = maps_[i](pixel + away, w + glm::dot(slope, away));
      if (!at) return false;
      patch[std::size_t(k)] = (matched + (*at - *centre)) * scale_[i];
    }
    return true;
  }

  // Prior weight of a shift from the match, grey² per px² of the full-size photograph.
  glm::dmat2 prior(std::size_t i, glm::dvec2 matchedFirst, double w) const {
    const double size = 0.5 * (scale_[i].x + scale_[i].y);
    const auto weight = [&](double px) { return kNoise * kNoise / (px * px * size * size); };
    glm::dmat2 held(weight(kPriorDeviationPx));
    if (match_.refined) return held;
    // Direction across the epipolar line of the first member's ray in member i.
    const Camera &first = views_[0].camera, &here = views_[i].camera;
    const glm::dvec3 ray = first.pose.rotation * unproject(first.intrinsics, matchedFirst);
    const glm::dvec3 apart = first.pose.position - here.pose.position;
    const auto seen = [&](double inverse) {
      return project(here.intrinsics, glm::conjugate(here.pose.rotation) * (ray + inverse * apart));
    };
    const double more = w + std::max(double(match_.inverseDepthStep), 1e-9);
    const auto near = seen(more), far = seen(w);
    if (!near || !far || !(glm::distance(*near, *far) > 0)) return held;
    const glm::dvec2 line = glm::normalize((*near - *far) * scale_[i]), across(-line.y, line.x);
    return held + (weight(kEpipolarDeviationPx) - weight(kPriorDeviationPx)) * glm::outerProduct(across, across);
  }

  // Returns the sum of squares, prior included; `step` leads to the minimum, to first order.
  static double solve(const Values& first, const Values& other, const glm::dmat2& held, glm::dvec2 shift,
                      glm::dvec2& step) {
    const double gain = first.spread / other.spread;
    glm::dvec2 meanSlope(0);
    for (const glm::dvec2& slope : other.slope) meanSlope += slope / double(kCount);
    glm::dmat2 normal = held;
    glm::dvec2 gradient = held * shift;
    double error = glm::dot(shift, gradient);
    for (std::size_t k = 0; k < kCount; ++k) {
      const double off = gain * (other.grey[k] - other.mean) - (first.grey[k] - first.mean);
      const glm::dvec2 slope = gain * (other.slope[k] - meanSlope);
      normal += glm::outerProduct(slope, slope);
      gradient += off * slope;
      error += off * off;
    }
    step = -(glm::inverse(normal) * gradient);
    return error;
  }

  std::span<const MatchView> views_;
  std::span<const Image8> full_;
  const DenseMatch& match_;
  std::vector<FrameToMember> maps_;
  std::vector<glm::dvec2> scale_;  // full-size photograph over view
};

}  // namespace

void refineAtFullSize(std::span<const MatchView> views, std::span<const Image8> full, const DenseMatch& match,
                      MatchedVertices& vertices) {
  const Refiner refiner(views, full, match);
  for (std::size_t v = 0; v < vertices.frame.size(); ++v) refiner.vertex(vertices, v);
}

}  // namespace ibr
