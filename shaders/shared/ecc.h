// SPDX-License-Identifier: Apache-2.0
// How a star is judged ([T] §3.5–3.6) in whole numbers, for GLSL and C++: the same samples, sums and winner, bit for
// bit, on every device.
//
// Positions are whole numbers of 2⁻⁷ px; the mean of two of them is their sum in 2⁻⁸ px. A pixel belongs to a triangle
// by the rasteriser's rule (its centre, top and left edges in, bottom and right out), found row by row with exact
// divisions. Texture coordinates run in 2⁻²⁴ px, weights in 2⁻¹⁴, values in 2⁻⁸ grey levels about mid-grey.
//
// Departures: sums are 64 bits wide instead of shifted right (NUMERICS T1–T3); what is compared are centred sums, exact
// to 2⁻¹⁶ grey² each, in 256-bit products (T4); no transcendental function draws the candidates (T7); a candidate's way
// ends before the *line* of an opposing edge, in the picture, in the means of two pictures and of all (T8).
#ifndef IBR_SHARED_ECC_H
#define IBR_SHARED_ECC_H

#include "shared/glsl.h"

#ifdef __cplusplus
#include <glm/gtc/type_precision.hpp>
namespace ibr::shader {
using glm::ivec2;
using glm::ivec3;
using std::int64_t;
using std::uint64_t;
}  // namespace ibr::shader
#define IBR_INOUT(type) type&
#else
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#define IBR_INOUT(type) inout type
#endif

IBR_SHARED_BEGIN

IBR_CONSTANT int kEccPixel = 256;  // of a mean, in its units
IBR_CONSTANT int kEccCoordinateBits = 24;
IBR_CONSTANT int kEccRunBits = 22;  // of texture coordinates along a run
IBR_CONSTANT int kEccRun = 64;      // most pixels of a run; then coordinates are taken anew
IBR_CONSTANT int kEccWeightBits = 14;
IBR_CONSTANT int kEccLongest = 262144;  // longest side of a triangle's box, in units of the mean: 1024 px
IBR_CONSTANT int kEccSteepest = 4;      // largest step of a texture coordinate from pixel to pixel, px

IBR_FUNCTION int64_t eccFloorDivide(int64_t a, int64_t b) {  // b > 0
  const int64_t quotient = a / b;
  return a - quotient * b < int64_t(0) ? quotient - int64_t(1) : quotient;
}

/// (b − a) × (c − a): twice the signed area.
IBR_FUNCTION int64_t eccArea(ivec2 a, ivec2 b, ivec2 c) {
  return int64_t(b.x - a.x) * int64_t(c.y - a.y) - int64_t(b.y - a.y) * int64_t(c.x - a.x);
}

// --- Coverage ---

/// First row whose centre is not above y (units of the mean): the first of a shape that begins there, and one past the
/// last of a shape that ends there.
IBR_FUNCTION int eccFirstRow(int y) {
  return (y + (kEccPixel / 2 - 1)) >> 8;
}

/// Where an edge crosses the rows' centres: the first column whose centre is not left of it.
struct EccEdge {
  int64_t column, rest;  // of the present row
  int64_t columnStep, restStep, whole;
};

/// `from` lies above `to`; at row `row`, for steps of `rows` rows.
IBR_FUNCTION EccEdge eccEdge(ivec2 from, ivec2 to, int row, int rows) {
  const int64_t dx = int64_t(to.x - from.x), dy = int64_t(to.y - from.y);
  EccEdge edge;
  edge.whole = dy * int64_t(kEccPixel);
  const int64_t crossing = int64_t(from.x - kEccPixel / 2) * dy +
                           (int64_t(row) * int64_t(kEccPixel) + int64_t(kEccPixel / 2 - from.y)) * dx + edge.whole -
                           int64_t(1);
  edge.column = eccFloorDivide(crossing, edge.whole);
  edge.rest = crossing - edge.column * edge.whole;
  const int64_t step = dx * int64_t(kEccPixel) * int64_t(rows);
  edge.columnStep = eccFloorDivide(step, edge.whole);
  edge.restStep = step - edge.columnStep * edge.whole;
  return edge;
}

IBR_FUNCTION void eccNextRow(IBR_INOUT(EccEdge) edge) {
  edge.column += edge.columnStep;
  edge.rest += edge.restStep;
  if (edge.rest >= edge.whole) {
    edge.rest -= edge.whole;
    edge.column += int64_t(1);
  }
}

// --- Samples ---

/// The affine map from pixels of the mean to one photograph, in a triangle: 2⁻²⁴ px, from the centre of the first
/// texel.
struct EccMap {
  int64_t originX, originY;        // at corner a of the mean
  int64_t xByX, xByY, yByX, yByY;  // change of x with x, of x with y, …, from pixel to pixel
};

/// m: corners in the mean, t: in the photograph; `area` = eccArea of m, > 0.
IBR_FUNCTION EccMap eccMap(ivec2 ma, ivec2 mb, ivec2 mc, ivec2 ta, ivec2 tb, ivec2 tc, int64_t area) {
  const int64_t bx = int64_t(mb.x - ma.x), by = int64_t(mb.y - ma.y), cx = int64_t(mc.x - ma.x),
                cy = int64_t(mc.y - ma.y);
  const int64_t ux = int64_t(tb.x - ta.x), uy = int64_t(tb.y - ta.y), vx = int64_t(tc.x - ta.x),
                vy = int64_t(tc.y - ta.y);
  const int64_t scale = int64_t(1) << (kEccCoordinateBits + 1);
  EccMap map;
  // To the centre of the first texel, and half a weight on, so that weights are rounded where bits are dropped.
  const int64_t shift = (int64_t(1) << (kEccCoordinateBits - kEccWeightBits - 1)) -
                        (int64_t(1) << (kEccCoordinateBits - 1));
  map.originX = (int64_t(ta.x) << (kEccCoordinateBits - 7)) + shift;
  map.originY = (int64_t(ta.y) << (kEccCoordinateBits - 7)) + shift;
  map.xByX = (ux * cy - vx * by) * scale / area;
  map.xByY = (vx * bx - ux * cx) * scale / area;
  map.yByX = (uy * cy - vy * by) * scale / area;
  map.yByY = (vy * bx - uy * cx) * scale / area;
  return map;
}

IBR_FUNCTION bool eccWithin(int64_t value, int64_t most) {
  return value >= -most && value <= most;
}

IBR_FUNCTION bool eccGentle(EccMap map) {
  const int64_t most = int64_t(kEccSteepest) << kEccCoordinateBits;
  return eccWithin(map.xByX, most) && eccWithin(map.xByY, most) && eccWithin(map.yByX, most) &&
         eccWithin(map.yByY, most);
}

IBR_FUNCTION bool eccSmall(ivec2 a, ivec2 b, ivec2 c) {
  const int width = max(a.x, max(b.x, c.x)) - min(a.x, min(b.x, c.x));
  const int height = max(a.y, max(b.y, c.y)) - min(a.y, min(b.y, c.y));
  return width <= kEccLongest && height <= kEccLongest;
}

/// Coordinates at the centre of pixel (column, row) of the mean, whose corner a is at `ma`.
IBR_FUNCTION int64_t eccAt(int64_t origin, int64_t byX, int64_t byY, ivec2 ma, int column, int row) {
  const int64_t x = int64_t(column) * int64_t(kEccPixel) + int64_t(kEccPixel / 2 - ma.x);
  const int64_t y = int64_t(row) * int64_t(kEccPixel) + int64_t(kEccPixel / 2 - ma.y);
  return origin + ((byX * x + byY * y) >> 8);
}

/// A texel is three signed bytes, red lowest: a level less 128.
IBR_FUNCTION ivec3 eccTexel(uint texel) {
  return ivec3(int(texel << 24) >> 24, int(texel << 16) >> 24, int(texel << 8) >> 24);
}

/// Bilinear, in 2⁻⁸ levels; weights of the right and lower neighbours in 2⁻¹⁴. Within ±32767.
IBR_FUNCTION int eccMixed(int t00, int t10, int t01, int t11, int wx, int wy) {
  const int whole = 1 << kEccWeightBits;
  const int upper = (t00 * (whole - wx) + t10 * wx + 32) >> 6;
  const int lower = (t01 * (whole - wx) + t11 * wx + 32) >> 6;
  const int value = (upper * (whole - wy) + lower * wy + whole / 2) >> kEccWeightBits;
  return value < -32767 ? -32767 : value;
}

IBR_FUNCTION ivec3 eccSample(uint t00, uint t10, uint t01, uint t11, int wx, int wy) {
  const ivec3 a = eccTexel(t00), b = eccTexel(t10), c = eccTexel(t01), d = eccTexel(t11);
  return ivec3(eccMixed(a.x, b.x, c.x, d.x, wx, wy), eccMixed(a.y, b.y, c.y, d.y, wx, wy),
               eccMixed(a.z, b.z, c.z, d.z, wx, wy));
}

// --- Sums and scores ---

/// Of one target; x is the source. Means are a channel's, products are summed over channels.
struct EccTarget {
  int64_t n;
  int64_t x0, x1, x2, y0, y1, y2;
  int64_t xx, yy, xy;
};

/// Σ(x − x̄)(y − ȳ) from Σxy, Σx, Σy over n > 0 samples, rounded up to a whole number by less than 1: x̄ and ȳ are split
/// into quotient and rest, so that nothing leaves 64 bits.
IBR_FUNCTION int64_t eccCentred(int64_t xy, int64_t x, int64_t y, int64_t n) {
  const int64_t ax = eccFloorDivide(x, n), ay = eccFloorDivide(y, n);
  const int64_t rx = x - ax * n, ry = y - ay * n;
  return xy - (ax * ay * n + ax * ry + ay * rx + rx * ry / n);
}

/// ECC = covariance / √(varianceX · varianceY), sums in 2⁻¹⁶ grey². Undefined where a variance is 0.
struct EccScore {
  int64_t covariance, varianceX, varianceY;
};

IBR_CONSTANT uint kEccChannels = 0u;      // a mean a channel and target, with a floor
IBR_CONSTANT uint kEccConcatenated = 1u;  // [T] eqs 1–3

/// Of `channels`: a target's part.
IBR_FUNCTION EccScore eccPlus(EccScore score, EccTarget t) {
  if (t.n == int64_t(0)) return score;
  const int64_t none = int64_t(0);
  score.covariance +=
      t.xy + eccCentred(none, t.x0, t.y0, t.n) + eccCentred(none, t.x1, t.y1, t.n) + eccCentred(none, t.x2, t.y2, t.n);
  score.varianceX +=
      t.xx + eccCentred(none, t.x0, t.x0, t.n) + eccCentred(none, t.x1, t.x1, t.n) + eccCentred(none, t.x2, t.x2, t.n);
  score.varianceY +=
      t.yy + eccCentred(none, t.y0, t.y0, t.n) + eccCentred(none, t.y1, t.y1, t.n) + eccCentred(none, t.y2, t.y2, t.n);
  return score;
}

/// What standing `way` (1/128 px) from where the match began costs, 2⁻¹⁶ grey² a sample and channel; `rigidity` is that of
/// one px.
IBR_FUNCTION int64_t eccCost(ivec2 way, int64_t rigidity) {
  const int64_t square = int64_t(way.x) * int64_t(way.x) + int64_t(way.y) * int64_t(way.y);
  return min((min(square, int64_t(1) << 30) * rigidity) >> 14, int64_t(1) << 30);
}

/// What going there costs: as much as that place costs more than where the point stands. Going back is free, not rewarded,
/// so that a move that wins never lowers the ECC itself.
IBR_FUNCTION int64_t eccToll(ivec2 wayThere, ivec2 wayHere, int64_t rigidity) {
  return max(eccCost(wayThere, rigidity) - eccCost(wayHere, rigidity), int64_t(0));
}

/// `all`: sums over the targets; `floor` and `cost` in 2⁻¹⁶ grey², a sample and channel.
IBR_FUNCTION EccScore eccFinished(EccScore channels, EccTarget all, uint definition, int64_t floor, int64_t cost) {
  EccScore score = channels;
  if (definition == kEccConcatenated) {
    const int64_t n = all.n * int64_t(3), x = all.x0 + all.x1 + all.x2, y = all.y0 + all.y1 + all.y2;
    score.covariance = n == int64_t(0) ? int64_t(0) : eccCentred(all.xy, x, y, n);
    score.varianceX = n == int64_t(0) ? int64_t(0) : eccCentred(all.xx, x, x, n);
    score.varianceY = n == int64_t(0) ? int64_t(0) : eccCentred(all.yy, y, y, n);
    return score;
  }
  const int64_t added = floor * all.n * int64_t(3);
  score.covariance += added - cost * all.n * int64_t(3);
  score.varianceX += added;
  score.varianceY += added;
  return score;
}

IBR_FUNCTION EccTarget eccSum(EccTarget a, EccTarget b) {
  a.n += b.n;
  a.x0 += b.x0;
  a.x1 += b.x1;
  a.x2 += b.x2;
  a.y0 += b.y0;
  a.y1 += b.y1;
  a.y2 += b.y2;
  a.xx += b.xx;
  a.yy += b.yy;
  a.xy += b.xy;
  return a;
}

IBR_FUNCTION bool eccDefined(EccScore s) {
  return s.varianceX > int64_t(0) && s.varianceY > int64_t(0);
}

/// 256 bits, lowest first.
struct EccWide {
  uint limb[8];
};

/// a² · b · c, all >= 0.
IBR_FUNCTION EccWide eccProduct(int64_t a, int64_t b, int64_t c) {
  uint factors[8];
  factors[0] = factors[2] = uint(a);
  factors[1] = factors[3] = uint(a >> 32);
  factors[4] = uint(b);
  factors[5] = uint(b >> 32);
  factors[6] = uint(c);
  factors[7] = uint(c >> 32);
  EccWide product;
  for (int i = 0; i < 8; ++i) product.limb[i] = 0u;
  product.limb[0] = factors[0];
  product.limb[1] = factors[1];
  for (int f = 1; f < 4; ++f) {  // product · factor, from the top limb down
    const uint64_t low = uint64_t(factors[2 * f]), high = uint64_t(factors[2 * f + 1]);
    EccWide next;
    uint64_t carry = uint64_t(0);
    uint64_t before = uint64_t(0);
    for (int i = 0; i < 8; ++i) {
      const uint64_t here = uint64_t(product.limb[i]);
      const uint64_t p = here * low, q = before * high;  // each < 2⁶⁴; they are added half by half
      const uint64_t sum = (p & uint64_t(0xffffffffu)) + (q & uint64_t(0xffffffffu)) + (carry & uint64_t(0xffffffffu));
      next.limb[i] = uint(sum);
      carry = (carry >> 32) + (p >> 32) + (q >> 32) + (sum >> 32);
      before = here;
    }
    product = next;
  }
  return product;
}

IBR_FUNCTION int eccCompare(EccWide a, EccWide b) {
  for (int i = 7; i >= 0; --i)
    if (a.limb[i] != b.limb[i]) return a.limb[i] > b.limb[i] ? 1 : -1;
  return 0;
}

/// Whether a's ECC is truly greater than b's. What is undefined is less than all that is defined.
IBR_FUNCTION bool eccGreater(EccScore a, EccScore b) {
  const int64_t none = int64_t(0);
  if (!eccDefined(a)) return false;
  if (!eccDefined(b)) return true;
  const int signA = a.covariance > none ? 1 : (a.covariance < none ? -1 : 0);
  const int signB = b.covariance > none ? 1 : (b.covariance < none ? -1 : 0);
  if (signA != signB) return signA > signB;
  const EccWide left = eccProduct(signA < 0 ? -a.covariance : a.covariance, b.varianceX, b.varianceY);
  const EccWide right = eccProduct(signB < 0 ? -b.covariance : b.covariance, a.varianceX, a.varianceY);
  const int order = eccCompare(left, right);
  return signA > 0 ? order > 0 : (signA < 0 && order < 0);
}

/// Whether a candidate is to be preferred to where the point stands; an undefined ECC there counts as 0.
IBR_FUNCTION bool eccWins(EccScore candidate, EccScore standing) {
  return eccGreater(candidate, standing) && (eccDefined(standing) || candidate.covariance > int64_t(0));
}

// --- Candidates ---

/// One word from two, all bits of both in all of its bits (an invertible mixing of the kind of PCG, O'Neill 2014).
IBR_FUNCTION uint eccHash(uint a, uint b) {
  uint h = a * 747796405u + (b ^ 2891336453u) * 277803737u;
  h = (h ^ (h >> 16)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return h ^ (h >> 16);
}

/// Of a point in one step: seeds of its candidates are eccHash(this, instance).
IBR_FUNCTION uint eccPointSeed(uint cycleSeed, uint member, uint point) {
  return eccHash(eccHash(cycleSeed, member), point);
}

/// ⌈√v⌉.
IBR_FUNCTION int64_t eccRootUp(int64_t v) {  // 0 <= v < 2⁵⁰
  int64_t root = int64_t(0);
  for (int bit = 24; bit >= 0; --bit) {
    const int64_t next = root + (int64_t(1) << bit);
    if (next * next <= v) root = next;
  }
  return root * root < v ? root + int64_t(1) : root;
}

/// How far p may go, (1 − 2⁻¹⁰) of the way to the line through a and b; 0 where they lie on a line or p behind it.
IBR_FUNCTION int eccReach(ivec2 p, ivec2 a, ivec2 b) {
  const int64_t area = eccArea(p, a, b);
  const int64_t dx = int64_t(b.x - a.x), dy = int64_t(b.y - a.y);
  const int64_t edge = eccRootUp(dx * dx + dy * dy);
  if (area <= int64_t(0) || edge == int64_t(0)) return 0;
  const int64_t reach = area / edge;
  const int64_t less = reach - (reach + int64_t(1023)) / int64_t(1024);
  return int(min(less, int64_t(1) << 20));
}

/// M′ = M·r²/R², at least 8 ([T] §3.7); r <= R.
IBR_FUNCTION uint eccInstances(uint instances, int radius, int most) {
  const int64_t scaled = int64_t(instances) * int64_t(radius) * int64_t(radius) / (int64_t(most) * int64_t(most));
  return min(instances, max(8u, uint(scaled)));
}

/// A point of the disc of this radius, uniformly; `seed` is the candidate's own.
IBR_FUNCTION ivec2 eccInDisc(uint seed, int radius) {
  uint h = seed;
  for (int attempt = 0; attempt < 16; ++attempt) {
    h = eccHash(h, uint(attempt));
    const uint side = uint(2 * radius + 1);
    const ivec2 at = ivec2(int(((h & 0xffffu) * side) >> 16) - radius, int(((h >> 16) * side) >> 16) - radius);
    if (at.x * at.x + at.y * at.y <= radius * radius) return at;
  }
  return ivec2(0, 0);
}

/// A point of the way of at most `radius` either way along `chord`, rounded towards 0.
IBR_FUNCTION ivec2 eccAlong(uint seed, int radius, ivec2 chord) {
  const uint h = eccHash(seed, 0u);
  const int64_t way = int64_t(int(((h & 0xffffu) * uint(2 * radius + 1)) >> 16) - radius);
  const int64_t edge = eccRootUp(int64_t(chord.x) * int64_t(chord.x) + int64_t(chord.y) * int64_t(chord.y));
  if (edge == int64_t(0)) return ivec2(0, 0);
  return ivec2(int(int64_t(chord.x) * way / edge), int(int64_t(chord.y) * way / edge));
}

IBR_SHARED_END

#endif
