// SPDX-License-Identifier: Apache-2.0
// What to photograph next, and what is amiss with what there is: told to the photographer from a finished scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

enum class AdviceKind : std::uint8_t {
  tooFew,     // photographs, or none of them joined
  turned,     // everything was photographed from one place
  apart,      // parts that nothing joins
  hole,       // neighbours that nothing joins within a part
  wide,       // neighbours too far apart for what is near
  direction,  // a place that lacks a look which its neighbours have
  exposure,   // much brighter or darker than its neighbours
  blurred,    // much less sharp than its neighbours
  unmatched,  // agrees with no other on most of its picture
  pose,       // where it was taken from is doubtful
  unused,     // no cell shows it
  twice,      // a photograph that repeats another
  row,        // all photographs stand in one row
};
/// "tooFew", "apart", …: of reports.
const char* adviceKindName(AdviceKind kind) noexcept;

enum class Severity : std::uint8_t {
  hint,     // more would be possible
  warning,  // pictures suffer
  serious,  // hardly anything can be shown, or not from everywhere
};
const char* severityName(Severity severity) noexcept;  // "hint", "warning", "serious"

struct Advice {
  AdviceKind kind;
  Severity severity;
  std::string sentence;              // what is amiss
  std::string remedy;                // what to do about it, a sentence
  std::vector<std::uint32_t> nodes;  // photographs concerned, ascending by name
  double figure;                     // by the kind: share shown, stops, ratio of sharpness, px, …; NaN: none
};

/// A photograph to take.
struct NextView {
  Camera camera;
  std::vector<std::uint32_t> beside;  // photographs that say where, and how it looks
  double gain;        // what it adds to the walk's estimate at one stand (scene/advice/walk_estimate.h), > 0
  std::string where;  // "halfway between A and B, looking as they do"
};

struct CaptureAdvice {
  std::vector<Advice> advice;   // gravest first
  std::vector<NextView> views;  // best first
  double shown = 1;             // 0 to 1: estimated share of a walk between the photographs that they show well
  double shownThen = 1;         // with the further views
};

struct AdviceOptions {
  std::size_t views = 10;
  bool pictures = true;  // whether textures of the scene's folder are looked at, for sharpness
};

/// Does not depend on the order of nodes and cells (but for its indices), nor on where the world lies, how it is
/// turned, and its scale. Textures that cannot be read are passed over. Throws Error{invalidInput} for a scene that
/// validate() finds a fault in.
CaptureAdvice adviseCapture(const Scene& scene, const AdviceOptions& options = {});

}  // namespace ibr
