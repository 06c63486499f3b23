// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Writes a COLMAP text model of views, all pinholes, without points. Throws Error{io}.
void writeColmapViews(const std::filesystem::path& folder, const std::vector<View>& views);

}  // namespace ibr::app
