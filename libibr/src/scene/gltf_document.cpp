// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/file.h"
#include "ibr/error.h"
#include "scene/htm_model_file.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMaxCount = std::int64_t(1) << 32;

std::size_t optionalCount(const JsonValue& json, const char* key) {
  return json.has(key) ? std::size_t(json[key].integer(0, kMaxCount)) : 0;
}

}  // namespace

GltfDocument::GltfDocument(const fs::path& file, const std::stop_token& stop)
    : folder_(file.has_parent_path() ? file.parent_path() : fs::path(".")), json_(parse(file, stop)) {
  if (const JsonValue version = root()["asset"]["version"]; !version.string().starts_with("2."))
    version.fault(fmt::format("\"{}\" is not a version of glTF 2", version.string()));
  if (root().has("extensionsRequired"))
    for (std::size_t i = 0; i < root()["extensionsRequired"].size(); ++i)
      if (const JsonValue name = root()["extensionsRequired"].at(i); name.string() != kSceneExtension &&
                                                                     name.string() != kHtmModelExtension &&
                                                                     name.string() != "KHR_materials_unlit")
        name.fault(fmt::format("the required extension \"{}\" is not supported", name.string()));
  if (!root().has("nodes")) return;
  for (std::size_t n = 0; n < root()["nodes"].size(); ++n)
    if (const JsonValue node = root()["nodes"].at(n); node.has("children"))
      for (std::size_t c = 0; c < node["children"].size(); ++c)
        children_.insert(&element("nodes", node["children"].at(c)).raw());
}

// A .glb is a header and two chunks, the JSON text and the first buffer; its first four bytes identify it.
nlohmann::json GltfDocument::parse(const fs::path& file, const std::stop_token& stop) {
  const std::vector<std::byte> bytes = readFile(file);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with("glTF")) return parseJson(text, stop);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    if (at + sizeof value > bytes.size()) throw JsonFault("", "the binary file is truncated");
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
  };
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  if (word(4) != 2) throw JsonFault("", fmt::format("version {} of the binary format is not supported", word(4)));
  const auto chunk = [&](std::size_t at, std::uint32_t type, const char* what) {
    if (word(at + 4) != type)
      throw JsonFault("", fmt::format("the binary file has no {} chunk at the expected offset", what));
    if (word(at) > bytes.size() - at - kChunkHeader) throw JsonFault("", "the binary file is truncated");
    return text.substr(at + kChunkHeader, word(at));
  };
  const std::string_view json = chunk(kHeader, kJson, "JSON");
  if (const std::size_t next = kHeader + kChunkHeader + json.size(); next < bytes.size()) {
    const std::string_view binary = chunk(next, kBinary, "buffer");
    const auto* first = reinterpret_cast<const std::byte*>(binary.data());
    binaryChunk_.assign(first, first + binary.size());
  }
  return parseJson(json, stop);
}

JsonValue GltfDocument::element(const char* list, const JsonValue& index) const {
  if (!root().has(list)) index.fault(fmt::format("refers to \"{}\", which is missing", list));
  return root()[list].at(index.index(root()[list].size()));
}

fs::path GltfDocument::reference(const JsonValue& uri) const {
  const std::string path = decodeUri(uri.string());
  if (path.empty()) uri.fault(fmt::format("\"{}\" is not a relative path", uri.string()));
  try {
    pathInside(folder_, path);
  } catch (const Error& e) {
    uri.fault(e.what());
  }
  return path;
}

float GltfDocument::Accessor::value(std::size_t element, std::size_t component) const {
  float value;
  std::memcpy(&value, &bytes[(element * components + component) * sizeof value], sizeof value);
  return value;
}

std::uint32_t GltfDocument::Accessor::index(std::size_t element) const {
  std::uint32_t value = 0;
  std::memcpy(&value, &bytes[element * componentBytes], componentBytes);
  return value;
}

GltfDocument::Accessor GltfDocument::accessor(const JsonValue& index, const char* type,
                                              std::initializer_list<int> componentTypes) {
  const JsonValue json = element("accessors", index);
  if (json["type"].string() != type) json["type"].fault(fmt::format("is {}, not {}", json["type"].string(), type));
  const auto component = int(json["componentType"].integer(0, 65535));
  if (std::find(componentTypes.begin(), componentTypes.end(), component) == componentTypes.end())
    json["componentType"].fault(fmt::format("{} is not allowed here", component));
  if (json.has("sparse")) json["sparse"].fault("sparse accessors are not supported");
  if (json.has("normalized") && json["normalized"].raw() != false) json["normalized"].fault("is not allowed here");
  Accessor result{json,
                  std::size_t(json["count"].integer(1, kMaxCount)),
                  1,
                  component == kUnsignedByte    ? 1u
                  : component == kUnsignedShort ? 2u
                                                : 4u,
                  {}};
  if (const std::string_view name = type; name.starts_with("VEC")) result.components = std::size_t(name[3] - '0');
  const std::size_t size = result.components * result.componentBytes;

  const JsonValue view = element("bufferViews", json["bufferView"]);
  const std::size_t offset = optionalCount(json, "byteOffset"), start = optionalCount(view, "byteOffset");
  const auto length = std::size_t(view["byteLength"].integer(1, kMaxCount));
  const std::size_t stride = view.has("byteStride") ? std::size_t(view["byteStride"].integer(4, 252)) : size;
  if (view.has("byteStride") && (stride < size || stride % 4 != 0))
    view["byteStride"].fault(fmt::format("{} is not a multiple of 4, or is less than {} bytes", stride, size));
  if (offset % result.componentBytes != 0)
    json["byteOffset"].fault(fmt::format("{} is not a multiple of {}", offset, result.componentBytes));
  if (start % result.componentBytes != 0)
    view["byteOffset"].fault(fmt::format("{} is not a multiple of {}", start, result.componentBytes));
  if (offset + (result.count - 1) * stride + size > length)
    json.fault(fmt::format("has {} elements that exceed the buffer view of {} bytes", result.count, length));
  const std::vector<std::byte>& buffer = this->buffer(view["buffer"]);
  if (start + length > buffer.size())
    view.fault(fmt::format("ends at byte {} of a buffer of {} bytes", start + length, buffer.size()));
  result.bytes.resize(result.count * size);
  for (std::size_t i = 0; i < result.count; ++i)
    std::memcpy(&result.bytes[i * size], &buffer[start + offset + i * stride], size);
  return result;
}

const std::vector<std::byte>& GltfDocument::buffer(const JsonValue& index) {
  const JsonValue json = element("buffers", index);
  if (&json.raw() == bufferJson_) return buffer_;
  const auto length = std::size_t(json["byteLength"].integer(1, kMaxCount));
  bufferJson_ = nullptr;
  if (!json.has("uri") && !binaryChunk_.empty() && &json.raw() == &root()["buffers"].at(0).raw()) {
    buffer_ = binaryChunk_;
    if (buffer_.size() < length)
      json["byteLength"].fault(fmt::format("is {}, but the file's buffer chunk has {} bytes", length, buffer_.size()));
  } else {
    const fs::path path = folder_ / reference(json["uri"]);
    buffer_ = readFile(path);
    if (buffer_.size() < length)
      json["byteLength"].fault(fmt::format("is {}, but {} has {} bytes", length, path.string(), buffer_.size()));
  }
  buffer_.resize(length);
  bufferJson_ = &json.raw();
  return buffer_;
}

}  // namespace ibr
