// SPDX-License-Identifier: Apache-2.0
// Values of glTF documents that the readers of scenes and of harmonised models share, and the collection of faults.
#pragma once

#include <algorithm>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/check.h"
#include "ibr/camera.h"
#include "ibr/scene.h"
#include "scene/gltf_document.h"

namespace ibr {

// Each throws JsonFault if the value does not fit the function's name.
double positive(const JsonValue& value);
double within(const JsonValue& value, double low, double high);
glm::dvec3 vector3(const JsonValue& value);
glm::dquat quaternion(const JsonValue& value);  // of length 1, normalised within 1e-3
Intrinsics intrinsicsOf(const JsonValue& json);

/// Supported versions of a document, and the remedy for an older one.
struct SupportedVersions {
  int oldest = 1, newest = 1;
  const char* remedy = "";
};
/// Throws JsonFault if the member "version" is not one of the supported versions.
void checkVersion(const JsonValue& json, const SupportedVersions& supported);
/// Content of the document's extension `name`, after a check of its version.
JsonValue extensionOf(const GltfDocument& document, const char* name, const SupportedVersions& supported);

/// Name and camera of a list entry with members "node" and "camera".
struct NamedCamera {
  std::string name;
  Camera camera;
};
NamedCamera namedCamera(const GltfDocument& document, const JsonValue& entry);

/// Returns `path` if it is a file, or for a folder the file `name` in it.
std::filesystem::path documentFile(const std::filesystem::path& path, const char* name);

/// Runs steps; a fault is thrown as an Error with the file's name, or stored if faults are collected.
class FaultSink {
 public:
  FaultSink(std::filesystem::path file, std::vector<Fault>* faults, std::size_t limit)
      : file_(std::move(file)), faults_(faults), limit_(limit) {}

  /// Returns true if the step had no fault.
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
  /// A fault that is already listed is not added again.
  void add(const std::string& field, const std::string& message) {
    const auto listed = [&](const Fault& fault) { return fault.field == field && fault.message == message; };
    if (!full() && std::ranges::none_of(*faults_, listed)) faults_->push_back({field, message});
  }
  bool full() const { return faults_ && faults_->size() >= limit_; }

 private:
  std::filesystem::path file_;
  std::vector<Fault>* faults_;
  std::size_t limit_;
};

/// Reads a list's entries, each of which has a "node" and a unique name. If an entry cannot be read, the list has a
/// fault, since `dependents` refer to its entries. `what` and `dependents`: names of an entry and of these, for
/// messages. `items` must be empty.
template <class Item, class Read>
void readNamed(const JsonValue& list, const char* what, const char* dependents, std::vector<Item>& items,
               FaultSink& sink, Read&& read) {
  std::map<std::string, std::size_t> names;
  for (std::size_t i = 0; i < list.size() && !sink.full(); ++i)
    sink.run([&] {
      items.push_back(read(list.at(i)));
      if (const auto [first, isNew] = names.emplace(items.back().name, i); !isNew)
        list.at(i)["node"].fault(fmt::format("\"{}\" is also the name of {} {}", first->first, what, first->second));
    });
  if (items.size() != list.size()) list.fault(fmt::format("has faults, so {} were not checked", dependents));
}

/// Loads a document without faults by `readAll`. Throws Error with the file and its first fault. `firstFault` returns
/// the faults of the content, one at most.
template <class ReadAll, class FirstFault>
auto loadDocument(const std::filesystem::path& file, ReadAll&& readAll, FirstFault&& firstFault) {
  FaultSink sink(file, nullptr, 0);
  std::invoke_result_t<ReadAll, const std::filesystem::path&, FaultSink&> content;
  sink.run([&] { content = readAll(file, sink); });
  // readAll has made all these checks; this one protects renderers against a gap in them.
  if (const std::vector<Fault> faults = firstFault(content); !faults.empty())
    fail(ErrorCode::invalidInput, "{}: {} {}", file.string(), faults[0].field, faults[0].message);
  return content;
}

/// Returns the faults of a file and of the files that it refers to.
template <class Content>
std::vector<Fault> faultsOfDocument(const std::filesystem::path& file, std::size_t limit,
                                    Content (*readAll)(const std::filesystem::path& file, FaultSink& sink),
                                    void (*checkFiles)(const Content& content, FaultSink& sink)) {
  std::vector<Fault> faults;
  FaultSink sink(file, &faults, limit);
  sink.run([&] {
    const Content content = readAll(file, sink);
    checkFiles(content, sink);
    if (faults.empty()) faults = validate(content, limit);
  });
  return faults;
}

}  // namespace ibr
