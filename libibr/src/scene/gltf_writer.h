// SPDX-License-Identifier: Apache-2.0
// Builds a glTF 2.0 document with buffers beside it, for the writers of scenes and of harmonised models.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>

#include "ibr/camera.h"

namespace ibr {

class GltfWriter {
 public:
  using Json = nlohmann::ordered_json;

  static constexpr int kFloat = 5126, kUnsignedByte = 5121, kUnsignedShort = 5123,
                       kUnsignedInt = 5125;                  // component types
  static constexpr int kVertices = 34962, kIndices = 34963;  // buffer view targets
  static constexpr int kPoints = 0, kTriangles = 4;          // primitive modes

  /// Buffers are written below `folder` immediately.
  explicit GltfWriter(std::filesystem::path folder);

  /// Adds an entry to a top-level list and returns its index.
  std::size_t add(const char* list, Json entry);
  Json& entry(const char* list, std::size_t index) { return lists_[list][index]; }

  /// Writes subfolder/NAME-HASH.bin. HASH is that of the contents, so a file is never overwritten by other contents.
  std::size_t addBuffer(const std::string& subfolder, const std::string& name, std::span<const std::byte> bytes);

  struct Array {
    std::size_t buffer, offset, bytes;
  };
  /// `stride`: bytes from one element to the next, a multiple of 4; 0: packed.
  std::size_t addAccessor(Array array, std::size_t count, int component, const char* type, int target = 0,
                          std::size_t stride = 0);

  /// Adds minimum and maximum of the positions of an accessor.
  void addBounds(std::size_t accessor, std::span<const glm::vec3> positions);

  /// A node with the pose and, for a pinhole, a camera. Exact intrinsics go into the extension: intrinsicsJson.
  std::size_t addCameraNode(const std::string& name, const Camera& camera);
  static Json intrinsicsJson(const Intrinsics& intrinsics);

  static Json triple(glm::dvec3 v) { return {v.x, v.y, v.z}; }

  /// Text of the document; lists and the extension's lists have one line per entry.
  std::string document(const char* extensionName, Json extension);

  /// Removes the files in a subfolder that have names as from addBuffer and that this document does not use: leftovers
  /// of an earlier save.
  void removeStaleBuffers(const std::string& subfolder) const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, Json> lists_;
  std::set<std::filesystem::path> buffers_;
};

/// Check that a text is UTF-8, and that a file lies inside `folder`, the document's folder. `what` and `field` are for
/// the message. Throw Error{invalidInput}.
void requireUtf8(const std::string& text, const std::filesystem::path& folder, const char* what,
                 const std::string& field);
void requireInside(const std::filesystem::path& file, const std::filesystem::path& folder, const char* what,
                   const std::string& field);
/// Requires "" or JSON text.
void requireJson(const std::string& text, const std::filesystem::path& folder, const char* what,
                 const std::string& field);

}  // namespace ibr
