// SPDX-License-Identifier: Apache-2.0
// A display without a screen (Xvfb, with openbox as its window manager), and hands that type and move the mouse in it
// (xdotool).
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <thread>
#include <vector>

namespace ibr::test {

/// Starts the display once for this program and sets DISPLAY; false where the programs for it are missing. Where
/// IBR_REQUIRE_DEVICE is set, that fails the test.
bool displayIsThere();

/// xdotool ARGUMENTS; what it printed. Fails the test where it fails.
std::string xdotool(const std::vector<std::string>& arguments);

/// Does something to a window while another thread runs its program: waits for the window, gives it the keyboard, then
/// calls `act` with its number. Whatever happens, the window is told to close after that; the destructor waits.
class Hands {
 public:
  explicit Hands(std::function<void(const std::string& window)> act);
  ~Hands();

 private:
  std::thread thread_;
};

void sleepFor(double seconds);

}  // namespace ibr::test
