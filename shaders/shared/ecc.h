// SPDX-License-Identifier: Apache-2.0
// Scoring of a star, the triangles around a point ([T] §3.5–3.6), in integers for GLSL and C++. Samples, sums and the
// winner are bit-identical on all devices.
//
// Positions are integers in 2⁻⁷ px; the mean of two positions is their sum in 2⁻⁸ px. Coverage follows the rasteriser's
// rule (a pixel's centre counts; top and left edges in, bottom and right out), row by row with exact divisions.
// Texture coordinates have a resolution of 2⁻²⁴ px, weights of 2⁻¹⁴, values of 2⁻⁸ grey levels about mid-grey.
//
// Departures: sums have 64 bits instead of a right shift. Scores compare centred sums, exact to 2⁻¹⁶ grey² each, in
// 256-bit products. Candidates are drawn without transcendental functions. A candidate's displacement ends before the
// *line* of an opposing edge: in the image, in the means of two images, and in the mean of all.
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

IBR_CONSTANT int kEccPixel = 256;  // one pixel, in units of the mean
IBR_CONSTANT int kEccCoordinateBits = 24;
IBR_CONSTANT int kEccRunBits = 22;  // fraction bits of texture coordinates along a run
IBR_CONSTANT int kEccRun = 64;      // maximum number of pixels of a run; the next run starts from exact coordinates
IBR_CONSTANT int kEccWeightBits = 14;
IBR_CONSTANT int kEccMaxSide = 262144;  // longest side of a triangle's box, in units of the mean: 1024 px
IBR_CONSTANT int kEccMaxGradient = 4;      // largest change of a texture coordinate from pixel to pixel, px

IBR_FUNCTION int64_t eccFloorDivide(int64_t a, int64_t b) {  // b > 0
  const int64_t quotient = a / b;
  return a - quotient * b < int64_t(0) ? quotient - int64_t(1) : quotient;
}

/// Returns (b − a) × (c − a): twice the signed area.
IBR_FUNCTION int64_t eccArea(ivec2 a, ivec2 b, ivec2 c) {
  return int64_t(b.x - a.x) * int64_t(c.y - a.y) - int64_t(b.y - a.y) * int64_t(c.x - a.x);
}

// --- Coverage ---

/// Returns the first row whose centre is not above y (units of the mean): the first row of a shape that begins at y,
/// and one past the last row of a shape that ends at y.
IBR_FUNCTION int eccFirstRow(int y) {
  return (y + (kEccPixel / 2 - 1)) >> 8;
}

/// Crossing of an edge with the rows' centres: the first column whose centre is not left of the edge.
struct EccEdge {
  int64_t column, rest;  // of the current row
  int64_t columnStep, restStep, whole;
};

/// `from` lies above `to`. The edge starts at row `row` and advances by `rows` rows.
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

/// Affine map from pixels of the mean to one photograph, for one triangle: 2⁻²⁴ px, from the centre of the first
/// texel.
struct EccMap {
  int64_t originX, originY;        // at corner a of the mean
  int64_t xByX, xByY, yByX, yByY;  // change per pixel: of x with x, of x with y, …
};

/// m: corners in the mean; t: corners in the photograph; `area` = eccArea of m, > 0.
IBR_FUNCTION EccMap eccMap(ivec2 ma, ivec2 mb, ivec2 mc, ivec2 ta, ivec2 tb, ivec2 tc, int64_t area) {
  const int64_t bx = int64_t(mb.x - ma.x), by = int64_t(mb.y - ma.y), cx = int64_t(mc.x - ma.x),
                cy = int64_t(mc.y - ma.y);
  const int64_t ux = int64_t(tb.x - ta.x), uy = int64_t(tb.y - ta.y), vx = int64_t(tc.x - ta.x),
                vy = int64_t(tc.y - ta.y);
  const int64_t scale = int64_t(1) << (kEccCoordinateBits + 1);
  EccMap map;
  // Shifts to the centre of the first texel, plus half a unit of the weights, so that dropping bits rounds.
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

IBR_FUNCTION bool eccGradientFits(EccMap map) {
  const int64_t most = int64_t(kEccMaxGradient) << kEccCoordinateBits;
  return eccWithin(map.xByX, most) && eccWithin(map.xByY, most) && eccWithin(map.yByX, most) &&
         eccWithin(map.yByY, most);
}

IBR_FUNCTION bool eccSizeFits(ivec2 a, ivec2 b, ivec2 c) {
  const int width = max(a.x, max(b.x, c.x)) - min(a.x, min(b.x, c.x));
  const int height = max(a.y, max(b.y, c.y)) - min(a.y, min(b.y, c.y));
  return width <= kEccMaxSide && height <= kEccMaxSide;
}

/// Returns a coordinate at the centre of pixel (column, row) of the mean, whose corner a is at `ma`.
IBR_FUNCTION int64_t eccCoordinateAt(int64_t origin, int64_t byX, int64_t byY, ivec2 ma, int column, int row) {
  const int64_t x = int64_t(column) * int64_t(kEccPixel) + int64_t(kEccPixel / 2 - ma.x);
  const int64_t y = int64_t(row) * int64_t(kEccPixel) + int64_t(kEccPixel / 2 - ma.y);
  return origin + ((byX * x + byY * y) >> 8);
}

/// Unpacks a texel: three signed bytes, red lowest, each a level minus 128.
IBR_FUNCTION ivec3 eccTexel(uint texel) {
  return ivec3(int(texel << 24) >> 24, int(texel << 16) >> 24, int(texel << 8) >> 24);
}

/// Interpolates bilinearly, in 2⁻⁸ levels; weights of the right and lower neighbours in 2⁻¹⁴. Within ±32767.
IBR_FUNCTION int eccBilinear(int t00, int t10, int t01, int t11, int wx, int wy) {
  const int whole = 1 << kEccWeightBits;
  const int upper = (t00 * (whole - wx) + t10 * wx + 32) >> 6;
  const int lower = (t01 * (whole - wx) + t11 * wx + 32) >> 6;
  const int value = (upper * (whole - wy) + lower * wy + whole / 2) >> kEccWeightBits;
  return value < -32767 ? -32767 : value;
}

IBR_FUNCTION ivec3 eccSample(uint t00, uint t10, uint t01, uint t11, int wx, int wy) {
  const ivec3 a = eccTexel(t00), b = eccTexel(t10), c = eccTexel(t01), d = eccTexel(t11);
  return ivec3(eccBilinear(a.x, b.x, c.x, d.x, wx, wy), eccBilinear(a.y, b.y, c.y, d.y, wx, wy),
               eccBilinear(a.z, b.z, c.z, d.z, wx, wy));
}

// --- Sums and scores ---

/// Sums over the samples of one target; x is the source. x and y per channel, products summed over the channels.
struct EccTarget {
  int64_t n;
  int64_t x0, x1, x2, y0, y1, y2;
  int64_t xx, yy, xy;
};

/// Returns Σ(x − x̄)(y − ȳ) from Σxy, Σx, Σy over n > 0 samples, rounded up by less than 1. x̄ and ȳ are split into
/// quotient and remainder, so that nothing exceeds 64 bits.
IBR_FUNCTION int64_t eccCentred(int64_t xy, int64_t x, int64_t y, int64_t n) {
  const int64_t ax = eccFloorDivide(x, n), ay = eccFloorDivide(y, n);
  const int64_t rx = x - ax * n, ry = y - ay * n;
  return xy - (ax * ay * n + ax * ry + ay * rx + rx * ry / n);
}

/// ECC = covariance / √(varianceX · varianceY), sums in 2⁻¹⁶ grey². Undefined if a variance is 0.
struct EccScore {
  int64_t covariance, varianceX, varianceY;
};

IBR_CONSTANT uint kEccChannels = 0u;      // one mean per channel and target, with a variance floor
IBR_CONSTANT uint kEccConcatenated = 1u;  // [T] eqs 1–3

/// Adds a target's sums to a score of definition kEccChannels.
IBR_FUNCTION EccScore eccAdd(EccScore score, EccTarget t) {
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

/// Returns the cost of a displacement `way` (1/128 px) from the initial match, 2⁻¹⁶ grey² per sample and channel.
/// `rigidity`: the cost of one px.
IBR_FUNCTION int64_t eccCost(ivec2 way, int64_t rigidity) {
  const int64_t square = int64_t(way.x) * int64_t(way.x) + int64_t(way.y) * int64_t(way.y);
  return min((min(square, int64_t(1) << 30) * rigidity) >> 14, int64_t(1) << 30);
}

/// Returns the additional cost of a move: the cost there less the cost here, at least 0. Moving back is free, but not
/// rewarded, so that a move that wins never lowers the ECC itself.
IBR_FUNCTION int64_t eccAddedCost(ivec2 displacementThere, ivec2 displacementHere, int64_t rigidity) {
  return max(eccCost(displacementThere, rigidity) - eccCost(displacementHere, rigidity), int64_t(0));
}

/// `all`: sums over the targets. `floor` and `cost`: 2⁻¹⁶ grey², per sample and channel.
IBR_FUNCTION EccScore eccFinalScore(EccScore channels, EccTarget all, uint definition, int64_t floor, int64_t cost) {
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

/// 256-bit integer, lowest limb first.
struct EccWideInt {
  uint limb[8];
};

/// Returns a² · b · c; all arguments >= 0.
IBR_FUNCTION EccWideInt eccProduct(int64_t a, int64_t b, int64_t c) {
  uint factors[8];
  factors[0] = factors[2] = uint(a);
  factors[1] = factors[3] = uint(a >> 32);
  factors[4] = uint(b);
  factors[5] = uint(b >> 32);
  factors[6] = uint(c);
  factors[7] = uint(c >> 32);
  EccWideInt product;
  for (int i = 0; i < 8; ++i) product.limb[i] = 0u;
  product.limb[0] = factors[0];
  product.limb[1] = factors[1];
  for (int f = 1; f < 4; ++f) {  // product · factor, limb by limb from the lowest
    const uint64_t low = uint64_t(factors[2 * f]), high = uint64_t(factors[2 * f + 1]);
    EccWideInt next;
    uint64_t carry = uint64_t(0);
    uint64_t before = uint64_t(0);
    for (int i = 0; i < 8; ++i) {
      const uint64_t here = uint64_t(product.limb[i]);
      const uint64_t p = here * low, q = before * high;  // each < 2⁶⁴; the halves are added separately
      const uint64_t sum = (p & uint64_t(0xffffffffu)) + (q & uint64_t(0xffffffffu)) + (carry & uint64_t(0xffffffffu));
      next.limb[i] = uint(sum);
      carry = (carry >> 32) + (p >> 32) + (q >> 32) + (sum >> 32);
      before = here;
    }
    product = next;
  }
  return product;
}

IBR_FUNCTION int eccCompare(EccWideInt a, EccWideInt b) {
  for (int i = 7; i >= 0; --i)
    if (a.limb[i] != b.limb[i]) return a.limb[i] > b.limb[i] ? 1 : -1;
  return 0;
}

/// Returns true if a's ECC is greater than b's, exactly. An undefined ECC is less than any defined one.
IBR_FUNCTION bool eccGreater(EccScore a, EccScore b) {
  const int64_t none = int64_t(0);
  if (!eccDefined(a)) return false;
  if (!eccDefined(b)) return true;
  const int signA = a.covariance > none ? 1 : (a.covariance < none ? -1 : 0);
  const int signB = b.covariance > none ? 1 : (b.covariance < none ? -1 : 0);
  if (signA != signB) return signA > signB;
  const EccWideInt left = eccProduct(signA < 0 ? -a.covariance : a.covariance, b.varianceX, b.varianceY);
  const EccWideInt right = eccProduct(signB < 0 ? -b.covariance : b.covariance, a.varianceX, a.varianceY);
  const int order = eccCompare(left, right);
  return signA > 0 ? order > 0 : (signA < 0 && order < 0);
}

/// Returns true if a candidate beats the current position; an undefined ECC there counts as 0.
IBR_FUNCTION bool eccWins(EccScore candidate, EccScore standing) {
  return eccGreater(candidate, standing) && (eccDefined(standing) || candidate.covariance > int64_t(0));
}

// --- Candidates ---

/// Hashes two words to one; every bit depends on all input bits (invertible mixing like PCG, O'Neill 2014).
IBR_FUNCTION uint eccHash(uint a, uint b) {
  uint h = a * 747796405u + (b ^ 2891336453u) * 277803737u;
  h = (h ^ (h >> 16)) * 2246822519u;
  h = (h ^ (h >> 13)) * 3266489917u;
  return h ^ (h >> 16);
}

/// Returns the seed of a point in one step; the seeds of its candidates are eccHash(seed, instance).
IBR_FUNCTION uint eccPointSeed(uint cycleSeed, uint member, uint point) {
  return eccHash(eccHash(cycleSeed, member), point);
}

/// Returns ⌈√v⌉.
IBR_FUNCTION int64_t eccCeilSqrt(int64_t v) {  // 0 <= v < 2⁵⁰
  int64_t root = int64_t(0);
  for (int bit = 24; bit >= 0; --bit) {
    const int64_t next = root + (int64_t(1) << bit);
    if (next * next <= v) root = next;
  }
  return root * root < v ? root + int64_t(1) : root;
}

/// Returns the largest displacement of p: (1 − 2⁻¹⁰) of its distance to the line a–b; 0 if p is on or behind the line.
IBR_FUNCTION int eccMaxMove(ivec2 p, ivec2 a, ivec2 b) {
  const int64_t area = eccArea(p, a, b);
  const int64_t dx = int64_t(b.x - a.x), dy = int64_t(b.y - a.y);
  const int64_t edge = eccCeilSqrt(dx * dx + dy * dy);
  if (area <= int64_t(0) || edge == int64_t(0)) return 0;
  const int64_t reach = area / edge;
  const int64_t less = reach - (reach + int64_t(1023)) / int64_t(1024);
  return int(min(less, int64_t(1) << 20));
}

/// Returns M′ = M·r²/R², at least 8 ([T] §3.7); r <= R.
IBR_FUNCTION uint eccCandidateCount(uint instances, int radius, int most) {
  const int64_t scaled = int64_t(instances) * int64_t(radius) * int64_t(radius) / (int64_t(most) * int64_t(most));
  return min(instances, max(8u, uint(scaled)));
}

/// Returns a uniformly distributed point of the disc with this radius; `seed` is the candidate's.
IBR_FUNCTION ivec2 eccOffsetInDisc(uint seed, int radius) {
  uint h = seed;
  for (int attempt = 0; attempt < 16; ++attempt) {
    h = eccHash(h, uint(attempt));
    const uint side = uint(2 * radius + 1);
    const ivec2 at = ivec2(int(((h & 0xffffu) * side) >> 16) - radius, int(((h >> 16) * side) >> 16) - radius);
    if (at.x * at.x + at.y * at.y <= radius * radius) return at;
  }
  return ivec2(0, 0);
}

/// Returns a uniformly distributed displacement of at most `radius` along `chord`, rounded towards 0.
IBR_FUNCTION ivec2 eccOffsetAlong(uint seed, int radius, ivec2 chord) {
  const uint h = eccHash(seed, 0u);
  const int64_t way = int64_t(int(((h & 0xffffu) * uint(2 * radius + 1)) >> 16) - radius);
  const int64_t edge = eccCeilSqrt(int64_t(chord.x) * int64_t(chord.x) + int64_t(chord.y) * int64_t(chord.y));
  if (edge == int64_t(0)) return ivec2(0, 0);
  return ivec2(int(int64_t(chord.x) * way / edge), int(int64_t(chord.y) * way / edge));
}

IBR_SHARED_END

#endif
