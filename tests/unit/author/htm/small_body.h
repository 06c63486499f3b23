// SPDX-License-Identifier: Apache-2.0
// A small body with exact photographs, and options for short tests.
#pragma once

#include <vector>

#include "htm_object.h"
#include "ibr/author/htm.h"

namespace ibr::test {

inline constexpr int kCameras = 8;

inline BumpyModel body(int cameras = kCameras, glm::dvec3 middle = glm::dvec3(0)) {
  BumpyOptions options;
  options.cameras = cameras;
  options.disagreement = 0;
  options.middle = middle;
  return bumpyModel(options);
}

inline const BumpyModel& theBody() {
  static const BumpyModel bumpy = body();
  return bumpy;
}

// Options for short tests; the input mesh is kept.
inline HtmOptions plainOptions() {
  HtmOptions options;
  options.faces = 0;
  options.inconsistentShare = 0;
  options.adjustRounds = 0;
  options.rounds = 1;
  options.radius = 8;
  options.threads = 1;
  return options;
}

inline std::vector<HtmPhotograph> disturbed(std::vector<HtmPhotograph> photographs) {
  for (std::size_t i = 0; i < photographs.size(); ++i)
    photographs[i].camera.camera = disturbed(photographs[i].camera.camera, 0.006, 0.008, int(i));
  return photographs;
}

}  // namespace ibr::test
