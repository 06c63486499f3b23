// SPDX-License-Identifier: Apache-2.0
// Loader interface of the fault runtime: hooks its functions between the loader and the runtime behind.
#include "fault_runtime.h"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "loader_interface.h"

namespace ibr::test {

Behind behind;
State* state = nullptr;

bool stands(const char* name) {
  const std::lock_guard lock(state->mutex);
  return state->faults.active(name).has_value();
}

std::string valueOf(const char* name) {
  const std::lock_guard lock(state->mutex);
  return state->faults.active(name).value_or("");
}

std::vector<std::string> split(const std::string& value, char by) {
  std::vector<std::string> words;
  std::istringstream in(value);
  for (std::string word; std::getline(in, word, by);) words.push_back(word);
  return words;
}

namespace {

XrResult getInstanceProcAddr(XrInstance instance, const char* name, PFN_xrVoidFunction* function);

struct Override {
  const char* name;
  PFN_xrVoidFunction ours;
  PFN_xrVoidFunction* theirs;
};

template <class F>
PFN_xrVoidFunction* slot(F& function) {
  return reinterpret_cast<PFN_xrVoidFunction*>(&function);
}

template <class F>
Override over(const char* name, F ours, F& theirs) {
  return {name, reinterpret_cast<PFN_xrVoidFunction>(ours), slot(theirs)};
}

const Override kOverrides[]{
    over("xrEnumerateInstanceExtensionProperties", &enumerateInstanceExtensionProperties,
         behind.enumerateInstanceExtensionProperties),
    over("xrGetInstanceProcAddr", &getInstanceProcAddr, behind.getInstanceProcAddr),
    over("xrCreateInstance", &createInstance, behind.createInstance),
    over("xrGetSystem", &getSystem, behind.getSystem),
    over("xrEnumerateViewConfigurationViews", &enumerateViewConfigurationViews, behind.enumerateViewConfigurationViews),
    over("xrCreateSession", &createSession, behind.createSession),
    over("xrDestroySession", &destroySession, behind.destroySession),
    over("xrBeginSession", &beginSession, behind.beginSession),
    over("xrEndSession", &endSession, behind.endSession),
    over("xrRequestExitSession", &requestExitSession, behind.requestExitSession),
    over("xrPollEvent", &pollEvent, behind.pollEvent),
    over("xrEnumerateReferenceSpaces", &enumerateReferenceSpaces, behind.enumerateReferenceSpaces),
    over("xrCreateReferenceSpace", &createReferenceSpace, behind.createReferenceSpace),
    over("xrCreateActionSpace", &createActionSpace, behind.createActionSpace),
    over("xrLocateSpace", &locateSpace, behind.locateSpace),
    over("xrLocateViews", &locateViews, behind.locateViews),
    over("xrSyncActions", &syncActions, behind.syncActions),
    over("xrEnumerateSwapchainFormats", &enumerateSwapchainFormats, behind.enumerateSwapchainFormats),
    over("xrCreateSwapchain", &createSwapchain, behind.createSwapchain),
    over("xrAcquireSwapchainImage", &acquireSwapchainImage, behind.acquireSwapchainImage),
    over("xrWaitSwapchainImage", &waitSwapchainImage, behind.waitSwapchainImage),
    over("xrReleaseSwapchainImage", &releaseSwapchainImage, behind.releaseSwapchainImage),
    over("xrGetVisibilityMaskKHR", &getVisibilityMask, behind.getVisibilityMask),
    over("xrWaitFrame", &waitFrame, behind.waitFrame),
    over("xrBeginFrame", &beginFrame, behind.beginFrame),
    over("xrEndFrame", &endFrame, behind.endFrame),
};

XrResult getInstanceProcAddr(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
  if (instance && !behind.requestExitSession) {  // called by this runtime, even if the program never uses the function
    behind.getInstanceProcAddr(instance, "xrRequestExitSession", slot(behind.requestExitSession));
    behind.getInstanceProcAddr(instance, "xrEnumerateSwapchainImages", slot(behind.enumerateSwapchainImages));
  }
  const XrResult result = behind.getInstanceProcAddr(instance, name, function);
  if (XR_FAILED(result)) return result;
  for (const Override& one : kOverrides)
    if (std::strcmp(one.name, name) == 0) {
      *one.theirs = *function;
      *function = one.ours;
    }
  return result;
}

const char* variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Prints the reason for a failure.
bool start() {
  try {
    if (!state) state = new State(variable("IBR_XR_FAULTS"), variable("IBR_XR_RECORD"), variable("IBR_XR_PICTURES"));
    return true;
  } catch (const std::invalid_argument& e) {
    std::fprintf(stderr, "IBR_XR_FAULTS: %s\n", e.what());
    return false;
  }
}

}  // namespace
}  // namespace ibr::test

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(
    const ibr::test::XrNegotiateLoaderInfo* loader, ibr::test::XrNegotiateRuntimeRequest* request) {
  using namespace ibr::test;
  if (!start()) return XR_ERROR_INITIALIZATION_FAILED;
  void* library = ::dlopen(variable("IBR_XR_RUNTIME_BEHIND"), RTLD_NOW | RTLD_LOCAL);
  void* symbol = library ? ::dlsym(library, "xrNegotiateLoaderRuntimeInterface") : nullptr;
  if (!symbol) {
    std::fprintf(stderr, "IBR_XR_RUNTIME_BEHIND: %s\n", ::dlerror());
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  const XrResult result = reinterpret_cast<NegotiateRuntime>(symbol)(loader, request);
  if (XR_FAILED(result)) return result;
  behind = {.getInstanceProcAddr = request->getInstanceProcAddr};
  request->getInstanceProcAddr = &getInstanceProcAddr;
  return result;
}
