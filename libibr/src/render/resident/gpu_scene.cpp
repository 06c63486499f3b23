// SPDX-License-Identifier: Apache-2.0
#include "render/resident/gpu_scene_state.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "base/check.h"
#include "render/photographs/photograph_choice.h"
#include "render/plan/draw_order.h"
#include "render/resident/stream_log.h"
#include "render/resident/texture_classes.h"

namespace ibr {
namespace {

constexpr double kMinMeshShare = 0.125;            // of the budget that meshes may take before they are streamed
constexpr std::uint64_t kBufferSlack = 64 * 1024;  // bytes by which a device may round up the size of a buffer

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

// Bytes of the budget for the pool of streamed meshes; 0: all meshes are resident. The rest is left to textures.
std::uint64_t meshPoolBytes(const SceneMeshes& meshes, std::uint64_t budget, std::uint64_t textureBytes,
                            std::uint64_t minTextureBytes) {
  const std::uint64_t least = meshes.fixedBytes() + minTextureBytes + kBufferSlack;
  const std::uint64_t available = budget - std::min(budget, least), streamed = meshes.streamedBytes();
  const double share = double(streamed) / double(std::max<std::uint64_t>(streamed + textureBytes, 1));
  const auto forMeshes = std::uint64_t(double(available) * std::max(share, kMinMeshShare));
  if (forMeshes >= streamed) return 0;
  check(available >= meshes.largestSlot(), ErrorCode::outOfMemory,
        "a budget of {} bytes is too small: this scene needs {} bytes even at one pixel per photograph, {} bytes of "
        "them for stand-ins of meshes and the largest mesh",
        budget, least + meshes.largestSlot(), meshes.fixedBytes() + meshes.largestSlot());
  return std::max(forMeshes, meshes.largestSlot());
}

}  // namespace

GpuScene::State::State(Device& device, const Scene& scene, const GpuSceneOptions& options)
    : sets(device, options.filter),
      loader(scene, options.source, options.depthSource),
      requirements(requirementsOf(scene, {})) {
  if (!options.depth) requirements.gatherable = 0;
  check(options.readerThreads <= kMaxReaderThreads, ErrorCode::invalidInput, "readerThreads: {} is not within 0 to {}",
        options.readerThreads, kMaxReaderThreads);
  jobs = std::make_unique<JobQueue>(options.readerThreads, options.executor, maxLoads(options.readerThreads) + 1);
  Uploader uploader(device, options.uploads, options.stagingBytes);
  std::vector<std::uint32_t> gathered;  // nodes that can be gathered from
  if (requirements.gatherable > 0)
    for (const std::uint32_t b : gatherableBackdrops(scene)) gathered.push_back(scene.backdrops[b].members[0]);
  std::vector<TextureArrayClass> classes = classify(device, loader, shownNodes(scene), *jobs, options.stop);
  const std::vector<TextureArrayClass> depths = classifyDepths(loader, gathered, *jobs, options.stop);
  meshes = SceneMeshes(scene, !gathered.empty());
  decodeBlocks(device, options, meshes.totalBytes() + totalBytes(depths), classes);
  classes.insert(classes.end(), depths.begin(), depths.end());
  makeMeshes(device, options, classes, uploader);
  textures.emplace(device, options, loader, std::move(classes), meshes.allocatedBytes(), uploader, *jobs);
  describeMeshes(scene, options.filter);
  if (!gathered.empty()) gather.emplace(device, options.filter, scene, *textures, gathered);
  uploader.flush();
  if (textures->streams() || meshes.streams())
    setUpStreaming(device, scene, options);
  else
    jobs.reset();
}

void GpuScene::State::makeMeshes(Device& device, const GpuSceneOptions& options,
                                 const std::vector<TextureArrayClass>& classes, Uploader& uploader) {
  const std::uint64_t budget = options.budgetBytes, textureBytes = totalBytes(classes);
  if (budget > 0 && meshes.totalBytes() + textureBytes > budget) {
    meshes.makeStandIns(*jobs, options.stop);
    const std::uint64_t pool = meshPoolBytes(meshes, budget, textureBytes, SceneTextures::minBytes(device, classes));
    if (pool > 0) {
      meshes.makeStreamed(device, uploader, pool);
      say(options.log, LogLevel::info,
          "meshes are streamed: {:.1f} MB of meshes, {:.1f} MB of the budget for them, {:.1f} MB for their stand-ins",
          megabytes(meshes.totalBytes()), megabytes(pool), megabytes(meshes.fixedBytes()));
      return;
    }
  }
  meshes.makeResident(device, uploader, options.stop);
}

void GpuScene::State::describeMeshes(const Scene& scene, TextureFilter filter) {
  const auto add = [&](const Cell& cell, std::vector<Mesh>& to) {
    Mesh& out = to.emplace_back();
    out.members = cell.members;
    out.exposed = requirements.gains;  // a photograph with a gain of 1 is shown with the exposure of others
    for (const std::uint32_t member : cell.members) {
      Camera& camera = out.cameras.emplace_back(scene.nodes[member].camera);
      camera.pose.rotation = glm::normalize(camera.pose.rotation);
      out.gains.push_back(scene.nodes[member].gain);
      out.panoramas |= std::uint32_t(isPanorama(scene.nodes[member])) << (out.cameras.size() - 1);
    }
    out.masked = isMasked(scene, cell);
    out.place = meshes.place(cells.size() + backdrops.size() - 1);
  };
  for (const Cell& cell : scene.cells) add(cell, cells);
  for (const Cell& backdrop : scene.backdrops) add(backdrop, backdrops);
  for (Mesh& cell : cells) {
    const std::uint32_t first = cell.members[0];
    cell.cubic = filter == TextureFilter::bicubic;
    cell.singleArray = std::ranges::all_of(cell.members, [&](std::uint32_t member) {
      return member == first ||
             (!textures->streams() && isPanorama(scene.nodes[member]) == isPanorama(scene.nodes[first]) &&
              textures->at(member).view == textures->at(first).view);
    });
    bind(cell, 0, 0);
  }
}

void GpuScene::State::setUpStreaming(Device& device, const Scene& scene, const GpuSceneOptions& options) {
  Streamer::Setup setup{.stagingBytes = options.stagingBytes};
  if (textures->streams()) {
    setup.classes = textures->classes();
    setup.textures = *textures->streamed();
  }
  setup.otherBytes = options.budgetBytes - setup.textures.budget;
  streamer = std::make_unique<Streamer>(device, *jobs, loader, meshes, std::move(setup), options.log);
  textures->use(*streamer);
  std::vector<bool> isStreamed(loader.items().count());
  for (std::uint32_t item = 0; item < isStreamed.size(); ++item) isStreamed[item] = streamer->isStreamed(item);
  wanted = WantedItems(scene, std::move(isStreamed));
  sets.reserve(std::min<std::size_t>(cells.size(), 2 * (kMaxCellCount + kMaxFadingOutCount)));
  streamer->startStreaming();
}

// Slots beyond the mesh's members repeat its first photograph, which shaders do not sample through them.
void GpuScene::State::bind(Mesh& mesh, std::uint64_t frame, std::uint64_t completedFrame) {
  PhotographSets::Slots slots;
  mesh.layers.resize(mesh.members.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::size_t member = i < mesh.members.size() ? i : 0;
    const SceneTextures::Sampled sampled = textures->at(mesh.members[member]);
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

void GpuScene::State::update(const FramePlan& plan, std::uint64_t frame, std::uint64_t completedFrame) {
  visitDrawn(plan, cells, [&](Mesh& cell) {
    cell.place = streamer->mesh(std::uint32_t(&cell - cells.data()));
    if (textures->streams()) bind(cell, frame, completedFrame);
  });
  for (const PlannedPhotograph& photograph : plan.photographs)
    backdrops[photograph.backdrop].place = streamer->mesh(std::uint32_t(cells.size()) + photograph.backdrop);
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
  if (state.streamer) {
    state.wanted.update(plan, state.streamer->maxResident());
    status = state.streamer->stream(commandBuffer, state.wanted.items(), state.wanted.needed(), frame, completedFrame,
                                    [&state](VkImageView view) {
                                      state.sets.forget(view);
                                      if (state.gather) state.gather->forget(view);
                                    });
    state.update(plan, frame, completedFrame);
  }
  if (state.gather) state.gather->bind(plan.photographs, frame, completedFrame);
  return status;
}

bool GpuScene::needsStreaming() const noexcept {
  return state_->streamer || (state_->gather && state_->gather->bindsFrames());
}

GpuScene::Memory GpuScene::memory() const noexcept {
  const std::uint64_t depth = state_->textures->depthBytes();
  return {.positions = state_->meshes.allocatedBytes() - state_->meshes.indexBytes(),
          .indices = state_->meshes.indexBytes(),
          .textures = state_->textures->allocatedBytes() - depth,
          .depth = depth};
}

const GpuScene::State& stateOf(const GpuScene& scene) noexcept {
  return *scene.state_;
}

}  // namespace ibr
