// SPDX-License-Identifier: Apache-2.0
#include "render/resident/gpu_scene_state.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/check.h"
#include "render/plan/draw_order.h"
#include "render/plan/photograph_choice.h"
#include "render/plan/vertex.h"
#include "shared/gather.h"

namespace ibr {
namespace {

struct Geometry {
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
};

void appendMesh(const Scene& scene, const Cell& cell, Geometry& geometry, GpuScene::State::Mesh& out) {
  out.vertexOffset = geometry.vertices.size() * sizeof(float);
  const std::vector<bool> usable = usablePoints(scene, cell);
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const glm::vec3 q(memberPoint(scene, cell, i, p));
      geometry.vertices.insert(geometry.vertices.end(), {q.x, q.y, q.z});
    }
    geometry.vertices.push_back(cell.mesh.inverseDistance[p]);
  }
  out.indices.first = std::uint32_t(geometry.indices.size());
  for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t) {
    const glm::uvec3 v = cell.mesh.triangles[t];
    if (usable[v.x] && usable[v.y] && usable[v.z]) geometry.indices.insert(geometry.indices.end(), {v.x, v.y, v.z});
  }
  out.indices.count = std::uint32_t(geometry.indices.size()) - out.indices.first;
}

bool isPanorama(const Node& node) {
  return node.camera.intrinsics.model == CameraModel::equirectangular;
}

// Returns the nodes that a cell or a backdrop shows, ascending.
std::vector<std::uint32_t> shownNodes(const Scene& scene) {
  std::vector<bool> shown(scene.nodes.size(), false);
  for (const std::vector<Cell>* cells : {&scene.cells, &scene.backdrops})
    for (const Cell& cell : *cells)
      for (const std::uint32_t member : cell.members) shown[member] = true;
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t n = 0; n < shown.size(); ++n)
    if (shown[n]) nodes.push_back(n);
  return nodes;
}

// Allocates at least 4 bytes: Vulkan has no empty buffers, and a scene may have no triangles.
Buffer makeArena(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage, const char* name,
                 Uploader& uploader) {
  // The vertex stage of overlays reads vertices and indices as storage buffers.
  usage |= VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  Buffer buffer(device, std::max<VkDeviceSize>(bytes.size(), 4), usage, MemoryKind::device, name);
  if (!bytes.empty()) uploader.buffer(buffer, 0, bytes);
  return buffer;
}

}  // namespace

GpuScene::State::State(Device& device, const Scene& scene, const GpuSceneOptions& options)
    : sets(device, options.filter), requirements(requirementsOf(scene, {})) {
  if (!options.depth) requirements.gatherable = 0;
  check(options.readerThreads <= kMaxReaderThreads, ErrorCode::invalidInput, "readerThreads: {} is not within 0 to {}",
        options.readerThreads, kMaxReaderThreads);
  jobs = std::make_unique<JobQueue>(options.readerThreads, options.executor, maxLoads(options.readerThreads) + 1);
  Uploader uploader(device, options.uploads, options.stagingBytes);
  addMeshes(device, scene, uploader, options.stop);
  std::vector<std::uint32_t> gathered;  // nodes that can be gathered from
  if (requirements.gatherable > 0) {
    for (const std::uint32_t b : gatherableBackdrops(scene)) gathered.push_back(scene.backdrops[b].members[0]);
    addEvidence(device, scene, uploader);
    depths = DepthTextures(device, scene, gathered, options.depthSource, uploader, *jobs, options.stop);
  }
  const std::uint64_t meshBytes =
      vertices.allocatedBytes() + indices.allocatedBytes() + evidence.allocatedBytes() + depths.allocatedBytes();
  photographs = std::make_unique<Photographs>(device, scene, options, shownNodes(scene), meshBytes, uploader, *jobs);
  for (Mesh& cell : cells) {
    const std::uint32_t first = cell.members[0];
    cell.cubic = options.filter == TextureFilter::bicubic;
    cell.singleArray = std::ranges::all_of(cell.members, [&](std::uint32_t member) {
      return member == first ||
             (!photographs->streams() && isPanorama(scene.nodes[member]) == isPanorama(scene.nodes[first]) &&
              photographs->at(member).view == photographs->at(first).view);
    });
    bind(cell, 0, 0);
  }
  if (!gathered.empty()) gather.emplace(device, options.filter, *photographs, depths, gathered);
  uploader.flush();
  if (StreamedPhotographs* const streamed = photographs->streamed()) {
    std::vector<std::vector<std::uint32_t>> members;
    for (const Mesh& cell : cells) members.push_back(cell.members);
    wanted = WantedNodes(std::move(members), scene.nodes.size());
    sets.reserve(std::min<std::size_t>(cells.size(), 2 * (kMaxCellCount + kMaxFadingOutCount)));
    streamed->startStreaming();
  } else {
    jobs.reset();
  }
}

void GpuScene::State::addMeshes(Device& device, const Scene& scene, Uploader& uploader, const std::stop_token& stop) {
  Geometry geometry;
  const auto add = [&](const Cell& cell, std::vector<Mesh>& meshes) {
    check(!stop.stop_requested(), ErrorCode::cancelled, "opening the scene was cancelled");
    Mesh& out = meshes.emplace_back();
    out.members = cell.members;
    out.exposed = requirements.gains;  // a photograph with a gain of 1 is shown with the exposure of others
    for (const std::uint32_t member : cell.members) {
      Camera& camera = out.cameras.emplace_back(scene.nodes[member].camera);
      camera.pose.rotation = glm::normalize(camera.pose.rotation);
      out.gains.push_back(scene.nodes[member].gain);
      out.panoramas |= std::uint32_t(isPanorama(scene.nodes[member])) << (out.cameras.size() - 1);
    }
    out.masked = isMasked(scene, cell);
    appendMesh(scene, cell, geometry, out);
  };
  for (const Cell& cell : scene.cells) add(cell, cells);
  for (const Cell& backdrop : scene.backdrops) add(backdrop, backdrops);
  vertices = makeArena(device, std::as_bytes(std::span(geometry.vertices)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
                       "cell vertices", uploader);
  indices = makeArena(device, std::as_bytes(std::span(geometry.indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
                      "cell indices", uploader);
}

void GpuScene::State::addEvidence(Device& device, const Scene& scene, Uploader& uploader) {
  std::vector<glm::u16vec2> values;
  const auto share = [](float value) { return std::uint16_t(std::lround(65535.0f * std::clamp(value, 0.0f, 1.0f))); };
  for (const std::uint32_t b : gatherableBackdrops(scene)) {
    const MorphMesh& mesh = scene.backdrops[b].mesh;
    backdrops[b].evidenceOffset = values.size() * sizeof values[0];
    for (std::size_t p = 0; p < mesh.vertexCount(); ++p)
      values.emplace_back(share(shader::gatherTrust(mesh.confirmations[p])), share(mesh.consensus[p]));
  }
  evidence = makeArena(device, std::as_bytes(std::span(values)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "evidence of depth",
                       uploader);
}

// Slots beyond the mesh's members repeat its first photograph, which shaders do not sample through them.
void GpuScene::State::bind(Mesh& mesh, std::uint64_t frame, std::uint64_t completedFrame) {
  PhotographSets::Slots slots;
  mesh.layers.resize(mesh.members.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::size_t member = i < mesh.members.size() ? i : 0;
    const Photographs::Sampled sampled = photographs->at(mesh.members[member]);
    slots[i] = {sampled.view, (mesh.panoramas >> member & 1) != 0};
    if (i < mesh.members.size()) mesh.layers[i] = sampled.layer;
  }
  mesh.photographs = sets.get(slots, frame, completedFrame);
}

// Calls `visit` with the mesh of every cell of a plan, in the current and the previous draw order. Some meshes are
// visited more than once.
template <class Meshes, class Visit>
void visitDrawn(const FramePlan& plan, Meshes& cells, Visit&& visit) {
  if (plan.settings.composition == Composition::gathered) return;
  for (const Order order : {Order::current, Order::previous})
    forCells(plan, order, [&](const PlannedCell& cell, std::uint32_t, std::uint32_t) { visit(cells[cell.cell]); });
}

GpuScene::GpuScene(Device& device, const Scene& scene, const GpuSceneOptions& options)
    : state_(std::make_unique<State>(device, scene, options)) {}
GpuScene::GpuScene(GpuScene&&) noexcept = default;
GpuScene& GpuScene::operator=(GpuScene&&) noexcept = default;
GpuScene::~GpuScene() = default;

GpuScene::StreamStatus GpuScene::stream(VkCommandBuffer commandBuffer, const FramePlan& plan, std::uint64_t frame,
                                        std::uint64_t completedFrame) {
  State& state = *state_;
  StreamStatus status;
  if (StreamedPhotographs* const streamed = state.photographs->streamed()) {
    state.wanted.update(plan, state.photographs->maxResident());
    status = streamed->stream(commandBuffer, state.wanted.nodes(), state.wanted.needed(), frame, completedFrame,
                              [&state](VkImageView view) {
                                state.sets.forget(view);
                                if (state.gather) state.gather->forget(view);
                              });
    visitDrawn(plan, state.cells, [&](GpuScene::State::Mesh& cell) { state.bind(cell, frame, completedFrame); });
  }
  if (state.gather) state.gather->bind(plan.photographs, frame, completedFrame);
  return status;
}

bool GpuScene::needsStreaming() const noexcept {
  return state_->photographs->streams() || (state_->gather && state_->gather->bindsFrames());
}

GpuScene::Memory GpuScene::memory() const noexcept {
  return {.positions = state_->vertices.allocatedBytes() + state_->evidence.allocatedBytes(),
          .indices = state_->indices.allocatedBytes(),
          .textures = state_->photographs->allocatedBytes(),
          .depth = state_->depths.allocatedBytes()};
}

const GpuScene::State& stateOf(const GpuScene& scene) noexcept {
  return *scene.state_;
}

}  // namespace ibr
