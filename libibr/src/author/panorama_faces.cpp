// SPDX-License-Identifier: Apache-2.0
#include "author/panorama_faces.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace ibr {
namespace {

constexpr double kPi = std::numbers::pi;

cv::Mat view(const Image8& image) {
  return {image.height, image.width, CV_8UC(image.channels), const_cast<std::uint8_t*>(image.values.data())};
}

// One pixel more on every side: what is beyond the seam, and what is beyond a pole, half a turn away.
cv::Mat bordered(const Image8& panorama) {
  const cv::Mat inner = view(panorama);
  cv::Mat tall(panorama.height + 2, panorama.width, inner.type()), result;
  inner.copyTo(tall.rowRange(1, panorama.height + 1));
  for (const auto& [to, from] : {std::pair(0, 0), std::pair(panorama.height + 1, panorama.height - 1)})
    for (int x = 0; x < panorama.width; ++x) {
      const int opposite = (x + panorama.width / 2) % panorama.width;
      inner.col(opposite).row(from).copyTo(tall.col(x).row(to));
    }
  cv::copyMakeBorder(tall, result, 0, 0, 1, 1, cv::BORDER_WRAP);
  return result;
}

}  // namespace

std::array<glm::dquat, 6> cubeRotations() {
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0);
  return {glm::dquat(1, 0, 0, 0),     glm::angleAxis(-kPi / 2, y), glm::angleAxis(kPi, y),
          glm::angleAxis(kPi / 2, y), glm::angleAxis(kPi / 2, x),  glm::angleAxis(-kPi / 2, x)};
}

Intrinsics faceIntrinsics(int size, double fovRadians) {
  const double focal = 0.5 * size / std::tan(0.5 * fovRadians);
  return {CameraModel::pinhole, size, size, focal, focal, 0.5 * size, 0.5 * size};
}

int faceSize(int panoramaWidth, double fovRadians) {
  return std::max(1, int(std::lround(panoramaWidth / kPi * std::tan(0.5 * fovRadians))));
}

Image8 facePicture(const Image8& panorama, const Intrinsics& face, glm::dquat rotation) {
  Intrinsics sphere;
  sphere.model = CameraModel::equirectangular;
  sphere.width = panorama.width;
  sphere.height = panorama.height;
  // Positions in the bordered picture, whose pixel centres lie at whole numbers for OpenCV.
  cv::Mat position(face.height, face.width, CV_32FC2);
  for (int y = 0; y < face.height; ++y)
    for (int x = 0; x < face.width; ++x) {
      const glm::dvec2 at = *project(sphere, rotation * unproject(face, {x + 0.5, y + 0.5}));
      position.at<cv::Vec2f>(y, x) = cv::Vec2f(float(at.x + 0.5), float(at.y + 0.5));
    }
  Image8 picture(face.width, face.height, panorama.channels);
  cv::Mat to = view(picture);
  cv::remap(bordered(panorama), to, position, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return picture;
}

}  // namespace ibr
