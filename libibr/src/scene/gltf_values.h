// SPDX-License-Identifier: Apache-2.0
// Values of glTF documents that the readers of scenes and of harmonised models share, and where their faults go.
#pragma once

#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "ibr/camera.h"
#include "ibr/scene.h"
#include "scene/gltf_document.h"

namespace ibr {

// Each is a JsonFault where the value is not what the name says.
double positive(const JsonValue& value);
double within(const JsonValue& value, double low, double high);
glm::dvec3 vector3(const JsonValue& value);
glm::dquat quaternion(const JsonValue& value);  // of length 1, normalised within 1e-3
Intrinsics intrinsicsOf(const JsonValue& json);

/// The content of the document's extension of that name; a newer version of it than `newest` is a fault.
JsonValue extensionOf(const GltfDocument& document, const char* name, int newest);

/// Name and camera of a list's entry with members "node" and "camera".
struct NamedCamera {
  std::string name;
  Camera camera;
};
NamedCamera namedCamera(const GltfDocument& document, const JsonValue& entry);

/// Calls steps; a fault is thrown as an Error that names the file, or kept where faults are collected.
class FaultSink {
 public:
  FaultSink(std::filesystem::path file, std::vector<Fault>* faults, std::size_t limit)
      : file_(std::move(file)), faults_(faults), limit_(limit) {}

  /// Whether there was none.
  template <class Step>
  bool run(Step&& step) {
    try {
      step();
      return true;
    } catch (const JsonFault& fault) {
      if (!faults_)
        fail(ErrorCode::invalidInput, "{}: {}{}{}", file_.string(), fault.pointer(),
             fault.pointer().empty() ? "" : ": ", fault.what());
      add(fault.pointer(), fault.what());
    } catch (const Error& error) {
      if (!faults_) throw;
      add("", error.what());
    }
    return false;
  }
  void add(std::string field, std::string message) {
    if (faults_->size() < limit_) faults_->push_back({std::move(field), std::move(message)});
  }
  bool full() const { return faults_ && faults_->size() >= limit_; }

 private:
  std::filesystem::path file_;
  std::vector<Fault>* faults_;
  std::size_t limit_;
};

}  // namespace ibr
