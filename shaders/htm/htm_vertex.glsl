// SPDX-License-Identifier: Apache-2.0
// Vertex of a thread in a compute shader: groups run along x; further rows of groups lie along z if the device allows
// too few groups along x.

uint htmVertex() {
  return (gl_WorkGroupID.z * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kHtmGroupSize + gl_LocalInvocationID.x;
}
