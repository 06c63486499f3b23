// SPDX-License-Identifier: Apache-2.0
// A virtual display (Xvfb, with the window manager openbox), and simulated input on the display: keys and mouse
// (xdotool).
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <thread>
#include <vector>

namespace ibr::test {

/// Starts the display once for this process and sets DISPLAY. Returns false if the needed programs are missing; if
/// IBR_REQUIRE_DEVICE is set, that fails the test.
bool displayIsThere();

/// Runs xdotool with the arguments and returns its output. Fails the test if xdotool fails.
std::string xdotool(const std::vector<std::string>& arguments);

/// Acts on a window while another thread runs its program: waits for the window, focuses the window, then calls `act`
/// with its number. Afterwards, also after exceptions, closes the window. The destructor waits.
class Hands {
 public:
  explicit Hands(std::function<void(const std::string& window)> act);
  ~Hands();

 private:
  std::thread thread_;
};

void sleepFor(double seconds);

}  // namespace ibr::test
