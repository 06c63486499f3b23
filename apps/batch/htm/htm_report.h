// SPDX-License-Identifier: Apache-2.0
// Results of harmonising, for reports.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "ibr/author/htm.h"

namespace ibr::app {

nlohmann::ordered_json htmReportJson(const HtmReport& report);

}  // namespace ibr::app
