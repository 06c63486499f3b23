// SPDX-License-Identifier: Apache-2.0
// Compares a harmonised model with other methods ([H] §4.2), view by view.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shared/draw/htm_model_renderer.h"

namespace ibr::app {

/// Compared methods. The last one is VDTBM with the adjusted cameras: it isolates the gain that comes from the cameras.
enum HtmMethodIndex : std::size_t { kHtm, kVdtbm, kVdvbm, kVdtbmAdjusted, kHtmMethodCount };
inline constexpr std::array<const char*, kHtmMethodCount> kHtmMethodNames{"htm", "vdtbm", "vdvbm", "vdtbmAdjusted"};

/// A view with a known image.
struct HtmTruthView {
  std::string name;
  Camera camera;
  Image8 picture;  // RGB
  Image8 mask;     // 1 channel, nonzero: pixels that count; empty: pixels that all methods cover
};

/// NaN if no pixel counts.
struct HtmScore {
  double psnr = 0;         // over the mask; pixels without the object are black
  double ssim = 0;         // over the mask
  double psnrCovered = 0;  // over the part of the mask that all methods cover
};

struct HtmViewScores {
  std::string name;
  std::array<HtmScore, kHtmMethodCount> score;
  std::array<Image8, kHtmMethodCount> picture;  // RGBA
  Image8 truth;                                 // RGB
};

class HtmEvaluator {
 public:
  /// The model must outlive this object.
  HtmEvaluator(const HtmModel& model, Device& device, const HtmImageSource& source);

  HtmViewScores judge(const HtmTruthView& view, HtmSettings settings);

 private:
  HtmModel given_, adjusted_;
  HtmModelRenderer harmonised_, baseline_, adjustedBaseline_;
};

/// Returns the means over views with finite scores.
std::array<HtmScore, kHtmMethodCount> meanScores(const std::vector<HtmViewScores>& verdicts);

}  // namespace ibr::app
