// SPDX-License-Identifier: Apache-2.0
// A body made in code as files that a harmonised model is built from.
#pragma once

#include <filesystem>
#include <string>

#include "support/bumpy_model.h"

namespace ibr::test {

/// Writes FOLDER/mesh.obj, images/NAME.png, masks/NAME.png (the body is 255) and sparse/ (COLMAP's text); NAME as the
/// cameras are called.
void writeHtmFiles(const BumpyModel& bumpy, const std::filesystem::path& folder);

/// sparse/ alone, of pinholes and images called `name`.png.
void writeSparse(const std::filesystem::path& folder, const std::vector<HtmCamera>& cameras);

}  // namespace ibr::test
