// SPDX-License-Identifier: Apache-2.0
#include "htm/gpu_model.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <span>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "htm/projection.h"
#include "ibr/texture.h"

namespace ibr {
namespace {

void upload(const Device& device, Buffer& buffer, std::span<const std::byte> bytes, const char* name,
            Uploader& uploader) {
  makeHtmBuffer(device, buffer, bytes.size(), name);
  uploader.buffer(buffer, 0, bytes);
}

// Makes a texture array; reuses an image of the same size and number of layers.
void makeTextureArrays(const Device& device, GpuImage& image, const GpuImageInfo& info, const char* name) {
  const GpuImageInfo& now = image.info();
  if (image.get() && now.extent.width == info.extent.width && now.extent.height == info.extent.height &&
      now.layers == info.layers)
    return;
  image = GpuImage();  // first, so that memory never holds two
  image = GpuImage(device, info, name);
}

// Smallest layer size that holds every camera's photograph.
VkExtent2D arrayExtentOf(const HtmModel& model) {
  VkExtent2D extent{1, 1};
  for (const HtmCamera& camera : model.cameras) {
    extent.width = std::max(extent.width, std::uint32_t(camera.camera.intrinsics.width));
    extent.height = std::max(extent.height, std::uint32_t(camera.camera.intrinsics.height));
  }
  return extent;
}

// Expands a photograph to RGBA of the layer's size: the border pixels repeat beyond the photograph.
Image8 padded(const HtmImage& picture, VkExtent2D extent) {
  const Image8& photograph = picture.photograph;
  Image8 out(int(extent.width), int(extent.height), 4);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int fromX = std::min(x, photograph.width - 1), fromY = std::min(y, photograph.height - 1);
      const auto to = out.pixel(x, y);
      std::ranges::copy(photograph.pixel(fromX, fromY).first(3), to.begin());
      to[3] = picture.visibility.empty() ? 255 : picture.visibility.pixel(fromX, fromY)[0];
    }
  return out;
}

void checkImages(const HtmImage& picture, const HtmCamera& camera) {
  const int width = camera.camera.intrinsics.width, height = camera.camera.intrinsics.height;
  const auto require = [&](const char* kind, const Image8& image, int minChannels, int maxChannels) {
    const bool fits = image.width == width && image.height == height && image.channels >= minChannels &&
                      image.channels <= maxChannels;
    check(fits, ErrorCode::invalidInput, "camera '{}': {} is {}x{} with {} channels, must be {}x{} with {} to {}",
          camera.name, kind, image.width, image.height, image.channels, width, height, minChannels, maxChannels);
  };
  require("photograph", picture.photograph, 3, 4);
  if (!picture.visibility.empty()) require("visibility", picture.visibility, 1, 1);
}

// Half of the nearest corner's depth; at least a thousandth of the farthest's.
double nearDistanceOf(const HtmModel& model, const Camera& camera, const glm::dvec3& middle) {
  const glm::dvec4 depthOf = htmProjection(camera, middle).depthOf;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const glm::uvec3& triangle : model.surface.mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const double depth = glm::dot(depthOf, glm::dvec4(model.surface.mesh.positions[triangle[c]] - middle, 1));
      farthest = std::max(farthest, depth);
      if (depth > 0) nearest = std::min(nearest, depth);
    }
  return farthest > 0 ? std::max(0.5 * nearest, 1e-3 * farthest) : 1.0;
}

SamplerHandle makeSampler(const Device& device, VkFilter filter, VkSamplerMipmapMode mips) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = filter;
  info.mipmapMode = mips;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  return make<SamplerHandle>(device, vkCreateSampler, info, "vkCreateSampler");
}

VkFilter depthFilter(const Device& device) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device.physicalDevice(), kHtmDepthMapFormat, &properties);
  const bool linear = properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
  return linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
}

const HtmModel& checked(const HtmModel& model) {
  const std::vector<Fault> faults = validate(model, 1);
  if (!faults.empty()) fail(ErrorCode::invalidInput, "{} {}", faults[0].field, faults[0].message);
  return model;
}

}  // namespace

void makeHtmBuffer(const Device& device, Buffer& buffer, std::uint64_t bytes, const char* name) {
  const std::uint32_t most = device.properties().limits.maxStorageBufferRange;
  check(bytes <= most, ErrorCode::unsupported,
        "harmonised model: {} take {} bytes, more than the storage buffer limit of {} bytes", name, bytes, most);
  if (buffer.get() && buffer.size() >= bytes) return;
  buffer = Buffer();  // first, so that memory never holds two
  buffer =
      Buffer(device, std::max<std::uint64_t>(bytes, 4),
             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
             MemoryKind::device, name);
}

HtmImage prepareHtmImage(const HtmModel& model, std::size_t camera, HtmImage picture) {
  checkImages(picture, model.cameras[camera]);
  return {{}, {}, std::make_shared<const std::vector<Image8>>(buildMips(padded(picture, arrayExtentOf(model))))};
}

GpuHtmModel::State::State(Device& device, const HtmModel& model, const HtmImageSource& source,
                          const GpuHtmModelOptions& options)
    : device_(&device), depthMaps_(device) {
  const bool software = device.kind() == DeviceKind::software;
  photographSampler = makeSampler(
      device, VK_FILTER_LINEAR,
      options.trilinear.value_or(!software) ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST);
  depthSampler = makeSampler(device, depthFilter(device), VK_SAMPLER_MIPMAP_MODE_NEAREST);
  replace(model, source, options.uploads);
}

void GpuHtmModel::State::replace(const HtmModel& model, const HtmImageSource& source, Uploads* uploads) {
  bounds = htmBounds(checked(model));
  vertexCount = std::uint32_t(model.vertexCount());
  triangleCount = std::uint32_t(model.surface.mesh.triangles.size());
  hasComplements = !model.complements.empty();
  cameras.clear();
  nearDistance.clear();
  for (const HtmCamera& camera : model.cameras) {
    cameras.push_back(camera.camera);
    nearDistance.push_back(nearDistanceOf(model, camera.camera, bounds.middle));
  }
  Uploader uploader(*device_, uploads);
  uploadMesh(model, uploader);
  uploadPhotographs(model, source, uploader);
  depthMaps_.draw(*device_, *this, uploader);
  uploader.flush();
}

void GpuHtmModel::State::uploadMesh(const HtmModel& model, Uploader& uploader) {
  std::vector<glm::vec3> relative;
  for (const glm::dvec3& position : model.surface.mesh.positions) relative.emplace_back(position - bounds.middle);
  upload(*device_, positions, std::as_bytes(std::span(relative)), "positions", uploader);
  upload(*device_, triangles, std::as_bytes(std::span(model.surface.mesh.triangles)), "triangles", uploader);
  static_assert(std::endian::native == std::endian::little);  // a CameraSet has the layout of a uvec2
  upload(*device_, members, std::as_bytes(std::span(model.surface.members)), "members", uploader);
  upload(*device_, complements, std::as_bytes(std::span(model.complements)), "complements", uploader);
}

void GpuHtmModel::State::uploadPhotographs(const HtmModel& model, const HtmImageSource& source, Uploader& uploader) {
  const VkExtent2D extent = arrayExtentOf(model);
  const auto layers = std::uint32_t(cameras.size());
  makeTextureArrays(*device_, photographs,
                    {.format = VK_FORMAT_R8G8B8A8_UNORM,
                     .extent = extent,
                     .layers = layers,
                     .mipLevels = std::uint32_t(std::bit_width(std::max(extent.width, extent.height))),
                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                     .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                    "photographs of a harmonised model");
  makeTextureArrays(*device_, depths,
                    {.format = kHtmDepthMapFormat,
                     .extent = extent,
                     .layers = layers,
                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                     .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                    "depths of a harmonised model");
  uploader.beginImage(photographs);
  for (std::uint32_t i = 0; i < layers; ++i) {
    HtmImage picture = source(model, i);
    if (!picture.levels) picture = prepareHtmImage(model, i, std::move(picture));
    const std::vector<Image8>& mips = *picture.levels;
    check(mips.size() == photographs.info().mipLevels && mips[0].width == int(extent.width) &&
              mips[0].height == int(extent.height),
          ErrorCode::invalidInput, "camera '{}': prepared mip levels belong to another model", model.cameras[i].name);
    for (std::uint32_t level = 0; level < mips.size(); ++level)
      uploader.image(photographs, i, level, {std::uint32_t(mips[level].width), std::uint32_t(mips[level].height)},
                     std::as_bytes(std::span(mips[level].values)));
  }
}

GpuHtmModel::GpuHtmModel(Device& device, const HtmModel& model, const HtmImageSource& source,
                         const GpuHtmModelOptions& options)
    : state_(std::make_unique<State>(device, model, source, options)) {}
GpuHtmModel::GpuHtmModel(GpuHtmModel&&) noexcept = default;
GpuHtmModel& GpuHtmModel::operator=(GpuHtmModel&&) noexcept = default;
GpuHtmModel::~GpuHtmModel() = default;

void GpuHtmModel::replace(const HtmModel& model, const HtmImageSource& source, Uploads* uploads) {
  state_->replace(model, source, uploads);
}

GpuHtmModel::Memory GpuHtmModel::memory() const noexcept {
  const State& s = *state_;
  return {.mesh = s.positions.allocatedBytes() + s.triangles.allocatedBytes() + s.members.allocatedBytes(),
          .complements = s.complements.allocatedBytes(),
          .photographs = s.photographs.allocatedBytes(),
          .depths = s.depths.allocatedBytes()};
}

const GpuHtmModel::State& stateOf(const GpuHtmModel& model) noexcept {
  return *model.state_;
}

}  // namespace ibr
