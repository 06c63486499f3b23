// SPDX-License-Identifier: Apache-2.0
// Writes the settings of a harmonised model as JSON text, which the model stores.
#pragma once

#include <string>

#include "ibr/author/htm.h"

namespace ibr {

std::string htmSettingsText(const HtmBuildOptions& options);

}  // namespace ibr
