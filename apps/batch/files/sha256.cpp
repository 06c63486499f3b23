// SPDX-License-Identifier: Apache-2.0
#include "batch/files/sha256.h"

#include <fmt/format.h>
#include <openssl/sha.h>

#include <array>

namespace ibr::app {

std::string sha256(std::span<const std::byte> bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

}  // namespace ibr::app
