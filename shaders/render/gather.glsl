// SPDX-License-Identifier: Apache-2.0
// Computes a pixel's colour from the photographs that see its surfaces. Shared by the fragment stages of the gather.
#include "render/cubic.glsl"
#include "render/gather_view.glsl"
#include "shared/cell.h"
#include "shared/panorama.h"

layout(constant_id = 0) const int kCandidates = 12;
layout(constant_id = 1) const int kLayers = 2;
layout(constant_id = 2) const int kColours = 4;
layout(constant_id = 3) const int kSlots = 1;       // bound texture arrays of photographs
layout(constant_id = 4) const int kDepthSlots = 1;  // bound texture arrays of depths
layout(constant_id = 5) const bool kPanoramas = false;  // a photograph may be a panorama
layout(constant_id = 6) const bool kExposed = false;    // photographs have gains
layout(constant_id = 7) const bool kMasked = false;     // photographs have masks
layout(constant_id = 8) const bool kCubic = false;      // bicubic filter where a photograph is magnified

layout(set = kSetGatherView, binding = kBindingGatherVoted) uniform sampler2D voted;
layout(set = kSetGatherView, binding = kBindingGatherHoles) uniform sampler2D holes;
layout(set = kSetGatherTextures, binding = kBindingGatherPhotographs) uniform texture2DArray photographs[kMaxGathered];
layout(set = kSetGatherTextures, binding = kBindingGatherDepths) uniform texture2DArray depths[kMaxGathered];
layout(set = kSetGatherTextures, binding = kBindingGatherSamplers) uniform sampler samplers[2];  // clamping, wrapping

// Texture arrays are not indexed, since not every device supports it. OF(s) is an expression for slot s.
#define IF_SLOT(count, OF, s) \
  if (count == s + 1 || slot == uint(s)) return OF(s);
#define OF_SLOTS(count, OF)                                                                              \
  IF_SLOT(count, OF, 0) IF_SLOT(count, OF, 1) IF_SLOT(count, OF, 2) IF_SLOT(count, OF, 3)                \
  IF_SLOT(count, OF, 4) IF_SLOT(count, OF, 5) IF_SLOT(count, OF, 6) IF_SLOT(count, OF, 7)                \
  IF_SLOT(count, OF, 8) IF_SLOT(count, OF, 9) IF_SLOT(count, OF, 10) IF_SLOT(count, OF, 11)              \
  IF_SLOT(count, OF, 12) IF_SLOT(count, OF, 13) IF_SLOT(count, OF, 14)                                   \
  return OF(15);
#define SAMPLED(which, s)                                                            \
  (kPanoramas && around ? textureLod(sampler2DArray(which[s], samplers[1]), at, lod) \
                        : textureLod(sampler2DArray(which[s], samplers[0]), at, lod))
#define OF_PHOTOGRAPH(s) SAMPLED(photographs, s)
#define OF_DEPTH(s) SAMPLED(depths, s)
#define TEXEL_OF_PHOTOGRAPH(s) texelFetch(sampler2DArray(photographs[s], samplers[0]), at, 0).rgb
#define SIZE_OF_PHOTOGRAPH(s) textureSize(sampler2DArray(photographs[s], samplers[0]), 0).xy

vec4 photographAt(uint slot, vec3 at, float lod, bool around) { OF_SLOTS(kSlots, OF_PHOTOGRAPH) }
vec3 photographTexel(uint slot, ivec3 at) { OF_SLOTS(kSlots, TEXEL_OF_PHOTOGRAPH) }
ivec2 photographSize(uint slot) { OF_SLOTS(kSlots, SIZE_OF_PHOTOGRAPH) }
vec4 depthAt(uint slot, vec3 at, float lod, bool around) { OF_SLOTS(kDepthSlots, OF_DEPTH) }

vec3 cubicPhotographAt(uint slot, vec3 coordinate, bool around) {
  const ivec2 size = photographSize(slot);
  const vec2 at = coordinate.xy * vec2(size) - 0.5;
  const ivec2 first = ivec2(floor(at)) - 1;
  const vec4 across = cubicWeights(fract(at.x)), down = cubicWeights(fract(at.y));
  vec3 sum = vec3(0.0);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      ivec2 texelAt = first + ivec2(x, y);
      if (around) texelAt.x = (texelAt.x + size.x) % size.x;
      texelAt = clamp(texelAt, ivec2(0), size - 1);
      sum += across[x] * down[y] * photographTexel(slot, ivec3(texelAt, int(coordinate.z + 0.5)));
    }
  return clamp(sum, 0.0, 1.0);
}

bool goesAround(int k) { return kPanoramas && views[c.view].candidate[k].panorama != 0u; }

/// Projection of a point into a candidate, with weight and mip level.
struct Sight {
  vec2 at;       // texture coordinate
  float weight;  // 0: the candidate does not see the point
  float lod;     // mip level
};

Sight sightOf(int k, vec3 ray, float rho, float uncertainty) {
  Sight sight = Sight(vec2(0.0), 0.0, 0.0);
  const uint v = c.view;
  const vec3 shift = views[v].candidate[k].shift, turned = views[v].candidate[k].toPhotograph * ray,
             direction = turned + rho * shift;
  const bool around = goesAround(k);
  const float distance = length(direction);
  float border = 1.0, here;
  if (around) {
    if (!(distance > 0.0)) return sight;
    sight.at = panoramaCoordinate(direction);
    here = rho / distance;
  } else {
    if (!(direction.z < 0.0)) return sight;
    const vec2 tangent = vec2(direction.x, -direction.y) / -direction.z;
    sight.at = views[v].candidate[k].principal + views[v].candidate[k].focal * tangent;
    const vec2 inside = min(sight.at, 1.0 - sight.at);
    // In widths: the border is equally wide on all sides.
    const float least = min(inside.x, inside.y * views[v].candidate[k].aspect);
    if (least < 0.0) return sight;
    border = min(least / kGatherBorder, 1.0);
    here = rho / -direction.z;
  }
  // Angle at the point between the two rays. The cross product uses the shift: it is precise for nearly parallel rays.
  const float angle = atan(rho * length(cross(turned, shift)), dot(turned, direction));
  const float beyond = angle + views[v].candidate[k].distanceCost;
  const float finer = views[v].candidate[k].focalPx * length(ray) / (views[v].focalPx * distance);
  const float resolution = min(finer, kGatherMaxResolution);
  const vec2 depth =
      depthAt(views[v].candidate[k].depthSlot, vec3(sight.at, float(views[v].candidate[k].depthLayer)), 0.0, around)
          .rg;
  const float own = views[v].candidate[k].depthScale * depth.r;
  const float unsure = uncertainty * here + gatherUncertainty(depth.g) * own;
  const float tolerance = 2.0 * gatherTolerance(views[v].candidate[k].step, here) + views[v].candidate[k].residual +
                          kGatherOcclusionSigmas * unsure;
  const float before = clamp((own - here) / tolerance - 1.0, 0.0, 1.0),
              behind = clamp((here - own) / tolerance - 1.0, 0.0, 1.0);
  const float visible = max((1.0 - before) * (1.0 - (1.0 - kGatherBehind) * behind), kGatherHidden);
  const float apart = smoothstep(0.0, kGatherOwnPoseCost, beyond);
  sight.weight = views[v].candidate[k].weight * resolution * resolution * mix(1.0, border, apart) *
                 mix(1.0, visible, apart) / ((kGatherAngleFloor + beyond) * max(apart, kGatherMinApart));
  const float moved = uncertainty * angle * views[v].candidate[k].focalPx;  // px
  sight.lod = max(log2(max(finer * views[v].detail, moved)), 0.0);
  return sight;
}

float maskOf(int k, vec2 at, float lod) {
  const uint v = c.view;
  const vec3 coordinate = vec3(at, float(views[v].candidate[k].layer));
  return maskShare(photographAt(views[v].candidate[k].slot, coordinate, lod, goesAround(k)).a);
}

vec3 colourOf(int k, vec2 at, float lod) {
  const uint v = c.view, slot = views[v].candidate[k].slot;
  const vec3 coordinate = vec3(at, float(views[v].candidate[k].layer));
  const bool around = goesAround(k);
  vec3 colour = photographAt(slot, coordinate, lod, around).rgb;
  if (kCubic && lod < 1.0) {  // replaces the linear colour as far as the finest level counts
    const vec3 linear = photographAt(slot, coordinate, 0.0, around).rgb;
    colour += (1.0 - lod) * (cubicPhotographAt(slot, coordinate, around) - linear);
  }
  if (kExposed) colour = exposedColour(colour, views[v].candidate[k].gain, views[v].candidate[k].slope);
  return colour;
}

struct Gathered {
  vec3 colour;
  float variance;  // 8-bit levels², mean over the channels; negative: no photograph sees the surface
  vec4 shares;     // of the four photographs of largest weight, best first
};

Gathered gather(vec3 ray, float rho, float uncertainty) {
  // Best photographs by weight. The weight of number N + 1 is subtracted from the N best, so that ranks fade.
  float weight[kMaxGatheredColours + 1], lod[kMaxGatheredColours + 1];
  int who[kMaxGatheredColours + 1];
  vec2 at[kMaxGatheredColours + 1];
  for (int i = 0; i <= kColours; ++i) {
    weight[i] = 0.0;
    who[i] = 0;
    lod[i] = 0.0;
    at[i] = vec2(0.0);
  }
  for (int k = 0; k < kCandidates; ++k) {
    if (k >= int(views[c.view].count)) break;
    Sight sight = sightOf(k, ray, rho, uncertainty);
    if (kMasked && sight.weight > 0.0) sight.weight *= maskOf(k, sight.at, sight.lod);
    int carried = k;
    for (int i = 0; i <= kColours; ++i)
      if (sight.weight > weight[i]) {
        const Sight displaced = Sight(at[i], weight[i], lod[i]);
        const int other = who[i];
        at[i] = sight.at;
        weight[i] = sight.weight;
        lod[i] = sight.lod;
        who[i] = carried;
        sight = displaced;
        carried = other;
      }
  }
  Gathered result = Gathered(vec3(0.0), -1.0, vec4(0.0));
  float sum = 0.0;
  vec3 mean = vec3(0.0), square = vec3(0.0);
  for (int i = 0; i < kColours; ++i) {
    const float w = weight[i] - weight[kColours];
    if (!(w > 0.0)) continue;
    const vec3 colour = colourOf(who[i], at[i], lod[i]);
    if (i < 4) result.shares[i] = w;
    sum += w;
    mean += w * colour;
    square += w * colour * colour;
  }
  if (!(sum > 0.0)) return result;
  result.shares /= sum;
  result.colour = mean / sum;
  const vec3 spread = max(square / sum - result.colour * result.colour, vec3(0.0));
  result.variance = dot(spread, vec3(255.0 * 255.0 / 3.0));
  return result;
}

/// Result of the vote at a pixel, with holes filled.
struct Surfaces {
  float rho[2];
  float uncertainty[2];  // of ρ, as a share of ρ
  int tier[2];
  float opacity;  // of the first surface, in front of the second
  float spread;   // of the hypotheses about the nearest surface that hides at least half, a share of its ρ
  int count;      // number of surfaces; 0: none
};

Surfaces surfacesAt(vec2 pixel) {
  const ivec2 at = min(ivec2(pixel * vec2(c.voteExtent) / vec2(c.extent)), ivec2(c.voteExtent) - 1);
  const vec4 vote = texelFetch(voted, at, 0);
  Surfaces s;
  s.rho[0] = vote.x;
  s.rho[1] = max(vote.y, 0.0);
  s.opacity = vote.z;
  const uint code = uint(vote.w);
  for (int l = 0; l < 2; ++l) {
    s.tier[l] = gatherIsCompleted(code, l) ? 2 : 0;
    s.uncertainty[l] = gatherUncertainty(gatherConsensus(code, l));
  }
  s.count = vote.y >= 0.0 ? 2 : 1;
  s.spread = gatherSpread(code);
  if (gatherIsHole(code)) {  // interpolated from the level of half the size
    const ivec2 last = ivec2(c.voteExtent + 1u) / 2 - 1;
    const vec2 half_ = 0.5 * (vec2(at) + 0.5) - 0.5;
    const ivec2 corner = ivec2(floor(half_));
    const vec2 t = half_ - vec2(corner);
    const vec4 a = texelFetch(holes, clamp(corner, ivec2(0), last), 0),
               b = texelFetch(holes, clamp(corner + ivec2(1, 0), ivec2(0), last), 0),
               d = texelFetch(holes, clamp(corner + ivec2(0, 1), ivec2(0), last), 0),
               e = texelFetch(holes, clamp(corner + ivec2(1, 1), ivec2(0), last), 0);
    s.rho[0] = mix(mix(a.r, b.r, t.x), mix(d.r, e.r, t.x), t.y);
    s.tier[0] = 3;
    s.count = a.a > 0.0 ? 1 : 0;
  }
  return s;
}

/// A gathered pixel.
struct Pixel {
  vec3 colour;
  int tier;        // −1: nothing is shown
  float rho;       // of the nearest surface that hides at least half of the surfaces behind
  float variance;  // of the surface with the largest weight, like tier and shares
  vec4 shares;
  float sigma;  // one standard deviation of ρ
};

Pixel gatheredPixel() {
  const Surfaces s = surfacesAt(gl_FragCoord.xy);
  const vec4 toRay = views[c.view].toRay;
  const vec3 ray = vec3(toRay.xy * gl_FragCoord.xy + toRay.zw, -1.0);
  Pixel pixel = Pixel(vec3(0.0), -1, s.count == 2 && s.opacity < 0.5 ? s.rho[1] : s.rho[0], 0.0, vec4(0.0),
                      0.0);
  float behind = 1.0, sum = 0.0, most = -1.0;
  for (int l = 0; l < kLayers; ++l) {
    if (l >= s.count) break;
    const Gathered gathered = gather(ray, s.rho[l], s.uncertainty[l]);
    if (gathered.variance < 0.0) continue;
    const float opacity = l + 1 == s.count ? 1.0 : s.opacity;
    const float weight = behind * opacity / (1.0 + gathered.variance / (kGatherColourSpread * kGatherColourSpread));
    behind *= 1.0 - opacity;
    sum += weight;
    pixel.colour += weight * gathered.colour;
    if (weight > most) {
      most = weight;
      pixel.tier = s.tier[l];
      pixel.variance = gathered.variance;
      pixel.shares = gathered.shares;
    }
  }
  if (!(sum > 0.0) || pixel.tier > views[c.view].maxTier)
    pixel.tier = -1;
  else
    pixel.colour /= sum;
  pixel.sigma = gatherSigma(pixel.tier, pixel.rho, views[c.view].step, s.spread, pixel.variance);
  return pixel;
}

vec4 canvasColour(Pixel pixel) { return vec4(pixel.colour, (255.0 - 64.0 * float(pixel.tier)) / 255.0); }

float canvasDepth(Pixel pixel) {
  return c.depthFirst + c.depthSpan * clamp(1.0 - views[c.view].nearDistance * pixel.rho, 0.0, 1.0);
}
