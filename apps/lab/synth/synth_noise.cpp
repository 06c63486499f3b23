// SPDX-License-Identifier: Apache-2.0
#include "lab/synth/synth_noise.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "base/check.h"
#include "batch/build/pose_errors.h"
#include "ibr/author/poses.h"

namespace ibr::app {
namespace {

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  /// Box and Muller 1958. Unlike std::normal_distribution, gives the same values with every standard library.
  double operator()(double deviation) {
    const double angle = 2 * std::numbers::pi * uniform();
    return deviation * std::sqrt(-2 * std::log(uniform())) * std::cos(angle);
  }
  glm::dvec3 vector(double deviation) {
    const double x = (*this)(deviation), y = (*this)(deviation);
    return {x, y, (*this)(deviation)};
  }

 private:
  double uniform() { return (double(engine_() >> 11) + 0.5) * 0x1p-53; }
  std::mt19937_64 engine_;
};

glm::dquat turn(const glm::dvec3& by) {
  const double angle = glm::length(by);
  return angle > 0 ? glm::angleAxis(angle, by / angle) : glm::dquat(1, 0, 0, 0);
}

void retriangulate(PosedModel& model) {
  for (Track& track : model.tracks) {
    std::vector<Camera> cameras;
    std::vector<glm::dvec2> pixels;
    for (const TrackObservation& seen : track.observations) {
      cameras.push_back(model.images[seen.image].camera);
      pixels.push_back(seen.pixel);
    }
    const auto point = cameras.size() < 2 ? std::nullopt : triangulate(cameras, pixels);
    if (point)
      track.position = *point;
    else
      track.observations.clear();
  }
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
}

}  // namespace

ExitCode synthesiseNoise(const NoiseOptions& options, const Context& context) {
  const PosedModel exact = readColmapModel(options.model, context.log());
  PosedModel model = exact;
  Normal random(context.options().seed);
  for (PosedImage& image : model.images) {
    Intrinsics& k = image.camera.intrinsics;
    check(k.model == CameraModel::pinhole && !image.lens, ErrorCode::unsupported,
          "{}: noise needs a pinhole without lens distortion; this is a panorama or has a distorting lens", image.name);
    // Only two of the three rotation axes move the image's centre.
    const double radians = options.pixels / (k.fx * std::numbers::sqrt2);
    image.camera.pose.rotation = glm::normalize(image.camera.pose.rotation * turn(random.vector(radians)));
    image.camera.pose.position += random.vector(options.shift / std::numbers::sqrt3);
    k.fx *= 1 + 0.01 * options.focalPercent;
    k.fy *= 1 + 0.01 * options.focalPercent;
  }
  if (!options.tracks) model.tracks.clear();
  for (Track& track : model.tracks)
    for (TrackObservation& seen : track.observations) {
      const double x = random(options.trackPixels);
      seen.pixel += glm::dvec2(x, random(options.trackPixels));
    }
  retriangulate(model);
  writeColmapModel(model, options.output);
  const PoseErrors errors = poseErrors(model, exact);
  context.print("{}: {} photographs, {} points; {}\n", options.output, model.images.size(), model.tracks.size(),
                text(errors));
  context.report({{"model", options.output}, {"points", model.tracks.size()}, {"errors", json(errors)}});
  return kExitOk;
}

}  // namespace ibr::app
