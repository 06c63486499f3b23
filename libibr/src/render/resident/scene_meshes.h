// SPDX-License-Identifier: Apache-2.0
// The meshes of a scene's cells and backdrops on the device: all, or under a budget stand-ins and a pool for the meshes
// that frames need (ibr/gpu_scene.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/buffer.h"
#include "gpu/transfer/upload.h"
#include "render/resident/mesh_stand_in.h"
#include "render/resident/residency.h"

namespace ibr {

struct IndexRange {
  std::uint32_t first = 0, count = 0;
};

/// Place of a mesh in the buffers, bytes.
struct MeshPlace {
  VkDeviceSize vertexOffset = 0;    // q_0 … q_{d−1}, ρ: 3d + 1 floats a vertex
  VkDeviceSize evidenceOffset = 0;  // trust and consensus, 2 × 16 bits a vertex; of backdrops that can be gathered from
  IndexRange indices;               // of the triangles that are drawn
  bool isStandIn = false;
};

/// Meshes have the numbers of the cells, then those of the backdrops. The scene must outlive this object.
class SceneMeshes {
 public:
  SceneMeshes() = default;
  /// Allocates nothing on the device. `gathers`: backdrops that can be gathered from have evidence.
  SceneMeshes(const Scene& scene, bool gathers);

  /// Bytes of all meshes; an upper bound until makeStandIns() was called.
  std::uint64_t totalBytes() const noexcept;

  /// Makes stand-ins in jobs and waits for them. Meshes of at most kMaxStandInTriangles have none: they are always
  /// resident. Throws Error{cancelled}.
  void makeStandIns(JobQueue& jobs, const std::stop_token& stop);
  std::uint64_t fixedBytes() const noexcept { return fixedBytes_; }        // always resident, when meshes are streamed
  std::uint64_t streamedBytes() const noexcept { return streamedBytes_; }  // of the slots of all others
  std::uint64_t largestSlot() const noexcept { return slotBytes_.empty() ? 0 : slotBytes_[0]; }

  /// Makes all meshes resident after uploader.flush(). Throws Error{cancelled}.
  void makeResident(const Device& device, Uploader& uploader, const std::stop_token& stop);
  /// Makes one buffer for everything, with a pool of at most `poolBytes`, at least largestSlot(). Stand-ins are
  /// resident after uploader.flush(). Precondition: makeStandIns() was called.
  void makeStreamed(const Device& device, Uploader& uploader, std::uint64_t poolBytes);
  bool streams() const noexcept { return chunkBytes_ > 0; }

  const Buffer& vertices() const noexcept { return vertices_; }
  const Buffer& indices() const noexcept { return streams() ? vertices_ : indices_; }
  const Buffer& evidence() const noexcept { return streams() ? vertices_ : evidence_; }  // empty: no gather

  /// `offset`: of the mesh's slot in the pool; nullopt: it is not in the pool.
  MeshPlace place(std::size_t mesh, std::optional<VkDeviceSize> offset = std::nullopt) const noexcept;
  /// Points of a cell's stand-in; empty where the mesh has none.
  std::span<const std::uint32_t> standInPoints(std::size_t mesh) const noexcept { return meshes_[mesh].part.points; }

  // Of streamed meshes. Chunks of the pool are the arrays of Residency, slots are their layers.
  std::vector<Residency::Class> classes(std::uint32_t group) const;
  std::uint32_t classOf(std::size_t mesh) const noexcept { return meshes_[mesh].slotClass; }  // Residency::kNone: none
  std::uint32_t chunkCount() const noexcept { return chunkCount_; }
  VkDeviceSize slotOffset(std::uint32_t chunk, std::uint32_t slotClass, std::uint32_t slot) const noexcept {
    return poolOffset_ + chunk * chunkBytes_ + slot * slotBytes_[slotClass];
  }
  std::uint64_t bytes(std::size_t mesh) const noexcept;
  /// Writes the bytes of a mesh's slot. Several threads may call it at a time.
  void write(std::size_t mesh, std::span<std::byte> to) const;

  std::uint64_t indexBytes() const noexcept { return indices_.allocatedBytes(); }
  std::uint64_t allocatedBytes() const noexcept {
    return vertices_.allocatedBytes() + indices_.allocatedBytes() + evidence_.allocatedBytes();
  }

 private:
  struct Mesh {
    const Cell* cell = nullptr;
    bool hasEvidence = false;
    std::uint32_t triangles = 0;  // that are drawn
    std::uint32_t slotClass = Residency::kNone;
    MeshPart part;    // stand-in
    MeshPlace place;  // of the mesh, or of its stand-in
  };
  struct Layout {
    std::uint64_t vertices = 0, evidence = 0, indices = 0;  // bytes
    std::uint64_t sum() const noexcept { return vertices + evidence + indices; }
  };
  static Layout layout(const Mesh& mesh, std::size_t points, std::size_t triangles) noexcept;
  void chooseSlots();
  void writePart(const Mesh& mesh, const MeshPart& part, std::span<std::byte> to) const;

  const Scene* scene_ = nullptr;
  std::vector<Mesh> meshes_;
  Buffer vertices_, indices_, evidence_;
  std::vector<std::uint64_t> slotBytes_;  // by class, descending
  std::uint64_t fixedBytes_ = 0, streamedBytes_ = 0, poolOffset_ = 0, chunkBytes_ = 0;
  std::uint32_t chunkCount_ = 0;
};

/// Bytes of a vertex with d members.
constexpr std::uint32_t vertexStride(std::size_t members) {
  return std::uint32_t((3 * members + 1) * sizeof(float));
}

}  // namespace ibr
