// SPDX-License-Identifier: Apache-2.0
// Which vertex a thread of a compute shader is for: groups along x, and rows of them along z where a device has too few
// in one.

uint htmVertex() {
  return (gl_WorkGroupID.z * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kHtmGroupSize + gl_LocalInvocationID.x;
}
