// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/functions.h"

#include <dlfcn.h>

#include <mutex>
#include <string_view>
#include <vector>

#include "base/check.h"

namespace ibr {

PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
#define IBR_DEFINE(name) PFN_##name name = nullptr;
IBR_GLOBAL_FUNCTIONS(IBR_DEFINE)
IBR_CORE_FUNCTIONS(IBR_DEFINE)
IBR_WINDOW_FUNCTIONS(IBR_DEFINE)
#undef IBR_DEFINE

namespace {

constexpr const char* kLoader = "libvulkan.so.1";

enum class Kind { global, core, window };

struct Function {
  const char* name;
  Kind kind;
  void (*set)(PFN_vkVoidFunction);
};

#define IBR_FUNCTION(name, kind) \
  {#name, kind, [](PFN_vkVoidFunction pointer) { ibr::name = reinterpret_cast<PFN_##name>(pointer); }},
#define IBR_GLOBAL_FUNCTION(name) IBR_FUNCTION(name, Kind::global)
#define IBR_CORE_FUNCTION(name) IBR_FUNCTION(name, Kind::core)
#define IBR_WINDOW_FUNCTION(name) IBR_FUNCTION(name, Kind::window)
constexpr Function kFunctions[]{IBR_GLOBAL_FUNCTIONS(IBR_GLOBAL_FUNCTION) IBR_CORE_FUNCTIONS(IBR_CORE_FUNCTION)
                                    IBR_WINDOW_FUNCTIONS(IBR_WINDOW_FUNCTION)};

enum class Loaded { none, global, all };

std::mutex mutex;  // guards the functions while they are loaded
Loaded loaded = Loaded::none;

/// Sets the functions that `wanted` selects to find(function), or none of them if a required one is missing.
template <class Wanted, class Find>
void load(std::string_view source, const Wanted& wanted, const Find& find) {
  std::vector<PFN_vkVoidFunction> found;
  for (const Function& function : kFunctions) {
    found.push_back(wanted(function) ? find(function) : nullptr);
    check(found.back() || !wanted(function) || function.kind == Kind::window, ErrorCode::unsupported,
          "{} has no function {}: libibr needs Vulkan 1.3", source, function.name);
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    if (wanted(kFunctions[i])) kFunctions[i].set(found[i]);
}

/// As above; global functions have no instance.
template <class Wanted>
void loadFrom(PFN_vkGetInstanceProcAddr caller, VkInstance instance, const Wanted& wanted) {
  load("the caller's vkGetInstanceProcAddr", wanted, [&](const Function& function) {
    return caller(function.kind == Kind::global ? VK_NULL_HANDLE : instance, function.name);
  });
}

/// Loads all functions from libvulkan.so.1, which stays open.
void loadDefault() {
  void* library = ::dlopen(kLoader, RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* reason = ::dlerror();
    fail(ErrorCode::unsupported, "the Vulkan loader {} cannot be opened (Debian: install libvulkan1): {}", kLoader,
         reason ? reason : "no reason is given");
  }
  const auto symbol = [&](const char* name) { return ::dlsym(library, name); };
  const auto entry = reinterpret_cast<PFN_vkGetInstanceProcAddr>(symbol("vkGetInstanceProcAddr"));
  check(entry, ErrorCode::unsupported, "{} has no function vkGetInstanceProcAddr", kLoader);
  load(
      kLoader, [](const Function&) { return true; },
      [&](const Function& function) { return reinterpret_cast<PFN_vkVoidFunction>(symbol(function.name)); });
  vkGetInstanceProcAddr = entry;
  loaded = Loaded::all;
}

}  // namespace

void loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance) {
  check(getInstanceProcAddr, ErrorCode::invalidInput, "loadFunctions: vkGetInstanceProcAddr is null");
  const std::lock_guard lock(mutex);
  loadFrom(getInstanceProcAddr, instance, [&](const Function& f) { return instance || f.kind == Kind::global; });
  vkGetInstanceProcAddr = getInstanceProcAddr;
  loaded = instance ? Loaded::all : Loaded::global;
}

void ensureGlobalFunctions() {
  const std::lock_guard lock(mutex);
  if (loaded == Loaded::none) loadDefault();
}

void ensureFunctions(VkInstance instance) {
  const std::lock_guard lock(mutex);
  if (loaded == Loaded::none) loadDefault();
  if (loaded == Loaded::all) return;
  check(instance, ErrorCode::invalidInput,
        "Vulkan's functions are not loaded: pass the instance to Device::loadFunctions");
  loadFrom(vkGetInstanceProcAddr, instance, [](const Function& f) { return f.kind != Kind::global; });
  loaded = Loaded::all;
}

}  // namespace ibr
