#version 460
// SPDX-License-Identifier: Apache-2.0
// Colour of a pixel ([H] Algorithm 9, eq. 7): photographs are read at their harmonised coordinates, and blended by the
// weights of eq. 5 over the cameras that see the point.
//
// Departures: visibility is soft, and the renderer does its own depth test. The projection is exact at each pixel; only
// its displacement is interpolated over the triangle. If no camera sees the point, all cameras that are members at the
// corners count.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "htm/htm_project.glsl"
#include "htm/htm_blend.glsl"
#include "htm/htm_encode.glsl"

layout(constant_id = 1) const bool kDisplaced = true;  // HtmMethod::harmonised

layout(set = 0, binding = kBindingHtmTriangles, scalar) readonly buffer Triangles {
  uvec3 triangles[];
};
layout(set = 0, binding = kBindingHtmDisplacements, scalar) readonly buffer Displacements {
  vec2 displacements[];
};

layout(location = 0) in vec3 inPosition;
layout(location = 1) in vec2 inShare;
layout(location = 2) flat in uint inTriangle;
layout(location = 0) out vec4 outColour;

void main() {
  const uvec3 corner = triangles[inTriangle];
  const vec3 share = vec3(1.0 - inShare.x - inShare.y, inShare);
  const uvec2 members0 = ranked[corner.x], members1 = ranked[corner.y], members2 = ranked[corner.z];
  const vec4 position = vec4(inPosition, 1.0);
  const vec2 texel = 1.0 / vec2(textureSize(photographs, 0).xy);
  HtmBlend seen = htmNothing(), hidden = htmNothing();
  bool settled = false;
  for (uvec2 left = members0 | members1 | members2; htmAny(left) && !settled; left = htmWithoutFirst(left)) {
    const uint k = htmFirst(left);
    const HtmProjected projected = htmProject(k, position);
    vec2 at = projected.at;
    if (kDisplaced) {
      const uint first = k * frame.vertexCount;
      at += share.x * displacements[first + corner.x] + share.y * displacements[first + corner.y] +
            share.z * displacements[first + corner.z];
    }
    const float takesPart = dot(share, vec3(htmHas(members0, k), htmHas(members1, k), htmHas(members2, k)));
    const float level = log2(cameras[k].detail / (gl_FragCoord.w * projected.inFront));
    const vec4 read = textureLod(photographs, vec3(at * texel, cameras[k].camera), level);
    const float counts = clamp(takesPart, 0.0, 1.0) * htmInside(k, projected, at);
    const float inView = htmInView(k, projected, texel);
    htmAdd(seen, cameras[k].log2Weight, counts * inView * read.a, read.rgb);
    htmAdd(hidden, cameras[k].log2Weight, counts, read.rgb);
    settled = htmSettled(seen, cameras[k].log2Rest, frame.cut);
  }
  const vec4 sum = seen.sum.w > 0.0 ? seen.sum : hidden.sum;
  outColour = sum.w > 0.0 ? vec4(htmEncode(sum.rgb / sum.w), 1.0) : vec4(htmEncode(frame.background), 0.0);
}
