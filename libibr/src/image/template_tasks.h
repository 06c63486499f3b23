// SPDX-License-Identifier: Apache-2.0
// What all searches of ibr/template_search.h refuse.
#pragma once

#include <span>

#include "ibr/template_search.h"

namespace ibr {

/// Throws Error{invalidInput} for pictures without 3 channels or pixels.
void checkTemplatePictures(std::span<const Image8* const> pictures);

/// Throws Error{invalidInput} as the calls of processorTemplateSearch.
void checkTemplateTasks(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                        std::size_t pictures);

}  // namespace ibr
