// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/baselines.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <list>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/eval/exposed_picture.h"
#include "author/eval/lumigraph.h"
#include "author/geometry/posed_model.h"
#include "base/bilinear.h"
#include "base/check.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/image_file.h"
#include "scene/reprojection.h"

namespace ibr {
namespace {

constexpr int kProxySide = 1024;            // px, longest side of a view's proxy
constexpr std::size_t kProxyMaps = 8;       // photographs whose depth maps make the proxy
constexpr std::size_t kMaxCandidates = 24;  // candidate photographs per view
constexpr std::size_t kVotesPerPart = 6;    // photographs that each part of the view votes for
constexpr float kMinConsensus = 0.15f;      // of depth; completed depth has less (author/depth/photograph_depth.h)

Camera scaledCamera(Camera camera, glm::ivec2 size) {
  camera.intrinsics = resized(camera.intrinsics, size.x, size.y);
  return camera;
}

class PhotographCache {
 public:
  PhotographCache(const Scene& scene, std::uint64_t bytes) : scene_(scene), bytes_(bytes) {}

  const Image8& picture(std::uint32_t node) {
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const auto& entry) { return entry.first == node; });
    if (found != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, found);
      return kept_.front().second;
    }
    const std::filesystem::path file = scene_.folder / scene_.nodes[node].imageFile;
    Image8 picture = readImage(file);
    const Intrinsics& k = scene_.nodes[node].camera.intrinsics;
    check(picture.width == k.width && picture.height == k.height, ErrorCode::invalidInput,
          "{}: the image is {}×{} px, its camera {}×{} px", file.string(), picture.width, picture.height, k.width,
          k.height);
    used_ += picture.values.size();
    while (!kept_.empty() && used_ > bytes_) {
      used_ -= kept_.back().second.values.size();
      kept_.pop_back();
    }
    kept_.emplace_front(node, std::move(picture));
    return kept_.front().second;
  }

 private:
  const Scene& scene_;
  std::uint64_t bytes_, used_ = 0;
  std::list<std::pair<std::uint32_t, Image8>> kept_;  // most recently used first
};

}  // namespace

struct Baselines::State {
  State(const Scene& s, const BaselineOptions& options)
      : scene(s),
        threads(options.threads > 0 ? options.threads : std::max(1, int(std::thread::hardware_concurrency()))),
        photographs(s, options.cacheBytes) {
    check(!scene.nodes.empty(), ErrorCode::invalidInput, "a scene without photographs has no baselines");
    for (const Node& node : scene.nodes) {
      check(node.camera.intrinsics.model == CameraModel::pinhole, ErrorCode::unsupported,
            "{}: is a panorama; baselines support pinhole cameras only", node.name);
      check(node.maskFile.empty(), ErrorCode::unsupported,
            "{}: has a mask, which baselines do not support; leave out --baselines to score the other methods",
            node.name);
    }
    std::vector<double> inverse;
    for (const Cell& cell : scene.cells)
      inverse.insert(inverse.end(), cell.mesh.inverseDistance.begin(), cell.mesh.inverseDistance.end());
    typicalInverseDistance = inverse.empty() ? 0 : median(inverse);
  }

  // The photograph with its exposure correction.
  Image8 shown(std::uint32_t node) {
    const Image8& picture = photographs.picture(node);
    return exposure ? applyGain(picture, *exposure * scene.nodes[node].gain) : picture;
  }

  // Matched depth, and matched depth with completed pixels. At infinity if the scene has no depth.
  struct NodeDepth {
    DepthMap matched, completed;
  };
  const NodeDepth& depthOf(std::uint32_t n) {
    const auto found = depths.find(n);
    if (found != depths.end()) return found->second;
    const Node& node = scene.nodes[n];
    if (node.depthFile.empty()) {
      const Camera camera = scaledCamera(node.camera, {1, 1});
      return depths.emplace(n, NodeDepth{{camera, ImageF(1, 1, 1, kUnknownDepth)}, {camera, ImageF(1, 1, 1, 0.0f)}})
          .first->second;
    }
    DepthMaps maps = readDepthTexture(readKtx2(scene.folder / node.depthFile), node.depthScale);
    const Camera camera = scaledCamera(node.camera, {maps.inverseDepth.width, maps.inverseDepth.height});
    NodeDepth depth{{camera, maps.inverseDepth}, {camera, std::move(maps.inverseDepth)}};
    for (std::size_t p = 0; p < maps.consensus.values.size(); ++p)
      if (maps.consensus.values[p] < kMinConsensus) depth.matched.inverseDepth.values[p] = kUnknownDepth;
    return depths.emplace(n, std::move(depth)).first->second;
  }

  double distanceTo(const Camera& view, std::uint32_t node) const {
    const Pose& pose = scene.nodes[node].camera.pose;
    const double angle = std::acos(std::clamp(glm::dot(viewAxis(view.pose), viewAxis(pose)), -1.0, 1.0));
    return glm::distance(view.pose.position, pose.position) * std::max(typicalInverseDistance, 1e-9) + angle;
  }
  std::uint32_t nearestTo(const Camera& view) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < scene.nodes.size(); ++i)
      if (distanceTo(view, i) < distanceTo(view, best)) best = i;
    return best;
  }

  // Inverse depth of a plane across the view: median of the points inside; 0 if there are none.
  static double medianInverseDepth(const Camera& view, const std::vector<glm::dvec4>& points) {
    std::vector<double> inside;
    for (const glm::dvec4& point : points) {  // homogeneous
      const glm::dvec3 direction =
          glm::conjugate(view.pose.rotation) * (glm::dvec3(point) - point.w * view.pose.position);
      const auto pixel = project(view.intrinsics, direction);
      if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x > view.intrinsics.width ||
          pixel->y > view.intrinsics.height)
        continue;
      inside.push_back(point.w / -direction.z);
    }
    return inside.empty() ? 0 : median(inside);
  }
  std::vector<glm::dvec4> pointsOf(std::uint32_t node) {
    constexpr int kSpacing = 3;  // px; dense enough for a median
    const DepthMap& map = depthOf(node).matched;
    std::vector<glm::dvec4> points;
    for (int y = 0; y < map.inverseDepth.height; y += kSpacing)
      for (int x = 0; x < map.inverseDepth.width; x += kSpacing) {
        const double w = double(map.inverseDepth.pixel(x, y)[0]);
        if (w < 0) continue;
        glm::dvec3 ray = unproject(map.camera.intrinsics, {x + 0.5, y + 0.5});
        ray /= -ray.z;
        points.emplace_back(map.camera.pose.rotation * ray + w * map.camera.pose.position, w);
      }
    return points;
  }

  // Weighted mean of the photographs, projected onto one plane.
  Image8 onPlane(const Camera& view, double inverseDepth,
                 const std::vector<std::pair<std::uint32_t, double>>& weights) {
    const int width = view.intrinsics.width, height = view.intrinsics.height;
    ImageF sum(width, height, 4);  // colours and weight
    for (const auto& [node, weight] : weights) {
      if (!(weight > 0)) continue;
      const Image8 picture = shown(node);
      const Reprojection towards(view, scene.nodes[node].camera);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const glm::dvec3 direction = towards.ray({x + 0.5, y + 0.5}) + inverseDepth * towards.shift();
          if (!(direction.z < 0)) continue;
          const glm::dvec2 pixel = towards.pixel(direction);
          if (!towards.inside(pixel)) continue;
          const glm::dvec3 colour = bilinear(picture, pixel);
          const auto to = sum.pixel(x, y);
          for (int c = 0; c < 3; ++c) to[std::size_t(c)] += float(weight * colour[c]);
          to[3] += float(weight);
        }
    }
    Image8 result(width, height, 4, 0);
    for (std::size_t at = 0; at < result.values.size(); at += 4) {
      const float weight = sum.values[at + 3];
      if (!(weight > 0)) continue;
      for (std::size_t c = 0; c < 3; ++c)
        result.values[at + c] = std::uint8_t(std::lround(sum.values[at + c] / weight));
      result.values[at + 3] = 255;
    }
    return result;
  }

  // Photographs that vote for parts of the view, sorted by number of votes, then by index.
  std::vector<std::uint32_t> candidates(const Camera& view) {
    constexpr int kParts = 16;
    const double inverseDepth = medianInverseDepth(view, pointsOf(nearestTo(view)));
    std::vector<std::size_t> votes(scene.nodes.size(), 0);
    std::vector<Reprojection> towards;
    for (const Node& node : scene.nodes) towards.emplace_back(view, node.camera);
    for (int part = 0; part < kParts * kParts; ++part) {
      const glm::dvec2 pixel((part % kParts + 0.5) / kParts * view.intrinsics.width,
                             (part / kParts + 0.5) / kParts * view.intrinsics.height);
      std::vector<std::pair<double, std::uint32_t>> seen;
      for (std::uint32_t i = 0; i < towards.size(); ++i) {
        const glm::dvec3 ray = towards[i].ray(pixel), direction = ray + inverseDepth * towards[i].shift();
        if (!(direction.z < 0) || !towards[i].inside(towards[i].pixel(direction))) continue;
        // The distance breaks ties: with the plane at infinity all angles would be 0.
        seen.emplace_back(std::acos(std::clamp(glm::dot(glm::normalize(ray), glm::normalize(direction)), -1.0, 1.0)) +
                              1e-3 * distanceTo(view, i),
                          i);
      }
      std::sort(seen.begin(), seen.end());
      for (std::size_t k = 0; k < std::min(seen.size(), kVotesPerPart); ++k) ++votes[seen[k].second];
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < votes.size(); ++i)
      if (votes[i] > 0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return votes[a] > votes[b]; });
    order.resize(std::min(order.size(), kMaxCandidates));
    return order;
  }

  Image8 lumigraph(const Camera& view) {
    const std::vector<std::uint32_t> chosen = candidates(view);
    std::vector<const DepthMap*> maps;
    for (const std::uint32_t node : chosen) maps.push_back(&depthOf(node).completed);
    const double scale = std::min(1.0, double(kProxySide) / std::max(view.intrinsics.width, view.intrinsics.height));
    const Camera small = scaledCamera(
        view, {std::max(1, int(view.intrinsics.width * scale)), std::max(1, int(view.intrinsics.height * scale))});
    LumigraphImage picture(view, proxyDepth(small, std::span(maps).first(std::min(maps.size(), kProxyMaps)), threads),
                           {.threads = threads});
    for (std::size_t i = 0; i < chosen.size(); ++i)
      picture.add(scene.nodes[chosen[i]].camera, shown(chosen[i]), *maps[i]);
    return picture.picture();
  }

  const Scene& scene;
  int threads;
  double typicalInverseDistance = 0;
  PhotographCache photographs;
  std::optional<glm::dvec3> exposure;
  std::map<std::uint32_t, NodeDepth> depths;
};

Baselines::Baselines(const Scene& scene, const BaselineOptions& options)
    : state_(std::make_unique<State>(scene, options)) {}
Baselines::Baselines(Baselines&&) noexcept = default;
Baselines::~Baselines() = default;

void Baselines::setExposure(const std::optional<glm::dvec3>& exposure) {
  state_->exposure = exposure;
}

Image8 Baselines::nearest(const Camera& view) {
  const std::uint32_t node = state_->nearestTo(view);
  return state_->onPlane(view, State::medianInverseDepth(view, state_->pointsOf(node)), {{node, 1.0}});
}

Image8 Baselines::lumigraph(const Camera& view) {
  return state_->lumigraph(view);
}

Image8 Baselines::crossFade(const Camera& view, const Cell& cell, std::span<const double> weights) {
  std::vector<glm::dvec4> points;
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p)
    if (const auto position = vertexPosition(state_->scene, cell, p)) points.emplace_back(*position, 1.0);
  std::vector<std::pair<std::uint32_t, double>> members;
  for (std::size_t i = 0; i < cell.members.size(); ++i) members.emplace_back(cell.members[i], weights[i]);
  return state_->onPlane(view, State::medianInverseDepth(view, points), members);
}

}  // namespace ibr
