// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "batch/command.h"
#include "batch/inspect/advice_report.h"
#include "batch/inspect/depth_pictures.h"
#include "batch/inspect/metadata_report.h"
#include "batch/inspect/model_info.h"
#include "batch/inspect/unused_photographs.h"
#include "batch/pictures/picture_info.h"
#include "ibr/asset.h"
#include "ibr/memory_demand.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "io/image_file.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/report/graph_svg.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, svg, advicePoses, depth;
  bool explain = false, advice = false;

  bool isForScenes() const { return explain || !depth.empty() || wantsAdvice(); }
  bool wantsAdvice() const { return advice || !svg.empty() || !advicePoses.empty(); }
};

using Memory = MemoryDemand;

// Measures by loading the scene. Skipped if the prediction exceeds the device's largest heap: a software device would
// take main memory instead.
std::optional<Memory> measuredMemory(const Scene& scene, std::uint64_t predicted, const Context& context) {
  try {
    Device device = Device::create({.device = context.options().device, .log = context.log()});
    std::uint64_t largestHeap = 0;
    const VkPhysicalDeviceMemoryProperties& properties = device.memoryProperties();
    for (std::uint32_t i = 0; i < properties.memoryHeapCount; ++i)
      largestHeap = std::max<std::uint64_t>(largestHeap, properties.memoryHeaps[i].size);
    if (predicted <= largestHeap) {
      // Keeps the stored formats, which the prediction assumes.
      const GpuScene gpuScene(device, scene, {.blocks = BlockTextureMode::keep, .log = context.log()});
      const GpuScene::Memory memory = gpuScene.memory();
      return Memory{memory.positions, memory.indices, memory.textures, memory.depth};
    }
    context.logMessage(LogLevel::info, "memory was not measured: {} needs {}, {} has {}", scene.folder.string(),
                       bytesText(double(predicted)), device.name(), bytesText(double(largestHeap)));
  } catch (const Error& e) {
    context.logMessage(LogLevel::info, "memory was not measured: {}", e.what());
  }
  return std::nullopt;
}

// Returns RGBA8 if the formats cannot be read: info reports as much as possible of an incomplete scene.
std::vector<TextureFormat> formatsOf(const Scene& scene, const Context& context) {
  try {
    return textureFormats(scene);
  } catch (const Error& e) {
    context.logMessage(LogLevel::warning, "textures are assumed to be RGBA8: {}", e.what());
    return std::vector<TextureFormat>(scene.nodes.size(), TextureFormat::rgba8);
  }
}

// Returns 0 if the depth textures cannot be read.
std::uint64_t depthBytesOf(const Scene& scene, const Context& context) {
  try {
    return depthTextureBytes(scene);
  } catch (const Error& e) {
    context.logMessage(LogLevel::warning, "depth textures are not counted: {}", e.what());
    return 0;
  }
}

struct Summary {
  std::array<std::size_t, 5> cellsByMembers{};
  std::size_t points = 0, pointsAtInfinity = 0, triangles = 0, tier0 = 0;
  std::size_t backdropPoints = 0, backdropTriangles = 0;
  double backdropKnown = 0;                     // mean share of their depths that was matched
  std::size_t withEvidence = 0, confirmed = 0;  // points of backdrops: with evidence; confirmed by a photograph
  std::map<std::pair<int, int>, std::size_t> sizes;
};

Summary summarise(const Scene& scene) {
  Summary summary;
  for (const Cell& cell : scene.cells) {
    ++summary.cellsByMembers[std::min<std::size_t>(cell.members.size(), 4)];
    summary.points += cell.mesh.vertexCount();
    summary.pointsAtInfinity += std::size_t(std::ranges::count(cell.mesh.inverseDistance, 0.0f));
    summary.triangles += cell.mesh.triangles.size();
    summary.tier0 += cell.mesh.tier0Count();
  }
  for (const Cell& backdrop : scene.backdrops) {
    summary.backdropPoints += backdrop.mesh.vertexCount();
    summary.backdropTriangles += backdrop.mesh.triangles.size();
    const auto& counts = backdrop.mesh.confirmations;
    summary.withEvidence += counts.size();
    summary.confirmed += counts.size() - std::size_t(std::ranges::count(counts, std::uint8_t(0)));
    summary.backdropKnown += backdrop.quality.coverage / double(scene.backdrops.size());
  }
  for (const Node& node : scene.nodes) ++summary.sizes[{node.camera.intrinsics.width, node.camera.intrinsics.height}];
  return summary;
}

// Share of a photograph that its mask excludes; NaN if the mask cannot be read.
double maskedShare(const Scene& scene, const Node& node, const Context& context) {
  try {
    const Image8 mask = readImage(scene.folder / node.maskFile);
    std::size_t ignored = 0;
    for (std::size_t p = 0; p < mask.values.size(); p += std::size_t(mask.channels)) ignored += mask.values[p] == 0;
    return double(ignored) * mask.channels / double(mask.values.size());
  } catch (const Error& e) {
    context.logMessage(LogLevel::warning, "{}", e.what());
    return std::nan("");
  }
}

// Reports the photographs with a mask and the masked shares.
void showMasks(const Scene& scene, const Context& context, Json& report) {
  report["masks"] = Json::array();
  Table masks;
  masks.row({"masked photograph", "share", "mask"});
  for (const Node& node : scene.nodes) {
    if (node.maskFile.empty()) continue;
    const double share = maskedShare(scene, node, context);
    masks.row({node.name, numberText(share, 4), node.maskFile.string()});
    report["masks"].push_back({{"photograph", node.name}, {"share", share}, {"file", node.maskFile.string()}});
  }
  if (!report["masks"].empty()) context.print("{}\n", masks.text());
}

std::vector<std::string> memberNames(const Scene& scene, const Cell& cell) {
  std::vector<std::string> names;
  for (const std::uint32_t member : cell.members) names.push_back(scene.nodes[member].name);
  return names;
}

void showExposures(const Scene& scene, Json& report, const Context& context) {
  double least = 1, most = 1;
  std::size_t known = 0;
  Json& exposures = report["exposures"] = Json::array();
  for (const Node& node : scene.nodes) {
    Json line{{"photograph", node.name}, {"gain", {node.gain.r, node.gain.g, node.gain.b}}};
    if (const auto exposure = relativeExposure(node.capture)) line["relativeExposure"] = *exposure;
    exposures.push_back(std::move(line));
    known += node.gain != glm::dvec3(1.0);
    least = std::min({least, node.gain.r, node.gain.g, node.gain.b});
    most = std::max({most, node.gain.r, node.gain.g, node.gain.b});
  }
  context.print("exposures    ");
  if (known > 0)
    context.print("{} measured, gains {:.3f} to {:.3f}\n", known, least, most);
  else
    context.print("none measured\n");
}

// Called last: poses of panoramas cannot be written, which is reported after all other output.
void writePosesToAdd(const std::string& file, const CaptureAdvice& advice, const Context& context) {
  if (advice.views.empty()) {
    context.logMessage(LogLevel::warning, "no next-best views found: {} is not written", file);
    return;
  }
  writeNextViews(file, advice);
  context.logMessage(LogLevel::info, "next-best views written to {}", file);
}

ExitCode showScene(const Options& options, const Context& context) {
  if (isImageFile(options.scene)) {
    check(!options.isForScenes(), ErrorCode::unsupported,
          "{} is an image: --explain, --advice, --svg and --depth need a scene", options.scene);
    return showPicture(options.scene, context);
  }
  if (const auto kind = assetKind(options.scene); kind && *kind != AssetKind::scene) {
    check(!options.isForScenes(), ErrorCode::unsupported,
          "{} is not a scene: --explain, --advice, --svg and --depth need a scene", options.scene);
    return *kind == AssetKind::htmModel ? showModel(options.scene, context) : showSequence(options.scene, context);
  }
  const Scene scene = loadScene(options.scene);
  const Summary summary = summarise(scene);
  const std::vector<TextureFormat> formats = formatsOf(scene, context);
  const std::uint64_t depthBytes = depthBytesOf(scene, context);
  const Memory predicted = memoryDemand(scene, formats, depthBytes);
  const std::optional<Memory> measured = measuredMemory(scene, predicted.sum(), context);

  Json report{{"scene", options.scene},
              {"acquisition", scene.acquisition},
              {"photographs", scene.nodes.size()},
              {"points", summary.points},
              {"pointsAtInfinity", summary.pointsAtInfinity},
              {"triangles", summary.triangles},
              {"tier0", summary.tier0},
              {"cells", Json::array()},
              {"unused", unusedJson(scene.unusedPhotographs)}};
  Table cells;
  cells.row({"cell", "photographs", "points", "triangles", "tier 0", "coverage", "ECC", "residual px", "score"});
  for (std::size_t i = 0; i < scene.cells.size(); ++i) {
    const Cell& cell = scene.cells[i];
    const auto names = memberNames(scene, cell);
    std::string joined;
    for (const std::string& name : names) joined += (joined.empty() ? "" : " ") + name;
    cells.row({fmt::format("{}", i), joined, fmt::format("{}", cell.mesh.vertexCount()),
               fmt::format("{}", cell.mesh.triangles.size()), fmt::format("{}", cell.mesh.tier0Count()),
               numberText(cell.quality.coverage, 3), numberText(cell.quality.ecc, 3),
               numberText(cell.quality.residualPx, 2), numberText(cell.quality.score, 3)});
    report["cells"].push_back({{"members", names},
                               {"points", cell.mesh.vertexCount()},
                               {"triangles", cell.mesh.triangles.size()},
                               {"tier0", cell.mesh.tier0Count()},
                               {"coverage", cell.quality.coverage},
                               {"ecc", cell.quality.ecc},
                               {"residualPx", cell.quality.residualPx},
                               {"score", cell.quality.score}});
  }
  context.print("{}\n", cells.text());
  context.print("{}", unusedText(scene.unusedPhotographs));
  showMasks(scene, context, report);

  context.print("photographs  {}", scene.nodes.size());
  for (const auto& [size, count] : summary.sizes) context.print(", {} of {}×{}", count, size.first, size.second);
  std::map<TextureFormat, std::size_t> stored;
  for (const TextureFormat format : formats) ++stored[format];
  context.print("\ntextures    ");
  for (const auto& [format, count] : stored)
    context.print(" {} in {}{}", count, textureFormatName(format), format == stored.rbegin()->first ? "" : ",");
  context.print("\ncells        {}: {} lines, {} triangles, {} tetrahedra\n", scene.cells.size(),
                summary.cellsByMembers[2], summary.cellsByMembers[3], summary.cellsByMembers[4]);
  context.print("points       {}, {} of them at infinity\n", summary.points, summary.pointsAtInfinity);
  context.print("triangles    {}, {} of them tier 0\n", summary.triangles, summary.tier0);
  showExposures(scene, report, context);
  const std::size_t backdropBytes =
      4 * sizeof(float) * summary.backdropPoints + 3 * sizeof(std::uint32_t) * summary.backdropTriangles;
  context.print("backdrops    {}", scene.backdrops.size());
  if (!scene.backdrops.empty())
    context.print(": {} points, {} triangles, {}; {:.0f} % of their depth was matched", summary.backdropPoints,
                  summary.backdropTriangles, bytesText(double(backdropBytes)), 100 * summary.backdropKnown);
  const double confirmed =
      summary.withEvidence > 0 ? double(summary.confirmed) / double(summary.withEvidence) : std::nan("");
  if (summary.withEvidence > 0) context.print(", {:.0f} % of their points confirmed", 100 * confirmed);
  const auto depths = std::ranges::count_if(scene.nodes, [](const Node& node) { return !node.depthFile.empty(); });
  context.print("\ndepth        {}", depths);
  if (depths > 0) context.print(" textures, {}", bytesText(double(depthBytes)));
  context.print("\n");
  report["backdrops"] = {{"count", scene.backdrops.size()},        {"points", summary.backdropPoints},
                         {"triangles", summary.backdropTriangles}, {"bytes", backdropBytes},
                         {"matchedShare", summary.backdropKnown},  {"confirmed", confirmed}};
  report["depth"] = {{"textures", depths}, {"bytes", depthBytes}};

  const auto memoryJson = [](const Memory& memory) {
    return Json{{"positions", memory.positions},
                {"indices", memory.indices},
                {"textures", memory.textures},
                {"depth", memory.depth}};
  };
  const auto memoryLine = [&](const char* label, const Memory& memory) {
    context.print("{}{}: {} photographs, {} vertices, {} indices, {} depth\n", label, bytesText(double(memory.sum())),
                  bytesText(double(memory.textures)), bytesText(double(memory.positions)),
                  bytesText(double(memory.indices)), bytesText(double(memory.depth)));
  };
  memoryLine("memory       predicted ", predicted);
  if (measured) memoryLine("             measured  ", *measured);
  const MetadataReport metadata = metadataReport(scene);
  context.print("{}", metadata.text);
  report["metadata"] = metadata.json;
  if (const double kept = folderBytes(scene.folder / ".build"); kept > 0) {
    context.print("cache        {} in .build for further builds; may be deleted\n", bytesText(kept));
    report["cacheBytes"] = kept;
  }
  report["memory"] = {{"predicted", memoryJson(predicted)}, {"measured", nullptr}};
  if (measured) report["memory"]["measured"] = memoryJson(*measured);

  if (options.explain) {
    report["stages"] = Json::array();
    context.print("\nrenderer stages (+ needed by this scene, - not needed)\n");
    const RendererOptions renderer =
        optionsFor(preset(Preset::balanced, deviceKindFor(context.options().device)), {1, 1});
    for (const StageExplanation& stage : explain(requirementsOf(scene, renderer), renderer)) {
      context.print("  {} {}: {}\n", stage.runs ? "+" : "-", stage.name, stage.why);
      report["stages"].push_back({{"stage", stage.name}, {"runs", stage.runs}, {"reason", stage.why}});
    }
  }
  CaptureAdvice advice;
  if (options.wantsAdvice()) advice = adviseCapture(scene);
  if (options.advice) {
    context.print("\nadvice\n{}", adviceText(advice));
    report["capture"] = adviceJson(scene, advice);
  }
  if (!options.svg.empty()) {
    writeFile(options.svg, graphSvg(scene, advice));
    context.logMessage(LogLevel::info, "image graph written to {}", options.svg);
  }
  if (!options.depth.empty()) {
    const std::size_t written = writeDepthPictures(scene, options.depth, context);
    check(written > 0, ErrorCode::unsupported, "{}: no photograph has a depth texture", options.scene);
    context.logMessage(LogLevel::info, "depth of {} photographs written to {}", written, options.depth);
  }
  context.report(report);
  if (!options.advicePoses.empty()) writePosesToAdd(options.advicePoses, advice, context);
  return kExitOk;
}

}  // namespace

const Command kInfoCommand{
    .name = "info",
    .summary =
        "Shows contents and memory of a scene, a harmonised model or 3D video, or the settings of a rendered image",
    .examples =
        "ibr info scene\nibr info scene --explain\nibr info scene --advice --svg graph.svg\nibr info scene "
        "--advice-poses next.json\nibr info scene --depth pictures\nibr info model\nibr info video\n"
        "ibr info pictures/frame_0000.png",
    .details =
        "--depth writes these files for each photograph, at the size of its depth texture:\n"
        "NAME.depth.png: light where near\n"
        "NAME.confirmations.png: none to four and more photographs\n"
        "NAME.consensus.png: 0 to 1\n"
        "NAME.depth.exr: the channels inverseDepth, confirmations and consensus\n"
        "inverseDepth is in 1/world unit, along the viewing axis, or for panoramas along the ray;\n"
        "0 is at infinity.",
    .afterInterrupt = "",
    .mainOptions = "explain advice svg depth json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->scene,
                "Folder of a scene, a model or 3D video, its .gltf or sequence.json, or an image")
          .required();
      addFlag(app, "--explain", options->explain,
              "Also list the stages of the renderer that this scene needs, with "
              "reasons");
      addFlag(app, "--advice", options->advice,
              "Also list problems of the photographs, and positions for ten more photographs");
      addOption(app, "--advice-poses", options->advicePoses,
                "Also write poses of ten more photographs: FILE.json is a camera path, else FILE is a folder for "
                "a COLMAP model")
          .type("FILE");
      addOption(app, "--svg", options->svg,
                "Also draw the image graph: cameras, cells by score, unused photographs and next-best views")
          .type("FILE");
      addOption(app, "--depth", options->depth,
                "Also write depth, confirmations and consensus of each photograph, as PNG and EXR")
          .type("DIR");
      return [options](const Context& context) { return showScene(*options, context); };
    }};

}  // namespace ibr::app
