// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ibr/htm_model.h"

namespace ibr::test {

/// Two cameras, a cube, and all optional parts of a harmonised model.
HtmModel exampleModel();
void writeExampleModel(const std::filesystem::path& folder);

}  // namespace ibr::test
