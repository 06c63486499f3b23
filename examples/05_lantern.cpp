// SPDX-License-Identifier: Apache-2.0
// Polygons in a photographed place ([T] §2.5.5, fig. 11): two lantern posts, drawn by the caller's pipeline and tested
// against the place's depth. One stands in front of the photographed surfaces, the other partly behind them.
//
//   05_lantern SCENE PICTURE.ppm      posts stand in the bundled cathedral
#include <ibr/ibr.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "shaders/lantern_frag.h"
#include "shaders/lantern_vert.h"
#include "vulkan_helpers.h"

namespace {

constexpr VkExtent2D kSize{960, 540};
constexpr double kNear = 0.1;  // near plane of the caller, world units

struct Vertex {
  glm::vec3 position, normal, colour, emissive;
};

// Appends the sides of a prism whose radius changes with its height; profile: height and radius, metres.
void addPrism(std::vector<Vertex>& vertices, int corners, const std::vector<glm::vec2>& profile, glm::vec3 colour,
              glm::vec3 emissive = glm::vec3(0)) {
  const auto corner = [&](int i, glm::vec2 ring) {
    const float angle = 2 * std::numbers::pi_v<float> * (float(i) + 0.5f) / float(corners);
    return glm::vec3(ring.y * std::cos(angle), ring.x, -ring.y * std::sin(angle));
  };
  for (std::size_t k = 1; k < profile.size(); ++k)
    for (int i = 0; i < corners; ++i) {
      const glm::vec3 a = corner(i, profile[k - 1]), b = corner(i + 1, profile[k - 1]), c = corner(i + 1, profile[k]),
                      d = corner(i, profile[k]), normal = glm::normalize(glm::cross(c - a, d - b));
      for (const glm::vec3& at : {a, b, c, a, c, d}) vertices.push_back({at, normal, colour, emissive});
    }
}

// A post at the origin, 3.4 m high, y up.
std::vector<Vertex> lantern() {
  std::vector<Vertex> vertices;
  const glm::vec3 iron(0.16f, 0.19f, 0.18f);
  addPrism(vertices, 8, {{0, .22}, {.1, .22}, {.1, .17}, {.45, .11}, {.45, .06}, {2.55, .05}, {2.55, .01}}, iron);
  addPrism(vertices, 4, {{2.55, .06}, {2.7, .15}}, iron);
  addPrism(vertices, 4, {{2.7, .14}, {3.12, .22}}, {0.5f, 0.45f, 0.3f}, {0.75f, 0.62f, 0.35f});
  addPrism(vertices, 4, {{3.12, .22}, {3.12, .27}, {3.16, .25}, {3.34, .05}, {3.42, .01}}, iron);
  return vertices;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: 05_lantern SCENE PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const ibr::GpuScene gpuScene(device, scene);
  const ibr::RenderSettings settings = ibr::preset(ibr::Preset::balanced, device.kind());
  ibr::RendererOptions options = ibr::optionsFor(settings, kSize);
  options.depth = true;
  const ibr::Renderer renderer(device, gpuScene, options);

  ibr::Camera view = scene.nodes.at(0).camera;
  view.pose.position = (view.pose.position + scene.nodes.at(1).camera.pose.position) / 2.0;
  view.intrinsics = ibr::pinholeFromFov(int(kSize.width), int(kSize.height), std::numbers::pi / 4);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settings});

  const helpers::Gpu gpu{device.physicalDevice(), device.handle(), device.queue(), device.queueFamily()};
  const helpers::Image frame(gpu, VK_FORMAT_R8G8B8A8_UNORM, kSize,
                             VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  const helpers::Image depth(gpu, VK_FORMAT_D32_SFLOAT, kSize, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
  const helpers::Pipeline pipeline(gpu, {.vertex = lantern_vert,
                                         .fragment = lantern_frag,
                                         .colour = frame.format,
                                         .depth = depth.format,
                                         .writesDepth = true,
                                         .vec3Attributes = sizeof(Vertex) / sizeof(glm::vec3),
                                         .constantBytes = sizeof(glm::mat4)});
  const std::vector<Vertex> vertices = lantern();
  const helpers::Buffer vertexBuffer(gpu, vertices.size() * sizeof(Vertex), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  std::memcpy(vertexBuffer.data, vertices.data(), vertices.size() * sizeof(Vertex));
  const helpers::Buffer pixels(gpu, 4 * kSize.width * kSize.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);

  const ibr::Target target{
      .image = frame.handle,
      .view = frame.views[0],
      .format = frame.format,
      .extent = frame.extent,
      .depth = ibr::DepthTarget{.image = depth.handle, .view = depth.views[0], .nearPlane = kNear}};
  // The posts stand in the axes of the second photograph: foot, then world units per metre.
  const glm::dmat4 toClip = ibr::clipFromCamera(view.intrinsics, kNear) * ibr::cameraFromWorld(view.pose) *
                            ibr::worldFromCamera(scene.nodes.at(1).camera.pose);
  const std::array<std::pair<glm::dvec3, double>, 2> posts{{{{1.6, -2.95, -12.0}, 0.8}, {{-3.27, -3.1, -20.5}, 1.0}}};
  helpers::submitAndWait(gpu, [&](VkCommandBuffer commands) {
    renderer.record(commands, plan, target);
    helpers::beginRendering(commands, frame, VK_ATTACHMENT_LOAD_OP_LOAD, &depth);
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertexBuffer.handle, &offset);
    for (const auto& [foot, scale] : posts) {
      const glm::mat4 ofPost(toClip * glm::scale(glm::translate(glm::dmat4(1.0), foot), glm::dvec3(scale)));
      pipeline.draw(commands, std::uint32_t(vertices.size()), &ofPost);
    }
    vkCmdEndRendering(commands);
    helpers::barrier(commands, frame, ibr::use::kColourAttachment, ibr::use::kTransferSource);
    helpers::copyToBuffer(commands, frame, pixels);
  });
  helpers::writePpm(argv[2], pixels.data, kSize.width, kSize.height);
} catch (const std::exception& error) {
  std::fprintf(stderr, "05_lantern: %s\n", error.what());
  return 2;
}
