// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first one stops the work after the current file, the second one ends the program at once.
#pragma once

namespace ibr::app {

void watchForInterrupt();
bool interrupted() noexcept;
/// Throws Error{cancelled} after Ctrl-C was pressed.
void stopIfInterrupted();

}  // namespace ibr::app
