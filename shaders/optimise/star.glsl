// SPDX-License-Identifier: Apache-2.0
// Scores the star of a point at a candidate ([T] §3.6). Reference: libibr/src/optimise/judge.cpp and star_mesh.cpp.
#include "optimise/mesh.glsl"

layout(binding = kBindingTexels, scalar) readonly buffer Texels { uint texels[]; };

struct StarSums {
  EccTarget targets[3];
  bool whole;
};

struct PairMaps {
  EccMap source, target;
  uint member, other;
  ivec2 origin;
};

ivec3 sampled(int texel, int stride, int x, int y) {  // coordinates relative to the start of the run
  const int upper = texel + (y >> kEccRunBits) * stride + (x >> kEccRunBits), lower = upper + stride;
  const int dropped = kEccRunBits - kEccWeightBits, mask = (1 << kEccWeightBits) - 1;
  return eccSample(texels[upper], texels[upper + 1], texels[lower], texels[lower + 1], (x >> dropped) & mask,
                   (y >> dropped) & mask);
}

void addRun(PairMaps maps, int column, int row, int pixels, inout EccTarget sums) {
  const int dropped = kEccCoordinateBits - kEccRunBits;
  const int64_t fraction = (int64_t(1) << kEccCoordinateBits) - int64_t(1);
  const int64_t ax = eccCoordinateAt(maps.source.originX, maps.source.xByX, maps.source.xByY, maps.origin, column, row);
  const int64_t ay = eccCoordinateAt(maps.source.originY, maps.source.yByX, maps.source.yByY, maps.origin, column, row);
  const int64_t bx = eccCoordinateAt(maps.target.originX, maps.target.xByX, maps.target.xByY, maps.origin, column, row);
  const int64_t by = eccCoordinateAt(maps.target.originY, maps.target.yByX, maps.target.yByY, maps.origin, column, row);
  const AlignmentPicture a = mesh.pictures[maps.member], b = mesh.pictures[maps.other];
  const int aTexel = int(a.firstTexel) + (int(ay >> kEccCoordinateBits) + 1) * int(a.stride) +
                     int(ax >> kEccCoordinateBits) + 1;
  const int bTexel = int(b.firstTexel) + (int(by >> kEccCoordinateBits) + 1) * int(b.stride) +
                     int(bx >> kEccCoordinateBits) + 1;
  int aX = int((ax & fraction) >> dropped), aY = int((ay & fraction) >> dropped);
  int bX = int((bx & fraction) >> dropped), bY = int((by & fraction) >> dropped);
  const int aStepX = int(maps.source.xByX >> dropped), aStepY = int(maps.source.yByX >> dropped);
  const int bStepX = int(maps.target.xByX >> dropped), bStepY = int(maps.target.yByX >> dropped);
  ivec3 sumX = ivec3(0), sumY = ivec3(0);
  for (int i = 0; i < pixels; ++i) {
    const ivec3 x = sampled(aTexel, int(a.stride), aX, aY), y = sampled(bTexel, int(b.stride), bX, bY);
    sumX += x;
    sumY += y;
    // A product is below 2³⁰, the sum of two below 2³¹, of three unsigned ones below 2³².
    const ivec3 xy = x * y;
    const ivec3 xx = x * x, yy = y * y;
    sums.xx += int64_t(uint(xx.x) + uint(xx.y) + uint(xx.z));
    sums.yy += int64_t(uint(yy.x) + uint(yy.y) + uint(yy.z));
    sums.xy += int64_t(xy.x + xy.y) + int64_t(xy.z);
    aX += aStepX;
    aY += aStepY;
    bX += bStepX;
    bY += bStepY;
  }
  sums.n += int64_t(pixels);
  sums.x0 += int64_t(sumX.x);
  sums.x1 += int64_t(sumX.y);
  sums.x2 += int64_t(sumX.z);
  sums.y0 += int64_t(sumY.x);
  sums.y1 += int64_t(sumY.y);
  sums.y2 += int64_t(sumY.z);
}

// Adds the rows between the ends of the edge top–bottom; the edge first–last spans these rows too.
void addRows(PairMaps maps, ivec2 top, ivec2 bottom, ivec2 first, ivec2 last, int step, int phase,
             inout EccTarget sums) {
  const int behind = eccFirstRow(bottom.y);
  int row = eccFirstRow(top.y);
  const int rest = (row + step - phase) % step;  // % is defined for non-negative values only
  row += rest == 0 ? 0 : step - rest;
  if (row >= behind) return;
  EccEdge near = eccEdge(top, bottom, row, step), far = eccEdge(first, last, row, step);
  for (; row < behind; row += step) {
    const int end = int(max(near.column, far.column));
    for (int column = int(min(near.column, far.column)); column < end; column += kEccRun)
      addRun(maps, column, row, min(end - column, kEccRun), sums);
    eccNextRow(near);
    eccNextRow(far);
  }
}

// Adds triangle a, b, c; returns false if the triangle cannot be scored.
bool addTriangle(uint member, uint other, ivec2 sa, ivec2 sb, ivec2 sc, ivec2 ta, ivec2 tb, ivec2 tc, int step,
                 int phase, inout EccTarget sums) {
  const ivec2 a = sa + ta, b = sb + tb, c = sc + tc;
  const int64_t area = eccArea(a, b, c);
  if (area <= int64_t(0) || !eccSizeFits(a, b, c)) return false;
  PairMaps maps;
  maps.source = eccMap(a, b, c, sa, sb, sc, area);
  maps.target = eccMap(a, b, c, ta, tb, tc, area);
  maps.member = member;
  maps.other = other;
  maps.origin = a;
  if (!eccGradientFits(maps.source) || !eccGradientFits(maps.target)) return false;
  ivec2 top = a, middle = b, bottom = c, swapped;
  if (middle.y < top.y) swapped = top, top = middle, middle = swapped;
  if (bottom.y < middle.y) swapped = middle, middle = bottom, bottom = swapped;
  if (middle.y < top.y) swapped = top, top = middle, middle = swapped;
  addRows(maps, top, middle, top, bottom, step, phase, sums);
  addRows(maps, middle, bottom, top, bottom, step, phase, sums);
  return true;
}

const EccTarget kNoSums = EccTarget(int64_t(0), int64_t(0), int64_t(0), int64_t(0), int64_t(0), int64_t(0), int64_t(0),
                                    int64_t(0), int64_t(0), int64_t(0));

StarSums judgedStar(uint member, uint point, ivec2 offset, int step, int phase) {
  StarSums sums;
  sums.whole = true;
  for (uint t = 0u; t < 3u; ++t) sums.targets[t] = kNoSums;
  uint target = 0u;
  for (uint other = 0u; other < mesh.members; ++other) {
    if (other == member) continue;
    const ivec2 source = positionIn(member, point) + offset, here = positionIn(other, point);
    EccTarget pair = kNoSums;
    for (uint e = starFirst[point]; e < starFirst[point + 1u]; ++e) {
      const uvec2 edge = starEdges[e];
      const bool judged = addTriangle(member, other, source, positionIn(member, edge.x), positionIn(member, edge.y),
                                      here, positionIn(other, edge.x), positionIn(other, edge.y), step, phase, pair);
      sums.whole = sums.whole && judged;
    }
    sums.targets[target++] = pair;
  }
  return sums;
}

int64_t pixelsOf(StarSums sums) { return sums.targets[0].n + sums.targets[1].n + sums.targets[2].n; }

EccScore scoreOf(StarSums sums, uint definition, int64_t floor, int64_t cost) {
  EccScore score = EccScore(int64_t(0), int64_t(0), int64_t(0));
  if (!sums.whole) return score;
  EccTarget all = kNoSums;
  for (uint t = 0u; t < 3u; ++t) {
    score = eccAdd(score, sums.targets[t]);
    all = eccSum(all, sums.targets[t]);
  }
  return eccFinalScore(score, all, definition, floor, cost);
}
