// SPDX-License-Identifier: Apache-2.0
// Checks the input of planFrame.
#pragma once

#include "ibr/frame_plan.h"

namespace ibr {

/// Throws Error{invalidInput} that names the field and its value, as planFrame promises.
void checkInput(const FrameInput& input);

}  // namespace ibr
