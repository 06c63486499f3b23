// SPDX-License-Identifier: Apache-2.0
#include "ibr/version.h"

#define IBR_TEXT_OF(number) #number
#define IBR_TEXT(number) IBR_TEXT_OF(number)

namespace ibr {

std::string_view version() noexcept {
  return IBR_TEXT(IBR_VERSION_MAJOR) "." IBR_TEXT(IBR_VERSION_MINOR) "." IBR_TEXT(IBR_VERSION_PATCH);
}

}  // namespace ibr
