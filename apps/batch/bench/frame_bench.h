// SPDX-License-Identifier: Apache-2.0
// Frame times of a scene drawn in several ways. The ways alternate frame by frame, so that a change of the machine's
// speed favours none of them; a ratio is the median of the ratios of frames measured next to each other.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

struct BenchVariant {
  const char* name;  // "paper" or "ours"
  DrawOrder order;
  ColourMapping colour;
  BlendMode blend;
  std::size_t views;
  bool hidden = false;  // true: corners that a headset's lenses hide are not drawn
};
/// Returns cells for the paper's way, else the composition of the settings.
Composition compositionOf(const BenchVariant& way, const RenderSettings& settings);

struct VariantTimes {
  BenchVariant way;
  std::vector<double> milliseconds;  // of frames
  std::vector<double> ratioToPaper,
      ratioToUnmapped;                     // ratios: to the paper's order, and to the same way without colour mapping
  std::vector<double> ratioToTwoMono;      // of two views: ratio to two frames of one view
  std::vector<double> ratioToWithoutMask;  // with hidden corners: ratio to the same way without hidden corners
  std::map<std::string, std::vector<double>> passes;  // ms by pass
};

/// Scene and views that are measured. Each view is single; a stereo frame has a pair of eyes at the view.
struct BenchSubject {
  std::string name;
  Scene scene;
  GpuSceneOptions gpuScene;
  std::vector<Camera> views;
};

struct BenchCase {
  RenderSettings settings;  // order, mapping, the paper's composition and the added dithered blend are set by each way
  bool stereo = false;      // true: also with two views
  int repeat = 9;           // frames for each way and view
};

struct BenchResult {
  std::size_t drawn = 0, triangles = 0;  // maximum over the views
  std::vector<VariantTimes> ways;
};

/// Plans whose weighted times sum to the mean time of a frame: colours are counted in one frame of a period only.
struct WeightedPlan {
  FramePlan plan;
  double weight;
};
/// Returns a single frame; with ColourMapping::ours also a frame that follows, which counts no colours.
std::vector<WeightedPlan> weightedPlans(const Scene& scene, const SceneBounds& bounds, FrameInput input);

/// Returns the left and the right eye at the given distance, world units.
std::vector<Camera> eyesAround(const Camera& middle, double distance);

/// A scene on a device, with the renderers and targets that the ways need.
class FrameBench {
 public:
  FrameBench(Device& device, const BenchSubject& subject, const BenchCase& wanted);
  ~FrameBench();
  /// Measures all ways. `step` is called before each round and may throw. Throws Error{unsupported} if the queue has no
  /// timestamps. `wanted` must equal the constructor's, except for the number of cells.
  BenchResult measure(const BenchCase& wanted, const std::function<void()>& step) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr::app
