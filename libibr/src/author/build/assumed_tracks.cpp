// SPDX-License-Identifier: Apache-2.0
#include "author/build/assumed_tracks.h"

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>

#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr int kColumns = 16, kRows = 8;
constexpr std::array kDistances{1.0, 2.0, 5.0, 20.0};  // distances, in median spacings of the capture sites

}  // namespace

std::vector<Track> assumedTracks(const std::vector<Camera>& photographs, const std::vector<bool>& hasNone) {
  std::vector<Track> tracks;
  const double spacing = captureSpacing(photographs);
  for (std::uint32_t i = 0; i < photographs.size(); ++i) {
    if (!hasNone[i]) continue;
    const auto& [k, pose] = photographs[i];
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        const glm::dvec2 pixel((column + 0.5) / kColumns * k.width, (row + 0.5) / kRows * k.height);
        const glm::dvec3 direction = pose.rotation * unproject(k, pixel);
        for (const double distance : kDistances)
          tracks.push_back({pose.position + distance * spacing * direction, {{i, pixel}}});
      }
  }
  return tracks;
}

}  // namespace ibr
