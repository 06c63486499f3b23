// SPDX-License-Identifier: Apache-2.0
// Values of glTF documents that the readers of scenes and of harmonised models share, and where their faults go.
#pragma once

#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <map>
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

/// Versions of a document that are read, and what to do about an older one.
struct ReadVersions {
  int oldest = 1, newest = 1;
  const char* remedy = "";
};
/// A member "version" outside of `read` is a fault.
void checkVersion(const JsonValue& json, const ReadVersions& read);
/// The content of the document's extension of that name, its version checked.
JsonValue extensionOf(const GltfDocument& document, const char* name, const ReadVersions& read);

/// Name and camera of a list's entry with members "node" and "camera".
struct NamedCamera {
  std::string name;
  Camera camera;
};
NamedCamera namedCamera(const GltfDocument& document, const JsonValue& entry);

/// The file itself, or of a folder the file of that name in it.
std::filesystem::path documentFile(const std::filesystem::path& path, const char* name);

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

/// Reads a list's entries, each of which has a "node" and a name of its own. Where one of them cannot be read, the list
/// is at fault, since its `dependents` refer to it. `what`: an entry. `items` is empty before.
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
  if (items.size() != list.size()) list.fault(fmt::format("has faults, so {} were not looked at", dependents));
}

/// What `readAll` makes of a file that has no faults. Throws Error, which names the file and its first fault.
template <class Content>
Content loadDocument(const std::filesystem::path& file,
                     Content (*readAll)(const std::filesystem::path& file, FaultSink& sink)) {
  FaultSink sink(file, nullptr, 0);
  Content content;
  sink.run([&] { content = readAll(file, sink); });
  // readAll has checked all of this; if it ever missed something, nothing wrong may go on to a renderer.
  if (const std::vector<Fault> faults = validate(content, 1); !faults.empty())
    fail(ErrorCode::invalidInput, "{}: {} {}", file.string(), faults[0].field, faults[0].message);
  return content;
}

/// The faults of a file and of those it refers to.
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
