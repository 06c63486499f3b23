// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/depth_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/check.h"
#include "base/file.h"
#include "base/median.h"
#include "base/raster.h"
#include "ibr/texture.h"
#include "io/exr.h"
#include "io/image_file.h"
#include "shared/cli/progress.h"
#include "shared/overlay.h"

namespace ibr::app {
namespace {

constexpr float kMaxConfirmations = 4;  // confirmations at the end of the colour ramp

Image8 coloured(const ImageF& values, const std::function<glm::vec3(float)>& colour) {
  Image8 picture(values.width, values.height, 3);
  for (std::size_t p = 0; p < values.values.size(); ++p) {
    const glm::vec3 levels = 255.0f * glm::clamp(colour(values.values[p]), 0.0f, 1.0f) + 0.5f;
    for (int c = 0; c < 3; ++c) picture.values[3 * p + std::size_t(c)] = std::uint8_t(levels[c]);
  }
  return picture;
}

// Confirmations at each pixel of a backdrop: those of the triangle's nearest vertex; 0 outside the mesh.
ImageF confirmationsOf(const MorphMesh& mesh, const Intrinsics& stored, int width, int height) {
  ImageF counts(width, height, 1, 0.0f);
  const glm::dvec2 scale(double(width) / stored.width, double(height) / stored.height);
  for (const glm::uvec3& t : mesh.triangles) {
    std::array<glm::dvec2, 3> at;
    for (int i = 0; i < 3; ++i) at[std::size_t(i)] = glm::dvec2(mesh.match[0][t[i]]) * scale;
    forTrianglePixels(at[0], at[1], at[2], width, height, [&](int x, int y, const glm::dvec3& share) {
      const int nearest = share.x >= std::max(share.y, share.z) ? 0 : share.y >= share.z ? 1 : 2;
      counts.pixel(x, y)[0] = float(mesh.confirmations[t[nearest]]);
    });
  }
  return counts;
}

}  // namespace

std::size_t writeDepthPictures(const Scene& scene, const std::filesystem::path& folder, const Context& context) {
  std::vector<double> largest;
  for (const Node& node : scene.nodes)
    if (!node.depthFile.empty()) largest.push_back(node.depthScale);
  const std::size_t count = largest.size();
  if (count == 0) return 0;
  // The brightest colour is the distance of the median photograph's nearest surface.
  const auto nearDistance = float(1 / (double(shader::kNearestDepth) * median(std::move(largest))));
  ProgressLine progress(context);
  std::size_t done = 0;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.depthFile.empty()) continue;
    check(progress.show({"writing depth", done++, count}), ErrorCode::cancelled, "stopped");
    const DepthMaps maps = readDepthTexture(readKtx2(scene.folder / node.depthFile), node.depthScale);
    const ImageF& depth = maps.inverseDepth;
    ImageF confirmations(depth.width, depth.height, 1, 0.0f);
    for (const Cell& backdrop : scene.backdrops)
      if (backdrop.members[0] == n && !backdrop.mesh.confirmations.empty())
        confirmations = confirmationsOf(backdrop.mesh, node.camera.intrinsics, depth.width, depth.height);
    const auto named = [&](const char* what) { return folder / (node.name + what); };
    makeFolders(named("").parent_path());
    writeImage(named(".depth.png"), coloured(depth, [&](float w) { return shader::depthColour(w, nearDistance); }));
    writeImage(named(".confirmations.png"),
               coloured(confirmations, [](float c) { return shader::rampColour(c / kMaxConfirmations); }));
    writeImage(named(".consensus.png"), coloured(maps.consensus, [](float a) { return shader::rampColour(a); }));
    writeExr(named(".depth.exr"),
             std::vector<ExrChannel>{
                 {"confirmations", confirmations}, {"consensus", maps.consensus}, {"inverseDepth", depth}});
  }
  progress.show({"writing depth", count, count});
  return count;
}

}  // namespace ibr::app
