// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/image_operations.h"

#include <algorithm>
#include <cstdlib>

#include "base/srgb.h"

namespace ibr::app {

Image8 rgb(const Image8& image) {
  Image8 out(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::ranges::copy(image.pixel(x, y).first(3), out.pixel(x, y).begin());
  return out;
}

void makeOpaque(Image8& image) {
  for (std::size_t i = 3; i < image.values.size(); i += 4) image.values[i] = 255;
}

std::vector<ExrChannel> exrChannels(const Image8& image, const FrameBuffers& buffers) {
  std::vector<ExrChannel> channels;
  const auto add = [&](const char* name, const auto& from, std::size_t channel, auto&& value) {
    ImageF& values = channels.emplace_back(name, ImageF(image.width, image.height, 1)).values;
    for (std::size_t i = 0; i < values.values.size(); ++i)
      values.values[i] = value(from.values[i * std::size_t(from.channels) + channel]);
  };
  const auto linear = [](std::uint8_t value) { return float(srgbToLinear(value / 255.0)); };
  const auto same = [](float value) { return value; };
  add("R", image, 0, linear);
  add("G", image, 1, linear);
  add("B", image, 2, linear);
  add("Z", buffers.surface, 0, same);
  add("tier", buffers.surface, 1, same);
  add("rank", buffers.surface, 2, same);
  add("weight.0", buffers.weights, 0, same);
  add("weight.1", buffers.weights, 1, same);
  add("weight.2", buffers.weights, 2, same);
  add("weight.3", buffers.weights, 3, same);
  add("confidence.spread", buffers.confidence, 0, same);
  add("confidence.uncertainty", buffers.confidence, 1, same);
  add("confidence.extrapolation", buffers.surface, 3, same);
  return channels;
}

Image8 absoluteDifference(const Image8& a, const Image8& b, int gain) {
  Image8 out(a.width, a.height, 3);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        out.pixel(x, y)[c] =
            std::uint8_t(std::min(255, gain * std::abs(int(a.pixel(x, y)[c]) - int(b.pixel(x, y)[c]))));
  return out;
}

Image8 sideBySide(const std::vector<Image8>& images) {
  int width = 0;
  for (const Image8& image : images) width += image.width;
  Image8 out(width, images.front().height, 3);
  for (int y = 0; y < out.height; ++y) {
    int left = 0;
    for (const Image8& image : images)
      for (int x = 0; x < image.width; ++x) std::ranges::copy(image.pixel(x, y), out.pixel(left++, y).begin());
  }
  return out;
}

}  // namespace ibr::app
