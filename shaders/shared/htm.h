// SPDX-License-Identifier: Apache-2.0
// A frame of a harmonised model as the shaders see it ([H] §3.2), for GLSL and C++.
#ifndef IBR_SHARED_HTM_H
#define IBR_SHARED_HTM_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

// Bindings of the one descriptor set.
IBR_CONSTANT int kBindingHtmPositions = 0;      // vec3[n_v], relative to the model's middle
IBR_CONSTANT int kBindingHtmTriangles = 1;      // uint[3 m]
IBR_CONSTANT int kBindingHtmMembers = 2;        // uvec2[n_v], bit i of the 64 the i-th camera
IBR_CONSTANT int kBindingHtmComplements = 3;    // vec2[n_c · n_c · n_v], px, as HtmModel::complementIndex
IBR_CONSTANT int kBindingHtmCameras = 4;        // HtmCameraParameters[]: those of the plan, best first
IBR_CONSTANT int kBindingHtmDisplacements = 5;  // vec2[planned · n_v]: what eq. 6 adds to the projection, px
IBR_CONSTANT int kBindingHtmColours = 6;        // vec4[n_v]: of HtmMethod::vertexColours
IBR_CONSTANT int kBindingHtmPhotographs = 7;    // a layer a camera, alpha is visibility
IBR_CONSTANT int kBindingHtmDepths = 8;         // a layer a camera, as large: inverse depth of the mesh, else 0
IBR_CONSTANT int kBindingHtmRanked = 9;         // uvec2[n_v]: members, bit k the k-th camera of the plan
IBR_CONSTANT int kHtmBindingCount = 10;

IBR_CONSTANT int kHtmGroupSize = 64;  // vertices

// Camera of a plan. With p = (position relative to the middle, 1), depth = dot(depthOf, p) along the viewing axis, and
// (dot(column, p), dot(row, p)) / depth is the pixel.
struct HtmCameraParameters {
  vec4 column, row, depthOf;
  vec2 size;           // of the picture, px
  float log2Weight;    // over the best camera's, <= 0
  float log2Rest;      // the same of the sum of all weights after it
  float detail;        // focal length over the view's: pixels of the photograph a pixel at the same depth
  float texelWidth;    // of its picture at depth 1, world units
  float nearDistance;  // what lies nearer than half of it does not count
  uint camera;         // its layer and its bit
};

struct HtmFrame {  // push constants
  mat4 clip;       // of the view, or of the camera whose depth is drawn
  vec3 background;
  float cut;             // of a sum of weights: what weighs less together is not looked at
  float depthTolerance;  // world units
  uint vertexCount;
  uint cameraCount;   // of all, for complements
  uint plannedCount;  // of the plan, at least 1
};

IBR_SHARED_END

#endif
