// SPDX-License-Identifier: Apache-2.0
// Where a planned camera shows a point of the mesh, and whether it sees it there: the same for pixels and for vertices.
// A point of the surface lies as deep as what is drawn there, so the depth test needs its tolerance in both.
#include "shared/htm.h"

layout(set = 0, binding = kBindingHtmRanked, scalar) readonly buffer Ranked {
  uvec2 ranked[];
};
layout(set = 0, binding = kBindingHtmCameras, scalar) readonly buffer Cameras {
  HtmCameraParameters cameras[];
};
layout(set = 0, binding = kBindingHtmPhotographs) uniform sampler2DArray photographs;
layout(set = 0, binding = kBindingHtmDepths) uniform sampler2DArray depths;
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

struct HtmProjected {
  vec2 at;        // px
  float depth;    // along the camera's axis
  float inFront;  // the same, but what lies nearer than the mesh can is held off: > 0
};

HtmProjected htmProject(uint k, vec4 position) {
  const float depth = dot(cameras[k].depthOf, position);
  const float inFront = max(depth, 0.5 * cameras[k].nearDistance);  // nothing of the mesh lies between them
  return HtmProjected(vec2(dot(cameras[k].column, position), dot(cameras[k].row, position)) / inFront, depth, inFront);
}

// 1 where a picture is read at a pixel of its own, 0 outside and behind it. To its last half pixel it counts in full.
float htmInside(uint k, HtmProjected projected, vec2 read) {
  const vec2 border = 2.0 * min(read, cameras[k].size - read);
  return projected.depth == projected.inFront ? clamp(min(border.x, border.y), 0.0, 1.0) : 0.0;
}

// 1 where nothing of the mesh lies before the point, 0 where something lies clearly before it. texel: of a layer.
float htmInView(uint k, HtmProjected projected, vec2 texel) {
  const float inverse = textureLod(depths, vec3(projected.at * texel, cameras[k].camera), 0.0).r;
  const float nearest = 1.0 / max(inverse, 1e-30);
  const float tolerance = frame.depthTolerance + projected.depth * cameras[k].texelWidth;
  return clamp(2.0 - (projected.depth - nearest) / tolerance, 0.0, 1.0);
}
