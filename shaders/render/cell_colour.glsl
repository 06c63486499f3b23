// SPDX-License-Identifier: Apache-2.0
// Colours of a cell's members at a fragment, blended ([T] eq. 6), dithered (eq. 7), or the mean of both. Included by
// every fragment stage that draws cells.
//
// Texture coordinates depend on interpolated values alone: on some devices (lavapipe) helper invocations read 0 from
// buffers, which would give wrong gradients along every edge.
#include "render/cubic.glsl"
#include "shared/cell.h"
#include "shared/panorama.h"

layout(constant_id = 0) const int kMembers = 4;
layout(constant_id = 1) const bool kSingleArray = false;   // all members' photographs are layers of one array
layout(constant_id = 2) const bool kDissolve = false;  // opacity below 1: some pixels are left to surfaces behind

// Bit i: member i is a panorama. A specialisation constant, so that a scene of pinholes pays nothing, fragments of a
// mixed cell do not branch, and helper invocations know the value. A scene has few such combinations.
layout(constant_id = 3) const int kPanoramas = 0;

// Blend mode; a constant, because some devices (lavapipe) execute both sides of every branch.
layout(constant_id = 4) const uint kBlending = kBlend;

layout(constant_id = 9) const bool kCubic = false;  // bicubic filter where a photograph is magnified

layout(constant_id = 11) const bool kExposed = false;  // photographs have gains
layout(constant_id = 12) const bool kMasked = false;  // a member's photograph has a mask: the alpha of its texture

layout(location = 0) in vec3 inTexture[kMaxMembers];
layout(location = 4) flat in uint inCell;
layout(location = 5) flat in float inDetail;

layout(set = kSetFrame, binding = kBindingParameters, scalar) readonly buffer Parameters { CellParameters cells[]; };
layout(set = kSetFrame, binding = kBindingExposures, scalar) readonly buffer Exposures { CellExposure exposures[]; };
layout(set = kSetFrame, binding = kBindingNoise, scalar) readonly buffer Noise { uint noiseRank[]; };
layout(set = kSetCell, binding = 0) uniform sampler2DArray photograph0;
layout(set = kSetCell, binding = 1) uniform sampler2DArray photograph1;
layout(set = kSetCell, binding = 2) uniform sampler2DArray photograph2;
layout(set = kSetCell, binding = 3) uniform sampler2DArray photograph3;

// Gradients are passed explicitly: implicit ones would measure the parallax between members where neighbouring pixels
// choose different members. Samplers are not indexed, since not every device supports dynamic indexing.
vec4 photograph(int slot, vec3 coordinate, vec2 dx, vec2 dy) {
  if (slot == 0) return textureGrad(photograph0, coordinate, dx, dy);
  if (slot == 1) return textureGrad(photograph1, coordinate, dx, dy);
  if (slot == 2) return textureGrad(photograph2, coordinate, dx, dy);
  return textureGrad(photograph3, coordinate, dx, dy);
}

vec3 texel(int slot, ivec3 at) {
  if (slot == 0) return texelFetch(photograph0, at, 0).rgb;
  if (slot == 1) return texelFetch(photograph1, at, 0).rgb;
  if (slot == 2) return texelFetch(photograph2, at, 0).rgb;
  return texelFetch(photograph3, at, 0).rgb;
}

bool isPanorama(int member) { return (kPanoramas >> member & 1) != 0; }

vec2 photographSize(int member) {
  if (member == 0) return vec2(textureSize(photograph0, 0).xy);
  if (member == 1) return vec2(textureSize(photograph1, 0).xy);
  if (member == 2) return vec2(textureSize(photograph2, 0).xy);
  return vec2(textureSize(photograph3, 0).xy);
}

vec3 cubic(int slot, vec3 coordinate, bool around) {
  const ivec2 size = ivec2(photographSize(slot));
  const vec2 at = coordinate.xy * vec2(size) - 0.5;
  const ivec2 first = ivec2(floor(at)) - 1;
  const vec4 across = cubicWeights(fract(at.x)), down = cubicWeights(fract(at.y));
  vec3 sum = vec3(0.0);
  for (int y = 0; y < 4; ++y) {
    vec3 row = vec3(0.0);
    for (int x = 0; x < 4; ++x) {
      ivec2 texelAt = first + ivec2(x, y);
      if (around) texelAt.x = (texelAt.x + size.x) % size.x;
      row += across[x] * texel(slot, ivec3(clamp(texelAt, ivec2(0), size - 1), int(coordinate.z + 0.5)));
    }
    sum += down[y] * row;
  }
  return clamp(sum, 0.0, 1.0);
}

struct Sampling {
  vec2 at, dx, dy;
  float spacing, reach;  // of a panorama's taps: PanoramaFootprint
};

/// `detail`: factor on the gradients.
Sampling sampling(int member, float detail) {
  Sampling s;
  if (isPanorama(member)) {
    const vec3 ray = normalize(inTexture[member]);
    const vec2 size = photographSize(member);
    const PanoramaFootprint footprint = panoramaFootprint(ray, detail * dFdx(ray), detail * dFdy(ray), size);
    s.at = panoramaCoordinate(ray);
    s.dx = vec2(footprint.texels / size.x, 0.0);
    s.dy = vec2(0.0, footprint.texels / size.y);
    s.spacing = footprint.spacing;
    s.reach = footprint.reach;
  } else {
    s.at = inTexture[member].xy / inTexture[member].z;
    s.dx = detail * dFdx(s.at);
    s.dy = detail * dFdy(s.at);
    s.spacing = s.reach = 0.0;
  }
  return s;
}

vec3 exposed(int member, vec3 colour) {
  if (!kExposed) return colour;
  return exposedColour(colour, exposures[inCell].member[member].gain, exposures[inCell].member[member].slope);
}

// Returns the contribution of tap k, −reach to reach, to the colour of `member`, read through `slot`; pinhole: k = 0.
vec4 tap(int slot, int member, Sampling s, float k) {
  const float share = clamp(s.reach + 1.0 - abs(k), 0.0, 1.0) / (1.0 + 2.0 * s.reach);
  const vec3 coordinate = vec3(s.at.x + k * s.spacing, s.at.y, float(cells[inCell].member[member].layer));
  vec4 colour = photograph(slot, coordinate, s.dx, s.dy);
  if (kCubic) {  // replaces the linear colour as far as the finest level counts
    const vec2 size = photographSize(slot);
    const float coarser = log2(max(max(length(s.dx * size), length(s.dy * size)), 1.0));
    if (coarser < 1.0) {
      const vec3 linear = photograph(slot, coordinate, vec2(0.0), vec2(0.0)).rgb;
      colour.rgb += (1.0 - coarser) * (cubic(slot, coordinate, isPanorama(member)) - linear);
    }
  }
  colour.rgb = exposed(member, colour.rgb);
  return share * colour;
}

float noise(uvec2 pixel) {
  const uvec2 tile = (pixel + cells[inCell].noise) % uint(kNoiseSize);
  return noiseFromRank(noiseRank[tile.y * uint(kNoiseSize) + tile.x]);
}

bool isDissolved(uvec2 pixel) { return noise(pixel + kDissolveOffset) >= cells[inCell].opacity; }

// Colours of the members and their weights, for scenes with masks.
struct Shown {
  vec3 colour[kMaxMembers];
  vec4 weights;  // sum 1, or all 0: every member is masked
};

Shown shownMembers(Sampling samplings[kMaxMembers], vec4 weights) {
  Shown shown;
  for (int i = 0; i < kMembers; ++i) {
    vec4 sum = vec4(0.0);
    if (weights[i] > 0.0) {
      const float last = ceil(samplings[i].reach);
      for (float k = -last; k <= last; ++k) sum += tap(i, i, samplings[i], k);
    }
    shown.colour[i] = sum.rgb;
    weights[i] *= maskShare(sum.a);
  }
  const float total = weights[0] + weights[1] + weights[2] + weights[3];
  shown.weights = total > 0.0 ? weights / total : vec4(0.0);
  return shown;
}

// Blends like the rest of cellColour. Discards the fragment if every member is masked.
vec3 maskedColour(uvec2 pixel, Sampling samplings[kMaxMembers], vec4 weights) {
  const Shown shown = shownMembers(samplings, weights);
  if (shown.weights == vec4(0.0)) discard;
  vec3 blended = vec3(0.0), dithered = vec3(0.0);
  const int chosen = kBlending != kBlend ? ditherMember(shown.weights, noise(pixel)) : 0;
  for (int i = 0; i < kMembers; ++i) {
    blended += shown.weights[i] * shown.colour[i];
    if (i == chosen) dithered = shown.colour[i];
  }
  return kBlending == kBlend ? blended : (kBlending == kDither ? dithered : 0.5 * (blended + dithered));
}

/// Discards dissolved fragments, and fragments with all members masked. `pixel`: of the image, for the noise. `more`:
/// factor on the gradients; 1 for the detail of the image's size, less for finer detail.
vec3 cellColour(uvec2 pixel, float more) {
  const float detail = more * inDetail;
  Sampling samplings[kMaxMembers];
  vec4 weights = vec4(0.0);
  float reach = 0.0;
  for (int i = 0; i < kMembers; ++i) {
    samplings[i] = sampling(i, detail);
    weights[i] = cells[inCell].member[i].blend;
    reach = max(reach, samplings[i].reach);
  }
  if (kDissolve && isDissolved(pixel)) discard;
  if (kMasked) return maskedColour(pixel, samplings, weights);
  vec3 blended = vec3(0.0), dithered = vec3(0.0);
  const int chosen = kBlending != kBlend ? ditherMember(weights, noise(pixel)) : 0;
  // Sampling a member is expensive, so one loop serves all members. Pinhole cells run it once.
  const float last = ceil(reach);
  float k = -last;
  do {
    if (kBlending != kDither)
      for (int i = 0; i < kMembers; ++i)
        if (weights[i] > 0.0) blended += weights[i] * tap(i, i, samplings[i], k).rgb;
    if (kBlending != kBlend) {
      if (kSingleArray) {
        dithered += tap(0, chosen, samplings[chosen], k).rgb;
      } else {
        for (int i = 0; i < kMembers; ++i)
          if (i == chosen) dithered += tap(i, i, samplings[i], k).rgb;
      }
    }
  } while (++k <= last);
  return kBlending == kBlend ? blended : (kBlending == kDither ? dithered : 0.5 * (blended + dithered));
}
