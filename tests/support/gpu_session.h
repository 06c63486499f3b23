// SPDX-License-Identifier: Apache-2.0
// Interface between gpu.cpp and gpu_main.cpp.
#pragma once

namespace ibr::test {

void makeTestDevice();     // throws Error if there is no device
void destroyTestDevice();  // precondition: all objects made from the device are destroyed
void beginTestCase();
void endTestCase();
int strayMessages();  // number of messages outside test cases or from other threads, e.g. about objects that
                      // were never destroyed

}  // namespace ibr::test
