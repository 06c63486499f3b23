// SPDX-License-Identifier: Apache-2.0
//
// A triangle is rasterised in homogeneous coordinates: a = M⁻¹·(X, Y, 1) with the vertices' (x, y, w) as columns of M
// gives weights with which every attribute, divided by w, is Σ a_i f_i; the pixel is inside where no a_i is negative.
// Nothing has to be clipped.
#include "reference/cell_pass_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "image/blue_noise.h"
#include "reference/morph.h"
#include "shared/cell.h"

namespace ibr::reference {
namespace {

struct Texel {
  glm::dvec3 colour;
  double range;
};

Texel bilinear(const Image8& image, glm::dvec2 at) {  // at: 0 to 1
  const double x = at.x * image.width - 0.5, y = at.y * image.height - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  Texel result{glm::dvec3(0), 0};
  glm::dvec3 low(255), high(0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto p = image.pixel(std::clamp(x0 + i, 0, image.width - 1), std::clamp(y0 + j, 0, image.height - 1));
      const glm::dvec3 value(p[0], p[1], p[2]);
      result.colour += (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0)) * value / 255.0;
      low = glm::min(low, value);
      high = glm::max(high, value);
    }
  const glm::dvec3 range = high - low;
  result.range = std::max({range.x, range.y, range.z});
  return result;
}

Texel sample(const std::vector<Image8>& levels, glm::dvec2 at, glm::dvec2 dx, glm::dvec2 dy) {
  const glm::dvec2 size(levels[0].width, levels[0].height);
  const double footprint = std::max(glm::length(dx * size), glm::length(dy * size));
  const double lod = std::clamp(std::log2(std::max(footprint, 1e-30)), 0.0, double(levels.size() - 1));
  const auto fine = std::size_t(lod);
  const Texel a = bilinear(levels[fine], at);
  if (fine + 1 >= levels.size() || lod == double(fine)) return a;
  const Texel b = bilinear(levels[fine + 1], at);
  const double t = lod - double(fine);
  return {a.colour * (1 - t) + b.colour * t, std::max(a.range, b.range)};
}

struct Triangle {
  std::array<std::array<glm::dvec3, 4>, 3> point;  // vertex, member: q_i
  glm::dmat3 inverse;                              // M⁻¹
  glm::dvec3 depth;                                // z_clip of the vertices
};

struct Step {
  const Scene& scene;
  const Cell& cell;
  const FramePlan& plan;
  std::array<double, 4> position, blend;
};

glm::dvec2 textureAt(const Step& step, const Triangle& t, std::size_t member, glm::dvec2 pixel) {
  const glm::dvec3 a = t.inverse * glm::dvec3(pixel, 1.0);
  const glm::dvec3 q = a[0] * t.point[0][member] + a[1] * t.point[1][member] + a[2] * t.point[2][member];
  const Intrinsics& k = step.scene.nodes[step.cell.members[member]].camera.intrinsics;
  return {(k.cx - k.fx * q.x / q.z) / k.width, (k.cy + k.fy * q.y / q.z) / k.height};
}

Texel shade(const Step& step, const Triangle& t, const std::vector<std::vector<Image8>>& textures, int x, int y,
            const std::vector<std::uint16_t>& noise) {
  const int chosen = shader::ditherMember(
      {float(step.blend[0]), float(step.blend[1]), float(step.blend[2]), float(step.blend[3])},
      shader::noiseFromRank(noise[std::size_t(y % shader::kNoiseSize * shader::kNoiseSize + x % shader::kNoiseSize)]));
  Texel result{glm::dvec3(0), 0};
  for (std::size_t i = 0; i < step.cell.members.size(); ++i) {
    double weight = step.blend[i];
    if (step.plan.settings.blend == BlendMode::dither) weight = int(i) == chosen ? 1.0 : 0.0;
    if (weight == 0.0) continue;
    // Derivatives as a GPU takes them, between the pixels of a 2×2 quad.
    const glm::dvec2 quad(x & ~1, y & ~1), here(x + 0.5, y + 0.5);
    const glm::dvec2 dx = textureAt(step, t, i, {quad.x + 1.5, here.y}) - textureAt(step, t, i, {quad.x + 0.5, here.y});
    const glm::dvec2 dy = textureAt(step, t, i, {here.x, quad.y + 1.5}) - textureAt(step, t, i, {here.x, quad.y + 0.5});
    const Texel texel = sample(textures[step.cell.members[i]], textureAt(step, t, i, here), dx, dy);
    result.colour += weight * texel.colour;
    result.range = std::max(result.range, texel.range);
  }
  return result;
}

}  // namespace

Picture render(const Scene& scene, const std::vector<std::vector<Image8>>& textures, const FramePlan& plan) {
  const Intrinsics& k = plan.view.intrinsics;
  const std::size_t count = std::size_t(k.width) * std::size_t(k.height);
  Picture picture{k.width, k.height, std::vector<glm::dvec4>(count, glm::dvec4(0)), std::vector<std::uint8_t>(count, 0),
                  std::vector<double>(count, 0)};
  std::vector<int> owner(count, -1);
  std::vector<double> depth(count, 2.0);
  const std::vector<std::uint16_t> noise = blueNoise(shader::kNoiseSize, 1);
  const glm::dquat toView = glm::conjugate(plan.view.pose.rotation);
  int slot = 0;
  for (int tier = 0; tier <= plan.settings.lowestTier; ++tier)
    for (const PlannedCell& planned : plan.cells) {
      const Cell& cell = scene.cells[planned.cell];
      Step step{scene, cell, plan, planned.position, planned.blend};
      if (tier == kTierRejected) {
        step.position = {};
        step.position[planned.best] = 1;
        step.blend = step.position;
      }
      for (std::size_t f = 0; f < cell.mesh.triangles.size(); ++f) {
        if (cell.mesh.tier[f] != tier) continue;
        Triangle t;
        glm::dmat3 m;
        for (int v = 0; v < 3; ++v) {
          const std::size_t p = cell.mesh.triangles[f][v];
          const glm::dvec3 d =
              toView * morph(scene, cell, p, step.position, plan.settings.morph, plan.view.pose.position);
          m[v] = {k.fx * d.x - k.cx * d.z, -k.fy * d.y - k.cy * d.z, -d.z};  // pixel coordinates times w
          const double rho = plan.settings.morph == Morph::ours ? double(cell.mesh.inverseDistance[p]) : 0.0;
          t.depth[v] = -d.z - plan.nearDistance * rho;
          for (std::size_t i = 0; i < cell.members.size(); ++i)
            t.point[std::size_t(v)][i] =
                unproject(scene.nodes[cell.members[i]].camera.intrinsics, cell.mesh.match[i][p]) *
                (plan.settings.morph == Morph::ours ? double(cell.mesh.ratio[i][p]) : 1.0);
        }
        t.inverse = glm::inverse(m);
        int x0 = 0, y0 = 0, x1 = k.width - 1, y1 = k.height - 1;
        if (m[0].z > 0 && m[1].z > 0 && m[2].z > 0) {
          auto bound = [&](int axis, bool low) {
            const double a = m[0][axis] / m[0].z, b = m[1][axis] / m[1].z, c = m[2][axis] / m[2].z;
            return std::clamp(low ? std::floor(std::min({a, b, c})) : std::ceil(std::max({a, b, c})), -1e6, 1e6);
          };
          x0 = std::max(x0, int(bound(0, true)) - 1), x1 = std::min(x1, int(bound(0, false)) + 1);
          y0 = std::max(y0, int(bound(1, true)) - 1), y1 = std::min(y1, int(bound(1, false)) + 1);
        }
        for (int y = y0; y <= y1; ++y)
          for (int x = x0; x <= x1; ++x) {
            const glm::dvec3 a = t.inverse * glm::dvec3(x + 0.5, y + 0.5, 1.0);
            if (!(a[0] >= 0 && a[1] >= 0 && a[2] >= 0 && a[0] + a[1] + a[2] > 0)) continue;
            const double z = std::clamp(glm::dot(a, t.depth), 0.0, 1.0);
            const std::size_t at = std::size_t(y) * std::size_t(k.width) + std::size_t(x);
            if (owner[at] >= 0 && (owner[at] < slot || depth[at] <= z)) continue;
            owner[at] = slot;
            depth[at] = z;
            const Texel texel = shade(step, t, textures, x, y, noise);
            picture.colour[at] = glm::dvec4(texel.colour, (255.0 - 64.0 * tier) / 255.0);
            picture.range[at] = texel.range;
          }
      }
      ++slot;
    }
  for (int y = 1; y + 1 < k.height; ++y)
    for (int x = 1; x + 1 < k.width; ++x) {
      bool same = true;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          same &= owner[std::size_t(y + j) * std::size_t(k.width) + std::size_t(x + i)] ==
                  owner[std::size_t(y) * std::size_t(k.width) + std::size_t(x)];
      picture.safe[std::size_t(y) * std::size_t(k.width) + std::size_t(x)] = same;
    }
  return picture;
}

}  // namespace ibr::reference
