// SPDX-License-Identifier: Apache-2.0
#include "author/poses/local_adjust.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "author/geometry/posed_model.h"
#include "author/poses/bundle_adjust.h"

namespace ibr {
namespace {

constexpr std::size_t kMaxTracks = 1000, kMinTracks = 20;
constexpr double kPriorShift = 0.02;  // one standard deviation, in distances from the first member

double medianError(std::span<const Camera> members, std::span<const LocalTrack> tracks) {
  std::vector<double> errors;
  for (const LocalTrack& track : tracks)
    for (std::size_t i = 0; i < members.size(); ++i)
      if (track.pixel[i]) {
        const auto at = seenAt(members[i], glm::dvec4(track.position, 1));
        errors.push_back(at ? glm::distance(*at, *track.pixel[i]) : INFINITY);
      }
  return errors.empty() ? 0 : median(errors);
}

}  // namespace

std::vector<LocalTrack> localTracks(const PosedModel& model, std::span<const std::vector<std::uint32_t>> tracksOf,
                                    std::span<const std::uint32_t> members) {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t i : members) all.insert(all.end(), tracksOf[i].begin(), tracksOf[i].end());
  std::sort(all.begin(), all.end());
  std::vector<std::vector<std::uint32_t>> seenBy(members.size() + 1);
  for (auto first = all.begin(); first != all.end();) {
    const auto last = std::upper_bound(first, all.end(), *first);
    seenBy[std::size_t(last - first)].push_back(*first);
    first = last;
  }
  std::vector<LocalTrack> tracks;
  for (std::size_t count = members.size(); count >= 2; --count) {
    const std::vector<std::uint32_t>& list = seenBy[count];
    const std::size_t room = kMaxTracks - tracks.size(), wanted = std::min(room, list.size());
    for (std::size_t k = 0; k < wanted; ++k) {  // evenly spaced: neighbours in the model are neighbours in images
      const Track& track = model.tracks[list[k * list.size() / wanted]];
      LocalTrack local{track.position, std::vector<std::optional<glm::dvec2>>(members.size())};
      for (const TrackObservation& seen : track.observations)
        if (const auto at = std::ranges::find(members, seen.image); at != members.end())
          local.pixel[std::size_t(at - members.begin())] = seen.pixel;
      tracks.push_back(std::move(local));
    }
  }
  return tracks;
}

std::vector<Pose> locallyAdjusted(std::span<const Camera> members, std::span<const LocalTrack> tracks,
                                  double minErrorPx) {
  std::vector<BundleCamera> cameras;
  double longest = 0;
  for (const Camera& member : members) {
    cameras.push_back({member, 0, cameras.empty()});
    longest = std::max(longest, glm::distance(member.pose.position, members[0].pose.position));
  }
  if (tracks.size() >= kMinTracks && medianError(members, tracks) >= minErrorPx) {
    std::vector<BundlePoint> points;
    for (const LocalTrack& track : tracks) {
      points.push_back({glm::dvec4(track.position, 1), {}});
      for (std::uint32_t i = 0; i < members.size(); ++i)
        if (track.pixel[i]) points.back().seen.push_back({i, *track.pixel[i]});
    }
    BundleOptions options;
    options.shift = kPriorShift * std::max(longest, 1e-12);
    const Bundle adjusted = adjustBundle(cameras, points, options);
    for (std::size_t i = 0; i < members.size(); ++i) cameras[i].camera = adjusted.cameras[i];
  }
  std::vector<Pose> poses;
  for (const BundleCamera& camera : cameras) poses.push_back(camera.camera.pose);
  return poses;
}

}  // namespace ibr
