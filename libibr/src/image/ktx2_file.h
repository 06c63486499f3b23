// SPDX-License-Identifier: Apache-2.0
// KTX 2.0 files of large textures, read by threads that may have to end soon.
#pragma once

#include <filesystem>
#include <stop_token>

#include "ibr/texture.h"

namespace ibr {

/// As readKtx2 without a token (ibr/texture.h). Throws Error{cancelled} before a level once `stop` is requested.
Texture readKtx2(const std::filesystem::path& path, int firstLevel, const std::stop_token& stop);

}  // namespace ibr
