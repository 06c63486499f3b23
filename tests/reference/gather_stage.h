// SPDX-License-Identifier: Apache-2.0
// Generated scenes for gathering, as data: photographs, backdrop meshes with evidence, depth textures. Includes their
// reference images, and the comparison of a device's image with the reference.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ibr/renderer.h"
#include "ibr/texture.h"
#include "lab/generate/synthetic.h"
#include "reference/composer.h"
#include "reference/stage.h"

namespace ibr::test {

/// Evidence of a vertex from the other photographs.
struct Evidence {
  std::uint8_t confirmations = 3;
  float consensus = 0.95f;
};

struct GatherOptions {
  std::vector<Camera> cameras;
  std::vector<TexturedPlane> planes;
  int gridStep = 8;  // px between the vertices of a backdrop's mesh
  int samplesPerAxis = 2;
  bool atInfinity = false;  // as SyntheticOptions::atInfinity, around the origin: all ρ are 0
  std::function<Evidence(std::size_t node, glm::dvec2 pixel)> evidence;                // none: Evidence{}
  std::function<double(std::size_t node, glm::dvec2 pixel, double rho)> inverseDepth;  // ρ of vertices; empty: exact
};

struct GatherStage {
  SyntheticScene made;                        // nodes with a placeholder depthFile, backdrops, no cells
  std::vector<std::vector<Image8>> textures;  // RGBA mip levels, by node
  std::vector<ImageF> depths;                 // content of Node::depthFile, by node: ρ / depthScale, consensus
  TextureFilter filter = TextureFilter::trilinear;

  /// Replaces a photograph. An RGBA image becomes a photograph with a mask.
  void setPhotograph(std::size_t node, Image8 photograph) {
    if (photograph.channels == 4) made.scene.nodes[node].maskFile = "masks/" + made.scene.nodes[node].name + ".png";
    made.photographs[node] = std::move(photograph);
    textures[node] = buildMips(made.photographs[node]);
  }

  /// A plan that uses all photographs with full weight.
  FramePlan plan(std::vector<Camera> views, RenderSettings settings = gatherSettings()) const {
    FramePlan plan;
    plan.views = std::move(views);
    plan.settings = std::move(settings);
    glm::dvec3 middle(0);
    for (const Camera& view : plan.views) middle += view.pose.position / double(plan.views.size());
    for (std::uint32_t n = 0; n < made.scene.nodes.size(); ++n)
      plan.photographs.push_back({n, n, 1.0, glm::distance(made.scene.nodes[n].camera.pose.position, middle)});
    plan.gather = {.spacing = 0.5, .medianInverseDepth = 0.25, .residualPx = 0.3};
    plan.nearDistance = 0.05;
    return plan;
  }
  FramePlan plan(const Camera& view) const { return plan(std::vector{view}); }

  /// Settings in which alpha encodes the tier, holes included.
  static RenderSettings gatherSettings() {
    RenderSettings settings;
    settings.composition = Composition::gathered;
    settings.alpha = AlphaContent::tier;
    settings.maxTier = kTierFilled;
    return settings;
  }

  reference::GatherTextures sources() const {
    return {[this](std::size_t node) -> const std::vector<Image8>& { return textures[node]; },
            [this](std::size_t node) -> const ImageF& { return depths[node]; }, filter};
  }
  reference::Composed compose(const FramePlan& plan, std::size_t view = 0) const {
    return reference::composeGathered(made.scene, plan, view, sources());
  }
  reference::Composed compose(const Camera& view) const { return compose(plan(view)); }
};

/// The backdrop of a photograph: a grid mesh. Tier 0 where a triangle lies on one surface; tier 1 (never drawn) where
/// the triangle connects two surfaces.
inline Cell gatherBackdrop(const SyntheticScene& made, std::uint32_t node, const GatherOptions& options) {
  const Camera& camera = made.scene.nodes[node].camera;
  const Intrinsics& k = camera.intrinsics;
  const auto surface = [&](glm::dvec2 pixel) -> std::optional<glm::dvec3> {  // relative to the camera, world axes
    const glm::dvec3 ray = camera.pose.rotation * unproject(k, pixel);
    const auto distance = distanceAlong(made, camera.pose.position, ray);
    return distance && !options.atInfinity ? std::optional(*distance * ray) : std::nullopt;
  };
  Cell cell;
  cell.members = {node};
  MorphMesh& mesh = cell.mesh;
  mesh.match.resize(1);
  mesh.ratio.resize(1);
  const auto ends = [&](int side) {
    std::vector<int> all;
    for (int at = 0; at < side; at += options.gridStep) all.push_back(at);
    all.push_back(side);
    return all;
  };
  const std::vector<int> columns = ends(k.width), rows = ends(k.height);
  for (const int y : rows)
    for (const int x : columns) {
      const glm::dvec2 pixel(x, y);
      const auto point = surface(pixel);
      double rho = point ? 1 / glm::length(*point) : 0.0;
      if (options.inverseDepth) rho = options.inverseDepth(node, pixel, rho);
      const Evidence evidence = options.evidence ? options.evidence(node, pixel) : Evidence{};
      mesh.match[0].push_back(pixel);
      mesh.ratio[0].push_back(1.0f);
      mesh.inverseDistance.push_back(float(rho));
      mesh.uncertainty.push_back(0.0f);
      mesh.confirmations.push_back(evidence.confirmations);
      mesh.consensus.push_back(evidence.consensus);
    }
  std::array<std::vector<glm::uvec3>, 2> tiers;
  const auto add = [&](const std::array<std::uint32_t, 3>& corners) {
    std::array<std::optional<glm::dvec3>, 3> at;
    for (std::size_t i = 0; i < 3; ++i) at[i] = surface(mesh.match[0][corners[i]]);
    const auto onPlane = [&](glm::dvec2 pixel) {
      const auto point = surface(pixel);
      if (!at[0] || !at[1] || !at[2] || !point) return !at[0] && !at[1] && !at[2] && !point;
      const glm::dvec3 normal = glm::cross(*at[1] - *at[0], *at[2] - *at[0]);
      return std::abs(glm::dot(normal, *point - *at[0])) <= 1e-6 * glm::length(normal) * glm::length(*at[0]);
    };
    const auto pixel = [&](std::size_t i) { return glm::dvec2(mesh.match[0][corners[i]]); };
    bool one = onPlane((pixel(0) + pixel(1) + pixel(2)) / 3.0);
    for (std::size_t i = 0; i < 3; ++i) one = one && onPlane(0.5 * (pixel(i) + pixel((i + 1) % 3)));
    tiers[one ? kTierConsistent : kTierRejected].push_back({corners[0], corners[1], corners[2]});
  };
  const auto across = std::uint32_t(columns.size());
  for (std::uint32_t j = 0; j + 1 < rows.size(); ++j)
    for (std::uint32_t i = 0; i + 1 < across; ++i) {
      const std::uint32_t corner = j * across + i;
      add({corner, corner + 1, corner + across});
      add({corner + 1, corner + across + 1, corner + across});
    }
  for (const int tier : {kTierConsistent, kTierRejected})
    for (const glm::uvec3& triangle : tiers[std::size_t(tier)]) {
      mesh.triangles.push_back(triangle);
      mesh.tier.push_back(std::uint8_t(tier));
      mesh.ecc.push_back(1.0f);
    }
  cell.quality.coverage = cell.quality.ecc = cell.quality.score = 1;
  cell.quality.residualPx = 0;
  return cell;
}

inline float toHalfAndBack(float value) {
  return glm::unpackHalf1x16(glm::packHalf1x16(value));
}

/// The nearest exact ρ of each block of 4 × 4 px, as a half-float texture holds the value. Sets Node::depthScale.
inline ImageF gatherDepth(SyntheticScene& made, std::size_t node, const GatherOptions& options) {
  constexpr int kBlock = 4;
  const Camera& camera = made.scene.nodes[node].camera;
  const ImageF distance = renderDepth(made, camera);
  const auto blocks = [](int side) { return (side + kBlock - 1) / kBlock; };
  ImageF depth(blocks(distance.width), blocks(distance.height), 2, 0.0f);
  double largest = 0;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      double most = 0;
      for (int j = y * kBlock; j < std::min((y + 1) * kBlock, distance.height); ++j)
        for (int i = x * kBlock; i < std::min((x + 1) * kBlock, distance.width); ++i) {
          const glm::dvec2 pixel(i + 0.5, j + 0.5);
          double rho = 1 / double(distance.pixel(i, j)[0]);
          if (options.inverseDepth) {  // inverseDepth expects ρ along the ray
            const double axis =
                camera.intrinsics.model == CameraModel::equirectangular ? 1.0 : -unproject(camera.intrinsics, pixel).z;
            rho = options.inverseDepth(node, pixel, rho * axis) / axis;
          }
          most = std::max(most, rho);
        }
      depth.pixel(x, y)[0] = float(most);
      const glm::dvec2 middle(kBlock * (x + 0.5), kBlock * (y + 0.5));
      depth.pixel(x, y)[1] =
          toHalfAndBack(options.evidence ? options.evidence(node, middle).consensus : Evidence{}.consensus);
      largest = std::max(largest, most);
    }
  const double scale = largest > 0 ? largest : 1;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      float& red = depth.pixel(x, y)[0];
      red = toHalfAndBack(float(double(red) / scale));
    }
  made.scene.nodes[node].depthScale = scale;
  made.scene.nodes[node].depthFile = "depth/" + made.scene.nodes[node].name + ".ktx2";
  return depth;
}

inline GatherStage gatherStage(const GatherOptions& options) {
  GatherStage stage;
  SyntheticScene& made = stage.made;
  made.planes = options.planes;
  if (options.atInfinity) made.centreOfInfinity = glm::dvec3(0);
  made.scene.acquisition = "synthetic";
  for (std::uint32_t n = 0; n < options.cameras.size(); ++n) {
    const std::string name = "view" + std::to_string(n);
    made.scene.nodes.push_back({name, options.cameras[n], "images/" + name + ".png", "textures/" + name + ".ktx2"});
    made.photographs.push_back(renderTruth(made, options.cameras[n], options.samplesPerAxis));
    made.scene.backdrops.push_back(gatherBackdrop(made, n, options));
    stage.depths.push_back(gatherDepth(made, n, options));
    stage.textures.push_back(buildMips(made.photographs[n]));
  }
  return stage;
}

/// Adds an exact cell of all photographs, which must be 2 to 4 pinholes.
inline void addCell(GatherStage& stage, const GatherOptions& options) {
  SyntheticOptions cells;
  cells.cameras = options.cameras;
  cells.planes = options.planes;
  cells.gridStep = options.gridStep;
  cells.samplesPerAxis = 1;
  stage.made.scene.cells = makeScene(cells).scene.cells;
}

/// A slanted wall, and a box in front of the wall that shows its front, left and upper sides.
inline std::vector<TexturedPlane> wallAndBox() {
  const glm::dvec3 slanted = glm::normalize(glm::dvec3(1, 0, -0.3));
  return {{.origin = {0, 0, -6}, .u = slanted, .extentU = 40, .extentV = 30, .seed = 1, .wavelength = 0.8},
          {.origin = {0.4, -0.2, -3}, .extentU = 1, .extentV = 0.8, .seed = 2, .wavelength = 0.3},
          {.origin = {-0.1, -0.2, -3.4}, .u = {0, 0, 1}, .extentU = 0.8, .extentV = 0.8, .seed = 3, .wavelength = 0.3},
          {.origin = {0.4, 0.2, -3.4}, .v = {0, 0, -1}, .extentU = 1, .extentV = 0.8, .seed = 4, .wavelength = 0.3}};
}

/// Three pinholes of different sizes in front of wallAndBox(), half a unit apart, one of them rolled.
inline GatherOptions wallOptions() {
  GatherOptions options;
  options.cameras = {cameraAt({0, 0, 0}, 0, 0, 160, 120), cameraAt({0.5, 0.1, 0}, 0.06, 0, 240, 160),
                     cameraAt({0.1, 0.5, 0.1}, -0.04, -0.06, 120, 160, 1.3)};
  options.cameras[2].pose.rotation *= glm::angleAxis(0.3, glm::dvec3(0, 0, 1));
  options.planes = wallAndBox();
  return options;
}

/// A room seen by a panorama and two pinholes.
inline GatherOptions roomOptions() {
  GatherOptions options;
  const Intrinsics sphere{CameraModel::equirectangular, 256, 128};
  options.cameras = {{sphere, {{0, 0, 0}, glm::angleAxis(0.4, glm::normalize(glm::dvec3(0.1, 1, 0.2)))}},
                     cameraAt({0.5, 0, 0.2}, 0.3, 0, 160, 120, 1.2),
                     cameraAt({0, 0.3, 0.4}, -0.2, 0.1, 160, 120, 1.2)};
  options.gridStep = 2;
  options.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  return options;
}

/// Differences between a device's image and the reference.
struct GatherComparison {
  double differing = 0;   // share of pixels whose colour differs by more than kColourTolerance, or whose tier differs
  double excused = 0;     // share of pixels that differ, but where rounding decides which support peak wins
  double wrongDepth = 0;  // share of pixels whose depth differs, without excused pixels; 0 without a depth
  static constexpr double kColourTolerance = 2;    // 8-bit levels
  static constexpr double kMinMargin = 1e-4;       // of the two largest supports, relative: smaller margins are excused
  static constexpr double kMaxExcused = 0.002;     // maximum share of the pixels
  static constexpr double kDepthTolerance = 1e-3;  // relative to the largest ρ

  bool isExcusable() const { return excused <= kMaxExcused; }
};

/// `image`: RGBA with AlphaContent::tier over a black background. `depth`: first channel of BufferTargets, along the
/// view's axis, infinity in holes; an empty image is not compared.
inline GatherComparison compareGathered(const reference::Composed& ref, const Image8& image, const ImageF& depth) {
  GatherComparison result;
  const double share = 1.0 / (double(ref.picture.width) * ref.picture.height);
  double largest = 0;
  for (const float rho : ref.opaqueInverseDepth.values) largest = std::max(largest, double(rho));
  for (int y = 0; y < ref.picture.height; ++y)
    for (int x = 0; x < ref.picture.width; ++x) {
      bool differs = image.pixel(x, y)[3] != ref.picture.pixel(x, y)[3];
      for (std::size_t c = 0; c < 3; ++c)
        differs = differs || std::abs(double(image.pixel(x, y)[c]) - double(ref.colour.pixel(x, y)[c])) >
                                 GatherComparison::kColourTolerance;
      const bool close = double(ref.supportMargin.pixel(x, y)[0]) < GatherComparison::kMinMargin;
      if (differs) (close ? result.excused : result.differing) += share;
      if (depth.empty() || (differs && close)) continue;
      const double rho = 1 / double(depth.pixel(x, y)[0]);
      if (std::abs(rho - double(ref.opaqueInverseDepth.pixel(x, y)[0])) > GatherComparison::kDepthTolerance * largest)
        result.wrongDepth += share;
    }
  return result;
}

}  // namespace ibr::test
