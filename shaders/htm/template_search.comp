#version 460
// SPDX-License-Identifier: Apache-2.0
// Finds the best position of a template in an image ([H] Alg. 3): one workgroup per template, whose lanes try
// displacements. All sums are integers, so absolute differences are identical on every device (ibr/template_search.h).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/template_search.h"

layout(local_size_x = kTemplateGroup) in;

layout(binding = kBindingTemplateTexels, scalar) readonly buffer Texels {
  uint texels[];
};
layout(binding = kBindingTemplatePictures, scalar) readonly buffer Pictures {
  SearchPicture pictures[];
};
layout(binding = kBindingTemplateTasks, scalar) readonly buffer Tasks {
  SearchTask tasks[];
};
layout(binding = kBindingTemplateSamples, scalar) readonly buffer Samples {
  uvec2 samples[];
};
layout(binding = kBindingTemplateFound, scalar) writeonly buffer Found {
  SearchFound found[];
};
layout(push_constant, scalar) uniform Step {
  SearchStep todo;
};

shared uvec3 best[kTemplateGroup];  // cost, squared distance from the start, displacement: the smallest wins

uvec3 colourOf(uint texel) {
  return uvec3(texel, texel >> 8, texel >> 16) & 0xffu;
}

ivec2 pixelOf(uint packed) {
  return ivec2(bitfieldExtract(int(packed), 0, 16), bitfieldExtract(int(packed), 16, 16));
}

uvec3 seenAt(SearchPicture picture, ivec2 pixel) {
  const ivec2 at = clamp(pixel, ivec2(0), picture.size - 1);
  return colourOf(texels[picture.firstTexel + uint(at.y) * uint(picture.size.x) + uint(at.x)]);
}

uint differences(SearchTask task, SearchPicture picture, ivec2 displacement) {
  uvec3 sum = uvec3(0u);
  for (uint s = task.first; s < task.first + task.count; ++s) {
    const uvec2 wanted = samples[s];
    sum += uvec3(abs(ivec3(seenAt(picture, pixelOf(wanted.x) + displacement)) - ivec3(colourOf(wanted.y))));
  }
  return sum.r + sum.g + sum.b;
}

// 64-bit integers: low and high half.
uvec2 product(uint a, uint b) {
  uvec2 wide;
  umulExtended(a, b, wide.y, wide.x);
  return wide;
}
uvec2 plus(uvec2 a, uvec2 b) {
  uint carry;
  const uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}
uvec2 minus(uvec2 a, uvec2 b) {
  uint borrow;
  const uint low = usubBorrow(a.x, b.x, borrow);
  return uvec2(low, a.y - b.y - borrow);
}
bool isLess(uvec2 a, uvec2 b) {
  return a.y < b.y || (a.y == b.y && a.x < b.x);
}
float rounded(uvec2 wide) {
  return float(wide.y) * 4294967296.0 + float(wide.x);
}
uvec2 dotProduct(uvec3 a, uvec3 b) {
  return plus(plus(product(a.r, b.r), product(a.g, b.g)), product(a.b, b.b));
}

// Returns n² times the variance of all colours, each channel about its own mean.
float variance(uint count, uint squares, uvec3 sum) {
  return rounded(minus(product(count, squares), dotProduct(sum, sum)));
}

struct Wanted {
  uvec3 sum;
  float variance;
};
Wanted wantedOf(SearchTask task) {
  uvec3 sum = uvec3(0u);
  uint squares = 0u;  // at most 4096 samples: below 2³⁰
  for (uint s = task.first; s < task.first + task.count; ++s) {
    const uvec3 colour = colourOf(samples[s].y);
    sum += colour;
    squares += colour.r * colour.r + colour.g * colour.g + colour.b * colour.b;
  }
  return Wanted(sum, variance(task.count, squares, sum));
}

float correlationCost(SearchTask task, SearchPicture picture, ivec2 displacement, Wanted wanted) {
  uvec3 sum = uvec3(0u);
  uint squares = 0u, products = 0u;
  for (uint s = task.first; s < task.first + task.count; ++s) {
    const uvec2 here = samples[s];
    const uvec3 a = seenAt(picture, pixelOf(here.x) + displacement), b = colourOf(here.y);
    sum += a;
    squares += a.r * a.r + a.g * a.g + a.b * a.b;
    products += a.r * b.r + a.g * b.g + a.b * b.b;
  }
  const uvec2 together = product(task.count, products), apart = dotProduct(sum, wanted.sum);
  const bool negative = isLess(together, apart);
  const float covariance = negative ? -rounded(minus(apart, together)) : rounded(minus(together, apart));
  const float scale = sqrt(variance(task.count, squares, sum)) * sqrt(wanted.variance);
  return scale > 0.0 ? max(0.0, 1.0 - covariance / scale) : 1.0;
}

bool comesBefore(uvec3 a, uvec3 b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const SearchTask task = tasks[gl_WorkGroupID.x];
  const SearchPicture picture = pictures[task.picture];
  const bool correlates = todo.measure == kMeasureCorrelation;
  Wanted wanted = Wanted(uvec3(0u), 0.0);
  if (correlates) wanted = wantedOf(task);
  const uint side = uint(2 * todo.radius + 1);
  uvec3 least = uvec3(0xffffffffu);
  for (uint k = lane; k < side * side; k += kTemplateGroup) {
    const ivec2 offset = ivec2(int(k % side), int(k / side)) - todo.radius;
    const ivec2 displacement = task.start + offset;
    const uint cost = correlates ? floatBitsToUint(correlationCost(task, picture, displacement, wanted))
                                 : differences(task, picture, displacement);
    const uvec3 here = uvec3(cost, uint(offset.x * offset.x + offset.y * offset.y), k);
    if (comesBefore(here, least)) least = here;
  }
  best[lane] = least;
  barrier();
  for (uint apart = kTemplateGroup / 2u; apart > 0u; apart /= 2u) {
    if (lane < apart && comesBefore(best[lane + apart], best[lane])) best[lane] = best[lane + apart];
    barrier();
  }
  if (lane == 0u) found[gl_WorkGroupID.x] = SearchFound(best[0].x, best[0].z);
}
