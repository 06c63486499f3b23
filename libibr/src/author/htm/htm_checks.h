// SPDX-License-Identifier: Apache-2.0
// Checks harmonise()'s arguments. Each function throws Error{invalidInput} that names what is wrong.
#pragma once

#include <span>

#include "ibr/author/htm.h"

namespace ibr {

void checkHtmOptions(const HtmOptions& options);
void checkHtmMesh(const TriangleMesh& mesh);
void checkHtmPhotographs(std::span<const HtmPhotograph> photographs);

}  // namespace ibr
