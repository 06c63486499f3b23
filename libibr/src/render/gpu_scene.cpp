// SPDX-License-Identifier: Apache-2.0
#include "render/gpu_scene.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <glm/geometric.hpp>
#include <map>

#include "base/check.h"
#include "gpu/descriptors.h"
#include "gpu/pipeline.h"
#include "gpu/upload.h"
#include "image/ktx2.h"
#include "render/vertex.h"
#include "shared/cell.h"

namespace ibr {
namespace {

std::vector<Image8> readTexture(const Scene& scene, std::size_t node) {
  return readKtx2(scene.folder / scene.nodes[node].textureFile);
}

std::uint32_t mipLevels(VkExtent2D size) {
  return std::uint32_t(std::bit_width(std::max(size.width, size.height)));
}

struct Place {
  std::uint32_t page, layer;
};

// Photographs of one size share pages of at most 256 MiB, in the order of the nodes.
std::vector<Place> makePages(const Device& device, const Scene& scene, std::vector<GpuImage>& pages) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> bySize;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Intrinsics& k = scene.nodes[n].camera.intrinsics;
    bySize[{k.width, k.height}].push_back(n);
  }
  std::vector<Place> places(scene.nodes.size());
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  for (const auto& [size, nodes] : bySize) {
    const VkExtent2D extent{std::uint32_t(size.first), std::uint32_t(size.second)};
    check(std::max(extent.width, extent.height) <= limits.maxImageDimension2D, ErrorCode::unsupported,
          "{}: {}x{} is more than the device's largest image of {}; build with a smaller --max-size",
          scene.nodes[nodes[0]].name, extent.width, extent.height, limits.maxImageDimension2D);
    constexpr std::uint64_t kPageBytes = std::uint64_t(256) << 20;
    const std::uint64_t layerBytes = std::uint64_t(extent.width) * extent.height * 4 * 4 / 3;
    const std::size_t perPage = std::clamp<std::uint64_t>(kPageBytes / layerBytes, 1, limits.maxImageArrayLayers);
    for (std::size_t first = 0; first < nodes.size(); first += perPage) {
      const std::size_t count = std::min(perPage, nodes.size() - first);
      for (std::size_t i = 0; i < count; ++i)
        places[nodes[first + i]] = {std::uint32_t(pages.size()), std::uint32_t(i)};
      pages.emplace_back(device,
                         GpuImageInfo{.format = VK_FORMAT_R8G8B8A8_UNORM,
                                      .extent = extent,
                                      .layers = std::uint32_t(count),
                                      .mipLevels = mipLevels(extent),
                                      .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                         fmt::format("photographs {}x{}", extent.width, extent.height));
    }
  }
  return places;
}

void uploadPhotographs(const Scene& scene, const TextureSource& source, const std::vector<Place>& places,
                       const std::vector<GpuImage>& pages, Uploader& uploader) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const GpuImage& page = pages[places[n].page];
    const VkExtent2D size = page.info().extent;
    const std::vector<Image8> levels = source(scene, n);
    check(levels.size() == page.info().mipLevels, ErrorCode::invalidInput, "{}: texture has {} levels, not {}",
          scene.nodes[n].name, levels.size(), page.info().mipLevels);
    for (std::uint32_t level = 0; level < levels.size(); ++level) {
      const Image8& image = levels[level];
      const VkExtent2D extent{std::max(1u, size.width >> level), std::max(1u, size.height >> level)};
      check(std::uint32_t(image.width) == extent.width && std::uint32_t(image.height) == extent.height &&
                image.channels == 4,
            ErrorCode::invalidInput, "{}: texture level {} is {}x{} with {} channels, not {}x{} with 4",
            scene.nodes[n].name, level, image.width, image.height, image.channels, extent.width, extent.height);
      uploader.image(page, places[n].layer, level, extent, std::as_bytes(std::span(image.values)));
    }
  }
}

struct Geometry {
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
};

void appendMesh(const Scene& scene, const Cell& cell, Geometry& geometry, GpuScene::State::Mesh& out) {
  out.vertexOffset = geometry.vertices.size() * sizeof(float);
  std::vector<bool> usable(cell.mesh.pointCount());
  for (std::size_t p = 0; p < cell.mesh.pointCount(); ++p) {
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const glm::vec3 q(memberPoint(scene, cell, i, p));
      geometry.vertices.insert(geometry.vertices.end(), {q.x, q.y, q.z});
    }
    geometry.vertices.push_back(cell.mesh.inverseDistance[p]);
    usable[p] = raysAgree(scene, cell, p);
  }
  for (std::uint8_t tier : {kTierAgrees, kTierRejected}) {
    out.tier[tier].firstIndex = std::uint32_t(geometry.indices.size());
    for (std::size_t t = 0; t < cell.mesh.triangles.size(); ++t) {
      const glm::uvec3 v = cell.mesh.triangles[t];
      if (cell.mesh.tier[t] == tier && usable[v.x] && usable[v.y] && usable[v.z])
        geometry.indices.insert(geometry.indices.end(), {v.x, v.y, v.z});
    }
    out.tier[tier].indexCount = std::uint32_t(geometry.indices.size()) - out.tier[tier].firstIndex;
  }
}

bool isPanorama(const Node& node) {
  return node.camera.intrinsics.model == CameraModel::equirectangular;
}

SamplerHandle makeSampler(const Device& device, VkSamplerAddressMode addressModeU) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = addressModeU;
  info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  return make<SamplerHandle>(device, vkCreateSampler, info, "vkCreateSampler");
}

// Slots beyond the cell's members repeat its first photograph; they are never sampled.
VkDescriptorSet makePhotographSet(const Device& device, const GpuScene::State& state, const Scene& scene,
                                  const Cell& cell, const std::vector<Place>& places) {
  const VkDescriptorSet set = allocateSet(device, state.pool.get(), state.photographLayout.get());
  for (std::uint32_t i = 0; i < shader::kMaxMembers; ++i) {
    const std::uint32_t node = cell.members[i < cell.members.size() ? i : 0];
    const SamplerHandle& sampler = isPanorama(scene.nodes[node]) ? state.panoramaSampler : state.sampler;
    writeSampledImage(device, set, i, sampler.get(), state.pages[places[node].page].view());
  }
  return set;
}

// An empty buffer is not allowed; a scene without triangles is.
Buffer makeArena(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage, const char* name,
                 Uploader& uploader) {
  Buffer buffer(device, std::max<VkDeviceSize>(bytes.size(), 4), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                MemoryKind::device, name);
  if (!bytes.empty()) uploader.buffer(buffer, 0, bytes);
  return buffer;
}

}  // namespace

GpuScene::GpuScene(Device& device, const Scene& scene, const TextureSource& source)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.requirements = requirementsOf(scene, {});
  std::array<VkDescriptorSetLayoutBinding, shader::kMaxMembers> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  state.photographLayout = makeSetLayout(device, bindings);
  state.sampler = makeSampler(device, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE);
  if (std::ranges::any_of(scene.nodes, isPanorama))
    state.panoramaSampler = makeSampler(device, VK_SAMPLER_ADDRESS_MODE_REPEAT);

  Uploader uploader(device);
  const std::vector<Place> places = makePages(device, scene, state.pages);
  uploadPhotographs(scene, source ? source : readTexture, places, state.pages, uploader);

  Geometry geometry;
  if (const auto sets = std::uint32_t(scene.cells.size() + scene.backdrops.size())) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets * shader::kMaxMembers};
    state.pool = makeDescriptorPool(device, sets, {&size, 1});
  }
  const auto addMesh = [&](const Cell& cell, std::vector<State::Mesh>& meshes) {
    State::Mesh& out = meshes.emplace_back();
    for (std::uint32_t member : cell.members) {
      Camera& camera = out.cameras.emplace_back(scene.nodes[member].camera);
      camera.pose.rotation = glm::normalize(camera.pose.rotation);
      out.panoramas |= std::uint32_t(isPanorama(scene.nodes[member])) << out.layers.size();
      out.layers.push_back(places[member].layer);
    }
    out.onePage = std::all_of(cell.members.begin(), cell.members.end(), [&](std::uint32_t member) {
      return places[member].page == places[cell.members[0]].page &&
             isPanorama(scene.nodes[member]) == isPanorama(scene.nodes[cell.members[0]]);
    });
    appendMesh(scene, cell, geometry, out);
    out.photographs = makePhotographSet(device, state, scene, cell, places);
  };
  for (const Cell& cell : scene.cells) addMesh(cell, state.cells);
  for (const Cell& backdrop : scene.backdrops) addMesh(backdrop, state.backdrops);
  state.vertices = makeArena(device, std::as_bytes(std::span(geometry.vertices)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
                             "cell vertices", uploader);
  state.indices = makeArena(device, std::as_bytes(std::span(geometry.indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
                            "cell indices", uploader);
  uploader.flush();
}

GpuScene::GpuScene(GpuScene&&) noexcept = default;
GpuScene& GpuScene::operator=(GpuScene&&) noexcept = default;
GpuScene::~GpuScene() = default;

GpuScene::Memory GpuScene::memory() const noexcept {
  Memory memory;
  memory.positions = state_->vertices.allocatedBytes();
  memory.indices = state_->indices.allocatedBytes();
  for (const GpuImage& page : state_->pages) memory.textures += page.allocatedBytes();
  return memory;
}

}  // namespace ibr
