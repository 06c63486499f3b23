// SPDX-License-Identifier: Apache-2.0
// Writes a generated body as input files of a harmonised-model build.
#pragma once

#include <filesystem>
#include <string>

#include "support/bumpy_model.h"

namespace ibr::test {

/// Writes FOLDER/mesh.obj, images/NAME.png, masks/NAME.png (255: body) and sparse/ (COLMAP text). NAME: name of
/// the camera.
void writeHtmFiles(const BumpyModel& bumpy, const std::filesystem::path& folder);

/// Writes sparse/ only: pinhole cameras and images named `name`.png.
void writeSparse(const std::filesystem::path& folder, const std::vector<HtmCamera>& cameras);

}  // namespace ibr::test
