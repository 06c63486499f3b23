// SPDX-License-Identifier: Apache-2.0
// Between gpu.cpp and gpu_main.cpp.
#pragma once

namespace ibr::test {

void makeTestDevice();     // throws Error where there is none
void destroyTestDevice();  // afterwards everything made from it must be gone
void beginTestCase();
void endTestCase();
int strayMessages();  // that came outside test cases or from other threads, such as of objects that were never
                      // destroyed

}  // namespace ibr::test
