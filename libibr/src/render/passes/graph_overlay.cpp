// SPDX-License-Identifier: Apache-2.0
#include "ibr/graph_overlay.h"

#include <array>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <ranges>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "base/vulkan/target_format.h"
#include "gpu/transfer/upload.h"
#include "ibr/scene.h"
#include "shaders/graph_frag.h"
#include "shaders/graph_vert.h"
#include "shared/graph.h"
#include "shared/overlay.h"

namespace ibr {
namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
static_assert(sizeof(shader::GraphConstants) <= 128);  // minimum that Vulkan guarantees

constexpr float kLineHalfWidth = 0.8f, kSeamHalfWidth = 2.3f;  // px
constexpr glm::vec3 kGrey(0.75f);                              // of photographs and cells that the frame does not draw
constexpr float kFaint = 0.4f;                                 // their strength, 0 to 1

struct Line {
  glm::vec3 from, to;  // from the graph's origin, world axes
};

// Range of lines of one photograph or cell.
struct LineRange {
  std::uint32_t first = 0, count = 0;
};

class Lines {
 public:
  explicit Lines(glm::dvec3 origin) : origin_(origin) {}

  void add(glm::dvec3 from, glm::dvec3 to) { all.push_back({glm::vec3(from - origin_), glm::vec3(to - origin_)}); }

  // Adds the pyramid of a pinhole's field of view, with a roof that marks the upper side.
  void addFrustum(const Camera& camera, double depth) {
    const Intrinsics& k = camera.intrinsics;
    const auto at = [&](double x, double y) {
      return camera.pose.position + camera.pose.rotation * (depth * unproject(k, {x * k.width, y * k.height}));
    };
    const std::array corners{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
    for (std::size_t i = 0; i < 4; ++i) {
      add(camera.pose.position, corners[i]);
      add(corners[i], corners[(i + 1) % 4]);
    }
    const glm::dvec3 middle = 0.5 * (corners[0] + corners[1]), below = 0.5 * (corners[2] + corners[3]);
    const glm::dvec3 roof = middle + 0.2 * (middle - below);
    add(glm::mix(corners[0], corners[1], 0.3), roof);
    add(roof, glm::mix(corners[0], corners[1], 0.7));
  }

  // Adds three great circles for a panorama.
  void addGlobe(const Pose& pose, double radius) {
    constexpr int kSides = 16;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](int side) {
        const double angle = glm::two_pi<double>() * side / kSides;
        glm::dvec3 direction(0);
        direction[(axis + 1) % 3] = radius * std::cos(angle);
        direction[(axis + 2) % 3] = radius * std::sin(angle);
        return pose.position + pose.rotation * direction;
      };
      for (int side = 0; side < kSides; ++side) add(at(side), at(side + 1));
    }
  }

  std::uint32_t count() const { return std::uint32_t(all.size()); }

  std::vector<Line> all;

 private:
  glm::dvec3 origin_;
};

glm::dvec3 middleOf(const std::vector<Camera>& cameras) {
  glm::dvec3 sum(0);
  for (const Camera& camera : cameras) sum += camera.pose.position / double(cameras.size());
  return sum;
}

}  // namespace

ImageGraph imageGraph(const Scene& scene) {
  ImageGraph graph;
  for (const Node& node : scene.nodes) graph.photographs.push_back(node.camera);
  for (const Cell& cell : scene.cells) graph.cells.push_back(cell.members);
  return graph;
}

struct GraphOverlay::State {
  glm::dvec3 origin{0};
  double frustumDepth = 1;
  std::vector<LineRange> photographs, cells;
  std::vector<std::vector<std::uint32_t>> members;  // of cells
  std::uint32_t lineCount = 0;
  Buffer lines;
  PipelineLayoutHandle layout;
  std::map<TargetFormat, PipelineHandle> pipelines;

  State(Device& device, const ImageGraph& graph, const GraphOverlayOptions& options);
  void makePipelines(const Device& device, const std::vector<TargetFormat>& formats);
  shader::GraphConstants constantsOf(const Camera& view) const noexcept;
};

GraphOverlay::State::State(Device& device, const ImageGraph& graph, const GraphOverlayOptions& options)
    : origin(middleOf(graph.photographs)), frustumDepth(options.frustumDepth), members(graph.cells) {
  check(std::isfinite(frustumDepth) && frustumDepth > 0, ErrorCode::invalidInput,
        "graph overlay: frustumDepth {} must be positive and finite", frustumDepth);
  Lines all(origin);
  const auto rangeSince = [&](std::uint32_t first) { return LineRange{first, all.count() - first}; };
  for (std::size_t i = 0; i < graph.photographs.size(); ++i) {
    const Camera& camera = graph.photographs[i];
    const glm::dvec3& p = camera.pose.position;
    check(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), ErrorCode::invalidInput,
          "graph overlay: the position of photographs[{}] is not finite", i);
    const std::uint32_t first = all.count();
    if (camera.intrinsics.model == CameraModel::pinhole)
      all.addFrustum(camera, frustumDepth);
    else
      all.addGlobe(camera.pose, 0.5 * frustumDepth);
    photographs.push_back(rangeSince(first));
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    const std::uint32_t first = all.count();
    for (const std::uint32_t member : members[c])
      check(member < graph.photographs.size(), ErrorCode::invalidInput,
            "graph overlay: cells[{}] refers to photograph {}, but there are {}", c, member, graph.photographs.size());
    for (std::size_t a = 0; a < members[c].size(); ++a)
      for (std::size_t b = a + 1; b < members[c].size(); ++b)
        all.add(graph.photographs[members[c][a]].pose.position, graph.photographs[members[c][b]].pose.position);
    cells.push_back(rangeSince(first));
  }
  lineCount = all.count();
  const auto bytes = std::as_bytes(std::span(all.all));
  lines = Buffer(device, std::max<VkDeviceSize>(bytes.size(), sizeof(Line)),
                 VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device, "graph");
  makePipelines(device, options.formats);
  Uploader uploader(device, options.uploads, kSmallStagingBytes);
  uploader.buffer(lines, 0, bytes);
  uploader.flush();
}

void GraphOverlay::State::makePipelines(const Device& device, const std::vector<TargetFormat>& formats) {
  const VkPushConstantRange constants{kStages, 0, sizeof(shader::GraphConstants)};
  layout = makePipelineLayout(device, {}, {&constants, 1});
  constexpr VkVertexInputBindingDescription kBinding{0, sizeof(Line), VK_VERTEX_INPUT_RATE_INSTANCE};
  constexpr std::array<VkVertexInputAttributeDescription, 2> kAttributes{
      {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Line, from)},
       {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Line, to)}}};
  for (const TargetFormat& format : formats) {
    checkTargetFormat("graph overlay", format);
    pipelines.emplace(format, makeGraphicsPipeline(device, {.name = "graph",
                                                            .vertex = shaders::graph_vert,
                                                            .fragment = shaders::graph_frag,
                                                            .bindings = {&kBinding, 1},
                                                            .attributes = kAttributes,
                                                            .layout = layout.get(),
                                                            .colourFormats = {&format.format, 1},
                                                            .blending = Blending::over}));
  }
}

shader::GraphConstants GraphOverlay::State::constantsOf(const Camera& view) const noexcept {
  const Intrinsics& k = view.intrinsics;
  return {.toView = glm::mat3(glm::mat3_cast(glm::conjugate(view.pose.rotation))),
          .shift = glm::vec3(origin - view.pose.position),
          .lens = {k.fx, k.fy, k.cx, k.cy},
          .size = {k.width, k.height},
          .fade = float(frustumDepth),
          .strength = 1,
          .halfWidth = kLineHalfWidth,
          .colour = {}};
}

GraphOverlay::GraphOverlay(Device& device, const ImageGraph& graph, const GraphOverlayOptions& options)
    : state_(std::make_unique<State>(device, graph, options)) {}
GraphOverlay::GraphOverlay(GraphOverlay&&) noexcept = default;
GraphOverlay& GraphOverlay::operator=(GraphOverlay&&) noexcept = default;
GraphOverlay::~GraphOverlay() = default;

void GraphOverlay::record(VkCommandBuffer commandBuffer, const Camera& view, std::span<const std::uint32_t> best,
                          const Target& target) const noexcept {
  const State& s = *state_;
  assert(s.pipelines.contains(formatOf(target)));
  assert(view.intrinsics.model == CameraModel::pinhole && view.intrinsics.width == int(target.extent.width) &&
         view.intrinsics.height == int(target.extent.height));
  transitionTarget(commandBuffer, target, target.initialUse, use::kColourAttachment);
  const VkRenderingAttachmentInfo attachment = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_LOAD);
  beginRendering(commandBuffer, target.extent, {&attachment, 1});
  vkCmdBindPipeline(commandBuffer, VK_PIPELINE_BIND_POINT_GRAPHICS, s.pipelines.at(formatOf(target)).get());
  const VkBuffer buffer = s.lines.get();
  const VkDeviceSize start = 0;
  vkCmdBindVertexBuffers(commandBuffer, 0, 1, &buffer, &start);

  shader::GraphConstants constants = s.constantsOf(view);
  const auto paint = [&](glm::vec3 colour, float strength, float halfWidth) {
    constants.colour = writtenColour(colour, formatOf(target));
    constants.strength = strength;
    constants.halfWidth = halfWidth;
    vkCmdPushConstants(commandBuffer, s.layout.get(), kStages, 0, sizeof constants, &constants);
  };
  const auto draw = [&](LineRange range) {
    if (range.count > 0) vkCmdDraw(commandBuffer, 6, range.count, 0, range.first);
  };
  // A dark seam under each line keeps the line visible on any image.
  const auto drawAll = [&](glm::vec3 colour, float strength, const auto& drawLines) {
    paint({0, 0, 0}, 0.5f * strength, kSeamHalfWidth);
    drawLines();
    paint(colour, strength, kLineHalfWidth);
    drawLines();
  };
  drawAll(kGrey, kFaint, [&] { draw({0, s.lineCount}); });
  for (std::size_t rank = best.size(); rank-- > 0;) {  // best cell last, over all others
    assert(best[rank] < s.cells.size());
    drawAll(shader::rankColour(float(rank), float(best.size())), 1, [&] {
      draw(s.cells[best[rank]]);
      for (const std::uint32_t member : s.members[best[rank]]) draw(s.photographs[member]);
    });
  }
  vkCmdEndRendering(commandBuffer);
  transitionTarget(commandBuffer, target, use::kColourAttachment, target.finalUse);
}

}  // namespace ibr
