// SPDX-License-Identifier: Apache-2.0
#include "render/resident/photograph_load.h"

namespace ibr {

void PhotographLoad::run(const std::stop_token& stop) noexcept try {
  texture = {};
  error = nullptr;
  if (arrayClass) texture = loader->load(node, *arrayClass, stop);
} catch (...) {
  error = std::current_exception();
}

void ArrayWork::run(const std::stop_token&) noexcept try {
  error = nullptr;
  std::uint64_t freed = 0;
  for (const GpuImage& image : retired) freed += image.allocatedBytes();
  retired.clear();
  bytes -= freed;
  made = GpuImage(*device, arrayInfo(*arrayClass, layers), arrayClass->text());
  bytes += made.allocatedBytes();
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
