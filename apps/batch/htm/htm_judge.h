// SPDX-License-Identifier: Apache-2.0
// A harmonised model against what it is compared with ([H] §4.2), view by view.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shared/draw/htm_renderer.h"

namespace ibr::app {

/// Who draws. The last one is VDTBM with the cameras that harmonising adjusted: what of the gain is theirs.
enum HtmRival : std::size_t { kHtm, kVdtbm, kVdvbm, kVdtbmAdjusted, kHtmRivalCount };
inline constexpr std::array<const char*, kHtmRivalCount> kHtmRivalNames{"htm", "vdtbm", "vdvbm", "vdtbmAdjusted"};

/// A view whose picture is known.
struct HtmTruthView {
  std::string name;
  Camera camera;
  Image8 picture;  // RGB
  Image8 mask;     // 1 channel, nonzero: pixels that count; empty: those that all rivals cover
};

/// NaN where no pixel counts.
struct HtmScore {
  double psnr = 0;         // over the mask; what is not drawn counts as black
  double ssim = 0;         // likewise
  double psnrCovered = 0;  // over what all rivals cover of the mask
};

struct HtmVerdict {
  std::string name;
  std::array<HtmScore, kHtmRivalCount> score;
  std::array<Image8, kHtmRivalCount> picture;  // RGBA
  Image8 truth;                                // RGB
};

class HtmJudge {
 public:
  /// The model must outlive it.
  HtmJudge(const HtmModel& model, Device& device, const HtmPictureSource& source);

  HtmVerdict judge(const HtmTruthView& view, HtmSettings settings);

 private:
  HtmModel given_, adjusted_;
  HtmPictures harmonised_, baseline_, adjustedBaseline_;
};

/// The means over views that have a number.
std::array<HtmScore, kHtmRivalCount> meanScores(const std::vector<HtmVerdict>& verdicts);

}  // namespace ibr::app
