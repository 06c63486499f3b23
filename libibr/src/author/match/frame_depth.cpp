// SPDX-License-Identifier: Apache-2.0
#include "author/match/frame_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <vector>

#include "author/geometry/match_view.h"
#include "base/check.h"
#include "base/raster.h"

namespace ibr {
namespace {

constexpr float kUnknown = -1;
constexpr double kSurfaceSteps = 2;  // maximum step between neighbours of one surface, in MemberDepth::step
constexpr double kToleranceLevels = 2, kRelativeTolerance = 0.01;  // tolerance: in sweep levels, plus a share of ρ

// Returns how much a depth at `there` supports one at `here`, 0 to 1.
double kernel(double here, double there, double step) {
  const double off = (here - there) / (kToleranceLevels * step + kRelativeTolerance * here);
  return std::max(0.0, 1 - off * off);
}

// A pixel of a depth map, projected into the frame.
struct ProjectedPixel {
  glm::dvec2 pixel{0};
  double inverseDepth = -1;  // negative: not visible in the frame
};

std::vector<ProjectedPixel> projectedPixels(const Camera& frame, const MemberDepth& member) {
  const Intrinsics &own = member.camera.intrinsics, &k = frame.intrinsics;
  const glm::dquat toFrame = glm::conjugate(frame.pose.rotation);
  const glm::dmat3 turn = glm::mat3_cast(toFrame * member.camera.pose.rotation);
  const glm::dvec3 shift = toFrame * (member.camera.pose.position - frame.pose.position);
  const bool alongAxis = own.model == CameraModel::pinhole;
  std::vector<ProjectedPixel> places(member.inverseDepth.values.size());
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x) {
      const double inverseDepth = double(member.inverseDepth.pixel(x, y)[0]);
      if (inverseDepth < 0) continue;
      const glm::dvec3 ray = unproject(own, {x + 0.5, y + 0.5});
      const glm::dvec3 direction = turn * (alongAxis ? ray / -ray.z : ray) + inverseDepth * shift;
      if (!(direction.z < 0)) continue;
      places[std::size_t(y) * std::size_t(own.width) + std::size_t(x)] = {
          {k.cx - k.fx * direction.x / direction.z, k.cy + k.fy * direction.y / direction.z},
          inverseDepth / -direction.z};
    }
  return places;
}

// ρ of the nearest part of the member's surface, in the frame's pixels.
ImageF layerOf(const Camera& frame, const MemberDepth& member) {
  const std::vector<ProjectedPixel> places = projectedPixels(frame, member);
  const ImageF& map = member.inverseDepth;
  ImageF layer(frame.intrinsics.width, frame.intrinsics.height, 1, kUnknown);
  const auto draw = [&](std::size_t a, std::size_t b, std::size_t c) {
    const ProjectedPixel &pa = places[a], &pb = places[b], &pc = places[c];
    if (pa.inverseDepth < 0 || pb.inverseDepth < 0 || pc.inverseDepth < 0) return;
    const auto [low, high] = std::minmax({map.values[a], map.values[b], map.values[c]});
    if (double(high - low) > kSurfaceSteps * member.step) return;
    forTrianglePixels(
        pa.pixel, pb.pixel, pc.pixel, layer.width, layer.height, [&](int x, int y, const glm::dvec3& share) {
          float& here = layer.pixel(x, y)[0];
          here =
              std::max(here, float(share.x * pa.inverseDepth + share.y * pb.inverseDepth + share.z * pc.inverseDepth));
        });
  };
  const bool closed = member.camera.intrinsics.model == CameraModel::equirectangular;
  const auto at = [&](int x, int y) {
    return std::size_t(y) * std::size_t(map.width) + std::size_t(x == map.width ? 0 : x);
  };
  for (int y = 0; y + 1 < map.height; ++y)
    for (int x = 0; x + (closed ? 0 : 1) < map.width; ++x) {
      draw(at(x, y), at(x + 1, y), at(x, y + 1));
      draw(at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
    }
  return layer;
}

// Fills gaps in each row with the lesser ρ of the known pixels on both sides; rows without known pixels become 0.
void fillRows(ImageF& map) {
  const auto width = std::size_t(map.width);
  for (int y = 0; y < map.height; ++y) {
    float* const row = &map.values[std::size_t(y) * width];
    for (std::size_t x = 0; x < width;) {
      if (row[x] >= 0) {
        ++x;
        continue;
      }
      std::size_t end = x;
      while (end < width && row[end] < 0) ++end;
      const float left = x > 0 ? row[x - 1] : kUnknown, right = end < width ? row[end] : kUnknown;
      const float value = left < 0 ? std::max(right, 0.0f) : right < 0 ? left : std::min(left, right);
      std::fill(row + x, row + end, value);
      x = end;
    }
  }
}

}  // namespace

FrameDepth depthOfFrame(const Camera& frame, std::span<const MemberDepth> members, double step) {
  check(members.size() <= kMaxMembers, ErrorCode::invalidInput, "{} members are more than the maximum of {}",
        members.size(), kMaxMembers);
  std::vector<ImageF> layers;
  for (const MemberDepth& member : members) layers.push_back(layerOf(frame, member));
  const int width = frame.intrinsics.width, height = frame.intrinsics.height;
  FrameDepth result{ImageF(width, height, 1, kUnknown), Image8(width, height, 1, 0)};
  for (std::size_t p = 0; p < result.inverseDepth.values.size(); ++p) {
    std::array<double, kMaxMembers> depth{};
    std::array<std::size_t, kMaxMembers> who{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < layers.size(); ++i)
      if (layers[i].values[p] >= 0) {
        who[count] = i;
        depth[count++] = double(layers[i].values[p]);
      }
    if (count == 0) continue;
    double most = 0, best = 0;
    for (std::size_t i = 0; i < count; ++i) {
      double support = 0;
      for (std::size_t j = 0; j < count; ++j) support += kernel(depth[i], depth[j], step);
      if (support > most || (support == most && depth[i] > best)) most = support, best = depth[i];
    }
    double sum = 0, mean = 0;
    for (std::size_t j = 0; j < count; ++j) {
      const double weight = kernel(best, depth[j], step);
      sum += weight;
      mean += weight * depth[j];
      if (weight > 0) result.agree.values[p] |= std::uint8_t(1u << who[j]);
    }
    result.inverseDepth.values[p] = float(mean / sum);
  }
  fillRows(result.inverseDepth);
  return result;
}

}  // namespace ibr
