// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first asks the work to stop at the next whole file, the second ends the program at once.
#pragma once

namespace ibr::app {

void watchForInterrupt();
bool interrupted() noexcept;
/// Throws Error{cancelled} once Ctrl-C was pressed.
void stopIfInterrupted();

}  // namespace ibr::app
