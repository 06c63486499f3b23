// SPDX-License-Identifier: Apache-2.0
// The one exception type of libibr. Thrown by constructors, loaders and solvers; `record` functions never throw.
#pragma once

#include <stdexcept>
#include <string>

namespace ibr {

enum class ErrorCode {
  invalidInput,  // a file or an argument is wrong; the message names file and field
  io,            // a file cannot be read or written; the message names it
  unsupported,   // right, but not something this build or device can do
  outOfMemory,   // host or device memory
  deviceLost,    // Device and everything made from it must be made again; Scene is untouched
  vulkan,        // any other Vulkan failure; the message names call and result
  cancelled,     // a progress callback asked to stop
};

class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace ibr
