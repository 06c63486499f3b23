// SPDX-License-Identifier: Apache-2.0
// Colour mapping by histogram specification ([T] §2.5.3, eqs 8–18) in integers, for GLSL and C++: bit-identical tables
// on all devices. Also the movement of tables over time, and the data that the passes share.
//
// Departures: eq. 15 with i_top = i_bot has slope 1. Floors and ceilings are integer divisions. Between the minimum
// number of samples and twice that number, a table is blended with the identity, to avoid jumps. Alpha codes of pixel
// states are far apart, so that rounding does not change a state.
#ifndef IBR_SHARED_COLOUR_MAP_H
#define IBR_SHARED_COLOUR_MAP_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kLevels = 256;  // d of the paper
IBR_CONSTANT uint kColourFresh = 1u;   // no table is remembered: the target is shown at once
IBR_CONSTANT uint kColourUnseen = 2u;  // not measured in this frame: the remembered target stays
IBR_CONSTANT int kCounters = 3 * kLevels;  // of one histogram: red, green, blue

// Continuation of a table beyond the observed range.
IBR_CONSTANT uint kMapNaive = 0u;       // eq. 10
IBR_CONSTANT uint kMapStrict = 1u;      // eq. 16
IBR_CONSTANT uint kMapPreserving = 2u;  // eq. 18

/// Observed range of one channel's modify histogram (eqs 11, 12), with f_naive at both ends.
struct ObservedRange {
  int bottom, top;            // i_bot, i_top
  int bottomLevel, topLevel;  // f_naive(i_bot), f_naive(i_top)
};

IBR_FUNCTION int floorDivide(int a, int b) {  // b > 0
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

IBR_FUNCTION int clampLevel(int level) { return level < 0 ? 0 : (level > kLevels - 1 ? kLevels - 1 : level); }

/// Eqs 15, 16, for levels outside the observed range.
IBR_FUNCTION int strictLevel(ObservedRange range, int i) {
  const int width = range.top - range.bottom;
  const int rise = width > 0 ? range.topLevel - range.bottomLevel : 1;
  return clampLevel(floorDivide(rise * (i - range.bottom), width > 0 ? width : 1) + range.bottomLevel);
}

/// Eq. 18, for levels outside the observed range.
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

/// Returns f(i); `naive` is f_naive(i).
IBR_FUNCTION int specifiedLevel(ObservedRange range, int i, int naive, uint method) {
  if (method == kMapNaive || (range.bottom <= i && i <= range.top)) return naive;
  return method == kMapStrict ? strictLevel(range, i) : preservingLevel(range, i);
}

/// Blends a table with the identity: below `least` samples the identity, from 2·least on the table. least < 2²³.
IBR_FUNCTION int trustedLevel(int level, int i, uint samples, uint least) {
  if (samples < least || samples == 0u) return i;
  if (samples >= 2u * least) return level;
  const int share = int((samples - least) * 256u / least);  // of 256
  return (i * (256 - share) + level * share + 128) / 256;
}

// Tables move in units of 1/256 level: `shown` is a table's current value, `target` its final value.
IBR_CONSTANT uint kFine = 256u;
IBR_CONSTANT uint kWhole = 65536u;  // a share of 1

/// Moves by share / kWhole of the way: at least one unit until the target is reached, at most `maxStep`. Monotone
/// in `shown` and `target`, so a table stays monotone. Reaches the target exactly.
IBR_FUNCTION uint approach(uint shown, uint target, uint share, uint maxStep) {
  const uint way = target > shown ? target - shown : shown - target;
  uint part = (way * share + (kWhole - 1u)) / kWhole;  // way <= 255·256, so the product is below 2³²
  const uint most = share == 0u ? 0u : (maxStep < way ? maxStep : way);
  part = part < most ? part : most;
  return target > shown ? shown + part : shown - part;
}

IBR_FUNCTION uint roundedLevel(uint fine) { return (fine + kFine / 2u) / kFine; }

/// Packs entry i of a table for the passes: the levels of the three channels at level i.
IBR_FUNCTION uint packLevels(uint red, uint green, uint blue) { return red | green << 8 | blue << 16; }
IBR_FUNCTION uint packedLevel(uint entry, uint channel) { return entry >> (8u * channel) & 255u; }

/// Converts a colour of 0 … 1 to the 8-bit levels that are counted and mapped.
IBR_FUNCTION uvec3 levelsOf(vec3 colour) { return uvec3(colour * 255.0f + 0.5f); }

/// Returns the mapped colour from the entries at the colour's three levels.
IBR_FUNCTION vec3 mappedColour(uint red, uint green, uint blue) {
  return vec3(float(packedLevel(red, 0u)), float(packedLevel(green, 1u)), float(packedLevel(blue, 2u))) / 255.0f;
}

// Alpha of the canvas in the paper's sequence, of 255: 0 for empty pixels, 255 − 64·tier for final colours, 32 less
// for colours that are not mapped yet.
IBR_CONSTANT float kPendingStep = 32.0f / 255.0f;
IBR_CONSTANT uint kPixelEmpty = 0u;
IBR_CONSTANT uint kPixelPending = 1u;
IBR_CONSTANT uint kPixelFinal = 2u;

IBR_FUNCTION uint pixelState(float alpha) {
  const uint code = uint(alpha * 255.0f + 0.5f);
  if (code < 16u) return kPixelEmpty;
  return ((code - 16u) / 32u & 1u) == 0u ? kPixelPending : kPixelFinal;
}

// Histograms: M[k] of cell k of n, then joint ones H[k][j], j < k (ours), or reference histograms R[k] (paper).
IBR_CONSTANT int kMaxMappedCells = 64;  // cells
IBR_FUNCTION uint modifyOffset(uint k) { return k * uint(kCounters); }
IBR_FUNCTION uint jointOffset(uint n, uint k, uint j) { return (n + k * (k - 1u) / 2u + j) * uint(kCounters); }
IBR_FUNCTION uint referenceOffset(uint n, uint k) { return (n + k) * uint(kCounters); }
IBR_FUNCTION uint counterCount(uint n, bool joint) {
  return (n + (joint ? n * (n - 1u) / 2u : n)) * uint(kCounters);
}

/// State of a cell's table between frames.
struct ColourSlot {
  uint owner;              // cell + 1; 0: free
  uint shown[kCounters];   // 1/256 levels: red, green, blue
  uint target[kLevels];    // packed
};

/// A frame's parameters of the colour tables. Cells best first.
struct ColourFrame {
  uint count;        // number of cells
  uint joint;        // 1: joint histograms (ours), 0: reference histograms (the paper's)
  uint method;       // kMapNaive …
  uint least;        // minimum number of samples
  uint kept;         // pixels with a noise rank below this, of 64², are counted
  uint measured;     // 1: the histograms are of this frame; 0: targets stay
  uint mainShare;    // share of the main table's way to the identity, of kWhole
  uint share;        // share of the other tables' ways
  uint maxStep;  // per frame, 1/256 levels
  uint tileColumns;  // of the proxy
  uint tileWidth, tileHeight;
  uint slot[kMaxMappedCells];
  uint owner[kMaxMappedCells];  // cell + 1
  uint fresh[kMaxMappedCells];  // kColourFresh, kColourUnseen
};

// Descriptor bindings of the set of these passes.
IBR_CONSTANT int kSetColour = 2;  // in graphics pipelines, after the sets of cells
IBR_CONSTANT int kBindingColourFrame = 0;
IBR_CONSTANT int kBindingCounters = 1;
IBR_CONSTANT int kBindingSlots = 2;
IBR_CONSTANT int kBindingTables = 3;      // packed, kLevels per slot
IBR_CONSTANT int kBindingColourNoise = 4;
IBR_CONSTANT int kBindingPicture = 5;     // proxy, or copy of the framebuffer
IBR_CONSTANT int kBindingCanvas = 6;      // storage image

IBR_SHARED_END

#endif
