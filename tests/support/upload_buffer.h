// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "gpu/transfer/upload.h"

namespace ibr::test {

/// Uploads and waits.
inline void uploadBuffer(const Device& device, const Buffer& to, VkDeviceSize offset,
                         std::span<const std::byte> bytes) {
  Uploader uploader(device, nullptr, kSmallStagingBytes);
  uploader.buffer(to, offset, bytes);
  uploader.flush();
}

}  // namespace ibr::test
