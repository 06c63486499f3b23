// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/build/build_options.h"
#include "batch/command.h"
#include "batch/doctor/findings.h"
#include "ibr/asset.h"
#include "ibr/htm_sequence.h"
#include "ibr/scene.h"
#include "io/image_file.h"
#include "shared/cli/options.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr std::size_t kMaxFaults = 100;

void examineAsset(const std::string& path, AssetKind kind, Findings& findings) {
  const auto faults = kind == AssetKind::htmModel      ? validateHtmModelFiles(path, kMaxFaults)
                      : kind == AssetKind::htmSequence ? validateHtmSequenceFiles(path, kMaxFaults)
                                                       : validateSceneFiles(path, kMaxFaults);
  for (const Fault& fault : faults)
    findings.add({"fault", Severity::serious, fmt::format("{}: {}.", fault.field, fault.message),
                  "Repeat the build, or restore the changed files.", kExitInvalidInput});
  if (!faults.empty()) return;
  if (kind != AssetKind::scene) {
    findings.fact("all files are valid");
    return;
  }
  const Scene scene = loadScene(path);
  const CaptureAdvice advice = adviseCapture(scene);
  findings.fact(fmt::format("{} photographs, {} cells; all files are valid", scene.nodes.size(), scene.cells.size()));
  if (!advice.views.empty())
    findings.fact(
        fmt::format("on a walk between the photographs, about {:.0f} % of an image is shown well; ibr info {} --advice "
                    "lists where more photographs help",
                    100 * advice.coverage, path));
  for (const Advice& one : advice.advice)
    findings.add({adviceKindName(one.kind), one.severity, one.problem, one.remedy, kExitInvalidInput});
}

ExitCode examine(const std::string& path, const BuildChoices& choices, const Context& context) {
  const bool beside = !choices.model.empty() || !choices.build.masks.empty();
  check(!beside || (!path.empty() && !assetKind(path)), ErrorCode::invalidInput,
        "--model and --masks need a folder of photographs");
  Findings findings;
  std::error_code ignored;
  if (path.empty()) {
    examineMachine(findings, context);
  } else if (const auto kind = assetKind(path)) {
    examineAsset(path, *kind, findings);
  } else {
    check(fs::exists(path, ignored), ErrorCode::io, "{}: no such file or folder", path);
    check(fs::is_directory(path, ignored), ErrorCode::unsupported,
          "{}: is neither a folder of photographs nor a scene; for an image, use ibr info", path);
    examinePhotographs(path, choices, findings, context);
  }
  findings.print(context);
  nlohmann::ordered_json json = findings.json();
  json["path"] = path.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(path);
  context.report(json);
  return findings.code();
}

}  // namespace

const Command kDoctorCommand{
    .name = "doctor",
    .summary = "Diagnoses this machine, a folder of photographs or a scene, and suggests remedies",
    .examples =
        "ibr doctor\nibr doctor --json -\nibr doctor photographs\nibr doctor photographs --model colmap/sparse/0 "
        "--masks masks\n"
        "ibr doctor scene\nibr doctor photographs --json findings.json",
    .details =
        "Prints findings with remedies, the most serious first: !! is serious, ! makes images\n"
        "worse, - is a hint. The exit code is 0 if no finding is serious. Other exit codes: 3 for\n"
        "photographs and scenes; 5 without a usable Vulkan device; 2 for a full disk or a missing\n"
        "folder. --device takes the number of a Vulkan device, or part of its name.",
    .afterInterrupt = "",
    .mainOptions = "model masks json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto path = std::make_shared<std::string>();
      addOption(app, "FOLDER_OR_SCENE", *path, "Folder of photographs, or scene [this machine]");
      const auto choices = std::make_shared<BuildChoices>();
      declareInputOptions(app, *choices);
      return [path, choices](const Context& context) { return examine(*path, *choices, context); };
    }};

}  // namespace ibr::app
