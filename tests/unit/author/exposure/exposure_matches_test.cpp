// SPDX-License-Identifier: Apache-2.0
// Comparing the colours of photographs with overlapping fields of view, with and without depth.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <set>

#include "author/exposure/exposure.h"
#include "author/exposure/exposure_overlap.h"
#include "author/exposure/vignetting.h"
#include "base/srgb.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/exact_depth.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;

namespace {

using Gains = std::vector<glm::dvec3>;

constexpr int kSide = 240;

glm::dquat turned(double right, double up) {
  return glm::angleAxis(-right, glm::dvec3(0, 1, 0)) * glm::angleAxis(up, glm::dvec3(1, 0, 0));
}

Camera lookingFrom(glm::dvec3 place, const glm::dquat& rotation) {
  return {pinholeFromFov(kSide, kSide, 105 * std::numbers::pi / 180), {place, rotation}};
}

// Faces of a cube; each field of view is 15 degrees wider than a right angle.
std::vector<Camera> faces(glm::dvec3 place) {
  constexpr double kRight = std::numbers::pi / 2;
  std::vector<Camera> cameras;
  for (int k = 0; k < 4; ++k) cameras.push_back(lookingFrom(place, turned(k * kRight, 0)));
  for (const double up : {kRight, -kRight}) cameras.push_back(lookingFrom(place, turned(0, up)));
  return cameras;
}

// Photographs of a room in a folder, each with its own exposure and vignetting.
class Taken {
 public:
  // `hasDepth`: all photographs have exact depth.
  explicit Taken(const std::vector<Camera>& cameras, bool hasDepth = false) {
    SyntheticOptions options;
    options.cameras = cameras;
    options.cells = {{0, 1}};  // not used
    options.gridStep = kSide;
    options.planes = roomPlanes({-5, -4, -6}, {6, 3, 5}, 1.5);
    options.samplesPerAxis = 2;
    scene = makeScene(options);
    for (std::uint32_t n = 0; hasDepth && n < cameras.size(); ++n) matched_.insert(n);
  }

  // Writes each photograph with its exposure and the lens's vignetting; values above 1 are clipped.
  void take(const Gains& exposures, glm::dvec2 vignetting = glm::dvec2(0.0)) {
    photographs.clear();
    model = {};
    for (std::size_t n = 0; n < scene.photographs.size(); ++n) {
      Image8 picture = scene.photographs[n];
      const Camera& camera = scene.scene.nodes[n].camera;
      const Intrinsics& k = camera.intrinsics;
      for (int y = 0; y < k.height; ++y)
        for (int x = 0; x < k.width; ++x) {
          const double radius = 2 * std::hypot(x + 0.5 - k.cx, y + 0.5 - k.cy) / std::hypot(k.width, k.height);
          for (int c = 0; c < 3; ++c) {
            std::uint8_t& level = picture.pixel(x, y)[std::size_t(c)];
            const double light =
                exposures[n][c] * std::exp(logVignetting(vignetting, radius)) * srgbToLinear(level / 255.0);
            level = std::uint8_t(std::lround(255 * linearToSrgb(std::clamp(light, 0.0, 1.0))));
          }
        }
      const std::string name = std::to_string(n) + ".png";
      writeImage(folder / name, picture);
      model.images.push_back({name, camera});
      photographs.push_back(findPhotograph(folder.path(), model.images.back(), 0));
    }
  }

  std::vector<ExposureMatch> matches() const {
    return exposureMatches(photographs, model, depths(), BuildJobs(2, 0, silent_));
  }
  std::vector<OverlapPoint> overlaps() const {
    return overlapPoints(photographs, model, depths(), BuildJobs(2, 0, silent_));
  }
  Exposures measured() const { return solveExposures(photographs.size(), matches()); }

  TemporaryFolder folder;
  SyntheticScene scene;
  std::vector<Photograph> photographs;
  PosedModel model;

 private:
  std::vector<PhotographDepth> depths() const {
    return depthOfPhotographs(camerasOf(scene.scene), {.matches = exactMatches(scene, matched_)});
  }

  std::set<std::uint32_t> matched_;
  ProgressCallback silent_;
};

const Gains kExposures{{1.8, 1.6, 1.9},   {0.55, 0.6, 0.52}, {1, 1.1, 0.9},
                       {0.7, 0.66, 0.74}, {1.3, 1.25, 1.2},  {0.9, 1, 1}};

// Returns the largest relative error after one common factor for each channel.
double worstError(const Gains& gains, const Gains& exposures) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    double mean = 0;
    for (std::size_t n = 0; n < gains.size(); ++n)
      mean += std::log(gains[n][c] * exposures[n][c]) / double(gains.size());
    for (std::size_t n = 0; n < gains.size(); ++n)
      worst = std::max(worst, std::abs(gains[n][c] * exposures[n][c] / std::exp(mean) - 1));
  }
  return worst;
}

}  // namespace

TEST_CASE("exposures of photographs from one position are measured at shared borders, without depth or points") {
  Taken taken(faces({0, 0, 0}));
  taken.take(kExposures);
  const Exposures exposures = taken.measured();
  CHECK(exposures.measured == 6);
  CHECK(exposures.parts == 1);
  CHECK(worstError(exposures.gains, kExposures) < 0.005);
  for (int c = 0; c < 3; ++c) {
    double mean = 0;
    for (const glm::dvec3& gain : exposures.gains) mean += std::log(gain[c]) / 6;
    CHECK(std::abs(mean) < 1e-12);
  }
}

TEST_CASE("overlaps lie where both photographs show the same point") {
  std::vector<Camera> cameras = faces({0, 0, 0});
  for (const Camera& camera : faces({0.5, 0.2, 0.1})) cameras.push_back(camera);
  Taken taken(cameras, true);
  taken.take(Gains(12, glm::dvec3(1)));
  std::size_t across = 0, ahead = 0;
  for (const OverlapPoint& point : taken.overlaps()) {
    const glm::dvec3 from = cameras[point.first].pose.position, to = cameras[point.second].pose.position;
    CHECK(point.first < point.second);
    ahead += point.second == point.first + 6;
    if (from == to) continue;  // depth is not read for this pair
    ++across;
    const double distance = distanceAlong(taken.scene, from, point.ray).value();
    CHECK(distance * point.inverseDistance == Approx(1).epsilon(0.06));
    const double there = distanceAlong(taken.scene, to, from + distance * point.ray - to).value();
    CHECK(there > 0.9);  // no surface occludes the overlap
  }
  CHECK(ahead > 200);
  CHECK(across > ahead + 200);
}

TEST_CASE("without depth, photographs with a large parallax are not compared") {
  Taken taken({lookingFrom({-1, 0, 0}, turned(0, 0)), lookingFrom({1, 0, 0.5}, turned(0.3, 0))});
  taken.take(Gains(2, glm::dvec3(1)));
  CHECK(taken.overlaps().empty());
  const Exposures exposures = taken.measured();
  CHECK(exposures.measured == 0);
  CHECK(exposures.gains == Gains(2, glm::dvec3(1)));
  CHECK(describeExposures(exposures).find("not measured") != std::string::npos);
}

TEST_CASE("unconnected parts keep a mean each, and are reported") {
  std::vector<Camera> cameras{lookingFrom({0, 0, 0}, turned(0, 0)), lookingFrom({0, 0, 0}, turned(0.6, 0)),
                              lookingFrom({0, 0, 0}, turned(2.9, 0)), lookingFrom({0, 0, 0}, turned(3.5, 0))};
  Taken taken(cameras);
  const Gains exposures{glm::dvec3(1), glm::dvec3(0.5), glm::dvec3(0.9), glm::dvec3(0.6)};
  taken.take(exposures);
  const Exposures found = taken.measured();
  CHECK(found.measured == 4);
  CHECK(found.parts == 2);
  CHECK(found.gains[1].g / found.gains[0].g == Approx(2).epsilon(0.005));
  CHECK(found.gains[3].g / found.gains[2].g == Approx(1.5).epsilon(0.005));
  CHECK(found.gains[0].g * found.gains[1].g == Approx(1));
  CHECK(found.gains[2].g * found.gains[3].g == Approx(1));
  CHECK(describeExposures(found).find("2 parts") != std::string::npos);
}

TEST_CASE("masked pixels are not compared") {
  Taken taken({lookingFrom({0, 0, 0}, turned(0, 0)), lookingFrom({0, 0, 0}, turned(0.5, 0))});
  taken.take({glm::dvec3(1), glm::dvec3(0.7)});
  // A person in a pale coat covers most of the overlap in the first photograph only.
  Image8 picture = readImage(taken.folder / "0.png"), mask(kSide, kSide, 1, 255);
  for (int y = 0; y < kSide; ++y)
    for (int x = kSide / 5; x < kSide; ++x)
      if (y > kSide / 8) {
        mask.pixel(x, y)[0] = 0;
        for (std::size_t c = 0; c < 3; ++c) picture.pixel(x, y)[c] = std::uint8_t(160 + picture.pixel(x, y)[c] / 4);
      }
  writeImage(taken.folder / "0.png", picture);
  CHECK(std::abs(taken.measured().gains[1].g / taken.measured().gains[0].g * 0.7 - 1) > 0.1);
  writeImage(taken.folder / "mask.png", mask);
  taken.photographs[0].storedMask = taken.folder / "mask.png";
  CHECK(taken.measured().gains[1].g / taken.measured().gains[0].g * 0.7 == Approx(1).epsilon(0.005));
}

TEST_CASE("fully clipped photographs and single photographs are unchanged") {
  Taken taken({lookingFrom({0, 0, 0}, turned(0, 0)), lookingFrom({0, 0, 0}, turned(0.5, 0))});
  taken.take({glm::dvec3(1), glm::dvec3(3000)});
  const Exposures clipped = taken.measured();
  CHECK(clipped.measured == 0);
  CHECK(clipped.gains == Gains(2, glm::dvec3(1)));
  taken.take({glm::dvec3(1), glm::dvec3(0)});
  CHECK(taken.measured().gains == Gains(2, glm::dvec3(1)));
  CHECK(solveExposures(1, {}).gains == Gains(1, glm::dvec3(1)));
}

TEST_CASE("vignetting is separated from exposures") {
  const glm::dvec2 planted(-0.35, -0.25);  // corners receive 55 % of the light
  Taken taken(faces({0, 0, 0}));
  const Gains exposures{{1, 0.9, 1}, {0.55, 0.6, 0.52}, {0.8, 0.8, 0.9}, {0.7, 0.66, 0.74}, {1, 1, 1}, {0.9, 1, 1}};
  taken.take(exposures, planted);
  const std::vector<ExposureMatch> matches = taken.matches();
  const std::vector<std::uint32_t> lenses(6, 0);
  const std::vector<glm::dvec2> found = solveVignetting(6, matches, lenses);
  for (const double radius : {0.3, 0.5, 0.7, 0.9})
    CHECK(std::exp(logVignetting(found[3], radius) - logVignetting(planted, radius)) == Approx(1).epsilon(0.02));
  CHECK(worstError(solveExposures(6, withoutVignetting(matches, found)).gains, exposures) < 0.005);
  taken.take(exposures);  // without vignetting
  CHECK(std::abs(logVignetting(solveVignetting(6, taken.matches(), lenses)[0], 1)) < 0.02);
}

TEST_CASE("removing vignetting restores the image") {
  Taken taken(std::vector<Camera>(2, lookingFrom({0, 0, 0}, turned(0, 0))));
  const glm::dvec2 planted(-0.4, -0.3);
  taken.take(Gains(2, glm::dvec3(0.9)));
  const Image8 there = readImage(taken.folder / "0.png");
  taken.take(Gains(2, glm::dvec3(0.9)), planted);
  const Image8 shaded = readImage(taken.folder / "0.png");
  const Intrinsics& k = taken.photographs[0].camera.intrinsics;
  const Image8 cleared = unvignetted(shaded, k, planted);
  std::size_t wrong = 0, differed = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        differed += std::abs(shaded.pixel(x, y)[c] - there.pixel(x, y)[c]) > 20;
        wrong += std::abs(cleared.pixel(x, y)[c] - there.pixel(x, y)[c]) > 2;
      }
  CHECK(differed > 10000);
  CHECK(double(wrong) < 0.001 * 3 * kSide * kSide);
  CHECK(unvignetted(shaded, k, {0, 0}) == shaded);
  CHECK(!isNegligible(planted));
  CHECK(isNegligible({0.02, -0.02}));  // at most half a percent anywhere
  CHECK(!isNegligible({0.1, -0.1}));   // none in the corners, but much between the middle and the corners
  const Intrinsics panorama{CameraModel::equirectangular, 64, 32};
  CHECK(vignettingRadius(panorama, {64, 32}) == 0);
  CHECK(vignettingRadius(k, {0, 0}) == Approx(1));
}

TEST_CASE("photographs of one camera, aperture and zoom share a lens") {
  Taken taken(faces({0, 0, 0}));
  taken.take(kExposures);
  CHECK(lensIndices(taken.photographs) == std::vector<std::uint32_t>(6, 0));
  taken.photographs[1].capture.fNumber = 2.8;
  taken.photographs[2].capture.model = "another";
  taken.photographs[3].whole.fx *= 1.5;
  taken.photographs[4].whole.fx *= 1.001;  // focal lengths estimated for each photograph differ slightly
  CHECK(lensIndices(taken.photographs) == std::vector<std::uint32_t>{0, 1, 2, 3, 0, 0});
}
