// SPDX-License-Identifier: Apache-2.0
//
// Rasterises triangles in homogeneous coordinates. With the vertices' (x, y, w) as columns of M, a = M⁻¹·(X, Y, 1)
// are weights: an attribute f divided by w is Σ a_i f_i. A pixel is inside if no a_i is negative. No clipping is
// needed.
#include "reference/cell_pass_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/integer.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "image/blue_noise.h"
#include "reference/morph.h"
#include "reference/texture_sampling.h"
#include "render/passes/draw_list.h"
#include "shared/cell.h"
#include "shared/overlay.h"
#include "shared/panorama.h"

namespace ibr::reference {
namespace {

struct Triangle {
  std::array<std::array<glm::dvec3, 4>, 3> point;  // vertex, member: q_i
  glm::dmat3 inverse;                              // M⁻¹
  glm::dvec3 depth;                                // z_clip of the vertices
  glm::dvec3 inverseDistance, uncertainty;         // of the vertices
};

struct DrawItem {
  const Scene& scene;
  const Cell& cell;
  const FramePlan& plan;
  PlannedCell::View weights;
  double opacity;
  int rank;
  double extrapolation;
  bool cubic;
  Correction correction;
  double detail() const { return double(shader::kFinerDetail) / plan.settings.textureScale; }
};

std::vector<DrawItem> drawListOf(const Scene& scene, const FramePlan& plan, const std::vector<PlannedCell>& cells,
                                 std::size_t view, bool cubic) {
  std::vector<DrawItem> items;
  for (const PlannedCell& c : cells)
    items.push_back({scene, scene.cells[c.cell], plan, c.view[view], c.opacity, int(&c - cells.data()),
                     c.extrapolationDistance, cubic, c.correction});
  return items;
}

const Intrinsics& intrinsicsOf(const DrawItem& item, std::size_t member) {
  return item.scene.nodes[item.cell.members[member]].camera.intrinsics;
}

// q_i at a pixel, up to a positive factor inside the triangle.
glm::dvec3 pointAt(const Triangle& t, std::size_t member, glm::dvec2 pixel) {
  const glm::dvec3 a = t.inverse * glm::dvec3(pixel, 1.0);
  return a[0] * t.point[0][member] + a[1] * t.point[1][member] + a[2] * t.point[2][member];
}

// Distance, px, from a pixel to the nearest edge of a triangle, negative outside; `a`: the pixel's weights.
double edgeDistance(const Triangle& t, glm::dvec3 a) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) nearest = std::min(nearest, a[i] / std::hypot(t.inverse[0][i], t.inverse[1][i]));
  return nearest;
}

Texel sample(const DrawItem& item, const Triangle& t, const std::vector<Image8>& levels, std::size_t member, int x,
             int y) {
  const Intrinsics& k = intrinsicsOf(item, member);
  // Derivatives as on a GPU, between the pixels of a 2×2 quad.
  const glm::dvec2 quad(x & ~1, y & ~1), here(x + 0.5, y + 0.5);
  auto difference = [&](auto value) {
    return std::pair(item.detail() * (value({quad.x + 1.5, here.y}) - value({quad.x + 0.5, here.y})),
                     item.detail() * (value({here.x, quad.y + 1.5}) - value({here.x, quad.y + 0.5})));
  };
  if (k.model == CameraModel::equirectangular) {
    const auto [dx, dy] = difference([&](glm::dvec2 pixel) { return glm::normalize(pointAt(t, member, pixel)); });
    return samplePanorama(levels, k, pointAt(t, member, here), dx, dy, item.cubic);
  }
  auto coordinate = [&](glm::dvec2 pixel) {
    const glm::dvec3 q = pointAt(t, member, pixel);
    return glm::dvec2((k.cx - k.fx * q.x / q.z) / k.width, (k.cy + k.fy * q.y / q.z) / k.height);
  };
  const auto [dx, dy] = difference(coordinate);
  const glm::dvec2 size(levels[0].width, levels[0].height);
  return trilinear(levels, coordinate(here), std::max(glm::length(dx * size), glm::length(dy * size)), false,
                   item.cubic);
}

// [T] §3.5 eq. 1 of two members' luminances in a window; nullopt if one of them has no contrast.
std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = double(a.size());
  double meanA = 0, meanB = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t k = 0; k < a.size(); ++k) meanA += a[k] / n, meanB += b[k] / n;
  for (std::size_t k = 0; k < a.size(); ++k) {
    aa += (a[k] - meanA) * (a[k] - meanA);
    bb += (b[k] - meanB) * (b[k] - meanB);
    ab += (a[k] - meanA) * (b[k] - meanB);
  }
  const double least = double(shader::kMinContrast);
  if (std::sqrt(aa / n) < least || std::sqrt(bb / n) < least) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

// Applies the photograph's gain unless exposure is off (shared/cell.h, exposedValue).
Texel exposed(const DrawItem& item, std::size_t member, Texel texel) {
  if (item.plan.settings.exposure == Exposure::off) return texel;
  const glm::dvec3 gain = item.plan.exposure * item.scene.nodes[item.cell.members[member]].gain;
  const double brightest = largest(texel.colour) + texel.range / 255;  // maximum before filtering
  texel.colour = exposedColour(texel.colour, gain);
  // Maximum slope of exposedColour, which is steep for nearly clipped values.
  const double most = std::max(1.0, largest(gain)) + (brightest > 0.9 ? 1 / 0.09 : 0.0);
  texel.range = most * texel.range + 128 * (most - 1);  // filters of devices differ by about a level, times the gain
  texel.levelRange *= most;
  return texel;
}

// Mean correlation of all pairs of members in a window around the pixel; 2 without contrast. Pinholes only.
double agreement(const DrawItem& item, const Triangle& t, const std::vector<std::vector<Image8>>& textures, int x,
                 int y) {
  const std::size_t members = item.cell.members.size();
  std::vector<std::vector<double>> windows(members);
  for (std::size_t i = 0; i < members; ++i) {
    const Intrinsics& k = intrinsicsOf(item, i);
    const std::vector<Image8>& levels = textures[item.cell.members[i]];
    const glm::dvec2 quad(x & ~1, y & ~1), here(x + 0.5, y + 0.5), size(levels[0].width, levels[0].height);
    const auto point = [&](glm::dvec2 pixel) {  // as interpolated by a GPU
      const glm::dvec3 a = t.inverse * glm::dvec3(pixel, 1.0);
      return pointAt(t, i, pixel) / (a.x + a.y + a.z);
    };
    const auto coordinate = [&](glm::dvec3 q) {
      return glm::dvec2((k.cx - k.fx * q.x / q.z) / k.width, (k.cy + k.fy * q.y / q.z) / k.height);
    };
    const auto slope = [&](auto value, glm::dvec2 from, glm::dvec2 to) { return value(to) - value(from); };
    const auto both = [&](auto value) {
      return std::pair(slope(value, {quad.x + 0.5, here.y}, {quad.x + 1.5, here.y}),
                       slope(value, {here.x, quad.y + 0.5}, {here.x, quad.y + 1.5}));
    };
    const auto [dx, dy] = both(point);
    const auto [cx, cy] = both([&](glm::dvec2 pixel) { return coordinate(point(pixel)); });
    const double footprint = item.detail() * std::max(glm::length(cx * size), glm::length(cy * size));
    for (int j = -shader::kAgreementReach; j <= shader::kAgreementReach; ++j)
      for (int n = -shader::kAgreementReach; n <= shader::kAgreementReach; ++n) {
        const Texel texel =
            trilinear(levels, coordinate(point(here) + double(n) * dx + double(j) * dy), footprint, false, false);
        const glm::dvec3 colour = exposed(item, i, texel).colour;
        windows[i].push_back(glm::dot(colour, glm::dvec3(0.299, 0.587, 0.114)));
      }
  }
  double sum = 0;
  int pairs = 0;
  for (std::size_t i = 1; i < members; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const auto value = correlation(windows[i], windows[j])) sum += *value, ++pairs;
  return pairs > 0 ? sum / pairs : 2;
}

const std::vector<std::uint16_t>& noiseRanks() {
  static const std::vector<std::uint16_t> ranks = blueNoise(shader::kNoiseSize, 1);
  return ranks;
}

float noiseAt(int x, int y) {
  x %= shader::kNoiseSize;
  y %= shader::kNoiseSize;
  return shader::noiseFromRank(noiseRanks()[std::size_t(y * shader::kNoiseSize + x)]);
}

// Applies the masks to the members' weights, which then sum to 1 or are all 0. Returns the range (as in RenderedImage)
// of a colour at a mask's border, since weights depend on texels, too. Returns 0 elsewhere, and infinity where such
// weights select a member.
double masked(const DrawItem& item, const Triangle& t, const std::vector<std::vector<Image8>>& textures, int x, int y,
              std::array<double, 4>& weights) {
  double total = 0;
  bool border = false;
  for (std::size_t i = 0; i < item.cell.members.size(); ++i) {
    weights[i] = std::max(weights[i], double(shader::kMinMaskedWeight));
    const double alpha = sample(item, t, textures[item.cell.members[i]], i, x, y).alpha;
    border = border || (weights[i] > 0 && alpha > 0 && alpha < 1);
    weights[i] *= std::clamp(2 * alpha - 1, 0.0, 1.0);
    total += weights[i];
  }
  for (double& weight : weights) weight = total > 0 ? weight / total : 0;
  if (!border) return 0;
  return item.plan.settings.blend == BlendMode::blend ? 4 * 255 / std::max(total, 1e-9)
                                                      : std::numeric_limits<double>::infinity();
}

bool isFullyMasked(const std::array<double, 4>& weights) {
  return std::ranges::all_of(weights, [](double weight) { return weight == 0; });
}

// `x`, `y`: the pixel; `noise`: offset into the noise pattern. `blend`: weights of the members, sum 1.
Texel shade(const DrawItem& item, const Triangle& t, const std::vector<std::vector<Image8>>& textures, int x, int y,
            glm::ivec2 noise, const std::array<double, 4>& blend, BufferValues& known) {
  const float random = noiseAt(x + noise.x, y + noise.y);
  const int chosen = shader::ditherMember({float(blend[0]), float(blend[1]), float(blend[2]), float(blend[3])}, random);
  Texel result;
  glm::dvec3 mean(0), square(0);
  std::array<double, 4> shares{};
  for (std::size_t i = 0; i < item.cell.members.size(); ++i) {
    const double dithered = int(i) == chosen ? 1.0 : 0.0;
    const BlendMode mode = item.plan.settings.blend;
    const double weight = mode == BlendMode::blend    ? blend[i]
                          : mode == BlendMode::dither ? dithered
                                                      : 0.5 * (blend[i] + dithered);
    shares[i] = weight;
    if (weight == 0.0 && blend[i] == 0.0) continue;
    const Texel texel = exposed(item, i, sample(item, t, textures[item.cell.members[i]], i, x, y));
    if (weight > 0.0) result = mixed(result, 1, texel, weight);
    mean += blend[i] * texel.colour;
    square += blend[i] * texel.colour * texel.colour;
  }
  const glm::dvec3 a = t.inverse * glm::dvec3(x + 0.5, y + 0.5, 1.0);  // sums to 1 / w
  const glm::dvec3 variance = glm::max(square - mean * mean, 0.0);
  known = {1.0 / std::max(glm::dot(a, t.inverseDistance), 0.0),
           kTierConsistent,
           item.rank,
           item.extrapolation,
           blend,
           std::sqrt((variance.x + variance.y + variance.z) / 3),
           glm::dot(a, t.uncertainty) / (a.x + a.y + a.z),
           glm::dot(a, t.inverseDistance) / (a.x + a.y + a.z),
           shares};
  if (item.plan.settings.overlay == Overlay::agreement) known.agreement = agreement(item, t, textures, x, y);
  return result;
}

// Offset of the second view's noise from the first's: the noise lies straight ahead at infinity of both views.
glm::ivec2 noiseOffset(const FramePlan& plan, std::size_t view) {
  if (view == 0) return {0, 0};
  const glm::dvec3 ahead =
      glm::slerp(plan.views[0].pose.rotation, plan.views[1].pose.rotation, 0.5) * glm::dvec3(0, 0, -1);
  glm::dvec2 at[2];
  for (int v = 0; v < 2; ++v)
    at[v] = *project(plan.views[v].intrinsics, glm::conjugate(plan.views[v].pose.rotation) * ahead);
  const glm::ivec2 offset(glm::round(at[0] - at[1]));
  return (offset % shader::kNoiseSize + shader::kNoiseSize) % shader::kNoiseSize;
}

// State of one canvas pixel: the best draw item so far, and the depth of its nearest triangle.
struct Owner {
  int item = -1;
  double depth = 2;
  int counted = -1;  // last draw item that covers the pixel, hidden or not
};

void drawItem(const DrawItem& item, int index, const std::vector<std::vector<Image8>>& textures, const Camera& view,
              glm::ivec2 noise, RenderedImage& picture, std::vector<Owner>& owners) {
  const Intrinsics& k = view.intrinsics;
  const glm::dquat toView = glm::conjugate(view.pose.rotation);
  const bool ours = item.plan.settings.morph == Morph::ours;
  const MorphMesh& mesh = item.cell.mesh;
  for (std::size_t f = 0, count = mesh.tier0Count(); f < count; ++f) {
    Triangle t;
    glm::dmat3 m;
    for (int v = 0; v < 3; ++v) {
      const std::size_t p = mesh.triangles[f][v];
      const glm::dvec3 d = toView * morph(item.scene, item.cell, p, item.weights.position, item.plan.settings.morph,
                                          view.pose.position, item.correction);
      m[v] = {k.fx * d.x - k.cx * d.z, -k.fy * d.y - k.cy * d.z, -d.z};  // pixel coordinates times w
      t.inverseDistance[v] = ours ? double(mesh.inverseDistance[p]) : 0.0;
      t.uncertainty[v] = mesh.uncertainty[p];
      t.depth[v] = -d.z - item.plan.nearDistance * (ours ? double(mesh.inverseDistance[p]) : 0.0);
      for (std::size_t i = 0; i < item.cell.members.size(); ++i)
        t.point[std::size_t(v)][i] =
            unproject(item.scene.nodes[item.cell.members[i]].camera.intrinsics, mesh.match[i][p]) *
            (ours ? double(mesh.ratio[i][p]) : 1.0);
    }
    if (m[0].z <= 0 && m[1].z <= 0 && m[2].z <= 0) continue;  // behind the view
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
        if (!(a[0] + a[1] + a[2] > 0)) continue;
        const std::size_t at = std::size_t(y) * std::size_t(k.width) + std::size_t(x);
        const double edge = std::abs(edgeDistance(t, a));
        if (owners[at].item < 0 || owners[at].item == index) picture.edge[at] = std::min(picture.edge[at], edge);
        if (!(a[0] >= 0 && a[1] >= 0 && a[2] >= 0)) continue;
        if (item.opacity < 1 && noiseAt(x + noise.x + int(shader::kDissolveOffset.x),
                                        y + noise.y + int(shader::kDissolveOffset.y)) >= float(item.opacity))
          continue;
        const double z = std::clamp(glm::dot(a, t.depth), 0.0, 1.0);
        if (std::exchange(owners[at].counted, index) != index) ++picture.overlap[at];
        if (owners[at].item >= 0 && (owners[at].item < index || owners[at].depth <= z)) continue;
        std::array<double, 4> blend = item.weights.blend;
        double border = 0;
        if (isMasked(item.scene, item.cell)) {
          border = masked(item, t, textures, x, y, blend);
          if (isFullyMasked(blend)) continue;
        }
        owners[at].item = index;
        owners[at].depth = z;
        const Texel texel = shade(item, t, textures, x, y, noise, blend, picture.known[at]);
        picture.colour[at] = glm::dvec4(glm::clamp(texel.colour, 0.0, 1.0), 1.0);
        picture.range[at] = std::max(texel.range, border);
        picture.levelRange[at] = texel.levelRange;
      }
  }
}

RenderedImage canvas(const Scene& scene, const std::vector<std::vector<Image8>>& textures, const FramePlan& plan,
                     const std::vector<PlannedCell>& cells, std::size_t viewIndex, bool cubic) {
  const Camera& view = plan.views[viewIndex];
  const int width = view.intrinsics.width, height = view.intrinsics.height;
  const std::size_t count = std::size_t(width) * std::size_t(height);
  RenderedImage picture{width,
                        height,
                        std::vector<glm::dvec4>(count, glm::dvec4(0)),
                        std::vector<std::uint8_t>(count, 0),
                        std::vector<double>(count, std::numeric_limits<double>::infinity()),
                        std::vector<double>(count, 0),
                        std::vector<double>(count, 0),
                        std::vector<BufferValues>(count),
                        std::vector<int>(count, 0)};
  std::vector<Owner> owners(count);
  const glm::ivec2 noise = noiseOffset(plan, viewIndex);
  const std::vector<DrawItem> items = drawListOf(scene, plan, cells, viewIndex, cubic);
  for (std::size_t s = 0; s < items.size(); ++s) drawItem(items[s], int(s), textures, view, noise, picture, owners);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const auto owner = [&](int i, int j) {
        return owners[std::size_t(j) * std::size_t(width) + std::size_t(i)].item;
      };
      bool same = true;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) same &= owner(x + i, y + j) == owner(x, y);
      picture.safe[std::size_t(y) * std::size_t(width) + std::size_t(x)] = same;
    }
  return picture;
}

// Cells of the current draw order, and cells that fade out at their previous ranks.
std::vector<PlannedCell> drawn(const FramePlan& plan) {
  std::vector<PlannedCell> cells = plan.cells;
  for (std::size_t i = plan.fadingOut.size(); i-- > 0;)
    cells.insert(cells.begin() + std::ptrdiff_t(plan.fadingOut[i].drawnBefore), plan.fadingOut[i].planned);
  return cells;
}

}  // namespace

RenderedImage render(const Scene& scene, const std::vector<std::vector<Image8>>& textures, const FramePlan& plan,
                     std::size_t view, TextureFilter filter) {
  const bool cubic = filter == TextureFilter::bicubic;
  RenderedImage picture = canvas(scene, textures, plan, drawn(plan), view, cubic);
  const glm::dvec3 background(plan.settings.background);
  std::optional<RenderedImage> previous;
  if (plan.previousWeight > 0) previous = canvas(scene, textures, plan, plan.previous, view, cubic);
  for (std::size_t at = 0; at < picture.colour.size(); ++at) {
    const auto shown = [](const glm::dvec4& colour, const glm::dvec3& behind) {
      return colour.a > 0 ? glm::dvec3(colour) : behind;
    };
    glm::dvec3 colour = shown(picture.colour[at], background);
    if (previous) {
      colour = glm::mix(colour, shown(previous->colour[at], colour), plan.previousWeight);
      picture.safe[at] &= previous->safe[at];
      picture.edge[at] = std::min(picture.edge[at], previous->edge[at]);
      picture.range[at] = std::max(picture.range[at], previous->range[at]);
      picture.levelRange[at] = std::max(picture.levelRange[at], previous->levelRange[at]);
    }
    picture.colour[at] = glm::dvec4(colour, picture.colour[at].a);
  }
  return picture;
}

}  // namespace ibr::reference
