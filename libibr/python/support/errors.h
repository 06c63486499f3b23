// SPDX-License-Identifier: Apache-2.0
// The library's exceptions as Python's ibr.Error, with the attribute `code`.
#pragma once

#include <pybind11/pybind11.h>

namespace ibr::python {

/// Adds the class Error to ibr._runtime.
void defineError(pybind11::module_& module);

/// Translates Error and std::filesystem::filesystem_error in this module. Each module calls it.
void translateErrors();

}  // namespace ibr::python
