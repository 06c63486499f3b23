// SPDX-License-Identifier: Apache-2.0
// What came of harmonising, for reports.
#pragma once

#include <nlohmann/json.hpp>

#include "ibr/htm_author.h"

namespace ibr::app {

nlohmann::ordered_json htmReportJson(const HtmReport& report);

}  // namespace ibr::app
