// SPDX-License-Identifier: Apache-2.0
#include "author/eval/lumigraph.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "author/backdrop/complete_depth.h"
#include "author/geometry/posed_model.h"
#include "base/bilinear.h"
#include "base/parallel.h"
#include "base/raster.h"
#include "scene/reprojection.h"

namespace ibr {
namespace {

constexpr double kMaxStretch = 4;          // max size of a map's pixel in the view, over its size without parallax
constexpr double kSameDepth = 0.04;        // relative inverse depth within which two maps see the same surface; or …
constexpr double kSameFar = 0.02;          // … relative to the view's median inverse depth
constexpr double kHiddenPenalty = 100;     // added to the penalty of occluded photographs, radians
constexpr double kHiddenParallax = 0.006;  // relative to the photograph's width
constexpr double kBorderShare = 0.03;      // width of the fade at the border, relative to the photograph's width
constexpr float kNone = std::numeric_limits<float>::infinity();

void inBands(int height, int threads, const std::function<void(int row)>& job) {
  constexpr int kRows = 16;
  runJobs(
      std::size_t((height + kRows - 1) / kRows), threads,
      [&](std::size_t band) {
        for (int y = int(band) * kRows; y < std::min(height, (int(band) + 1) * kRows); ++y) job(y);
      },
      [](std::size_t) { return true; });
}

// The nearest value that two maps agree on, else the median. Precondition: not empty.
float confirmed(std::vector<float>& depths, double same) {
  std::sort(depths.begin(), depths.end(), std::greater());
  for (std::size_t i = 0; i + 1 < depths.size(); ++i)
    if (double(depths[i] - depths[i + 1]) <= std::max(kSameDepth * double(depths[i]), same))
      return 0.5f * (depths[i] + depths[i + 1]);
  return depths[depths.size() / 2];
}

// Every unknown pixel gets the value of the nearest known one.
void fillFromNearest(ImageF& depth) {
  cv::Mat unknown(depth.height, depth.width, CV_8U);
  std::size_t known = 0;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const bool here = depth.pixel(x, y)[0] >= 0;
      unknown.at<std::uint8_t>(y, x) = here ? 0 : 1;
      known += here;
    }
  if (known == 0) std::fill(depth.values.begin(), depth.values.end(), 0.0f);
  if (known == 0 || known == depth.values.size()) return;
  cv::Mat distance, label;
  cv::distanceTransform(unknown, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<float> ofLabel(known + 1, 0.0f);
  const ImageF before = depth;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (before.pixel(x, y)[0] >= 0) ofLabel.at(std::size_t(label.at<int>(y, x))) = before.pixel(x, y)[0];
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (before.pixel(x, y)[0] < 0) depth.pixel(x, y)[0] = ofLabel.at(std::size_t(label.at<int>(y, x)));
}

}  // namespace

ImageF warpedDepth(const Camera& view, const DepthMap& map) {
  const Reprojection towards(map.camera, view);
  const ImageF& from = map.inverseDepth;
  struct Vertex {
    glm::dvec2 pixel;
    double inverseDepth = kUnknownDepth;
  };
  std::vector<Vertex> vertices(from.values.size());
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) {
      const double w = double(from.pixel(x, y)[0]);
      if (w < 0) continue;
      const glm::dvec3 direction = towards.ray({x + 0.5, y + 0.5}) + w * towards.shift();
      // Skips points almost beside the camera: their depth is too uncertain to be stretched over the view.
      if (!(direction.z < -0.05)) continue;
      vertices[std::size_t(y) * std::size_t(from.width) + std::size_t(x)] = {towards.pixel(direction),
                                                                             w / -direction.z};
    }
  const double longest = kMaxStretch * std::max(view.intrinsics.fx / map.camera.intrinsics.fx, 1.0);
  ImageF depth(view.intrinsics.width, view.intrinsics.height, 1, kUnknownDepth);
  const auto draw = [&](const Vertex& a, const Vertex& b, const Vertex& c) {
    if (a.inverseDepth < 0 || b.inverseDepth < 0 || c.inverseDepth < 0) return;
    const auto tooLong = [&](const Vertex& p, const Vertex& q) {
      return std::abs(p.pixel.x - q.pixel.x) > longest || std::abs(p.pixel.y - q.pixel.y) > longest;
    };
    if (tooLong(a, b) || tooLong(b, c) || tooLong(c, a)) return;
    forTrianglePixels(
        a.pixel, b.pixel, c.pixel, depth.width, depth.height, [&](int x, int y, const glm::dvec3& weights) {
          const double w = weights.x * a.inverseDepth + weights.y * b.inverseDepth + weights.z * c.inverseDepth;
          depth.pixel(x, y)[0] = std::max(depth.pixel(x, y)[0], float(w));
        });
  };
  for (int y = 0; y + 1 < from.height; ++y)
    for (int x = 0; x + 1 < from.width; ++x) {
      const Vertex* const corner = &vertices[std::size_t(y) * std::size_t(from.width) + std::size_t(x)];
      draw(corner[0], corner[1], corner[from.width]);
      draw(corner[1], corner[from.width + 1], corner[from.width]);
    }
  return depth;
}

ImageF proxyDepth(const Camera& view, std::span<const DepthMap* const> maps, int threads) {
  std::vector<ImageF> warped(maps.size());
  runJobs(
      maps.size(), threads, [&](std::size_t i) { warped[i] = warpedDepth(view, *maps[i]); },
      [](std::size_t) { return true; });
  ImageF proxy(view.intrinsics.width, view.intrinsics.height, 1, kUnknownDepth);
  std::vector<double> known;
  for (const ImageF& map : warped)
    for (std::size_t at = 0; at < map.values.size(); at += 7)  // every 7th value suffices for a median
      if (map.values[at] >= 0) known.push_back(double(map.values[at]));
  const double same = known.empty() ? 0 : kSameFar * median(known);
  std::vector<float> depths;
  for (std::size_t at = 0; at < proxy.values.size(); ++at) {
    depths.clear();
    for (const ImageF& map : warped)
      if (map.values[at] >= 0) depths.push_back(map.values[at]);
    if (!depths.empty()) proxy.values[at] = confirmed(depths, same);
  }
  fillFromNearest(proxy);
  return proxy;
}

LumigraphImage::LumigraphImage(const Camera& view, ImageF proxy, const LumigraphOptions& options)
    : view_(view), proxy_(std::move(proxy)), options_(options) {
  const auto pixels = std::size_t(view.intrinsics.width) * std::size_t(view.intrinsics.height);
  candidates_.resize(pixels * std::size_t(options.best + 1), Candidate{kNone, {}});
}

void LumigraphImage::add(const Camera& photograph, const Image8& picture, const DepthMap& depth) {
  inBands(view_.intrinsics.height, options_.threads, [&](int y) { addRow(y, photograph, picture, depth); });
}

void LumigraphImage::addRow(int y, const Camera& photograph, const Image8& picture, const DepthMap& depth) {
  const Reprojection towards(view_, photograph);
  const Intrinsics &from = view_.intrinsics, &to = photograph.intrinsics;
  const double baseline = glm::length(towards.shift());
  const double mapScale = double(depth.inverseDepth.width) / to.width;
  const double hiddenInverseDepth = baseline > 0 ? kHiddenParallax * to.width / (to.fx * baseline) : kNone;
  for (int x = 0; x < from.width; ++x) {
    const double w = double(proxy_.pixel(x * proxy_.width / from.width, y * proxy_.height / from.height)[0]);
    const glm::dvec3 ray = towards.ray({x + 0.5, y + 0.5}), direction = ray + w * towards.shift();
    if (!(direction.z < 0)) continue;
    const glm::dvec2 pixel = towards.pixel(direction);
    if (!towards.inside(pixel)) continue;
    const double here = glm::length(ray), there = glm::length(direction);
    const double angle = std::acos(std::clamp(glm::dot(ray, direction) / (here * there), -1.0, 1.0));
    const double coarser = std::log2(there * from.fx / (here * to.fx));
    double penalty = angle < 1e-7 ? 0 : angle;
    if (penalty > 0) penalty += options_.resolutionWeight * std::max(coarser, 0.0);
    const double border = std::min(std::min(pixel.x, to.width - pixel.x), std::min(pixel.y, to.height - pixel.y));
    penalty /= std::clamp(border / (kBorderShare * to.width), 1e-6, 1.0);
    const glm::ivec2 own(std::clamp(int(pixel.x * mapScale), 0, depth.inverseDepth.width - 1),
                         std::clamp(int(pixel.y * mapScale), 0, depth.inverseDepth.height - 1));
    if (double(depth.inverseDepth.pixel(own.x, own.y)[0]) - w / -direction.z > hiddenInverseDepth)
      penalty += kHiddenPenalty;

    Candidate* const list =
        &candidates_[(std::size_t(y) * std::size_t(from.width) + std::size_t(x)) * std::size_t(options_.best + 1)];
    int place = options_.best;
    if (!(float(penalty) < list[place].penalty)) continue;
    for (; place > 0 && float(penalty) < list[place - 1].penalty; --place) list[place] = list[place - 1];
    const glm::dvec3 colour = bilinear(picture, pixel);
    list[place].penalty = float(penalty);
    for (int c = 0; c < 3; ++c) list[place].colour[c] = std::uint8_t(std::lround(colour[c]));
  }
}

Image8 LumigraphImage::picture() const {
  Image8 result(view_.intrinsics.width, view_.intrinsics.height, 4, 0);
  const auto count = std::size_t(options_.best);
  for (std::size_t at = 0; at * (count + 1) < candidates_.size(); ++at) {
    const std::span<const Candidate> list(&candidates_[at * (count + 1)], count + 1);
    if (list[0].penalty == kNone) continue;
    const auto found = std::size_t(std::ranges::find(list, kNone, &Candidate::penalty) - list.begin());
    constexpr double kMinPenalty = 1e-7;  // penalty of a photograph at the view's position, radians
    const double limit =
        found > count ? double(list[count].penalty) : 1.5 * double(list[found - 1].penalty) + kMinPenalty;
    double sum = 0;
    glm::dvec3 colour(0.0);
    for (std::size_t i = 0; i < std::min(found, count); ++i) {
      const double penalty = double(list[i].penalty);
      const double weight = (1 - penalty / limit) / std::max(penalty, kMinPenalty);
      sum += weight;
      for (int c = 0; c < 3; ++c) colour[c] += weight * list[i].colour[c];
    }
    std::uint8_t* const to = &result.values[4 * at];
    for (int c = 0; c < 3; ++c)
      to[c] = sum > 0 ? std::uint8_t(std::lround(colour[c] / sum)) : list[0].colour[c];  // all are equally good
    to[3] = 255;
  }
  return result;
}

}  // namespace ibr
