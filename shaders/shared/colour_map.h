// SPDX-License-Identifier: Apache-2.0
// Colour mapping by histogram specification ([T] §2.5.3, eqs 8–18) in integers, for GLSL and C++: the same table, bit for
// bit, on every device. Also how tables move over time, and what the passes share in memory.
//
// Departures: eq. 15 with i_top = i_bot has slope 1 (NUMERICS T15); floors and ceilings are integer divisions (T16);
// between the least number of samples and twice that a table fades from the identity, so that nothing snaps; the state
// of a pixel is told from alpha in steps far apart (T14).
#ifndef IBR_SHARED_COLOUR_MAP_H
#define IBR_SHARED_COLOUR_MAP_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kLevels = 256;  // d of the paper
IBR_CONSTANT uint kColourFresh = 1u;   // nothing is remembered, the target is shown at once
IBR_CONSTANT uint kColourUnseen = 2u;  // not measured in this frame: the remembered target stays
IBR_CONSTANT int kCounters = 3 * kLevels;  // of one histogram: red, green, blue

// How a table goes on beyond the observed range.
IBR_CONSTANT uint kMapNaive = 0u;       // eq. 10
IBR_CONSTANT uint kMapStrict = 1u;      // eq. 16
IBR_CONSTANT uint kMapPreserving = 2u;  // eq. 18

/// Of one channel's modify histogram (eqs 11, 12), with f_naive at both ends.
struct ObservedRange {
  int bottom, top;            // i_bot, i_top
  int bottomLevel, topLevel;  // f_naive(i_bot), f_naive(i_top)
};

IBR_FUNCTION int floorDivide(int a, int b) {  // b > 0
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

IBR_FUNCTION int clampLevel(int level) { return level < 0 ? 0 : (level > kLevels - 1 ? kLevels - 1 : level); }

/// Eqs 15, 16 outside the observed range.
IBR_FUNCTION int strictLevel(ObservedRange range, int i) {
  const int width = range.top - range.bottom;
  const int rise = width > 0 ? range.topLevel - range.bottomLevel : 1;
  return clampLevel(floorDivide(rise * (i - range.bottom), width > 0 ? width : 1) + range.bottomLevel);
}

/// Eq. 18 outside the observed range.
IBR_FUNCTION int preservingLevel(ObservedRange range, int i) {
  const int strict = strictLevel(range, i);
  if (i < range.bottom) {
    const int mixed = (range.bottomLevel * i + range.bottom - 1) / range.bottom;  // ⌈mix(0, f(i_bot), i / i_bot)⌉
    return strict > mixed ? strict : mixed;
  }
  const int rest = kLevels - 1 - range.top;
  const int mixed = (range.topLevel * rest + (kLevels - 1 - range.topLevel) * (i - range.top) + rest - 1) / rest;
  return strict < mixed ? strict : mixed;
}

/// f(i); `naive` is f_naive(i).
IBR_FUNCTION int specifiedLevel(ObservedRange range, int i, int naive, uint method) {
  if (method == kMapNaive || (range.bottom <= i && i <= range.top)) return naive;
  return method == kMapStrict ? strictLevel(range, i) : preservingLevel(range, i);
}

/// Below `least` samples the identity, from 2·least on the table, between them a mixture, rounded. least < 2²³.
IBR_FUNCTION int trustedLevel(int level, int i, uint samples, uint least) {
  if (samples < least || samples == 0u) return i;
  if (samples >= 2u * least) return level;
  const int share = int((samples - least) * 256u / least);  // of 256
  return (i * (256 - share) + level * share + 128) / 256;
}

// Tables move in 1/256 of a level: `shown` is what a table holds, `target` what it should hold.
IBR_CONSTANT uint kFine = 256u;
IBR_CONSTANT uint kWhole = 65536u;  // a share of 1

/// Goes share / kWhole of the way, at least one step while there is any, at most `largestStep`. Increasing in `shown` and
/// in `target`, so a table stays monotone; arrives exactly.
IBR_FUNCTION uint approach(uint shown, uint target, uint share, uint largestStep) {
  const uint way = target > shown ? target - shown : shown - target;
  uint part = (way * share + (kWhole - 1u)) / kWhole;  // way <= 255·256, so the product is below 2³²
  const uint most = share == 0u ? 0u : (largestStep < way ? largestStep : way);
  part = part < most ? part : most;
  return target > shown ? shown + part : shown - part;
}

IBR_FUNCTION uint roundedLevel(uint fine) { return (fine + kFine / 2u) / kFine; }

/// Entry i of a table as the passes read it: the level of each channel at level i.
IBR_FUNCTION uint packLevels(uint red, uint green, uint blue) { return red | green << 8 | blue << 16; }
IBR_FUNCTION uint packedLevel(uint entry, uint channel) { return entry >> (8u * channel) & 255u; }

/// A colour of 0 … 1 as the 8 bits that are counted and mapped.
IBR_FUNCTION uvec3 levelsOf(vec3 colour) { return uvec3(colour * 255.0f + 0.5f); }

/// Of the entries at a colour's three levels.
IBR_FUNCTION vec3 mappedColour(uint red, uint green, uint blue) {
  return vec3(float(packedLevel(red, 0u)), float(packedLevel(green, 1u)), float(packedLevel(blue, 2u))) / 255.0f;
}

// Alpha of the canvas in the paper's sequence, of 255: 0 where nothing was drawn, 255 − 64·tier where the colour is final,
// 32 less where it is still to be mapped.
IBR_CONSTANT float kPendingStep = 32.0f / 255.0f;
IBR_CONSTANT uint kPixelEmpty = 0u;
IBR_CONSTANT uint kPixelPending = 1u;
IBR_CONSTANT uint kPixelFinal = 2u;

IBR_FUNCTION uint pixelState(float alpha) {
  const uint code = uint(alpha * 255.0f + 0.5f);
  if (code < 16u) return kPixelEmpty;
  return ((code - 16u) / 32u & 1u) == 0u ? kPixelPending : kPixelFinal;
}

// Histograms: M[k] of cell k of the n, then joint ones H[k][j], j < k (ours), or reference histograms R[k] (paper's).
IBR_CONSTANT int kLargestMapped = 64;  // cells
IBR_FUNCTION uint modifyOffset(uint k) { return k * uint(kCounters); }
IBR_FUNCTION uint jointOffset(uint n, uint k, uint j) { return (n + k * (k - 1u) / 2u + j) * uint(kCounters); }
IBR_FUNCTION uint referenceOffset(uint n, uint k) { return (n + k) * uint(kCounters); }
IBR_FUNCTION uint counterCount(uint n, bool joint) {
  return (n + (joint ? n * (n - 1u) / 2u : n)) * uint(kCounters);
}

/// A cell's table between frames.
struct ColourSlot {
  uint owner;              // cell + 1; 0: nobody's
  uint shown[kCounters];   // 1/256 levels: red, green, blue
  uint target[kLevels];    // packed
};

/// What a frame asks of the tables. Cells best first.
struct ColourFrame {
  uint count;        // of cells
  uint joint;        // 1: joint histograms (ours), 0: reference histograms (the paper's)
  uint method;       // kMapNaive …
  uint least;        // samples
  uint kept;         // of the 64² ranks of the noise: pixels that are counted
  uint measured;     // 1: the histograms are of this frame, 0: targets stay as they are
  uint mainShare;    // of the way to the identity, of kWhole
  uint share;        // of the way of all other tables
  uint largestStep;  // 1/256 levels
  uint tileColumns;  // of the proxy
  uint tileWidth, tileHeight;
  uint slot[kLargestMapped];
  uint owner[kLargestMapped];  // cell + 1
  uint fresh[kLargestMapped];  // kColourFresh, kColourUnseen
};

// Descriptor bindings of the passes' own set.
IBR_CONSTANT int kSetColour = 2;  // beside those of cells, in graphics
IBR_CONSTANT int kBindingColourFrame = 0;
IBR_CONSTANT int kBindingCounters = 1;
IBR_CONSTANT int kBindingSlots = 2;
IBR_CONSTANT int kBindingTables = 3;      // packed, kLevels a slot
IBR_CONSTANT int kBindingColourNoise = 4;
IBR_CONSTANT int kBindingPicture = 5;     // proxy, or copy of the framebuffer
IBR_CONSTANT int kBindingCanvas = 6;      // storage image

IBR_SHARED_END

#endif
