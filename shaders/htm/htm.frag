#version 460
// SPDX-License-Identifier: Apache-2.0
// A pixel's colour ([H] Algorithm 9, eq. 7): photographs read at their harmonised coordinates, blended by the weights of
// eq. 5 over the cameras that see the point.
//
// Departures: visibility is soft, and the depth test is the renderer's own; the projection is exact at each pixel, only
// what is added to it is interpolated over the triangle. Where no camera is left, those that take part at the corners
// count though they may not see the point.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/htm.h"
#include "htm/htm_blend.glsl"
#include "htm/htm_encode.glsl"

layout(constant_id = 1) const bool kDisplaced = true;  // HtmMethod::harmonised

layout(set = 0, binding = kBindingHtmTriangles, scalar) readonly buffer Triangles {
  uvec3 triangles[];
};
layout(set = 0, binding = kBindingHtmRanked, scalar) readonly buffer Ranked {
  uvec2 ranked[];
};
layout(set = 0, binding = kBindingHtmCameras, scalar) readonly buffer Cameras {
  HtmCameraParameters cameras[];
};
layout(set = 0, binding = kBindingHtmDisplacements, scalar) readonly buffer Displacements {
  vec2 displacements[];
};
layout(set = 0, binding = kBindingHtmPhotographs) uniform sampler2DArray photographs;
layout(set = 0, binding = kBindingHtmDepths) uniform sampler2DArray depths;
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
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
    const uint camera = cameras[k].camera;
    const float depth = dot(cameras[k].depthOf, position);
    const float inFront = max(depth, 0.5 * cameras[k].nearDistance);  // nothing of the mesh lies between them
    const vec2 projected = vec2(dot(cameras[k].column, position), dot(cameras[k].row, position)) / inFront;
    vec2 at = projected;
    if (kDisplaced) {
      const uint first = k * frame.vertexCount;
      at += share.x * displacements[first + corner.x] + share.y * displacements[first + corner.y] +
            share.z * displacements[first + corner.z];
    }
    // To its last half pixel a picture counts in full.
    const vec2 border = 2.0 * min(at, cameras[k].size - at);
    const float inside = depth == inFront ? clamp(min(border.x, border.y), 0.0, 1.0) : 0.0;
    const float takesPart = dot(share, vec3(htmHas(members0, k), htmHas(members1, k), htmHas(members2, k)));
    const float level = log2(cameras[k].detail / (gl_FragCoord.w * inFront));
    const vec4 read = textureLod(photographs, vec3(at * texel, camera), level);
    const float nearest = 1.0 / max(textureLod(depths, vec3(projected * texel, camera), 0.0).r, 1e-30);
    const float tolerance = frame.depthTolerance + depth * cameras[k].texelWidth;
    const float inView = clamp(2.0 - (depth - nearest) / tolerance, 0.0, 1.0);
    const float counts = clamp(takesPart, 0.0, 1.0) * inside;
    htmAdd(seen, cameras[k].log2Weight, counts * inView * read.a, read.rgb);
    htmAdd(hidden, cameras[k].log2Weight, counts, read.rgb);
    settled = htmSettled(seen, cameras[k].log2Rest, frame.cut);
  }
  const vec4 sum = seen.sum.w > 0.0 ? seen.sum : hidden.sum;
  outColour = sum.w > 0.0 ? vec4(htmEncode(sum.rgb / sum.w), 1.0) : vec4(htmEncode(frame.background), 0.0);
}
