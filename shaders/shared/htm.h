// SPDX-License-Identifier: Apache-2.0
// Parameters of a frame of a harmonised model for its shaders ([H] §3.2), for GLSL and C++.
#ifndef IBR_SHARED_HTM_H
#define IBR_SHARED_HTM_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

// Bindings of the only descriptor set.
IBR_CONSTANT int kBindingHtmPositions = 0;      // vec3[n_v], relative to the model's centre
IBR_CONSTANT int kBindingHtmTriangles = 1;      // uint[3 m]
IBR_CONSTANT int kBindingHtmMembers = 2;        // uvec2[n_v]; bit i of 64: camera i
IBR_CONSTANT int kBindingHtmComplements = 3;    // vec2[n_c · n_c · n_v], px, as HtmModel::complementIndex
IBR_CONSTANT int kBindingHtmCameras = 4;        // HtmCameraParameters[] of the plan's cameras, best first
IBR_CONSTANT int kBindingHtmDisplacements = 5;  // vec2[planned · n_v]: displacement of the projection by eq. 6, px
IBR_CONSTANT int kBindingHtmColours = 6;        // vec4[n_v], for HtmMethod::vertexColours
IBR_CONSTANT int kBindingHtmPhotographs = 7;    // one layer per camera, alpha is visibility
IBR_CONSTANT int kBindingHtmDepths = 8;         // one layer per camera, same size: inverse depth of the mesh, or 0
IBR_CONSTANT int kBindingHtmRanked = 9;         // uvec2[n_v]: members; bit k: camera k of the plan
IBR_CONSTANT int kHtmBindingCount = 10;

IBR_CONSTANT int kHtmGroupSize = 64;  // vertices

// Camera of a plan. With p = (position relative to the centre, 1), depth = dot(depthOf, p) along the viewing axis. The
// pixel is (dot(column, p), dot(row, p)) / depth.
struct HtmCameraParameters {
  vec4 column, row, depthOf;
  vec2 size;           // of the image, px
  float log2Weight;    // relative to the best camera's weight, <= 0
  float log2Rest;      // of the sum of all later weights, likewise
  float detail;        // focal length over the view's: pixels of the photograph per view pixel at the same depth
  float texelWidth;    // of its image at depth 1, world units
  float nearDistance;  // points nearer than half of it do not count
  uint camera;         // its layer and its bit
};

struct HtmFrame {  // push constants
  mat4 clip;       // of the view, or of the camera whose depth is drawn
  vec3 background;
  float cut;             // share of a sum of weights: smaller rests are skipped
  float depthTolerance;  // world units
  uint vertexCount;
  uint cameraCount;   // of all cameras, to index complements
  uint plannedCount;  // cameras of the plan, at least 1
};

IBR_SHARED_END

#endif
