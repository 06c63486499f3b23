// SPDX-License-Identifier: Apache-2.0
// Projects a point of the mesh into a planned camera and tests its visibility, for pixels and vertices alike. The depth
// image contains the point's own surface, so both tests need the depth tolerance.
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
  float inFront;  // depth, at least half the mesh's nearest distance: > 0
};

HtmProjected htmProject(uint k, vec4 position) {
  const float depth = dot(cameras[k].depthOf, position);
  const float inFront = max(depth, 0.5 * cameras[k].nearDistance);  // the mesh has no point between the two
  return HtmProjected(vec2(dot(cameras[k].column, position), dot(cameras[k].row, position)) / inFront, depth, inFront);
}

// Returns 1 inside the image, 0 outside and behind the camera; fades within the last half pixel at the border.
float htmInside(uint k, HtmProjected projected, vec2 read) {
  const vec2 border = 2.0 * min(read, cameras[k].size - read);
  return projected.depth == projected.inFront ? clamp(min(border.x, border.y), 0.0, 1.0) : 0.0;
}

// Returns 1 if the mesh does not hide the point, 0 if it clearly does. texel: 1 / size of a layer.
float htmInView(uint k, HtmProjected projected, vec2 texel) {
  const float inverse = textureLod(depths, vec3(projected.at * texel, cameras[k].camera), 0.0).r;
  const float nearest = 1.0 / max(inverse, 1e-30);
  const float tolerance = frame.depthTolerance + projected.depth * cameras[k].texelWidth;
  return clamp(2.0 - (projected.depth - nearest) / tolerance, 0.0, 1.0);
}
