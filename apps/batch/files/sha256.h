// SPDX-License-Identifier: Apache-2.0
// SHA-256: identifies data in reports, so that others can check that they have the same data.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ibr::app {

/// Returns 64 hexadecimal digits in lower case.
std::string sha256(std::span<const std::byte> bytes);

}  // namespace ibr::app
