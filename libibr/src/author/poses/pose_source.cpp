// SPDX-License-Identifier: Apache-2.0
#include "author/poses/pose_source.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "base/check.h"
#include "io/image_file.h"

namespace ibr {

ImageSize PoseSource::sizeOf(const std::string& name) {
  if (photographs.folder().empty()) {
    const std::filesystem::path beside = std::filesystem::is_directory(path) ? path : path.parent_path();
    photographs = PhotographFinder(beside.empty() ? "." : beside);
  }
  const auto found = photographs.find(name);
  if (!found) {
    missing.push_back(name);
    return {64, 64};
  }
  const ImageFileInfo info = probeImage(photographs.folder() / *found);
  return {info.width, info.height};
}

void setLens(PosedImage& image, LensModel model, int width, int height, const std::vector<double>& parameters,
             Border border) {
  const Lens lens(model, width, height, parameters);
  image.lens.reset();
  if (lens.distorts()) {
    image.camera.intrinsics = undistorted(lens, border);
    image.lens = lens;
  } else {
    const glm::dvec2 f = lens.focal(), c = lens.centre();
    image.camera.intrinsics = {CameraModel::pinhole, width, height, f.x, f.y, c.x, c.y};
  }
}

void setBrownLens(PosedImage& image, int width, int height, const PinholeTerms& pinhole, const BrownTerms& terms,
                  Border border) {
  setLens(image, LensModel::fullOpencv, width, height,
          {pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy, terms.k1, terms.k2, terms.p1, terms.p2, terms.k3, 0, 0, 0},
          border);
}

void setPanorama(PosedImage& image, int width, int height) {
  check(width == 2 * height, ErrorCode::unsupported,
        "is a spherical camera of {}x{} px, not twice as wide as high; partial panoramas are not supported", width,
        height);
  image.camera.intrinsics = {CameraModel::equirectangular, width, height, 0, 0, 0, 0};
  image.lens.reset();
}

ImageSize sizeAsStored(const PosedImage& image) {
  const Intrinsics& k = image.camera.intrinsics;
  return image.lens ? ImageSize{image.lens->width(), image.lens->height()} : ImageSize{k.width, k.height};
}

void observe(Track& track, const PosedModel& model, std::uint32_t image, glm::dvec2 pixel) {
  for (const TrackObservation& known : track.observations)
    if (known.image == image) return;
  const PosedImage& posed = model.images[image];
  const std::optional<glm::dvec2> seen =
      posed.lens ? undistort(pixel, *posed.lens, posed.camera.intrinsics) : std::optional(pixel);
  if (seen) track.observations.push_back({image, *seen});
}

std::optional<std::string> rotationFault(const glm::dmat3& matrix) {
  constexpr double kRounding = 1e-3;  // as for transforms.json
  const glm::dmat3 product = glm::transpose(matrix) * matrix;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(product[i][j] - (i == j)) <= kRounding)) return "is not a rotation: its rows are not orthonormal";
  if (!(glm::determinant(matrix) > 0)) return "is a reflection, not a rotation: its determinant is -1";
  return std::nullopt;
}

glm::dquat rotationOf(const glm::dmat3& matrix) {
  return glm::normalize(glm::quat_cast(matrix));
}

glm::dmat3 matrixOfRows(const std::array<double, 9>& rows) {
  glm::dmat3 matrix;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix[j][i] = rows[std::size_t(3 * i + j)];
  return matrix;
}

}  // namespace ibr
