// SPDX-License-Identifier: Apache-2.0
#include "author/photographs/masks.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "author/pixels/cv_view.h"
#include "base/check.h"
#include "ibr/author/lens.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr int kUsedThreshold = 191;  // of 255: a pixel is used if more than this share is

Image8 firstChannel(const Image8& picture) {
  Image8 grey(picture.width, picture.height, 1);
  for (std::size_t p = 0; p < grey.values.size(); ++p)
    grey.values[p] = picture.values[p * std::size_t(picture.channels)];
  return grey;
}

// Fills pixels where `known` is 0 with colours from increasingly wide surroundings.
void fillUnknown(cv::Mat& colours, const cv::Mat& known) {
  if (cv::countNonZero(known) == int(known.total()) || (known.rows == 1 && known.cols == 1)) return;
  const cv::Size half(std::max(known.cols / 2, 1), std::max(known.rows / 2, 1));
  cv::Mat shown, sum, share, weight, quotient, wide;
  colours.copyTo(shown, known);
  cv::resize(shown, sum, half, 0, 0, cv::INTER_AREA);
  cv::resize(known, share, half, 0, 0, cv::INTER_AREA);
  cv::Mat some = share > 0;
  cv::max(share, 1, weight);
  cv::cvtColor(weight, weight, cv::COLOR_GRAY2RGB);
  cv::divide(sum, weight, quotient, 255);
  fillUnknown(quotient, some);
  cv::resize(quotient, wide, colours.size(), 0, 0, cv::INTER_LINEAR);
  wide.copyTo(colours, ~known);
}

}  // namespace

std::optional<fs::path> findMaskFile(const fs::path& folder, const std::string& photograph) {
  std::error_code ignored;
  for (const fs::path& file : {folder / (photograph + ".png"), (folder / photograph).replace_extension(".png")})
    if (fs::is_regular_file(file, ignored)) return file;
  return std::nullopt;
}

fs::path storedMaskFile(const std::string& photograph) {
  return fs::path("masks") / (photograph + ".png");
}

void checkMaskSize(const Photograph& photograph, const fs::path& file) {
  const ImageFileInfo wanted = probeImage(photograph.source), mask = probeImage(file);
  const bool turned = photograph.applyOrientation && wanted.orientation >= 5 && mask.orientation < 5;
  const int width = turned ? wanted.height : wanted.width, height = turned ? wanted.width : wanted.height;
  check(mask.width == width && mask.height == height, ErrorCode::invalidInput,
        "{}: the mask is {} × {} px, {} is {} × {}", file.string(), mask.width, mask.height, photograph.source.string(),
        width, height);
}

Image8 loadMask(const Photograph& photograph, const fs::path& file) {
  checkMaskSize(photograph, file);
  Image8 mask = readImage(file, photograph.applyOrientation);
  for (std::uint8_t& value : mask.values) value = value ? 255 : 0;
  if (photograph.lens) mask = undistort(mask, *photograph.lens, photograph.whole);
  const Intrinsics& k = photograph.camera.intrinsics;
  return resizedMask(firstChannel(mask), k.width, k.height);
}

Image8 storedMask(const Photograph& photograph) {
  return photograph.storedMask.empty() ? Image8() : readMask(photograph.storedMask, photograph.camera.intrinsics);
}

Image8 readMask(const fs::path& file, const Intrinsics& camera) {
  const Image8 mask = firstChannel(readImage(file));
  check(mask.width == camera.width && mask.height == camera.height, ErrorCode::invalidInput,
        "{}: the mask is {} × {} px, its camera {} × {}", file.string(), mask.width, mask.height, camera.width,
        camera.height);
  return mask;
}

Image8 resizedMask(const Image8& mask, int width, int height) {
  if (mask.empty()) return {};
  Image8 result(width, height, 1);
  cv::Mat to = cvView(result);
  if (width == mask.width && height == mask.height)
    cvView(mask).copyTo(to);
  else
    cv::resize(cvView(mask), to, to.size(), 0, 0, cv::INTER_AREA);
  return binaryMask(std::move(result));
}

Image8 binaryMask(Image8 means) {
  cv::Mat values = cvView(means);
  cv::threshold(values, values, kUsedThreshold, 255, cv::THRESH_BINARY);
  return means;
}

Image8 widenedMask(const Image8& mask, int px) {
  if (mask.empty()) return {};
  Image8 result(mask.width, mask.height, 1);
  cv::Mat to = cvView(result);
  cv::erode(cvView(mask), to, cv::getStructuringElement(cv::MORPH_RECT, {2 * px + 1, 2 * px + 1}), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(255));
  return result;
}

Image8 combinedMask(const Image8& a, const Image8& b) {
  Image8 result(a.width, a.height, 1);
  cv::Mat to = cvView(result);
  cv::min(cvView(a), cvView(b), to);
  return result;
}

double ignoredShare(const Image8& mask) {
  if (mask.empty()) return 0;
  return double(std::ranges::count(mask.values, std::uint8_t(0))) / double(mask.values.size());
}

Image8 fillMasked(const Image8& rgb, const Image8& mask) {
  Image8 filled = rgb;
  cv::Mat colours = cvView(filled);
  if (!mask.empty() && ignoredShare(mask) < 1) fillUnknown(colours, cvView(mask));
  return filled;
}

Image8 withMask(const Image8& rgb, const Image8& mask) {
  const Image8 filled = fillMasked(rgb, mask);
  const cv::Mat colours = cvView(filled);
  Image8 result(rgb.width, rgb.height, 4);
  cv::Mat to = cvView(result);
  const cv::Mat from[]{colours, cvView(mask)};
  constexpr int kChannels[]{0, 0, 1, 1, 2, 2, 3, 3};
  cv::mixChannels(from, 2, &to, 1, kChannels, 4);
  return result;
}

void dropMaskedObservations(PosedModel& model, std::uint32_t image, const std::vector<std::uint32_t>& tracks,
                            const Image8& mask) {
  if (mask.empty()) return;
  const Intrinsics& k = model.images[image].camera.intrinsics;
  const glm::dvec2 scale(double(mask.width) / k.width, double(mask.height) / k.height);
  for (const std::uint32_t t : tracks)
    std::erase_if(model.tracks[t].observations, [&](const TrackObservation& seen) {
      return seen.image == image && isIgnored(mask, glm::vec2(seen.pixel * scale));
    });
}

void dropUnobservedTracks(PosedModel& model) {
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
}

}  // namespace ibr
