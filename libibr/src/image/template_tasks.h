// SPDX-License-Identifier: Apache-2.0
// Input checks that all searches of ibr/template_search.h share.
#pragma once

#include <span>

#include "ibr/template_search.h"

namespace ibr {

/// Throws Error{invalidInput} for images without pixels or without exactly 3 channels.
void checkTemplateImages(std::span<const Image8* const> pictures);

/// Throws the same Error{invalidInput} as the calls of cpuTemplateSearch.
void checkTemplateTasks(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                        std::size_t pictures);

}  // namespace ibr
