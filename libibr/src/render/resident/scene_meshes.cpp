// SPDX-License-Identifier: Apache-2.0
#include "render/resident/scene_meshes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/gtc/type_precision.hpp>
#include <numeric>
#include <utility>

#include "base/check.h"
#include "render/photographs/photograph_choice.h"
#include "render/plan/vertex.h"
#include "render/resident/read_in_order.h"
#include "shared/gather.h"

namespace ibr {
namespace {

constexpr double kSlotRatio = 1.25;           // of the sizes of slots: a fifth of a slot is unused at most
constexpr std::uint64_t kSlotAlignment = 16;  // bytes
constexpr std::uint64_t kMaxChunks = 64;      // of a pool, so that memory can move between sizes of slots
constexpr std::uint64_t kEvidenceBytes = sizeof(glm::u16vec2);

// Allocates at least 4 bytes: Vulkan has no empty buffers, and a scene may have no triangles.
Buffer makeArena(const Device& device, std::uint64_t bytes, VkBufferUsageFlags usage, const char* name) {
  // The vertex stage of overlays reads vertices and indices as storage buffers.
  usage |= VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  return Buffer(device, std::max<VkDeviceSize>(bytes, 4), usage, MemoryKind::device, name);
}

template <class Value>
Buffer makeArena(const Device& device, const std::vector<Value>& values, VkBufferUsageFlags usage, const char* name,
                 Uploader& uploader) {
  const auto bytes = std::as_bytes(std::span(values));
  Buffer buffer = makeArena(device, bytes.size(), usage, name);
  if (!bytes.empty()) uploader.buffer(buffer, 0, bytes);
  return buffer;
}

// Calls visit(value) for the 3d + 1 floats of a vertex.
template <class Visit>
void forVertex(const Scene& scene, const Cell& cell, std::uint32_t point, Visit&& visit) {
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const glm::vec3 q(memberPoint(scene, cell, i, point));
    visit(q.x), visit(q.y), visit(q.z);
  }
  visit(cell.mesh.inverseDistance[point]);
}

glm::u16vec2 evidenceOf(const MorphMesh& mesh, std::uint32_t point) {
  const auto share = [](float value) { return std::uint16_t(std::lround(65535.0f * std::clamp(value, 0.0f, 1.0f))); };
  return {share(shader::gatherTrust(mesh.confirmations[point])), share(mesh.consensus[point])};
}

MeshPart wholeMesh(const Scene& scene, const Cell& cell) {
  MeshPart part{std::vector<std::uint32_t>(cell.mesh.vertexCount()), drawnTriangles(scene, cell)};
  std::iota(part.points.begin(), part.points.end(), 0u);
  return part;
}

}  // namespace

SceneMeshes::SceneMeshes(const Scene& scene, bool gathers) : scene_(&scene) {
  meshes_.reserve(scene.cells.size() + scene.backdrops.size());
  for (const std::vector<Cell>* cells : {&scene.cells, &scene.backdrops})
    for (const Cell& cell : *cells)
      meshes_.push_back({.cell = &cell, .triangles = std::uint32_t(cell.mesh.tier0Count())});
  if (gathers)
    for (const std::uint32_t b : gatherableBackdrops(scene)) meshes_[scene.cells.size() + b].hasEvidence = true;
}

SceneMeshes::Layout SceneMeshes::layout(const Mesh& mesh, std::size_t points, std::size_t triangles) noexcept {
  return {.vertices = points * vertexStride(mesh.cell->members.size()),
          .evidence = mesh.hasEvidence ? points * kEvidenceBytes : 0,
          .indices = triangles * sizeof(glm::uvec3)};
}

std::uint64_t SceneMeshes::bytes(std::size_t mesh) const noexcept {
  const Mesh& of = meshes_[mesh];
  return layout(of, of.cell->mesh.vertexCount(), of.triangles).sum();
}

std::uint64_t SceneMeshes::totalBytes() const noexcept {
  std::uint64_t sum = 0;
  for (std::size_t m = 0; m < meshes_.size(); ++m) sum += bytes(m);
  return sum;
}

void SceneMeshes::makeStandIns(JobQueue& jobs, const std::stop_token& stop) {
  struct Made {
    std::size_t triangles;
    MeshPart part;
  };
  readInOrder<Made>(
      jobs, meshes_.size(), stop,
      [&](std::size_t m, const std::stop_token&) {
        const Cell& cell = *meshes_[m].cell;
        const std::vector<glm::uvec3> drawn = drawnTriangles(*scene_, cell);
        if (drawn.size() <= kMaxStandInTriangles) return Made{drawn.size(), {}};
        return Made{drawn.size(), meshStandIn(cell, drawn)};
      },
      [&](std::size_t m, Made made) {
        meshes_[m].triangles = std::uint32_t(made.triangles);
        meshes_[m].part = std::move(made.part);
      });
  chooseSlots();
}

void SceneMeshes::chooseSlots() {
  const auto isStreamed = [](const Mesh& mesh) { return mesh.triangles > kMaxStandInTriangles; };
  std::uint64_t largest = 0, smallest = ~std::uint64_t(0);
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const Mesh& mesh = meshes_[m];
    if (!isStreamed(mesh)) {
      fixedBytes_ += bytes(m);
      continue;
    }
    fixedBytes_ += layout(mesh, mesh.part.points.size(), mesh.part.triangles.size()).sum();
    largest = std::max(largest, bytes(m));
    smallest = std::min(smallest, bytes(m));
  }
  if (largest == 0) return;
  const auto aligned = [](std::uint64_t size) { return (size + kSlotAlignment - 1) / kSlotAlignment * kSlotAlignment; };
  for (std::uint64_t slot = aligned(largest);;) {
    slotBytes_.push_back(slot);
    slot = aligned(std::uint64_t(double(slot) / kSlotRatio));
    if (slot < smallest || slot >= slotBytes_.back()) break;
  }
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    if (!isStreamed(meshes_[m])) continue;
    const auto below = std::ranges::upper_bound(slotBytes_, bytes(m), std::ranges::greater());  // the first too small
    meshes_[m].slotClass = std::uint32_t(below - slotBytes_.begin()) - 1;
    streamedBytes_ += slotBytes_[meshes_[m].slotClass];
  }
}

void SceneMeshes::makeResident(const Device& device, Uploader& uploader, const std::stop_token& stop) {
  std::vector<float> vertices;
  std::vector<glm::uvec3> indices;
  std::vector<glm::u16vec2> evidence;
  bool hasEvidence = false;
  for (Mesh& mesh : meshes_) {
    check(!stop.stop_requested(), ErrorCode::cancelled, "opening the scene was cancelled");
    mesh.part = {};
    mesh.slotClass = Residency::kNone;
    const std::vector<glm::uvec3> drawn = drawnTriangles(*scene_, *mesh.cell);
    mesh.place = {.vertexOffset = vertices.size() * sizeof(float),
                  .evidenceOffset = evidence.size() * kEvidenceBytes,
                  .indices = {std::uint32_t(3 * indices.size()), std::uint32_t(3 * drawn.size())}};
    for (std::uint32_t p = 0; p < mesh.cell->mesh.vertexCount(); ++p) {
      forVertex(*scene_, *mesh.cell, p, [&](float value) { vertices.push_back(value); });
      if (mesh.hasEvidence) evidence.push_back(evidenceOf(mesh.cell->mesh, p));
    }
    hasEvidence |= mesh.hasEvidence;
    indices.insert(indices.end(), drawn.begin(), drawn.end());
  }
  vertices_ = makeArena(device, vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "cell vertices", uploader);
  indices_ = makeArena(device, indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "cell indices", uploader);
  if (hasEvidence)
    evidence_ = makeArena(device, evidence, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "evidence of depth", uploader);
}

void SceneMeshes::makeStreamed(const Device& device, Uploader& uploader, std::uint64_t poolBytes) {
  assert(poolBytes >= largestSlot());
  poolOffset_ = (fixedBytes_ + kSlotAlignment - 1) / kSlotAlignment * kSlotAlignment;
  chunkBytes_ = largestSlot() * std::max<std::uint64_t>(1, poolBytes / kMaxChunks / largestSlot());
  chunkCount_ = std::uint32_t(poolBytes / chunkBytes_);
  std::vector<std::byte> fixed(fixedBytes_);
  std::uint64_t at = 0;
  for (Mesh& mesh : meshes_) {
    const bool whole = mesh.slotClass == Residency::kNone;
    const MeshPart made = whole ? wholeMesh(*scene_, *mesh.cell) : MeshPart{};
    const MeshPart& part = whole ? made : mesh.part;
    const Layout size = layout(mesh, part.points.size(), part.triangles.size());
    writePart(mesh, part, std::span(fixed).subspan(at, size.sum()));
    mesh.place = {.vertexOffset = at,
                  .evidenceOffset = at + size.vertices,
                  .indices = {std::uint32_t((at + size.vertices + size.evidence) / sizeof(std::uint32_t)),
                              std::uint32_t(3 * part.triangles.size())},
                  .isStandIn = !whole};
    at += size.sum();
  }
  assert(at == fixedBytes_);
  vertices_ = makeArena(device, poolOffset_ + chunkCount_ * chunkBytes_,
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "meshes");
  uploader.buffer(vertices_, 0, fixed);
}

MeshPlace SceneMeshes::place(std::size_t mesh, std::optional<VkDeviceSize> offset) const noexcept {
  const Mesh& of = meshes_[mesh];
  if (!offset) return of.place;
  const Layout size = layout(of, of.cell->mesh.vertexCount(), of.triangles);
  const VkDeviceSize indices = *offset + size.vertices + size.evidence;
  return {.vertexOffset = *offset,
          .evidenceOffset = *offset + size.vertices,
          .indices = {std::uint32_t(indices / sizeof(std::uint32_t)), 3 * of.triangles}};
}

std::vector<Residency::Class> SceneMeshes::classes(std::uint32_t group) const {
  std::vector<Residency::Class> classes;
  for (const std::uint64_t slot : slotBytes_)
    classes.push_back({chunkBytes_, std::uint32_t(chunkBytes_ / slot), group});
  return classes;
}

void SceneMeshes::write(std::size_t mesh, std::span<std::byte> to) const {
  writePart(meshes_[mesh], wholeMesh(*scene_, *meshes_[mesh].cell), to);
}

void SceneMeshes::writePart(const Mesh& mesh, const MeshPart& part, std::span<std::byte> to) const {
  assert(to.size() == layout(mesh, part.points.size(), part.triangles.size()).sum());
  std::byte* at = to.data();
  const auto put = [&](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  for (const std::uint32_t p : part.points) forVertex(*scene_, *mesh.cell, p, put);
  if (mesh.hasEvidence)
    for (const std::uint32_t p : part.points) put(evidenceOf(mesh.cell->mesh, p));
  std::memcpy(at, part.triangles.data(), part.triangles.size() * sizeof(glm::uvec3));
}

}  // namespace ibr
