// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 document and the buffers beside it, or a .glb with both in one file. All input is untrusted: every number
// is checked when read. File references must stay inside the document's folder, accessors inside their buffer. Faults
// are JsonFaults, unreadable files Error{io}.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <set>
#include <stop_token>
#include <vector>

#include "scene/json_check.h"

namespace ibr {

class GltfDocument {
 public:
  /// A requested stop throws Error{cancelled} while the document is parsed.
  explicit GltfDocument(const std::filesystem::path& file, const std::stop_token& stop = {});
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  JsonValue root() const { return JsonValue(json_); }

  /// Element of a top-level list that `index` refers to.
  JsonValue element(const char* list, const JsonValue& index) const;

  bool hasParent(const JsonValue& node) const { return children_.contains(&node.raw()); }

  /// A file inside the folder, relative to it.
  std::filesystem::path reference(const JsonValue& uri) const;

  /// Elements of an accessor, packed (without the gaps of a stride).
  struct Accessor {
    JsonValue json;
    std::size_t count, components, componentBytes;
    std::vector<std::byte> bytes;

    float value(std::size_t element, std::size_t component) const;  // for float components
    std::uint32_t index(std::size_t element) const;                 // integer; counts components across elements
  };
  /// `type` is "SCALAR" or "VEC2" … "VEC4"; `componentTypes` are the allowed ones, kFloat and so on. Only the last
  /// buffer is cached, so callers should read accessors buffer by buffer. Not thread-safe.
  static constexpr int kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
  Accessor accessor(const JsonValue& index, const char* type, std::initializer_list<int> componentTypes);

 private:
  const std::vector<std::byte>& buffer(const JsonValue& index);
  nlohmann::json parse(const std::filesystem::path& file, const std::stop_token& stop);

  std::filesystem::path folder_;
  std::vector<std::byte> binaryChunk_;  // of a .glb
  nlohmann::json json_;
  std::set<const nlohmann::json*> children_;  // nodes that have a parent
  std::vector<std::byte> buffer_;
  const nlohmann::json* bufferJson_ = nullptr;  // owner of buffer_'s contents
};

}  // namespace ibr
