// SPDX-License-Identifier: Apache-2.0
// Features of a photograph (features.h) kept in a file, private to a build on one machine.
#pragma once

#include <filesystem>
#include <optional>

#include "author/features/features.h"

namespace ibr {

void storeFeatures(const std::filesystem::path& file, const Features& features);

/// nullopt where there is none, or one that is damaged.
std::optional<Features> fetchFeatures(const std::filesystem::path& file);

}  // namespace ibr
