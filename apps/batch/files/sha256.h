// SPDX-License-Identifier: Apache-2.0
// SHA-256: names data in reports, so that others can tell whether they have the same.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ibr::app {

/// 64 hexadecimal digits, small letters.
std::string sha256(std::span<const std::byte> bytes);

}  // namespace ibr::app
