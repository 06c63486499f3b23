// SPDX-License-Identifier: Apache-2.0
// Version of libibr. The macros are of the headers, version() is of the linked library. CMake reads the macros.
#pragma once

#include <string_view>

#include "ibr/export.h"

/// Version of the headers: major, minor and patch number.
#define IBR_VERSION_MAJOR 0
#define IBR_VERSION_MINOR 1
#define IBR_VERSION_PATCH 0

namespace ibr {

/// Returns "MAJOR.MINOR.PATCH" of the linked library.
IBR_API std::string_view version() noexcept;

}  // namespace ibr
