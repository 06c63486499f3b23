// SPDX-License-Identifier: Apache-2.0
// A walk through a grid of photographs of one colour each: colours identify the resident textures.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "reference/stage.h"
#include "support/gpu.h"

namespace ibr::test {

inline constexpr std::uint64_t kMiB = std::uint64_t(1) << 20;

/// side² cameras a metre apart, all in one direction, before a backdrop at infinity; two of three triangles a square.
inline Scene gridScene(int side, int width, int height) {
  Scene scene;
  for (int z = 0; z < side; ++z)
    for (int x = 0; x < side; ++x) {
      Node& node = scene.nodes.emplace_back();
      node.name = fmt::format("{}-{}", x, z);
      node.camera = cameraAt({double(x), 0, double(z)}, 0, 0, width, height, 1.4);
    }
  const auto add = [&](std::vector<std::uint32_t> members) {
    Cell& cell = scene.cells.emplace_back();
    cell.members = std::move(members);
    const std::vector<glm::vec2> corners{{0, 0}, {width, 0}, {0, height}, {width, height}};
    cell.mesh.match.assign(3, corners);
    cell.mesh.ratio.assign(3, std::vector<float>(4, 1.0f));
    cell.mesh.inverseDistance.assign(4, 0.0f);
    cell.mesh.uncertainty.assign(4, 0.0f);
    cell.mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
    cell.mesh.tier.assign(2, kTierConsistent);
    cell.mesh.ecc.assign(2, 1.0f);
  };
  for (std::uint32_t z = 0; z + 1 < std::uint32_t(side); ++z)
    for (std::uint32_t x = 0; x + 1 < std::uint32_t(side); ++x) {
      const std::uint32_t n = z * std::uint32_t(side) + x, below = n + std::uint32_t(side);
      add({n, n + 1, below});
      add({n + 1, below + 1, below});
    }
  return scene;
}

/// One colour a photograph, different from its neighbours. The stand-in has the same hue, but is darker.
struct Colours {
  TextureFormat format = TextureFormat::rgba8;
  static constexpr int kMaxStandInSide = 64;

  static std::array<std::uint8_t, 3> of(std::size_t node, bool standIn) {
    const auto value = [&](std::size_t factor) { return std::uint8_t(128 + (node * factor % 8) * 16); };
    std::array<std::uint8_t, 3> colour{value(1), value(3), value(5)};
    if (standIn)
      for (std::uint8_t& c : colour) c = std::uint8_t(c / 2);
    return colour;
  }

  Texture operator()(const Scene& scene, std::size_t node, int firstLevel) const {
    const Intrinsics& k = scene.nodes[node].camera.intrinsics;
    Texture texture;
    texture.format = format;
    texture.width = std::max(1, k.width >> firstLevel);
    texture.height = std::max(1, k.height >> firstLevel);
    for (int w = texture.width, h = texture.height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
      const auto colour = of(node, std::max(w, h) <= kMaxStandInSide);
      std::vector<std::byte> block;
      if (format == TextureFormat::rgba8) {
        block = {std::byte(colour[0]), std::byte(colour[1]), std::byte(colour[2]), std::byte(255)};
      } else {
        Image8 image(4, 4, 4, 255);
        for (int i = 0; i < 16; ++i) std::ranges::copy(colour, image.pixel(i % 4, i / 4).begin());
        block = encodeTexture({image}, format).levels[0];
      }
      std::vector<std::byte>& bytes = texture.levels.emplace_back(textureBytes(format, w, h));
      for (std::size_t at = 0; at < bytes.size(); at += block.size()) std::ranges::copy(block, &bytes[at]);
      if (w == 1 && h == 1) return texture;
    }
  }
};

/// Viewer whose device has always finished the frame before the last.
class Walker {
 public:
  Walker(const Scene& scene, const GpuSceneOptions& options, VkExtent2D size)
      : scene_(scene),
        bounds_(sceneBounds(scene)),
        gpuScene(testDevice(), scene, options),
        renderer_(testDevice(), gpuScene, {size}),
        offscreen_(testDevice(), size) {}

  FramePlan planAt(glm::dvec3 position) {
    const VkExtent2D size = offscreen_.target().extent;
    RenderSettings settings;
    settings.switchSeconds = 0;
    settings.background = {1, 0, 1};
    return planFrame(scene_, bounds_, {{cameraAt(position, 0, 0, int(size.width), int(size.height), 1.2)}, settings});
  }

  Image8 frame(const FramePlan& plan) {
    ++number;
    const Image8 picture = offscreen_.render([&](VkCommandBuffer commands) {
      streamed = gpuScene.stream(commands, plan, number, number < 2 ? 0 : number - 2);
      renderer_.record(commands, plan, offscreen_.target());
    });
    most = std::max(most, gpuScene.memory().sum());
    uploaded += streamed.uploadedBytes;
    return picture;
  }

 private:
  const Scene& scene_;
  SceneBounds bounds_;

 public:
  GpuScene gpuScene;
  GpuScene::StreamStatus streamed;
  std::uint64_t number = 0, most = 0, uploaded = 0;

 private:
  Renderer renderer_;
  Offscreen offscreen_;
};

/// Shares of pixels in the photograph's own colour and in its stand-in's colour.
struct Shares {
  double own = 0, standIn = 0;
};
inline Shares sharesOf(const Image8& picture, std::size_t node) {
  Shares shares;
  for (const bool standIn : {false, true}) {
    const auto colour = Colours::of(node, standIn);
    double& share = standIn ? shares.standIn : shares.own;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        bool same = true;
        for (std::size_t c = 0; c < 3; ++c) same &= std::abs(picture.pixel(x, y)[c] - colour[c]) <= 4;  // BC1
        share += same;
      }
    share /= picture.width * picture.height;
  }
  return shares;
}

/// Number of pixels without a photograph. The background is purple, and no photograph's green is so low.
inline int emptyPixels(const Image8& picture) {
  int count = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) count += picture.pixel(x, y)[1] < 48;
  return count;
}

struct Messages {
  std::vector<std::string> warnings, errors, others;
  LogCallback log() {
    return [this](LogLevel level, std::string_view text) {
      (level == LogLevel::error ? errors : level == LogLevel::warning ? warnings : others).emplace_back(text);
    };
  }
};

}  // namespace ibr::test
