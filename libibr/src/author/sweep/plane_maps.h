// SPDX-License-Identifier: Apache-2.0
// A plane as the members of a cell see it: a homography from the first member's picture to each other's.
//
// Without poses each has 8 degrees of freedom of its own. With poses one plane has 3: its inverse depth along the first
// member's axis is linear in the picture, w = n·(x, y, 1), and member i sees it by H_i = A_i + b_i nᵀ, where A_i and
// b_i are those of FrameToMember.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "author/geometry/match_view.h"
#include "author/geometry/mean_frame.h"

namespace ibr {

inline constexpr std::uint32_t kNoFeature = 0xffffffffu;

/// A place that all members see; px in each one's picture.
struct PlaneTrack {
  std::array<glm::dvec2, kMostMembers> at{};
  std::array<std::uint32_t, kMostMembers> feature{kNoFeature, kNoFeature, kNoFeature, kNoFeature};
  int plane = -1;  // that it was first found on
};

struct PlaneMaps {
  std::vector<glm::dmat3> to;  // of each member; that of the first is the identity

  /// nullopt where a member has it behind itself.
  std::optional<std::array<glm::dvec2, kMostMembers>> operator()(glm::dvec2 pixel) const;
  /// Largest distance of the track from where the plane puts its first place, px; infinite where a member has it
  /// behind.
  double error(const PlaneTrack& track) const;
};

class PlaneFitter {
 public:
  /// With poses: the first member is the frame. Without: `cameras` only tells how many members there are.
  PlaneFitter(std::span<const Camera> cameras, bool posed);

  std::size_t leastTracks() const { return posed_ ? 3 : 4; }
  /// Least squares. nullopt for too few tracks, tracks that fix no plane, and planes that are seen mirrored or at a
  /// scale of more than 8 there.
  std::optional<PlaneMaps> operator()(std::span<const PlaneTrack* const> tracks) const;

 private:
  std::optional<PlaneMaps> withPoses(std::span<const PlaneTrack* const> tracks) const;
  std::optional<PlaneMaps> withoutPoses(std::span<const PlaneTrack* const> tracks) const;

  bool posed_;
  glm::dvec2 centre_;
  double unit_;
  std::vector<FrameToMember> maps_;
};

}  // namespace ibr
