// SPDX-License-Identifier: Apache-2.0
// Cache of a photograph's features (features.h), in native layout.
#pragma once

#include <filesystem>
#include <optional>

#include "author/features/features.h"

namespace ibr {

void storeFeatures(const std::filesystem::path& file, const Features& features);

/// Returns nullopt if the file is missing or damaged.
std::optional<Features> fetchFeatures(const std::filesystem::path& file);

}  // namespace ibr
