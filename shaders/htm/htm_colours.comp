#version 460
// SPDX-License-Identifier: Apache-2.0
// View-dependent vertex colours (VDVBM, the comparison method of [H] §4.2). One thread per vertex. A vertex gets the
// mean of the pixels at its projections, weighted by eq. 5 and by visibility, as in htm.frag.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "htm/htm_project.glsl"
#include "htm/htm_blend.glsl"
#include "htm/htm_vertex.glsl"

layout(local_size_x = kHtmGroupSize) in;

layout(set = 0, binding = kBindingHtmPositions, scalar) readonly buffer Positions {
  vec3 positions[];
};
layout(set = 0, binding = kBindingHtmColours, scalar) writeonly buffer Colours {
  vec4 colours[];
};

void main() {
  const uint v = htmVertex();
  if (v >= frame.vertexCount) return;
  uvec2 left = ranked[v];
  const vec4 position = vec4(positions[v], 1.0);
  const vec2 texel = 1.0 / vec2(textureSize(photographs, 0).xy);
  HtmBlend seen = htmNothing(), hidden = htmNothing();
  bool settled = false;
  for (; htmAny(left) && !settled; left = htmWithoutFirst(left)) {
    const uint k = htmFirst(left);
    const HtmProjected projected = htmProject(k, position);
    const vec4 read = textureLod(photographs, vec3(projected.at * texel, cameras[k].camera), 0.0);
    const float counts = htmInside(k, projected, projected.at);
    htmAdd(seen, cameras[k].log2Weight, counts * htmInView(k, projected, texel) * read.a, read.rgb);
    htmAdd(hidden, cameras[k].log2Weight, counts, read.rgb);
    settled = htmSettled(seen, cameras[k].log2Rest, frame.cut);
  }
  const vec4 sum = seen.sum.w > 0.0 ? seen.sum : hidden.sum;
  colours[v] = sum.w > 0.0 ? vec4(sum.rgb / sum.w, 1.0) : vec4(0.0);
}
