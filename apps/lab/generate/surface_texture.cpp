// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/surface_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

namespace ibr {
namespace {

using glm::vec2;
using glm::vec3;

// Mixes the bits of a lattice point (MurmurHash3's finaliser, A. Appleby).
std::uint32_t hashed(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = std::uint32_t(x) * 0x9e3779b1u ^ std::uint32_t(y) * 0x85ebca77u ^ seed * 0xc2b2ae3du;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}
float share(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  return float(hashed(x, y, seed) >> 8) * 0x1p-24f;
}

// Value noise, 0 to 1, of wavelengths of about 2.
float noise(vec2 at, std::uint32_t seed) {
  const vec2 cell = glm::floor(at), f = at - cell, s = f * f * (3.0f - 2.0f * f);
  const auto x = std::int32_t(cell.x), y = std::int32_t(cell.y);
  return glm::mix(glm::mix(share(x, y, seed), share(x + 1, y, seed), s.x),
                  glm::mix(share(x, y + 1, seed), share(x + 1, y + 1, seed), s.x), s.y);
}

// Sum of octaves from `length` down to `finest`, about 0 to 1. Octaves lose little amplitude, so that details stay
// visible at every distance.
float octaves(vec2 at, float length, float finest, std::uint32_t seed) {
  constexpr float kGain = 0.8f;
  float sum = 0, weight = 1, weights = 0;
  for (; length > finest; length /= 2, weight *= kGain) {
    sum += weight * noise(at / length, seed++);
    weights += weight;
  }
  return weights > 0 ? 0.5f + 1.5f * (sum / weights - 0.5f) : 0.5f;
}

vec3 hue(float turn) {
  return 0.5f + 0.5f * glm::cos(6.2832f * (turn + vec3(0, 0.33f, 0.67f)));
}

// Colour of one of a material's pieces: bricks, stones, boards.
vec3 piece(std::int32_t x, std::int32_t y, std::uint32_t seed, vec3 dark, vec3 light) {
  return glm::mix(dark, light, share(x, y, seed)) * glm::mix(vec3(0.85f), hue(share(x, y, seed + 1)), 0.2f);
}

vec3 brick(vec2 at, float texel, std::uint32_t seed) {
  constexpr vec2 kSize(0.24f, 0.085f);
  constexpr float kMortar = 0.011f;
  const float row = std::floor(at.y / kSize.y);
  const float along = at.x / kSize.x + (int(row) % 2 == 0 ? 0.0f : 0.5f) + 0.1f * share(int(row), 7, seed);
  const vec2 inside(kSize.x * (along - std::floor(along)), at.y - row * kSize.y);
  const float worn = 0.006f * noise(at / 0.02f, seed + 2);
  const bool mortar = std::min({inside.x, inside.y, kSize.x - inside.x, kSize.y - inside.y}) < kMortar / 2 + worn;
  return mortar ? vec3(0.42f, 0.4f, 0.36f)
                : piece(int(std::floor(along)), int(row), seed, {0.16f, 0.05f, 0.035f}, {0.62f, 0.3f, 0.2f}) *
                      (0.5f + octaves(at, 0.06f, texel, seed + 20));
}

vec3 stone(vec2 at, float texel, std::uint32_t seed) {
  constexpr float kSize = 0.22f;
  const vec2 scaled = at / kSize + 0.4f * vec2(noise(at / 0.1f, seed), noise(at / 0.1f, seed + 1));
  const vec2 cell = glm::floor(scaled);
  float first = 9, second = 9;  // distances of the nearest two centres: their difference is 0 on joints
  std::int32_t x = 0, y = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const auto cx = std::int32_t(cell.x) + i, cy = std::int32_t(cell.y) + j;
      const float away = glm::length(vec2(cx, cy) + vec2(share(cx, cy, seed + 3), share(cx, cy, seed + 4)) - scaled);
      if (away < first) {
        second = std::exchange(first, away);
        x = cx, y = cy;
      } else {
        second = std::min(second, away);
      }
    }
  if (second - first < 0.09f) return vec3(0.1f, 0.09f, 0.08f);
  return piece(x, y, seed, {0.12f, 0.12f, 0.11f}, {0.66f, 0.62f, 0.5f}) *
         (0.45f + 1.1f * octaves(at, 0.08f, texel, seed + 10));
}

vec3 tiles(vec2 at, float texel, std::uint32_t seed) {
  constexpr float kSize = 0.3f;
  const vec2 cell = glm::floor(at / kSize), inside = at - cell * kSize;
  const auto x = int(cell.x), y = int(cell.y);
  const vec2 edge = glm::min(inside, kSize - inside);
  if (std::min(edge.x, edge.y) < 0.004f) return vec3(0.05f);
  const vec3 base = (x + y) % 2 == 0 ? piece(x, y, seed, {0.5f, 0.45f, 0.36f}, {0.8f, 0.76f, 0.66f})
                                     : piece(x, y, seed, {0.05f, 0.07f, 0.09f}, {0.3f, 0.2f, 0.16f});
  const float vein = std::abs(octaves(at + 5.0f * share(x, y, seed + 5), 0.16f, texel, seed + 30) - 0.5f);
  return glm::mix(vec3(0.75f, 0.6f, 0.45f), base, glm::smoothstep(0.0f, 0.05f, vein));
}

vec3 planks(vec2 at, float texel, std::uint32_t seed) {
  constexpr vec2 kSize(1.3f, 0.13f);
  const float row = std::floor(at.y / kSize.y);
  const float along = at.x / kSize.x + share(int(row), 1, seed);
  const vec2 inside(kSize.x * (along - std::floor(along)), at.y - row * kSize.y);
  if (std::min(inside.x, inside.y) < 0.006f) return vec3(0.03f);
  const auto x = int(std::floor(along)), y = int(row);
  const float bend = 0.02f * noise(at / 0.3f, seed + 6);
  const float grain = octaves({at.x * 0.12f + 3 * share(x, y, seed + 7), at.y + bend}, 0.05f, texel, seed + 40);
  return piece(x, y, seed, {0.2f, 0.1f, 0.05f}, {0.66f, 0.46f, 0.26f}) * (0.35f + 1.3f * grain);
}

vec3 crate(vec2 at, vec2 extent, float texel, std::uint32_t seed) {
  const vec2 edge = 0.5f * extent - glm::abs(at);
  const float frame = 0.14f * std::min(extent.x, extent.y);
  const vec3 paint = glm::mix(vec3(0.9f), hue(share(1, 1, seed)), 0.6f);
  if (std::min(edge.x, edge.y) < frame) return paint * planks({at.x + at.y, at.y - at.x}, texel, seed);
  // Marks in a coarse grid stand for a label.
  const vec2 cell = glm::floor(at / (0.07f * std::min(extent.x, extent.y)));
  const bool marked = std::abs(cell.y) < 4 && share(int(cell.x), int(cell.y), seed + 8) > 0.55f;
  const vec3 wood = planks({at.y, at.x}, texel, seed + 1);
  return marked ? 0.35f * wood * hue(share(2, 2, seed)) : wood;
}

vec3 poster(vec2 at, vec2 extent, float texel, std::uint32_t seed) {
  vec3 colour = 0.25f + 0.6f * hue(share(0, 0, seed));
  const float unit = std::min(extent.x, extent.y);
  for (int i = 1; i <= 30; ++i) {
    const auto s = [&](int n) { return share(i, n, seed); };
    const vec2 offset = at - (vec2(s(1), s(2)) - 0.5f) * extent;
    const float turn = 6.2832f * s(3), size = unit * (0.03f + 0.25f * s(4) * s(4));
    const vec2 turned(offset.x * std::cos(turn) + offset.y * std::sin(turn),
                      offset.y * std::cos(turn) - offset.x * std::sin(turn));
    const float ring = glm::length(turned);
    const bool covered = i % 3 == 0   ? ring < size && ring > 0.5f * size * s(5)
                         : i % 3 == 1 ? std::abs(turned.x) < size && std::abs(turned.y) < size * (0.15f + s(5))
                                      : ring < size && std::sin(turned.x * 25 / size) > 0;
    if (covered) colour = glm::mix(vec3(s(6) > 0.5f ? 0.9f : 0.02f), hue(s(7)), 0.75f);
  }
  return colour * (0.75f + 0.5f * octaves(at, 0.03f, texel, seed + 50));
}

vec3 cloth(vec2 at, float texel, std::uint32_t seed) {
  const float stripes = at.x / (0.05f + 0.08f * share(0, 1, seed));
  const auto stripe = int(std::floor(stripes + 0.6f * noise(at / 0.25f, seed)));
  const vec3 base = glm::mix(vec3(share(stripe, 2, seed)), hue(share(stripe, 3, seed)), 0.6f);
  const vec2 knot = glm::floor(at / 0.025f);
  return base * (0.35f + 0.7f * share(int(knot.x), int(knot.y), seed + 9)) *
         (0.6f + octaves(at, 0.1f, texel, seed + 60));
}

// Light of four lamps below the ceiling, and of everything around.
float light(const Surface& surface, glm::dvec2 at) {
  const glm::dvec3 point = surface.origin + surface.u * at.x + surface.v * at.y;
  const glm::dvec3 normal = glm::cross(surface.u, surface.v);
  double sum = 0.35;
  for (const glm::dvec3 lamp : {glm::dvec3(-2.6, 2.7, -1.7), {2.4, 2.7, -1.9}, {-2.2, 2.7, 1.8}, {2.9, 2.7, 1.6}}) {
    const glm::dvec3 to = lamp - point;
    const double squared = glm::dot(to, to);
    sum += (0.25 + 0.75 * std::abs(glm::dot(normal, to)) / std::sqrt(squared)) / (1 + 0.35 * squared);
  }
  return float(sum);
}

std::uint32_t encoded(vec3 linear) {
  const vec3 root = glm::sqrt(glm::clamp(linear, 0.0f, 1.0f)) * 255.0f + 0.5f;
  return std::uint32_t(root.x) | std::uint32_t(root.y) << 8 | std::uint32_t(root.z) << 16;
}
vec3 decoded(std::uint32_t texel) {
  const vec3 root(float(texel & 255), float(texel >> 8 & 255), float(texel >> 16));
  return root * root;  // times 255²
}

}  // namespace

vec3 surfaceColour(const Surface& surface, glm::dvec2 at, double texel) {
  const vec2 point(at), extent(surface.extentU, surface.extentV);
  const auto finest = float(texel);
  const std::uint32_t seed = surface.seed * 101;
  vec3 colour(0);
  switch (surface.material) {
    case Material::brick:
      colour = brick(point, finest, seed);
      break;
    case Material::stone:
      colour = stone(point, finest, seed);
      break;
    case Material::tiles:
      colour = tiles(point, finest, seed);
      break;
    case Material::planks:
      colour = planks(point, finest, seed);
      break;
    case Material::crate:
      colour = crate(point, extent, finest, seed);
      break;
    case Material::poster:
      colour = poster(point, extent, finest, seed);
      break;
    case Material::cloth:
      colour = cloth(point, finest, seed);
      break;
  }
  const float grain = 0.45f + 1.1f * octaves(point, 0.8f, finest, seed + 70);
  return glm::clamp(colour * grain * light(surface, at), 0.0f, 1.0f);
}

SurfaceTexture::SurfaceTexture(const Surface& surface, double density) {
  Level level{std::max(1, int(std::ceil(surface.extentU * density))),
              std::max(1, int(std::ceil(surface.extentV * density))),
              {}};
  level.texels.reserve(std::size_t(level.width) * std::size_t(level.height));
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      const glm::dvec2 at(((x + 0.5) / level.width - 0.5) * surface.extentU,
                          ((y + 0.5) / level.height - 0.5) * surface.extentV);
      level.texels.push_back(encoded(surfaceColour(surface, at, 1 / density)));
    }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& from = levels_.back();
    Level half{std::max(1, from.width / 2), std::max(1, from.height / 2), {}};
    half.texels.reserve(std::size_t(half.width) * std::size_t(half.height));
    for (int y = 0; y < half.height; ++y)
      for (int x = 0; x < half.width; ++x) {
        vec3 sum(0);
        for (const int j : {2 * y, std::min(2 * y + 1, from.height - 1)})
          for (const int i : {2 * x, std::min(2 * x + 1, from.width - 1)})
            sum += decoded(from.texels[std::size_t(j) * std::size_t(from.width) + std::size_t(i)]);
        half.texels.push_back(encoded(sum / (4 * 255.0f * 255.0f)));
      }
    levels_.push_back(std::move(half));
  }
}

vec3 SurfaceTexture::Level::sample(vec2 share) const {
  const float x = std::clamp(share.x * float(width) - 0.5f, 0.0f, float(width - 1));
  const float y = std::clamp(share.y * float(height) - 0.5f, 0.0f, float(height - 1));
  const auto left = int(x), top = int(y);
  const float fx = x - float(left), fy = y - float(top);
  const std::uint32_t* row = texels.data() + std::size_t(top) * std::size_t(width) + left;
  const std::uint32_t* next = top + 1 < height ? row + width : row;
  const int right = left + 1 < width ? 1 : 0;
  const vec3 upper = decoded(row[0]) * (1 - fx) + decoded(row[right]) * fx;
  const vec3 lower = decoded(next[0]) * (1 - fx) + decoded(next[right]) * fx;
  return upper * (1 - fy) + lower * fy;
}

vec3 SurfaceTexture::sample(vec2 share, float level) const {
  constexpr float kScale = 1 / (255.0f * 255.0f);
  const float wanted = std::clamp(level, 0.0f, float(levels_.size() - 1));
  const auto fine = std::size_t(wanted);
  const float coarse = wanted - float(fine);
  const vec3 first = levels_[fine].sample(share);
  return kScale * (coarse > 0 ? first * (1 - coarse) + levels_[fine + 1].sample(share) * coarse : first);
}

}  // namespace ibr
