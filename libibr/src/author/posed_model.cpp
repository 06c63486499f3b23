// SPDX-License-Identifier: Apache-2.0
#include "author/posed_model.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <set>

#include "base/check.h"

namespace ibr {

void removeImages(PosedModel& model, const std::vector<std::string>& list) {
  const std::set<std::string> names(list.begin(), list.end());
  for (const std::string& name : names)
    check(std::any_of(model.images.begin(), model.images.end(), [&](const auto& i) { return i.name == name; }),
          ErrorCode::invalidInput, "\"{}\" is to be left out, but the model has no such image", name);
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

std::vector<glm::dvec3> pointsSeenBy(const PosedModel& model, std::uint32_t image) {
  std::vector<glm::dvec3> points;
  for (const Track& track : model.tracks)
    if (std::ranges::any_of(track.observations, [&](const TrackObservation& o) { return o.image == image; }))
      points.push_back(track.position);
  return points;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ibr
