// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/posed_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "base/check.h"

namespace ibr {

void removeImages(PosedModel& model, const std::vector<std::string>& list) {
  const std::set<std::string> names(list.begin(), list.end());
  for (const std::string& name : names)
    check(std::any_of(model.images.begin(), model.images.end(), [&](const auto& i) { return i.name == name; }),
          ErrorCode::invalidInput, "\"{}\" cannot be excluded: the model has no such image", name);
  constexpr std::uint32_t kGone = ~0u;
  std::vector<std::uint32_t> index;
  std::vector<PosedImage> kept;
  for (PosedImage& image : model.images) {
    const bool keep = !names.contains(image.name);
    index.push_back(keep ? std::uint32_t(kept.size()) : kGone);
    if (keep) kept.push_back(std::move(image));
  }
  model.images = std::move(kept);
  for (Track& track : model.tracks) {
    std::erase_if(track.observations, [&](const TrackObservation& o) { return index[o.image] == kGone; });
    for (TrackObservation& o : track.observations) o.image = index[o.image];
  }
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
}

double reprojectionError(const PosedModel& model) {
  std::vector<double> errors;
  for (const Track& track : model.tracks)
    for (const TrackObservation& seen : track.observations) {
      const Camera& camera = model.images[seen.image].camera;
      const auto pixel =
          project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (track.position - camera.pose.position));
      if (pixel) errors.push_back(glm::distance(*pixel, seen.pixel));
    }
  return errors.empty() ? 0 : median(errors);
}

std::vector<std::vector<std::uint32_t>> tracksOfImages(const PosedModel& model) {
  std::vector<std::vector<std::uint32_t>> tracks(model.images.size());
  for (std::uint32_t t = 0; t < model.tracks.size(); ++t)
    for (const TrackObservation& seen : model.tracks[t].observations) {
      std::vector<std::uint32_t>& its = tracks[seen.image];
      if (its.empty() || its.back() != t) its.push_back(t);
    }
  return tracks;
}

Camera matchedCamera(Camera camera) {
  Intrinsics& k = camera.intrinsics;
  const double pixels = double(k.width) * k.height;
  if (pixels <= kMatchPixels) return camera;
  const double scale = std::sqrt(kMatchPixels / pixels);
  k = resized(k, std::max(1, int(k.width * scale)), std::max(1, int(k.height * scale)));
  return camera;
}

}  // namespace ibr
