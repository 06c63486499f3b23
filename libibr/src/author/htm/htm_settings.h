// SPDX-License-Identifier: Apache-2.0
// The settings of a harmonised model as the text that it keeps.
#pragma once

#include <string>

#include "ibr/htm_author.h"

namespace ibr {

std::string htmSettingsText(const HtmBuildOptions& options);

}  // namespace ibr
