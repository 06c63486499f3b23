// SPDX-License-Identifier: Apache-2.0
// Another program, run to its end: what it prints is read line by line.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ibr {

struct ChildResult {
  int status = 0;        // its exit status, or 128 and the signal that ended it
  bool stopped = false;  // by us
};

/// Runs `arguments[0]`, looked for along PATH unless it names a folder, with our environment and `environment` (names
/// and values) over it; its stdin is empty. `line` gets what it prints to stdout and stderr, without line ends;
/// lines of more than 64 KiB in pieces.
/// `goesOn` is asked ten times a second and oftener; when it says no, the program and all that it has started are ended
/// (SIGTERM, after three seconds SIGKILL) and waited for. Throws Error{io} where it cannot be started.
ChildResult runChild(const std::vector<std::string>& arguments,
                     const std::vector<std::pair<std::string, std::string>>& environment,
                     const std::function<void(std::string_view)>& line, const std::function<bool()>& goesOn);

}  // namespace ibr
