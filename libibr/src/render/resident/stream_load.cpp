// SPDX-License-Identifier: Apache-2.0
#include "render/resident/stream_load.h"

#include <cassert>
#include <cstring>

namespace ibr {

void StreamLoad::run(const std::stop_token& stop) noexcept try {
  error = nullptr;
  if (!arrayClass) return meshes->write(loader->items().meshIndex(item), piece.memory);
  const Texture texture = loader->load(item, *arrayClass, stop);
  std::size_t at = 0;
  for (const std::vector<std::byte>& level : texture.levels) {
    assert(at + level.size() <= piece.memory.size());
    std::memcpy(&piece.memory[at], level.data(), level.size());
    at += level.size();
  }
} catch (...) {
  error = std::current_exception();
}

void ArrayWork::run(const std::stop_token&) noexcept try {
  error = nullptr;
  const auto bytesOf = [](const GpuImage& image, bool depthOnly) {
    return depthOnly && image.info().format != vulkanFormat(TextureFormat::rg16f) ? 0 : image.allocatedBytes();
  };
  std::uint64_t freed = 0, freedDepth = 0;
  for (const GpuImage& image : retired) {
    freed += bytesOf(image, false);
    freedDepth += bytesOf(image, true);
  }
  retired.clear();
  bytes -= freed;
  depthBytes -= freedDepth;
  made = GpuImage(*device, arrayInfo(*arrayClass, layers), arrayClass->text());
  bytes += bytesOf(made, false);
  depthBytes += bytesOf(made, true);
} catch (...) {
  error = std::current_exception();
}

std::string messageOf(const std::exception_ptr& error) try {
  std::rethrow_exception(error);
} catch (const std::exception& e) {
  return e.what();
} catch (...) {
  return "unknown exception";
}

}  // namespace ibr
