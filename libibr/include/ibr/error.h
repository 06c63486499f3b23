// SPDX-License-Identifier: Apache-2.0
// The exception type of libibr. Constructors, loaders and solvers throw it; `record` functions never throw.
#pragma once

#include <stdexcept>
#include <string>

#include "ibr/export.h"

namespace ibr {

/// Cause of an Error.
enum class ErrorCode {
  invalidInput,  // a file or an argument is wrong; the message names file and field
  io,            // a file cannot be read or written; the message names the file
  unsupported,   // valid input that this build or device cannot handle
  outOfMemory,   // host or device memory
  deviceLost,    // the Device and all objects made from it must be recreated; the Scene remains valid
  vulkan,        // any other Vulkan failure; the message names call and result
  cancelled,     // a progress callback returned false, or a stop was requested
};

/// Exception of libibr. what() is the message, for people.
class IBR_API Error : public std::runtime_error {
 public:
  /// Makes an error. The message names the file or field, what happened and what to do.
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }  // cause of the error

 private:
  ErrorCode code_;
};

}  // namespace ibr
