// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/command.h"
#include "ibr/asset.h"
#include "ibr/htm_sequence.h"
#include "ibr/scene.h"
#include "shared/cli/options.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFaults = 1000;

ExitCode validateFiles(const std::string& scene, const Context& context) {
  const auto kind = assetKind(scene);
  const auto faults = kind == AssetKind::htmModel      ? validateHtmModelFiles(scene, kMaxFaults)
                      : kind == AssetKind::htmSequence ? validateHtmSequenceFiles(scene, kMaxFaults)
                                                       : validateSceneFiles(scene, kMaxFaults);
  Json report{{"scene", scene}, {"faults", Json::array()}};
  for (const Fault& fault : faults) {
    context.print("{}: {}\n", fault.field, fault.message);
    report["faults"].push_back({{"field", fault.field}, {"message", fault.message}});
  }
  if (faults.empty())
    context.print("{}: no fault\n", scene);
  else
    context.print("{}: {}{} fault{}\n", scene, faults.size() == kMaxFaults ? "at least " : "", faults.size(),
                  faults.size() == 1 ? "" : "s");
  context.report(report);
  return faults.empty() ? kExitOk : kExitInvalidInput;
}

}  // namespace

const Command kValidateCommand{
    .name = "validate",
    .summary = "Lists all faults of a scene, a harmonised model or 3D video, with their location",
    .examples = "ibr validate scene\nibr validate scene --json faults.json\nibr validate model\nibr validate video",
    .details = "The exit code is 3 if there is a fault.",
    .afterInterrupt = "",
    .mainOptions = "json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto scene = std::make_shared<std::string>();
      addOption(app, "SCENE", *scene, "Folder of a scene, a model or 3D video, or its .gltf or sequence.json")
          .required();
      return [scene](const Context& context) { return validateFiles(*scene, context); };
    }};

}  // namespace ibr::app
