// SPDX-License-Identifier: Apache-2.0
// What harmonise() refuses before it begins: each throws Error{invalidInput} that names what is wrong.
#pragma once

#include <span>

#include "ibr/htm_author.h"

namespace ibr {

void checkHtmOptions(const HtmOptions& options);
void checkHtmMesh(const TriangleMesh& mesh);
void checkHtmPhotographs(std::span<const HtmPhotograph> photographs);

}  // namespace ibr
