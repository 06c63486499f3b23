// SPDX-License-Identifier: Apache-2.0
#include "lab/stream/driver_time.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/usage.h"
#include "base/vulkan/functions.h"
#include "ibr/device.h"

namespace ibr::app {
namespace {

thread_local double spent = 0;
double measuringSeconds = 0;  // time of a measurement outside the measured interval, s

class Measurement {
 public:
  Measurement() : begin_(threadSeconds()) {}
  Measurement(const Measurement&) = delete;
  Measurement& operator=(const Measurement&) = delete;
  ~Measurement() { spent += threadSeconds() - begin_ + measuringSeconds; }

 private:
  double begin_;
};

// A function of Vulkan with its measured replacement. `Name`: distinguishes functions of one type.
template <class Function, int Name>
struct Measured;
template <class Result, class... Arguments, int Name>
struct Measured<Result(VKAPI_PTR*)(Arguments...), Name> {
  static inline Result(VKAPI_PTR* real)(Arguments...) = nullptr;
  static Result VKAPI_PTR call(Arguments... arguments) {
    const Measurement measurement;
    return real(arguments...);
  }
};

PFN_vkGetInstanceProcAddr loaderFunction() {
  static void* const loader = dlopen("libvulkan.so.1", RTLD_NOW);
  check(loader != nullptr, ErrorCode::unsupported, "libvulkan.so.1 is not installed");
  return reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader, "vkGetInstanceProcAddr"));
}

enum Names : int {
#define IBR_NUMBER(name) k_##name,
  IBR_CORE_FUNCTIONS(IBR_NUMBER)
#undef IBR_NUMBER
};

PFN_vkVoidFunction VKAPI_PTR measuredFunction(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction function = loaderFunction()(instance, name);
#define IBR_REPLACE(replaced)                                                                   \
  if (function && std::strcmp(name, #replaced) == 0) {                                          \
    Measured<PFN_##replaced, k_##replaced>::real = reinterpret_cast<PFN_##replaced>(function);  \
    return reinterpret_cast<PFN_vkVoidFunction>(&Measured<PFN_##replaced, k_##replaced>::call); \
  }
  IBR_CORE_FUNCTIONS(IBR_REPLACE)
#undef IBR_REPLACE
  return function;
}

}  // namespace

void measureDriverTime() {
  constexpr int kRounds = 50, kMeasurements = 2000;
  double least = std::numeric_limits<double>::infinity();  // of the rounds: others were disturbed
  for (int round = 0; round < kRounds; ++round) {
    const double before = spent, begin = threadSeconds();
    for (int i = 0; i < kMeasurements; ++i) {
      const Measurement measurement;
    }
    least = std::min(least, (threadSeconds() - begin - (spent - before)) / kMeasurements);
  }
  measuringSeconds = std::max(least, 0.0);
  Device::loadFunctions(measuredFunction);
}

double driverSeconds() {
  return spent;
}

}  // namespace ibr::app
