// SPDX-License-Identifier: Apache-2.0
// Draws polygons into a scene ([T] §2.5.5, fig. 11): two lantern posts from a glTF file, by the caller's pipeline,
// tested against the scene's depth. One stands in front of the photographed surfaces, the other partly behind them.
//
//   03_lantern SCENE LANTERN.gltf PICTURE.ppm
//
// Positions suit the bundled cathedral scene. Returns 3 if the far post is not partly hidden or the near one is.
#include <ibr/ibr.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "shaders/lantern_frag.h"
#include "shaders/lantern_vert.h"

namespace {

constexpr VkExtent2D kExtent{960, 720};
constexpr double kNear = 0.05;  // of the caller's projection, world units

void require(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + " failed");
}

// Reads the subset of glTF that the lantern uses: triangles without indices, positions and normals as floats.
struct Primitive {
  std::vector<glm::vec3> vertices;  // position, normal, position, …
  glm::vec3 baseColour, emissive;
};

std::vector<Primitive> readGltf(const std::filesystem::path& path) {
  const nlohmann::json gltf = nlohmann::json::parse(std::ifstream(path));
  const std::filesystem::path binary = path.parent_path() / gltf.at("buffers").at(0).at("uri").get<std::string>();
  std::vector<char> bytes(gltf.at("buffers").at(0).at("byteLength").get<std::size_t>());
  if (!std::ifstream(binary, std::ios::binary).read(bytes.data(), std::streamsize(bytes.size())))
    throw ibr::Error(ibr::ErrorCode::io, binary.string() + ": cannot be read");
  const auto vectors = [&](const nlohmann::json& index) {
    const nlohmann::json& accessor = gltf.at("accessors").at(index.get<std::size_t>());
    const nlohmann::json& view = gltf.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    std::vector<glm::vec3> values(accessor.at("count").get<std::size_t>());
    const auto offset = view.value("byteOffset", std::size_t(0)), size = values.size() * sizeof values[0];
    if (offset > bytes.size() || size > bytes.size() - offset)
      throw ibr::Error(ibr::ErrorCode::invalidInput, path.string() + ": an accessor leads out of the buffer");
    std::memcpy(values.data(), bytes.data() + offset, size);
    return values;
  };
  const auto colour = [](const nlohmann::json& c) { return glm::vec3(c.at(0), c.at(1), c.at(2)); };
  std::vector<Primitive> primitives;
  for (const nlohmann::json& source : gltf.at("meshes").at(0).at("primitives")) {
    const auto positions = vectors(source.at("attributes").at("POSITION"));
    const auto normals = vectors(source.at("attributes").at("NORMAL"));
    const nlohmann::json& material = gltf.at("materials").at(source.at("material").get<std::size_t>());
    Primitive& primitive = primitives.emplace_back();
    primitive.baseColour = colour(material.at("pbrMetallicRoughness").at("baseColorFactor"));
    primitive.emissive = material.contains("emissiveFactor") ? colour(material["emissiveFactor"]) : glm::vec3(0.0f);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      primitive.vertices.push_back(positions[i]);
      primitive.vertices.push_back(normals.at(i));
    }
  }
  return primitives;
}

// Resources of the caller's renderer: memory, a depth buffer, vertices, a pipeline.
class Polygons {
 public:
  Polygons(const ibr::Device& device, std::vector<Primitive> primitives)
      : device_(device), primitives_(std::move(primitives)) {
    makeDepth();
    makeVertices();
    makePipeline();
  }
  Polygons(const Polygons&) = delete;
  Polygons& operator=(const Polygons&) = delete;
  ~Polygons() {
    const VkDevice d = device_.handle();
    vkDestroyPipeline(d, pipeline_, nullptr);
    vkDestroyPipelineLayout(d, layout_, nullptr);
    vkDestroyImageView(d, depthView_, nullptr);
    vkDestroyImage(d, depth_, nullptr);
    vkDestroyBuffer(d, vertices_, nullptr);
    for (const VkDeviceMemory memory : memory_) vkFreeMemory(d, memory, nullptr);
  }

  /// Target for the scene's depth.
  ibr::DepthTarget depthTarget() const {
    return {.image = depth_, .view = depthView_, .format = VK_FORMAT_D32_SFLOAT, .nearPlane = kNear};
  }

  /// Call within a rendering (vkCmdBeginRendering).
  void draw(VkCommandBuffer commands, const glm::mat4& toClip) const {
    struct Constants {
      glm::mat4 toClip;
      glm::vec4 baseColour, emissive;
    };
    const VkDeviceSize offset = 0;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices_, &offset);
    std::uint32_t first = 0;
    for (const Primitive& primitive : primitives_) {
      const Constants constants{toClip, glm::vec4(primitive.baseColour, 0), glm::vec4(primitive.emissive, 0)};
      vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                         kConstantBytes, &constants);
      const auto count = std::uint32_t(primitive.vertices.size() / 2);
      vkCmdDraw(commands, count, 1, first, 0);
      first += count;
    }
  }

 private:
  static constexpr std::uint32_t kConstantBytes = 92;

  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) {
    const VkPhysicalDeviceMemoryProperties& has = device_.memoryProperties();
    for (std::uint32_t type = 0; type < has.memoryTypeCount; ++type) {
      if (!(needs.memoryTypeBits >> type & 1) || (has.memoryTypes[type].propertyFlags & wanted) != wanted) continue;
      const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
      require(vkAllocateMemory(device_.handle(), &info, nullptr, &memory_.emplace_back()), "vkAllocateMemory");
      return memory_.back();
    }
    throw std::runtime_error("no suitable memory");
  }

  void makeDepth() {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = VK_FORMAT_D32_SFLOAT;
    info.extent = {kExtent.width, kExtent.height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    require(vkCreateImage(device_.handle(), &info, nullptr, &depth_), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_.handle(), depth_, &needs);
    require(vkBindImageMemory(device_.handle(), depth_, allocate(needs, 0), 0), "vkBindImageMemory");
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = depth_;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = info.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
    require(vkCreateImageView(device_.handle(), &view, nullptr, &depthView_), "vkCreateImageView");
  }

  void makeVertices() {
    std::vector<glm::vec3> all;
    for (const Primitive& p : primitives_) all.insert(all.end(), p.vertices.begin(), p.vertices.end());
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = all.size() * sizeof all[0];
    info.usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    require(vkCreateBuffer(device_.handle(), &info, nullptr, &vertices_), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_.handle(), vertices_, &needs);
    const VkDeviceMemory memory =
        allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    require(vkBindBufferMemory(device_.handle(), vertices_, memory, 0), "vkBindBufferMemory");
    void* mapped = nullptr;
    require(vkMapMemory(device_.handle(), memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memcpy(mapped, all.data(), info.size);
    vkUnmapMemory(device_.handle(), memory);
  }

  VkShaderModule makeShader(std::span<const std::uint32_t> words) const {
    const VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, words.size_bytes(),
                                        words.data()};
    VkShaderModule shader = VK_NULL_HANDLE;
    require(vkCreateShaderModule(device_.handle(), &info, nullptr, &shader), "vkCreateShaderModule");
    return shader;
  }

  void makePipeline() {
    const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, kConstantBytes};
    VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layoutInfo.pushConstantRangeCount = 1;
    layoutInfo.pPushConstantRanges = &constants;
    require(vkCreatePipelineLayout(device_.handle(), &layoutInfo, nullptr, &layout_), "vkCreatePipelineLayout");

    VkPipelineShaderStageCreateInfo stages[2]{};
    stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
    stages[0].module = makeShader(ibr::shaders::lantern_vert);
    stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[1].module = makeShader(ibr::shaders::lantern_frag);
    for (VkPipelineShaderStageCreateInfo& stage : stages) {
      stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
      stage.pName = "main";
    }
    const VkVertexInputBindingDescription binding{0, 2 * sizeof(glm::vec3), VK_VERTEX_INPUT_RATE_VERTEX};
    const VkVertexInputAttributeDescription attributes[]{{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0},
                                                         {1, 0, VK_FORMAT_R32G32B32_SFLOAT, sizeof(glm::vec3)}};
    VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    input.vertexBindingDescriptionCount = 1;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = 2;
    input.pVertexAttributeDescriptions = attributes;
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    const VkViewport viewport{0, 0, float(kExtent.width), float(kExtent.height), 0, 1};
    const VkRect2D scissor{{0, 0}, kExtent};
    VkPipelineViewportStateCreateInfo viewports{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewports.viewportCount = viewports.scissorCount = 1;
    viewports.pViewports = &viewport;
    viewports.pScissors = &scissor;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.cullMode = VK_CULL_MODE_BACK_BIT;  // glTF's front faces are counter-clockwise; clip space has y down
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState replace{};
    replace.colorWriteMask = 0xf;
    VkPipelineColorBlendStateCreateInfo blending{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blending.attachmentCount = 1;
    blending.pAttachments = &replace;
    const VkFormat colourFormat = VK_FORMAT_R8G8B8A8_UNORM;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachmentFormats = &colourFormat;
    rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewports;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blending;
    info.layout = layout_;
    const VkResult result = vkCreateGraphicsPipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_);
    for (const VkPipelineShaderStageCreateInfo& stage : stages)
      vkDestroyShaderModule(device_.handle(), stage.module, nullptr);
    require(result, "vkCreateGraphicsPipelines");
  }

  const ibr::Device& device_;
  std::vector<Primitive> primitives_;
  std::vector<VkDeviceMemory> memory_;
  VkImage depth_ = VK_NULL_HANDLE;
  VkImageView depthView_ = VK_NULL_HANDLE;
  VkBuffer vertices_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

// Projects camera axes to clip space, with an infinite far plane: matches DepthTarget's default convention.
glm::dmat4 projectionOf(const ibr::Intrinsics& k) {
  glm::dmat4 p(0.0);
  p[0][0] = 2 * k.fx / k.width;
  p[1][1] = -2 * k.fy / k.height;
  p[2] = {1 - 2 * k.cx / k.width, 1 - 2 * k.cy / k.height, -1, -1};
  p[3][2] = -kNear;
  return p;
}

// Foot of a post in the view's axes (right, up, behind), and the number of world units in a metre.
struct Place {
  glm::dvec3 foot;
  double scale;
};

class Picture {
 public:
  Picture(ibr::Device& device, const ibr::Scene& scene, const std::filesystem::path& lantern)
      : gpuScene_(device, scene),
        renderer_(device, gpuScene_, optionsWithDepth(device)),
        offscreen_(device, kExtent),
        polygons_(device, readGltf(lantern)) {
    ibr::Camera view = scene.nodes.at(1).camera;
    view.intrinsics = ibr::pinholeFromFov(int(kExtent.width), int(kExtent.height), std::numbers::pi / 5.5);
    plan_ = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, settingsOf(device)});
  }

  /// `testDepth` false: ignores the scene's depth.
  ibr::Image8 render(std::span<const Place> places, bool testDepth) {
    ibr::Target target = offscreen_.target();
    const ibr::ImageUse after = target.finalUse;
    target.finalUse = ibr::use::kColourAttachment;  // the caller draws on
    target.depth = polygons_.depthTarget();
    return offscreen_.render([&](VkCommandBuffer commands) {
      renderer_.record(commands, plan_, target);
      begin(commands, target, testDepth);
      for (const Place& place : places) {
        const glm::dmat4 model = glm::scale(glm::translate(glm::dmat4(1.0), place.foot), glm::dvec3(place.scale));
        polygons_.draw(commands, glm::mat4(projectionOf(plan_.views[0].intrinsics) * model));
      }
      vkCmdEndRendering(commands);
      VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
      barrier.srcStageMask = target.finalUse.stages;
      barrier.srcAccessMask = target.finalUse.access;
      barrier.dstStageMask = after.stages;
      barrier.dstAccessMask = after.access;
      barrier.oldLayout = target.finalUse.layout;
      barrier.newLayout = after.layout;
      barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
      barrier.image = target.image;
      barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
      VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
      dependency.imageMemoryBarrierCount = 1;
      dependency.pImageMemoryBarriers = &barrier;
      vkCmdPipelineBarrier2(commands, &dependency);
    });
  }

 private:
  static ibr::RenderSettings settingsOf(const ibr::Device& device) {
    return ibr::preset(ibr::Preset::balanced, device.kind());
  }
  static ibr::RendererOptions optionsWithDepth(const ibr::Device& device) {
    ibr::RendererOptions options = ibr::optionsFor(settingsOf(device), kExtent);
    options.depth = true;
    return options;
  }

  // The renderer leaves both images in attachment layouts; their contents are loaded.
  static void begin(VkCommandBuffer commands, const ibr::Target& target, bool testDepth) {
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = target.view;
    colour.imageLayout = target.finalUse.layout;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingAttachmentInfo depth = colour;
    depth.imageView = target.depth->view;
    depth.imageLayout = target.depth->finalUse.layout;
    if (!testDepth) depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.clearValue.depthStencil.depth = 1;
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = kExtent;
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &colour;
    rendering.pDepthAttachment = &depth;
    vkCmdBeginRendering(commands, &rendering);
  }

  ibr::GpuScene gpuScene_;
  ibr::Renderer renderer_;
  ibr::Offscreen offscreen_;
  Polygons polygons_;
  ibr::FramePlan plan_;
};

std::size_t differing(const ibr::Image8& a, const ibr::Image8& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.values.size(); i += 4)
    count += !std::equal(&a.values[i], &a.values[i + 3], &b.values[i]);
  return count;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fputs("usage: 03_lantern SCENE LANTERN.gltf PICTURE.ppm\n", stderr);
    return 1;
  }
  ibr::Device device = ibr::Device::create();
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  Picture picture(device, scene, argv[2]);
  const Place kFront{{1.6, -2.95, -12.0}, 0.8}, kBehind{{-3.27, -3.1, -20.5}, 1.0};

  const std::array both{kFront, kBehind};
  const ibr::Image8 plain = picture.render({}, true), shown = picture.render(both, true);
  std::ofstream file(argv[3], std::ios::binary);
  file << "P6\n" << shown.width << ' ' << shown.height << "\n255\n";
  for (std::size_t i = 0; i < shown.values.size(); i += 4)
    file.write(reinterpret_cast<const char*>(&shown.values[i]), 3);
  if (!file.flush()) throw ibr::Error(ibr::ErrorCode::io, std::string(argv[3]) + ": cannot be written");

  bool asExpected = true;
  for (const auto& [name, place, partly] : {std::tuple("near", kFront, false), std::tuple("far", kBehind, true)}) {
    const std::size_t whole = differing(picture.render({&place, 1}, false), plain);
    const std::size_t visible = differing(picture.render({&place, 1}, true), plain);
    std::printf("%s post: %zu of %zu pixels can be seen\n", name, visible, whole);
    asExpected &= partly ? visible > whole / 10 && visible < whole * 9 / 10 : visible == whole && whole > 0;
  }
  return asExpected ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "03_lantern: %s\n", error.what());
  return 2;
}
