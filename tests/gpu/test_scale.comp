// SPDX-License-Identifier: Apache-2.0
#version 460
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kFactor = 1;
layout(push_constant) uniform Push { uint count, summand; };
layout(set = 0, binding = 0) buffer Values { uint values[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < count) values[i] = kFactor * values[i] + summand;
}
