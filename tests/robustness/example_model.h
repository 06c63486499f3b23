// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ibr/htm_model.h"

namespace ibr::test {

/// Two cameras, a cube, and all that a harmonised model may have.
HtmModel exampleModel();
void writeExampleModel(const std::filesystem::path& folder);

}  // namespace ibr::test
