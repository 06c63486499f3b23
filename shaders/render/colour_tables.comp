#version 460
// SPDX-License-Identifier: Apache-2.0
// Makes colour tables from histograms ([T] §2.5.3, eqs 8–18), cell by cell, main cell first, in one workgroup.
//
// Ours has joint histograms H[k][j]. The reference histogram of cell k is the sum over owners j of H[k][j], mapped
// through the table that cell j shows: the colours that the paper's sequence would find in the framebuffer. Thread i
// computes level i.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/colour_map.h"

layout(local_size_x = kLevels) in;

layout(binding = kBindingColourFrame, scalar) readonly buffer Frame { ColourFrame frame; };
layout(binding = kBindingCounters, scalar) readonly buffer Counters { uint counters[]; };
layout(binding = kBindingSlots, scalar) buffer Slots { ColourSlot slots[]; };
layout(binding = kBindingTables, scalar) coherent buffer Tables { uint tables[]; };  // read by other threads

layout(push_constant) uniform Range { uint first, last; };  // cells

shared uint reference[kCounters], modify[kCounters], naive[kCounters];
shared int bottom[3], top[3];

void cumulate(uint i) {  // eq. 9
  for (uint distance = 1u; distance < uint(kLevels); distance *= 2u) {
    uvec3 r = uvec3(0u), m = uvec3(0u);
    for (uint c = 0u; c < 3u && i >= distance; ++c) {
      r[c] = reference[c * uint(kLevels) + i - distance];
      m[c] = modify[c * uint(kLevels) + i - distance];
    }
    barrier();
    for (uint c = 0u; c < 3u; ++c) {
      reference[c * uint(kLevels) + i] += r[c];
      modify[c * uint(kLevels) + i] += m[c];
    }
    barrier();
  }
}

uint naiveLevel(uint c, uint seen) {  // eq. 10: the first j with m̂_i <= r̂_j
  uint low = 0u, high = uint(kLevels) - 1u;
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (reference[c * uint(kLevels) + middle] >= seen)
      high = middle;
    else
      low = middle + 1u;
  }
  return low;
}

void gather(uint k, uint i) {
  for (uint c = 0u; c < 3u; ++c) {
    const uint at = c * uint(kLevels) + i;
    modify[at] = counters[modifyOffset(k) + at];
    reference[at] = frame.joint != 0u ? 0u : counters[referenceOffset(frame.count, k) + at];
  }
  barrier();
  if (frame.joint == 0u) return;
  for (uint j = 0u; j < k; ++j) {
    const uint entry = tables[frame.slot[j] * uint(kLevels) + i];
    for (uint c = 0u; c < 3u; ++c) {
      const uint seen = counters[jointOffset(frame.count, k, j) + c * uint(kLevels) + i];
      if (seen != 0u) atomicAdd(reference[c * uint(kLevels) + packedLevel(entry, c)], seen);
    }
  }
  barrier();
}

uint targetOf(uint k, uint i) {
  gather(k, i);
  cumulate(i);
  const uint last = uint(kLevels) - 1u;
  for (uint c = 0u; c < 3u; ++c) {
    const uint at = c * uint(kLevels) + i, seen = modify[at], samples = modify[c * uint(kLevels) + last];
    const uint before = i == 0u ? 0u : modify[at - 1u];
    naive[at] = naiveLevel(c, seen);
    if (samples == 0u) {
      if (i == 0u) bottom[c] = top[c] = 0;
    } else {
      if (seen != 0u && before == 0u) bottom[c] = int(i);              // eq. 11
      if (seen == samples && (i == 0u || before != samples)) top[c] = int(i);  // eq. 12
    }
  }
  barrier();
  uvec3 level;
  for (uint c = 0u; c < 3u; ++c) {
    const uint base = c * uint(kLevels);
    const ObservedRange range =
        ObservedRange(bottom[c], top[c], int(naive[base + uint(bottom[c])]), int(naive[base + uint(top[c])]));
    const int specified = specifiedLevel(range, int(i), int(naive[base + i]), frame.method);
    level[c] = uint(trustedLevel(specified, int(i), modify[base + last], frame.least));
  }
  barrier();
  return packLevels(level.r, level.g, level.b);
}

void main() {
  const uint i = gl_LocalInvocationID.x;
  for (uint k = first; k < last; ++k) {
    const uint s = frame.slot[k];
    const bool remembered = (frame.fresh[k] & kColourFresh) == 0u && slots[s].owner == frame.owner[k];
    const bool isMain = k == 0u;
    uint target = packLevels(i, i, i);
    if (!isMain && frame.measured != 0u && (frame.fresh[k] & kColourUnseen) == 0u)
      target = targetOf(k, i);
    else if (!isMain && remembered)
      target = slots[s].target[i];
    uvec3 level;
    for (uint c = 0u; c < 3u; ++c) {
      const uint at = c * uint(kLevels) + i;
      uint shown = packedLevel(target, c) * kFine;
      if (remembered)
        shown = approach(slots[s].shown[at], shown, isMain ? frame.mainShare : frame.share,
                         isMain ? uint(kLevels) * kFine : frame.maxStep);
      slots[s].shown[at] = shown;
      level[c] = roundedLevel(shown);
    }
    slots[s].target[i] = target;
    tables[s * uint(kLevels) + i] = packLevels(level.r, level.g, level.b);
    memoryBarrierBuffer();
    barrier();
    if (i == 0u) slots[s].owner = frame.owner[k];  // after all threads have read the owner
  }
}
