// SPDX-License-Identifier: Apache-2.0
// Advice to the photographer about a finished scene: faults of the capture, and next-best views.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ibr/export.h"
#include "ibr/scene.h"

namespace ibr {

/// Fault of a capture that advice is about.
enum class AdviceKind : std::uint8_t {
  tooFew,     // fewer than two photographs, or no cells
  turned,     // all photographs are from one capture site
  apart,      // a group of photographs that no cell joins to the others
  hole,       // neighbouring capture sites of one group that no cell joins
  wide,       // neighbouring capture sites too far apart for near objects
  direction,  // a capture site lacks a viewing direction that its neighbours have
  exposure,   // a photograph is much brighter or darker than its neighbours
  blurred,    // a photograph is much less sharp than its neighbours
  unmatched,  // a photograph agrees with others on little of its area
  pose,       // inaccurate pose of a photograph, or of all
  unused,     // a photograph that no cell shows (Scene::unusedPhotographs)
  twice,      // a photograph with the capture site and viewing direction of another
  row,        // all capture sites lie in one row
};
/// Returns the enumerator's name ("tooFew", "apart", …), for reports.
IBR_API const char* adviceKindName(AdviceKind kind) noexcept;

/// Effect of a fault on the scene.
enum class Severity : std::uint8_t {
  hint,     // the scene could show more
  warning,  // image quality suffers
  serious,  // almost nothing can be shown, or not from everywhere
};
IBR_API const char* severityName(Severity severity) noexcept;  // returns "hint", "warning" or "serious"

/// A fault of the capture and its remedy.
struct Advice {
  AdviceKind kind;                   // the fault
  Severity severity;                 // its effect
  std::string problem;               // description of the fault, for people
  std::string remedy;                // action to take, for people; may be empty with AdviceKind::unused
  std::vector<std::uint32_t> nodes;  // photographs concerned, indices into Scene::nodes, ascending by name
  double value;                      // by kind: number of photographs (tooFew, apart), share shown (hole, wide,
                                     // direction), stops (exposure), ratio of sharpness (blurred), share that agrees
                                     // (unmatched), residual over the longest side (pose); NaN: none
};

/// A photograph to take.
struct NextView {
  Camera camera;                              // world pose, and intrinsics to photograph with
  std::vector<std::uint32_t> referenceNodes;  // nodes that `where` refers to, indices into Scene::nodes
  double gain;        // weighted sum, over viewpoints of a walk, of what the view adds to the share shown; > 0
  std::string where;  // capture site and direction, for people: "halfway between A and B, looking as they do"
};

/// Result of adviseCapture().
struct CaptureAdvice {
  std::vector<Advice> advice;    // most severe first
  std::vector<NextView> views;   // best first, given the views before
  double coverage = 1;           // 0 to 1: mean share of an image that photographs show well, estimated over a walk
  double coverageWithViews = 1;  // the same, once `views` are photographed
};

/// Options of adviseCapture().
struct AdviceOptions {
  std::size_t views = 10;    // maximum number of CaptureAdvice::views
  bool readTextures = true;  // read the textures in the scene's folder, for AdviceKind::blurred
};

/// Returns advice on a scene. Apart from indices, the result does not depend on the order of nodes and cells, nor on
/// the world's position, rotation and scale. Textures that cannot be read are skipped. Throws Error{invalidInput} for a
/// scene in which validate() finds a fault.
IBR_API CaptureAdvice adviseCapture(const Scene& scene, const AdviceOptions& options = {});

}  // namespace ibr
