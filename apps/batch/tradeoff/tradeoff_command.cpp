// SPDX-License-Identifier: Apache-2.0
// `ibr tradeoff`: cost and accuracy of each render setting, and checks of the presets
// (libibr/docs/tradeoff.md).
#include <CLI/CLI.hpp>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "batch/command.h"
#include "batch/command_text.h"
#include "batch/files/file_hash.h"
#include "batch/files/poses.h"
#include "batch/files/sha256.h"
#include "batch/files/truth.h"
#include "batch/tradeoff/tradeoff_html.h"
#include "batch/tradeoff/tradeoff_measure.h"
#include "ibr/metrics.h"
#include "ibr/texture.h"
#include "shared/camera/auto_path.h"
#include "shared/cli/json_text.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/cli/signals.h"
#include "shared/draw/image_operations.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kReferenceViews = 2;

struct Options {
  std::string scene, truth, poses, output, sweep, command;
  std::vector<std::string> only;           // views of the truth
  std::vector<std::string> knobs, builds;  // builds: NAME=SCENE
  int autoViews = 0, shrink = 1, repeat = 9, walk = 3000;
  PictureSize size;
  bool grid = true, list = false, check = false;
};

// Averages shrink × shrink pixels of the truth, and scales the camera.
TradeoffSubject smaller(const TradeoffSubject& whole, int shrink) {
  TradeoffSubject small = whole;
  Intrinsics& k = small.view.camera.intrinsics;
  k.width /= shrink;
  k.height /= shrink;
  for (double* length : {&k.fx, &k.fy, &k.cx, &k.cy}) *length /= shrink;
  small.truth = Image8(k.width, k.height, whole.truth.channels);
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x)
      for (int c = 0; c < whole.truth.channels; ++c) {
        int sum = 0;
        for (int i = 0; i < shrink * shrink; ++i)
          sum += whole.truth.pixel(shrink * x + i % shrink, shrink * y + i / shrink)[std::size_t(c)];
        small.truth.pixel(x, y)[std::size_t(c)] = std::uint8_t((2 * sum + shrink * shrink) / (2 * shrink * shrink));
      }
  return small;
}

std::vector<TradeoffSubject> subjectsOf(const Options& options, const Scene& scene, const Context& context) {
  std::vector<TradeoffSubject> subjects;
  if (!options.truth.empty()) {
    const Truth truth(options.truth, options.only, context.log());
    for (const View& view : truth.views()) subjects.push_back(smaller({view, truth.picture(view)}, options.shrink));
  }
  if (!options.poses.empty())
    for (const View& view : readViews(options.poses, options.size, context.log())) subjects.push_back({view, {}});
  const int automatic = options.autoViews > 0 ? options.autoViews : subjects.empty() ? 5 : 0;
  if (automatic > 0)
    for (const View& view : frames(autoPath(scene, automatic, options.size.width, options.size.height)))
      subjects.push_back({view, {}});
  return subjects;
}

VkExtent2D largestOf(const std::vector<TradeoffSubject>& subjects, const std::vector<View>& walk) {
  VkExtent2D largest{1, 1};
  const auto grow = [&](const Camera& camera) {
    largest.width = std::max(largest.width, std::uint32_t(camera.intrinsics.width));
    largest.height = std::max(largest.height, std::uint32_t(camera.intrinsics.height));
  };
  for (const TradeoffSubject& subject : subjects) grow(subject.view.camera);
  for (const View& view : walk) grow(view.camera);
  return largest;
}

// Scenes by the names of their builds.
struct SceneBuilds {
  std::vector<std::string> names, folders;  // names: without the first scene; folders: of all
  std::vector<Scene> scenes;
};

SceneBuilds sceneBuildsOf(const Options& options) {
  SceneBuilds sceneBuilds{{}, {options.scene}, {}};
  for (const std::string& build : options.builds) {
    const std::size_t at = build.find('=');
    check(at != std::string::npos && at > 0, ErrorCode::invalidInput, "--build {}: must be NAME=SCENE", build);
    sceneBuilds.names.push_back(build.substr(0, at));
    sceneBuilds.folders.push_back(build.substr(at + 1));
  }
  for (const std::string& folder : sceneBuilds.folders) sceneBuilds.scenes.push_back(loadScene(folder));
  return sceneBuilds;
}

// Key of all inputs of images and times, except the setting.
std::uint64_t keyOf(const Options& options, const SceneBuilds& sceneBuilds,
                    const std::vector<TradeoffSubject>& subjects, const Device& device, const Context& context) {
  Hash hash;
  addProgram(hash);
  for (const std::string& folder : sceneBuilds.folders) addFolder(hash, folder);
  for (const auto& [view, truth] : subjects) {
    const Pose& pose = view.camera.pose;
    const Intrinsics& k = view.camera.intrinsics;
    hash.add(view.name);
    for (const double number :
         {pose.position.x, pose.position.y, pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y,
          pose.rotation.z, double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy})
      hash.add(number);
    hash.add(std::as_bytes(std::span(truth.values)));
  }
  hash.add(device.name());
  hash.add(std::int64_t(context.options().threads));
  hash.add(std::int64_t(options.walk));
  return hash.value();
}

// Hash of the names and contents of all files of the scene, sorted by name.
std::string datasetHash(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  std::string all;
  for (const fs::path& file : files)
    all += file.lexically_relative(folder).generic_string() + ' ' + sha256(readFile(file)) + '\n';
  return sha256(std::as_bytes(std::span(all.data(), all.size())));
}

std::string processorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown";
}

Json aboutJson(const Options& options, const SceneBuilds& sceneBuilds, const std::vector<TradeoffSubject>& subjects,
               const Device& device, const Context& context) {
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  const bool software = device.kind() == DeviceKind::software;
  Json views = Json::array();
  for (const auto& [view, truth] : subjects)
    views.push_back({{"name", view.name},
                     {"size", {view.camera.intrinsics.width, view.camera.intrinsics.height}},
                     {"truth", !truth.empty()}});
  return {
      {"libibr", IBR_VERSION},
      {"scene", options.scene},
      {"dataset", datasetHash(options.scene)},
      {"builds", sceneBuilds.names},
      {"truth", options.truth},
      {"shrink", options.shrink},
      {"views", views},
      {"device", device.name()},
      {"software", software},
      {"processor", processorName()},
      {"cores", std::thread::hardware_concurrency()},
      {"limits",
       {{"subTexelPrecisionBits", limits.subTexelPrecisionBits},
        {"mipmapPrecisionBits", limits.mipmapPrecisionBits},
        {"timestampPeriodNs", limits.timestampPeriod}}},
      {"clock",
       "planning: the host's steady clock; drawing: the device's timestamps, from the first command of a frame to the "
       "last, without the copy to the host"},
      {"seed", context.options().seed},
      {"warmUp", 1},
      {"repeat", options.repeat},
      {"order", "interleaved: each round measures all settings once, in random order"},
      {"command", options.command}};
}

std::vector<TradeoffWalk> walksOf(TradeoffRenderer& stage, const std::vector<TradeoffSetting>& settings,
                                  const std::vector<View>& walk, std::uint64_t key, MeasurementCache& kept,
                                  ProgressLine& progress) {
  std::vector<TradeoffWalk> walks;
  for (std::size_t p = 0; p < kPresets.size() && !walk.empty(); ++p) {
    Hash hash;
    hash.add(key);
    hash.add(std::string("walk ") + kPresets[p].first);
    const std::optional<Json> json = kept.find(hash.value());
    try {
      if (json) {
        walks.push_back(walkOf(*json));
        continue;
      }
    } catch (const Json::exception&) {  // damaged line: walked again
    }
    walks.push_back(measureWalk(stage, kPresets[p].first, settings[p].variant, walk, [&] {
      check(progress.show({"walking", p, kPresets.size()}), ErrorCode::cancelled, "stopped");
    }));
    kept.add(hash.value(), walkJson(walks.back()));
  }
  return walks;
}

// Reads the report of `ibr-lab sweep`; null if no file is given.
Json sweepOf(const std::string& file) {
  if (file.empty()) return nullptr;
  const Json json = parsedJson(readTextFile(file));
  const bool good = json.is_object() && json.contains("settings") && json["settings"].is_array() &&
                    std::ranges::all_of(json["settings"], [](const Json& row) {
                      return row.is_object() && row.contains("method") && row["method"].is_string() &&
                             row.contains("setting") && row["setting"].is_string() && row.contains("seconds") &&
                             row.contains("ecc") && row.contains("scores") && row["scores"].is_object() &&
                             row["scores"].contains("psnrCovered");
                    });
  check(good, ErrorCode::invalidInput, "{}: is not a report of ibr-lab sweep (--sweep)", file);
  return json;
}

// Finds the worst view of each preset, against the truth, or against the reference preset if there is no truth.
std::vector<WorstView> worstViews(TradeoffRenderer& stage, const std::vector<TradeoffRow>& rows,
                                  const std::vector<TradeoffSubject>& subjects) {
  std::vector<WorstView> worst;
  for (std::size_t p = 0; p < kPresets.size(); ++p) {
    const auto flipOf = [](const TradeoffView& view) {
      return std::isfinite(view.truth.flip) ? view.truth.flip : view.reference.flip;
    };
    if (!rows[p].failure.empty()) continue;
    const std::vector<TradeoffView>& views = rows[p].views;
    const std::size_t v = std::size_t(std::ranges::max_element(views, {}, flipOf) - views.begin());
    const Camera& camera = subjects[v].view.camera;
    const Image8 picture = stage.picture(rows[p].setting.variant, camera);
    const Image8& truth = subjects[v].truth;
    const Image8 other = truth.empty() ? stage.picture(rows[kReferenceSetting].setting.variant, camera) : truth;
    worst.push_back(
        {kPresets[p].first, views[v].name, flipOf(views[v]), rgb(picture), rgb(other), flipPicture(picture, other)});
  }
  return worst;
}

// Mean over the views with a truth; NaN if there is none.
double sampledDetailOf(const std::vector<TradeoffSubject>& subjects) {
  double sum = 0;
  int count = 0;
  for (const TradeoffSubject& subject : subjects)
    if (!subject.truth.empty()) sum += sampledDetail(subject.truth), ++count;
  return sum / count;
}

// Errors of colour tables, on the first photograph with a texture.
std::vector<MapError> mapErrorsOf(const Scene& scene, std::uint64_t seed) {
  for (const Node& node : scene.nodes)
    if (!node.textureFile.empty())
      return mapErrors(decodeTexture(readKtx2(scene.folder / node.textureFile, 0))[0], seed);
  return {};
}

// Settings that this report does not vary, with the reasons.
std::vector<std::string> missingKnobs(const Options& options, const Scene& scene) {
  std::vector<std::string> missing;
  if (options.sweep.empty())
    missing.emplace_back(
        "settings M, R, D and t of the optimiser: measure these with ibr-lab sweep, then give its report with --sweep "
        "FILE");
  if (options.builds.empty())
    missing.emplace_back(
        "mesh density: build the scene with other options, then give these builds with --build NAME=SCENE");
  if (!hasPlainTextures(scene))
    missing.emplace_back(
        "texture formats: the scene's textures are block-compressed; to compare formats, build the scene with "
        "--texture rgba8");
  missing.emplace_back("precision of the ECC: there is no setting, because sums are exact on every device");
  missing.emplace_back("texture coordinate complements: only harmonised models have these (ibr htm eval)");
  return missing;
}

ExitCode tradeoff(const Options& options, const Context& context) {
  const Json sweep = sweepOf(options.sweep);
  const SceneBuilds sceneBuilds = sceneBuildsOf(options);
  const TradeoffSettings settings =
      tradeoffSettings({deviceKindFor(context.options().device), options.knobs, options.grid,
                        hasPlainTextures(sceneBuilds.scenes[0]), sceneBuilds.names});
  if (options.list) {
    for (const TradeoffSetting& setting : settings.all) context.print("{}\n", setting.name());
    return kExitOk;
  }
  for (const std::string& source : sceneBuilds.folders)
    check(!isInside(options.output, source), ErrorCode::invalidInput,
          "--output {}: lies in {}, whose files identify cached measurements; choose another folder", options.output,
          source);
  const std::vector<TradeoffSubject> subjects = subjectsOf(options, sceneBuilds.scenes[0], context);
  std::vector<View> walk;
  if (options.walk > 0)
    walk = frames(autoPath(sceneBuilds.scenes[0], options.walk, subjects[0].view.camera.intrinsics.width,
                           subjects[0].view.camera.intrinsics.height));
  TradeoffRenderer stage(sceneBuilds.scenes, largestOf(subjects, walk), context);
  makeFolders(options.output);
  const fs::path folder = options.output;
  MeasurementCache kept(folder / "tradeoff.kept.jsonl");
  const std::uint64_t key = keyOf(options, sceneBuilds, subjects, stage.device(), context);
  TradeoffReport report;
  report.knobs = settings.knobs;
  report.about = aboutJson(options, sceneBuilds, subjects, stage.device(), context);
  {
    ProgressLine progress(context);
    TradeoffMeasure measure(stage, subjects, {options.repeat, context.options().seed, key}, kept);
    report.rows = measure.measure(settings.all, [&](std::size_t done, std::size_t total) {
      check(progress.show({"measuring", done, total}), ErrorCode::cancelled, "stopped");
    });
    if (measure.found() > 0)
      context.logMessage(LogLevel::info, "{} of {} measurements are cached", measure.found(),
                         settings.all.size() + std::size_t(options.repeat));
    std::vector<View> first;  // views to compare with the reference implementation, which is slow
    for (std::size_t v = 0; v < std::min(kReferenceViews, subjects.size()); ++v) first.push_back(subjects[v].view);
    report.implementation = implementationErrors(stage, first, [&] { stopIfInterrupted(); });
    report.walks = walksOf(stage, settings.all, walk, key, kept, progress);
  }
  report.mapErrors = mapErrorsOf(sceneBuilds.scenes[0], context.options().seed);
  report.sampledDetail = sampledDetailOf(subjects);
  report.missing = missingKnobs(options, sceneBuilds.scenes[0]);
  const std::vector<TradeoffFigure> figures = tradeoffFigures(report, sweep);
  for (const TradeoffFigure& figure : figures) writeFile(folder / figure.file, figure.svg);
  writeFile(folder / "report.html", tradeoffHtml(report, figures, worstViews(stage, report.rows, subjects), folder));
  const Json json = reportJson(report);
  writeFile(folder / "tradeoff.json", jsonText(json) + '\n');
  writeFile(folder / "tradeoff.csv", tradeoffCsv(report.rows));
  context.print("{}", reportText(report));
  context.report(json);
  const std::vector<TradeoffGate> gates = presetGates(report.rows);
  const bool beaten = std::ranges::any_of(gates, [](const TradeoffGate& gate) { return gate.counted && !gate.holds; });
  return options.check && beaten ? kExitComparison : kExitOk;
}

}  // namespace

const Command kTradeoffCommand{
    .name = "tradeoff",
    .summary = "Measures time, memory and accuracy of each render setting",
    .examples =
        "ibr tradeoff scene -o report\n"
        "ibr tradeoff scene --truth held-out --shrink 2 -o report\n"
        "ibr tradeoff scene --path auto:4 --size 640x360 --knobs cells renderScale --repeat 5 -o report\n"
        "ibr tradeoff scene --truth held-out --build coarse=scene8 fine=scene2 -o report\n"
        "ibr tradeoff scene --list -o report",
    .details =
        "One setting (knob) at a time is varied from the default (--preset balanced). Then the\n"
        "four presets and combinations of the most important settings are measured. Images are\n"
        "rendered once; times are measured in rounds over all settings. Three accuracies are\n"
        "reported separately: against held-out photographs (--truth), against --preset reference,\n"
        "and for the device against a reference implementation in double precision. Views are\n"
        "those of the truth, of --poses and of --path, together. Times are those of the device\n"
        "and of planning, without the copy to the host. Run nothing else on the machine during\n"
        "the measurement.\n"
        "The folder gets tradeoff.json, tradeoff.csv, figures, and report.html, which contains\n"
        "all of them.",
    .afterInterrupt = "finished measurements are cached; run the same command again to resume",
    .mainOptions = "output truth only shrink path size knobs no-grid check json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      app.add_option("-o,--output", options->output, "Folder for the measurements; created if missing")
          ->required()
          ->type_name("DIR");
      auto* truth =
          app.add_option("--truth", options->truth, "Held-out photographs with their poses")->type_name("DIR");
      app.add_option("--only", options->only, "Compare only these views of the truth, by name")
          ->needs(truth)
          ->type_name("NAME...");
      addInt(app, "--shrink", options->shrink, 1, 64,
             "Factor by which the truth's images are reduced: means of N × N px")
          ->needs(truth);
      app.add_option("--poses,--views", options->poses,
                     "File or folder of further views: COLMAP model, "
                     "transforms.json or camera path")
          ->type_name("FILE");
      addAutoPath(app, options->autoViews);
      addSize(app, "--size", options->size,
              "Size of the images of --poses and --path [that of the poses; of the "
              "photographs]");
      app.add_option("--knobs", options->knobs,
                     "Vary only these settings: " + fmt::format("{}", fmt::join(tradeoffKnobNames(), " ")))
          ->type_name("NAME...");
      app.add_flag_callback(
          "--no-grid", [options] { options->grid = false; }, "Measure no combinations of settings");
      app.add_option("--build", options->builds,
                     "Also measure further builds of the same photographs, drawn with "
                     "default settings")
          ->type_name("NAME=SCENE...");
      app.add_option("--sweep", options->sweep,
                     "Also show the results of ibr-lab sweep for this scene, from its "
                     "sweep.json")
          ->type_name("FILE");
      addInt(app, "--repeat", options->repeat, 1, 10'000, "Rounds of time measurements");
      addInt(app, "--walk", options->walk, 0, 1'000'000,
             "Number of frames of a walk through the scene; frames around changes of the main cell are drawn; 0: no "
             "walk");
      app.add_flag("--check", options->check,
                   "Exit with code 6 if a preset does not meet its guarantees for counts and images; times are not "
                   "checked");
      app.add_flag("--list", options->list, "Only list the settings");
      app.callback([options, &app] {
        if (options->knobs == std::vector<std::string>{"default"}) options->knobs.clear();
        for (const std::string& knob : options->knobs) {
          const std::vector<std::string> names = tradeoffKnobNames();
          if (std::ranges::find(names, knob) == names.end())
            throw CLI::ValidationError(
                "--knobs", "unknown setting '" + knob + "'; choose from " + fmt::format("{}", fmt::join(names, ", ")));
        }
        options->command = commandText("ibr tradeoff", givenArguments(app));
      });
      return [options](const Context& context) { return tradeoff(*options, context); };
    }};

}  // namespace ibr::app
