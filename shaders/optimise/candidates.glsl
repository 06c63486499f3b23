// SPDX-License-Identifier: Apache-2.0
// Positions of a point's candidates, and which of them are valid. Reference: libibr/src/optimise/star_mesh.cpp.
layout(binding = kBindingKeptFirst, scalar) readonly buffer KeptFirst { uint keptFirst[]; };
layout(binding = kBindingKeptEdges, scalar) readonly buffer KeptEdges { uvec3 keptEdges[]; };
layout(binding = kBindingBorder, scalar) readonly buffer Borders { uvec3 borders[]; };

int maxMove(uint member, uint point, int radius) {
  int most = radius;
  for (uint e = starFirst[point]; e < starFirst[point + 1u]; ++e) {
    const uvec2 edge = starEdges[e];
    const ivec2 p = positionIn(member, point), a = positionIn(member, edge.x), b = positionIn(member, edge.y);
    most = min(most, eccMaxMove(p, a, b));
    for (uint k = 0u; k < mesh.members; ++k)
      if (k != member)
        most = min(most, eccMaxMove(p + positionIn(k, point), a + positionIn(k, edge.x), b + positionIn(k, edge.y)));
    if (mesh.members > 2u)
      most = min(most, eccMaxMove(sumOfPositions(point), sumOfPositions(edge.x), sumOfPositions(edge.y)));
  }
  return most;
}

ivec2 offsetOf(uint member, uint point, int reach, uint seed, uint instance) {
  if (instance == 0u) return ivec2(0);
  const uint own = eccHash(eccPointSeed(seed, member, point), instance);
  const uvec3 border = borders[point];
  if (border.z == kBorderInterior) return eccOffsetInDisc(own, reach);
  return eccOffsetAlong(own, reach, positionIn(member, border.y) - positionIn(member, border.x));
}

bool isUnfolded(ivec2 a, ivec2 b, ivec2 c) { return eccArea(a, b, c) > int64_t(0); }

bool fits(uint member, uint point, ivec2 offset) {
  const ivec2 to = positionIn(member, point) + offset, most = mesh.pictures[member].size * 128;
  if (to.x < 0 || to.y < 0 || to.x > most.x || to.y > most.y) return false;
  for (uint e = starFirst[point]; e < starFirst[point + 1u]; ++e) {
    const uvec2 edge = starEdges[e];
    const ivec2 a = positionIn(member, edge.x), b = positionIn(member, edge.y);
    if (!isUnfolded(to, a, b)) return false;
    for (uint k = 0u; k < mesh.members; ++k)
      if (k != member && !isUnfolded(to + positionIn(k, point), a + positionIn(k, edge.x), b + positionIn(k, edge.y)))
        return false;
    if (mesh.members > 2u &&
        !isUnfolded(sumOfPositions(point) + offset, sumOfPositions(edge.x), sumOfPositions(edge.y)))
      return false;
  }
  for (uint e = keptFirst[point]; e < keptFirst[point + 1u]; ++e) {
    const uvec3 edge = keptEdges[e];
    if (((edge.z >> member) & 1u) != 0u && !isUnfolded(to, positionIn(member, edge.x), positionIn(member, edge.y)))
      return false;
  }
  return true;
}
