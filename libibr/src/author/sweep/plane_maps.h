// SPDX-License-Identifier: Apache-2.0
// A plane as the members of a cell see it: homographies from the first member's image to each other member's.
//
// Without poses each homography has its own 8 degrees of freedom. With poses a plane has 3: its inverse depth along the
// first member's axis is linear in the image, w = n·(x, y, 1). Member i then sees the plane by H_i = A_i + b_i nᵀ, with
// A_i and b_i of FrameToMember.
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

/// A point that all members see; px in each one's image.
struct PlaneTrack {
  std::array<glm::dvec2, kMaxMembers> at{};
  std::array<std::uint32_t, kMaxMembers> feature{kNoFeature, kNoFeature, kNoFeature, kNoFeature};
  int plane = -1;  // on which it was first found
};

struct PlaneMaps {
  std::vector<glm::dmat3> to;  // for each member; the first one's is the identity

  /// Maps a pixel of the first member to all members; nullopt if the point is behind a member.
  std::optional<std::array<glm::dvec2, kMaxMembers>> operator()(glm::dvec2 pixel) const;
  /// Maximum distance of the track from the plane's prediction for its first position, px; infinite if the prediction
  /// is behind a member.
  double error(const PlaneTrack& track) const;
};

class PlaneFitter {
 public:
  /// With poses: the first member is the frame. Without: `cameras` only gives the number of members.
  PlaneFitter(std::span<const Camera> cameras, bool posed);

  std::size_t minTracks() const { return posed_ ? 3 : 4; }
  /// Least squares. nullopt for too few tracks, for tracks that determine no plane, and for planes that are seen
  /// mirrored or at a scale of more than 8 there.
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
