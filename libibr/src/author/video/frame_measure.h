// SPDX-License-Identifier: Apache-2.0
// What the choice of frames needs to know of each frame of a video: its detail, and points that it shares with others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "ibr/image.h"

namespace ibr {

struct TrackedPoint {
  std::uint32_t id = 0;
  float x = 0, y = 0;  // px, from the top-left corner
};

struct FrameMeasure {
  std::array<float, 4> detail{};     // mean squared difference of neighbours: along x, y and both diagonals
  std::vector<TrackedPoint> points;  // ascending ids; none in a blurred frame
};

/// Tracks points from one sharp frame to the next (Lucas, Kanade 1981; corners by Shi, Tomasi 1994). A frame with much
/// less detail than the frames of the last half second is blurred: points would be lost there.
class FrameMeasurer {
 public:
  explicit FrameMeasurer(double framesPerSecond);
  ~FrameMeasurer();

  /// Measures the next frame: grey, of one size.
  FrameMeasure measure(const Image8& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
