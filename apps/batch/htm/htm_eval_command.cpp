// SPDX-License-Identifier: Apache-2.0
// `ibr htm eval`: compares methods ([H] §4.2, figs 10 and 11).
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "base/check.h"
#include "base/file.h"
#include "batch/files/poses.h"
#include "batch/files/truth.h"
#include "batch/htm/htm_commands.h"
#include "batch/htm/htm_evaluator.h"
#include "batch/htm/htm_options.h"
#include "io/image_file.h"
#include "shared/cli/htm_view_settings.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/draw/image_operations.h"
#include "shared/report/plot.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, truth, poses, output;
  std::vector<std::string> views;
  bool leaveOneOut = false, keepMesh = false;
  HtmSettings settings;
};

Image8 threshold(const Image8& grey, int least) {
  Image8 mask(grey.width, grey.height, 1);
  for (int y = 0; y < grey.height; ++y)
    for (int x = 0; x < grey.width; ++x) mask.pixel(x, y)[0] = grey.pixel(x, y)[0] >= least ? 255 : 0;
  return mask;
}

// Reads a view's mask from the truth's folder `masks`; empty if there is no such folder.
Image8 truthMask(const fs::path& truth, const View& view) {
  const fs::path masks = truth / "masks";
  if (!fs::is_directory(masks)) return {};
  const fs::path file = pictureFile(masks, view.name);
  const Image8 mask = threshold(readImage(file), 128);
  check(mask.width == view.camera.intrinsics.width && mask.height == view.camera.intrinsics.height,
        ErrorCode::invalidInput, "{}: the mask does not have the size of its image", file.string());
  return mask;
}

std::vector<HtmViewScores> againstTruth(const Options& options, const HtmModel& model, Device& device,
                                        ProgressLine& progress, const Context& context) {
  const Truth truth(options.truth, options.views, context.log());
  HtmEvaluator judge(model, device, readHtmPicture);
  std::vector<HtmViewScores> verdicts;
  for (const View& view : truth.views()) {
    check(progress.show({"comparing", verdicts.size(), truth.views().size()}), ErrorCode::cancelled, "stopped");
    verdicts.push_back(
        judge.judge({view.name, view.camera, truth.picture(view), truthMask(options.truth, view)}, options.settings));
  }
  return verdicts;
}

// A camera with its pose before the adjustment, and its photograph. The mask is the stored visibility if the model was
// built with masks; else empty, since the visibility then comes from a mesh that this photograph helped to build.
HtmPhotograph photographOf(const HtmModel& model, std::size_t i) {
  HtmImage picture = readHtmPicture(model, i);
  HtmPhotograph photograph{model.cameras[i], std::move(picture.photograph), {}};
  if (!picture.visibility.empty() && htmHasMasks(model.settings)) photograph.mask = threshold(picture.visibility, 1);
  if (photograph.camera.given) photograph.camera.camera = *photograph.camera.given;
  photograph.camera.given.reset();
  return photograph;
}

class LeaveOneOut {
 public:
  LeaveOneOut(const Options& options, const HtmModel& model, const Context& context)
      : options_(options), model_(model), optimise_(withThreads(htmOptionsFromJson(model.settings), context)) {
    for (std::size_t i = 0; i < model.cameras.size(); ++i) photographs_.push_back(photographOf(model, i));
    if (options.poses.empty()) return;
    for (const View& view : readViews(options.poses, {}, context.log())) poses_.push_back(view);
  }

  HtmViewScores without(std::size_t i, Device& device, const ProgressCallback& progress) {
    const HtmPhotograph& left = photographs_[i];
    const HtmTruthView view{left.camera.name, poseOf(left), left.picture, left.mask};
    HtmSettings settings = options_.settings;
    if (options_.keepMesh) {
      settings.exclude |= CameraSet(1) << i;
      return HtmEvaluator(model_, device,
                          [&](const HtmModel&, std::size_t k) {
                            return HtmImage{photographs_[k].picture, readHtmPicture(model_, k).visibility};
                          })
          .judge(view, settings);
    }
    std::vector<HtmPhotograph> others = photographs_;
    others.erase(others.begin() + std::ptrdiff_t(i));
    const HtmResult rebuilt = harmonise(model_.source->mesh, others, optimise_, progress);
    return HtmEvaluator(rebuilt.model, device,
                        [&](const HtmModel&, std::size_t k) {
                          return HtmImage{others[k].picture, rebuilt.visibility[k]};
                        })
        .judge(view, settings);
  }

 private:
  Camera poseOf(const HtmPhotograph& photograph) const {
    if (options_.poses.empty()) return photograph.camera.camera;
    const auto found = std::ranges::find(poses_, photograph.camera.name, &View::name);
    check(found != poses_.end(), ErrorCode::invalidInput, "{}: has no view {}", options_.poses, photograph.camera.name);
    check(found->camera.intrinsics.width == photograph.picture.width &&
              found->camera.intrinsics.height == photograph.picture.height,
          ErrorCode::invalidInput, "{}: {} does not have the size of its photograph", options_.poses,
          photograph.camera.name);
    return found->camera;
  }

  const Options& options_;
  const HtmModel& model_;
  HtmOptions optimise_;
  std::vector<HtmPhotograph> photographs_;
  std::vector<View> poses_;
};

std::vector<HtmViewScores> leavingOneOut(const Options& options, const HtmModel& model, Device& device,
                                         ProgressLine& progress, const Context& context) {
  check(options.keepMesh || model.source.has_value(), ErrorCode::invalidInput,
        "{}: the model does not contain the mesh before optimisation; use --keep-mesh, which does not need this mesh",
        options.model);
  std::set<std::string> unknown(options.views.begin(), options.views.end());
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < model.cameras.size(); ++i)
    if (unknown.erase(model.cameras[i].name) > 0 || options.views.empty()) chosen.push_back(i);
  check(unknown.empty(), ErrorCode::invalidInput, "{}: has no camera {} (--views)", options.model,
        unknown.empty() ? std::string() : *unknown.begin());
  LeaveOneOut leave(options, model, context);
  std::vector<HtmViewScores> verdicts;
  for (const std::size_t i : chosen) {
    const std::size_t done = verdicts.size();
    check(progress.show({"leaving one out", done, chosen.size()}), ErrorCode::cancelled, "stopped");
    // Stages of the inner work would hide the overall progress.
    verdicts.push_back(leave.without(i, device, [&](const Progress&) {
      return progress.show({"leaving one out", done, chosen.size()});
    }));
    context.logMessage(LogLevel::info, "{}: htm {:.2f} dB, vdtbm {:.2f}, vdvbm {:.2f}", verdicts.back().name,
                       verdicts.back().score[kHtm].psnr, verdicts.back().score[kVdtbm].psnr,
                       verdicts.back().score[kVdvbm].psnr);
  }
  return verdicts;
}

Json scoreJson(const HtmScore& score) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  return {{"psnr", number(score.psnr)}, {"ssim", number(score.ssim)}, {"psnrCovered", number(score.psnrCovered)}};
}

Json methodScoresJson(const std::array<HtmScore, kHtmMethodCount>& scores) {
  Json json = Json::object();
  for (std::size_t r = 0; r < kHtmMethodCount; ++r) json[kHtmMethodNames[r]] = scoreJson(scores[r]);
  return json;
}

void printTable(const std::vector<HtmViewScores>& verdicts, const Context& context) {
  Table table;
  table.row({"view", "HTM dB", "VDTBM", "VDVBM", "VDTBM, adjusted cameras", "HTM covered dB", "VDTBM", "VDVBM",
             "HTM SSIM", "VDTBM", "VDVBM"});
  const auto add = [&](const std::string& name, const std::array<HtmScore, kHtmMethodCount>& s) {
    table.row({name, numberText(s[kHtm].psnr, 2), numberText(s[kVdtbm].psnr, 2), numberText(s[kVdvbm].psnr, 2),
               numberText(s[kVdtbmAdjusted].psnr, 2), numberText(s[kHtm].psnrCovered, 2),
               numberText(s[kVdtbm].psnrCovered, 2), numberText(s[kVdvbm].psnrCovered, 2), numberText(s[kHtm].ssim, 4),
               numberText(s[kVdtbm].ssim, 4), numberText(s[kVdvbm].ssim, 4)});
  };
  for (const HtmViewScores& verdict : verdicts) add(verdict.name, verdict.score);
  add("mean", meanScores(verdicts));
  context.print("{}", table.text());
}

// [H] fig. 10.
std::string plotOf(const std::vector<HtmViewScores>& verdicts, const std::string& title) {
  PlotPanel panel{.title = "PSNR", .xName = "view", .yName = "dB"};
  const std::array<const char*, kHtmMethodCount> names{"HTM", "VDTBM", "VDVBM", "VDTBM, adjusted cameras"};
  for (std::size_t r = 0; r < kHtmMethodCount; ++r) {
    PlotSeries series{names[r], {}};
    for (std::size_t v = 0; v < verdicts.size(); ++v)
      series.points.push_back({double(v + 1), verdicts[v].score[r].psnr, r == 0 ? verdicts[v].name : std::string()});
    panel.series.push_back(std::move(series));
  }
  return plotSvg(title, {panel}, {"PSNR over the object's pixels; holes count as black."});
}

// [H] fig. 11: the object's crop from the photograph, then VDVBM, VDTBM and HTM.
void writePictures(const HtmViewScores& verdict, const fs::path& folder) {
  const Image8& truth = verdict.truth;
  int left = truth.width, right = 0, top = truth.height, bottom = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      if (verdict.picture[kHtm].pixel(x, y)[3] > 0)
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
  if (right < left) return;
  const auto cropped = [&](const Image8& image) {
    Image8 crop(right - left + 1, bottom - top + 1, 3);
    for (int y = 0; y < crop.height; ++y)
      for (int x = 0; x < crop.width; ++x)
        std::ranges::copy(image.pixel(left + x, top + y).first(3), crop.pixel(x, y).begin());
    return crop;
  };
  std::vector<Image8> row{cropped(truth)};
  for (const HtmMethodIndex rival : {kVdvbm, kVdtbm, kHtm}) row.push_back(cropped(verdict.picture[rival]));
  const fs::path file = pictureFile(folder, verdict.name);
  makeFolders(file.parent_path());
  writeImage(file, sideBySide(row));
}

ExitCode evaluate(const Options& options, const Context& context) {
  const HtmModel model = loadHtmModel(options.model);
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  std::vector<HtmViewScores> verdicts;
  {
    ProgressLine progress(context);
    verdicts = options.leaveOneOut ? leavingOneOut(options, model, device, progress, context)
                                   : againstTruth(options, model, device, progress, context);
  }
  if (!options.output.empty()) {
    const fs::path folder = options.output;
    for (const HtmViewScores& verdict : verdicts) writePictures(verdict, folder);
    makeFolders(folder);
    writeFile(folder / "psnr.svg", plotOf(verdicts, options.model));
  }
  printTable(verdicts, context);
  Json json{{"views", Json::array()}, {"mean", methodScoresJson(meanScores(verdicts))}};
  for (const HtmViewScores& verdict : verdicts) {
    Json entry{{"name", verdict.name}};
    entry.update(methodScoresJson(verdict.score));
    json["views"].push_back(std::move(entry));
  }
  json["device"] = device.name();
  json["settings"] = {{"gamma", options.settings.gamma},
                      {"weightCut", options.settings.weightCut},
                      {"leaveOneOut", options.leaveOneOut},
                      {"keepMesh", options.keepMesh},
                      {"poses", options.poses}};
  json["model"] = options.model;
  context.report(json);
  return kExitOk;
}

}  // namespace

const Command kHtmEvalCommand{
    .name = "eval",
    .summary = "Compares harmonised texture mapping with blended photographs and vertex colours",
    .examples =
        "ibr htm eval model --leave-one-out -o comparison\n"
        "ibr htm eval model --truth held-out -o comparison --json -\n"
        "ibr htm eval model --leave-one-out --poses exact/sparse --views cam03.jpg cam07.jpg",
    .details =
        "HTM draws the model. VDTBM blends photographs without displacement. VDVBM draws vertex\n"
        "colours. Both draw the mesh and the cameras as given. A fourth column is VDTBM with\n"
        "adjusted cameras, to separate the gain of the adjustment. All methods have the same\n"
        "weights, visibility and masks.\n"
        "--leave-one-out builds the model again without each photograph, and renders the view of\n"
        "its camera, as given or from --poses. --truth DIR has images/, a COLMAP model in sparse/\n"
        "and optionally masks/.\n"
        "PSNR and SSIM are over the pixels of the object's mask; holes count as black. 'Covered'\n"
        "is over the object's pixels that all methods draw. Without masks, all figures are over\n"
        "these pixels.\n"
        "-o writes psnr.svg, and for each view a row: photograph, VDVBM, VDTBM, HTM.",
    .afterInterrupt = "no report was written; run the same command again, or a part of the views with --views",
    .mainOptions = "truth leave-one-out keep-mesh views output json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "MODEL", options->model, "Model folder").required();
      const Option truth = addOption(app, "--truth", options->truth, "Folder of views with known images").type("DIR");
      const Option leave = addFlag(app, "--leave-one-out", options->leaveOneOut,
                                   "Compare each photograph with a model built without "
                                   "the photograph")
                               .excludes(truth);
      addFlag(app, "--keep-mesh", options->keepMesh,
              "With --leave-one-out: build no model again; leave the camera out only when drawing")
          .needs(leave);
      addOption(app, "--poses", options->poses, "With --leave-one-out: exact poses of the cameras")
          .needs(leave)
          .type("FILE|DIR");
      addOption(app, "--views", options->views, "Compare only these views, by name").type("NAME");
      addOption(app, "-o,--output", options->output, "Folder for images and plot; created if missing").type("DIR");
      declareHtmSettings(app, options->settings);
      afterParsing(app, [options] {
        if (options->truth.empty() && !options->leaveOneOut) requireOption("--truth or --leave-one-out");
      });
      return [options](const Context& context) { return evaluate(*options, context); };
    }};

}  // namespace ibr::app
