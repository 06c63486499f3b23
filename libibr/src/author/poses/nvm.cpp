// SPDX-License-Identifier: Apache-2.0
// Reads NVM_V3 of VisualSFM, and of COLMAP's converter. Camera axes: x right, y down, z forward. The quaternion maps
// world to camera; the position is the camera's centre.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "author/poses/text_words.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();

// The header's calibration of all cameras: "FixedK fx cx fy cy r".
std::optional<PinholeTerms> fixedCalibration(TextWords& words, const std::string& header) {
  if (header.empty()) return std::nullopt;
  const std::filesystem::path at = words.where();
  TextWords values(at, header);
  if (values.word("FixedK") != "FixedK")
    words.fault(fmt::format("\"{}\" is no calibration FixedK", header.substr(0, 40)));
  PinholeTerms pinhole{};
  pinhole.fx = values.real("FixedK fx");
  pinhole.cx = values.real("FixedK cx");
  pinhole.fy = values.real("FixedK fy");
  pinhole.cy = values.real("FixedK cy");
  if (!values.atEnd() && values.real("FixedK r") != 0)
    fail(ErrorCode::unsupported,
         "{}: the radial term r of FixedK is not 0; it distorts measurements, not projections, "
         "which no lens of libibr does",
         words.where());
  return pinhole;
}

PosedImage readCamera(TextWords& words, const std::optional<PinholeTerms>& fixed, PoseSource& source) {
  PosedImage image;
  image.name = std::string(words.word("an image's name"));
  for (char& c : image.name)
    if (c == '"') c = ' ';  // VisualSFM's form of a blank
  const double focal = words.real("the focal length");
  std::array<double, 4> q{};
  for (double& value : q) value = words.real("a value of the quaternion");
  glm::dvec3 centre;
  for (int c = 0; c < 3; ++c) centre[c] = words.real("a value of the camera's centre");
  const double radial = words.real("the radial distortion");
  words.integer("the 0 at the end of a camera", 0, 0);
  if (radial != 0)
    fail(ErrorCode::unsupported,
         "{}: the radial distortion {} of {} is not 0; it distorts measurements, not "
         "projections, which no lens of libibr does",
         words.where(), radial, image.name);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1.0) <= 1e-3))
    words.fault(fmt::format("the quaternion of {} has length {}, not 1", image.name, length));
  const glm::dquat toCamera(q[0] / length, q[1] / length, q[2] / length, q[3] / length);
  image.camera.pose = poseFromWorldToCamera(toCamera, -(toCamera * centre));
  const ImageSize size = source.sizeOf(image.name);
  const PinholeTerms k = fixed.value_or(PinholeTerms{focal, focal, 0.5 * size.width, 0.5 * size.height});
  try {
    setLens(image, LensModel::pinhole, size.width, size.height, {k.fx, k.fy, k.cx, k.cy}, source.border);
  } catch (const Error& e) {
    words.fault(fmt::format("camera {}: {}", image.name, e.what()));
  }
  return image;
}

struct Measurement {
  std::size_t track;
  std::uint32_t image;
  glm::dvec2 pixel;
};

void readPoint(TextWords& words, PosedModel& model, std::vector<Measurement>& measurements) {
  Track track;
  for (int c = 0; c < 3; ++c) track.position[c] = words.real("a point's position");
  for (int c = 0; c < 3; ++c) words.real("a point's colour");
  const std::int64_t count = words.integer("the number of a point's measurements", 0, kMaxCount);
  for (std::int64_t m = 0; m < count; ++m) {
    const auto image = words.integer("a measurement's image", 0, std::int64_t(model.images.size()) - 1);
    words.integer("a measurement's feature", -1, std::numeric_limits<std::int64_t>::max());
    const double x = words.real("a measurement's x"), y = words.real("a measurement's y");
    measurements.push_back({model.tracks.size(), std::uint32_t(image), {x, y}});
  }
  model.tracks.push_back(std::move(track));
}

glm::dvec2 centreOf(const Camera& camera) {
  return {camera.intrinsics.cx, camera.intrinsics.cy};
}

// VisualSFM measures from the principal point, COLMAP 3.8's converter from the image's corner: of the two, the one that
// is nearer to the projections of most points.
bool measuresFromCorner(const PosedModel& model, const std::vector<Measurement>& measurements) {
  std::ptrdiff_t votes = 0;
  for (const Measurement& m : measurements) {
    const Camera& camera = model.images[m.image].camera;
    const glm::dvec3 direction =
        glm::conjugate(camera.pose.rotation) * (model.tracks[m.track].position - camera.pose.position);
    if (const auto seen = project(camera.intrinsics, direction))
      votes += glm::distance(*seen, m.pixel) < glm::distance(*seen, m.pixel + centreOf(camera)) ? 1 : -1;
  }
  return votes > 0;
}

}  // namespace

PosedModel readNvm(PoseSource& source) {
  TextWords words(source.path, source.text);
  words.word("NVM_V3");
  const auto fixed = fixedCalibration(words, std::string(words.restOfLine()));
  PosedModel largest;
  std::size_t models = 0;
  // Further models follow. One without points holds the images that are not registered.
  for (std::int64_t cameras; !words.atEnd() && (cameras = words.integer("the number of cameras", 0, kMaxCount)) > 0;) {
    PosedModel model;
    for (std::int64_t i = 0; i < cameras; ++i) model.images.push_back(readCamera(words, fixed, source));
    const std::int64_t points = words.integer("the number of points", 0, kMaxCount);
    std::vector<Measurement> measurements;
    for (std::int64_t p = 0; p < points; ++p) readPoint(words, model, measurements);
    const bool fromCorner = measuresFromCorner(model, measurements);
    for (const Measurement& m : measurements)
      observe(model.tracks[m.track], model, m.image,
              fromCorner ? m.pixel : m.pixel + centreOf(model.images[m.image].camera));
    if (models++ > 0 && points == 0) continue;
    if (model.images.size() > largest.images.size()) largest = std::move(model);
  }
  if (largest.images.empty()) words.fault("the file has no camera");
  if (models > 1)
    source.warn(fmt::format("has {} models; the largest, of {} images, is read", models, largest.images.size()));
  return largest;
}

}  // namespace ibr
