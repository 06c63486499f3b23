// SPDX-License-Identifier: Apache-2.0
// The Python module ibr._runtime.
#include "ibr/version.h"
#include "runtime/bind.h"
#include "support/errors.h"

PYBIND11_MODULE(_runtime, module) {
  using namespace ibr::python;
  module.doc() = "The runtime of libibr; import it as ibr.";
  module.attr("__version__") = std::string(ibr::version());
  bindEnums(module);
  defineError(module);
  translateErrors();
  bindCamera(module);
  bindScene(module);
  bindAdvice(module);
  bindSettings(module);
  bindPlan(module);
  bindDevice(module);
  bindRender(module);
  bindMetrics(module);
  bindHtm(module);
  bindOptimiser(module);
}
