// SPDX-License-Identifier: Apache-2.0
// Times of frames of a scene in several ways, measured in turn, frame by frame, so that a machine whose speed drifts
// does not favour one; a ratio is the median of the ratios of frames measured next to each other.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

struct BenchWay {
  const char* name;  // "paper" or "ours"
  DrawOrder order;
  ColourMapping colour;
  BlendMode blend;
  std::size_t views;
  bool hidden = false;  // corners that a headset's lenses leave out are not drawn
};
/// The paper's way draws cells; ours what the settings name.
Composition compositionOf(const BenchWay& way, const RenderSettings& settings);

struct WayTimes {
  BenchWay way;
  std::vector<double> milliseconds;         // of frames
  std::vector<double> toPaper, toUnmapped;  // ratios: to the paper's order and to the same way, without mapping
  std::vector<double> toTwoMono;            // of two views: to a frame of each alone
  std::vector<double> toWhole;              // with hidden corners: to the same way without
  std::map<std::string, std::vector<double>> passes;  // ms by pass
};

/// What is measured. Views are single; a stereo frame is a pair of eyes at one of them.
struct BenchSubject {
  std::string name;
  Scene scene;
  GpuSceneOptions gpuScene;
  std::vector<Camera> views;
};

struct BenchCase {
  RenderSettings settings;  // cells among them; order, blend (unless asked for) and mapping are the ways'
  bool stereo = false;      // also with two views
  int repeat = 9;           // frames a way and view
};

struct BenchResult {
  std::size_t drawn = 0, triangles = 0;  // of a view, at most
  std::vector<WayTimes> ways;
};

/// Plans whose times, weighted, are those of a frame: colours are counted in one frame of a period, and not in others.
struct WeightedPlan {
  FramePlan plan;
  double weight;
};
/// A frame by itself, and where colours are mapped our way one that follows it.
std::vector<WeightedPlan> weightedPlans(const Scene& scene, const SceneBounds& bounds, FrameInput input);

/// The left and the right eye, so far apart in world units.
std::vector<Camera> eyesAround(const Camera& middle, double distance);

/// A scene on a device, with everything that any way needs.
class FrameBench {
 public:
  FrameBench(Device& device, const BenchSubject& subject, const BenchCase& wanted);
  ~FrameBench();
  /// `step` is called before each round and may throw. Throws Error{unsupported} where the queue has no timestamps.
  /// `wanted` is as at first but for its number of cells.
  BenchResult measure(const BenchCase& wanted, const std::function<void()>& step) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr::app
