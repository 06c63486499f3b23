// SPDX-License-Identifier: Apache-2.0
// Checks photographs without poses: files, sizes, camera metadata, sharpness, duplicates.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/check.h"
#include "base/median.h"
#include "batch/build/build_options.h"
#include "batch/doctor/examined_photograph.h"
#include "batch/doctor/findings.h"
#include "ibr/author/build.h"
#include "ibr/author/photographs.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr std::size_t kFew = 5;  // photographs
constexpr double kStops = 1.0;   // range of exposures from the smallest to the largest, stops
constexpr double kZoom = 1.03;   // ratio of focal lengths
constexpr double kBlur = 0.35;   // share of the median sharpness, of similar photographs and of all of the size
// Minimum correlation of signatures to compare the sharpness of photographs (the four most similar of one size).
// Counts of photographs reported as blurred, of 252 in eight sets, 144 of them rendered: unchanged (two are soft), with
// a Gaussian blur of 1 px, of 2 px, and with a motion blur of 8 px, by threshold:
//   any            5   242   252   243
//   0.1            4   239   249   240
//   0.2            3   215   225   217
//   0.3            2   202   208   203
//   0.5            2   188   190   189
//   four by name  14   242   251   243
constexpr double kMinCorrelation = 0.3;
constexpr std::size_t kMaxSimilar = 4, kMinSimilar = 2;
constexpr double kDuplicateCorrelation = 0.9995;  // correlation of two signatures
constexpr std::size_t kMaxCompared = 3000;

void videos(const std::vector<std::string>& names, Findings& findings) {
  if (!names.empty())
    findings.add({"format", Severity::warning,
                  fmt::format("{}: {}.", someOf(names), names.size() == 1 ? "is a video" : "are videos"),
                  "ibr build uses frames of videos that are named: ibr build PHOTOS VIDEO -o SCENE."});
}

// Reports files that a build skips. A reason has the form "problem: remedy", or only names the problem.
void reportSkipped(const std::vector<PhotographFolder::UnreadableFile>& unread, Findings& findings) {
  std::map<std::string, std::vector<PhotographFolder::UnreadableFile>> byReason;
  for (const PhotographFolder::UnreadableFile& file : unread) byReason[file.reason].push_back(file);
  for (auto& [reason, files] : byReason) {
    const std::size_t colon = std::min(reason.find(": "), reason.size());
    for (PhotographFolder::UnreadableFile& file : files) file.reason.resize(colon);
    std::string remedy = colon < reason.size() ? reason.substr(colon + 2) : "copy the file again, or remove it";
    remedy[0] = char(std::toupper(static_cast<unsigned char>(remedy[0])));
    findings.add({"file", Severity::warning, unreadableText(files) + ".", remedy + "."});
  }
}

const char* remedyOf(ErrorCode code) {
  if (code == ErrorCode::unsupported) return "Or remove the file; copying the file again does not help.";
  if (code == ErrorCode::io) return "Check the permissions of the file.";
  return "Copy the file from the camera again, or remove it.";
}

void unreadable(const std::vector<ExaminedPhotograph>& all, Findings& findings) {
  for (const ExaminedPhotograph& photo : all)
    if (!photo.readError.empty())
      findings.add({"file", Severity::serious, fmt::format("{} cannot be read: {}.", photo.name, photo.readError),
                    remedyOf(photo.code)});
}

bool sameSize(const ExaminedPhotograph& a, const ExaminedPhotograph& b) {
  return a.info.width == b.info.width && a.info.height == b.info.height;
}

void sizes(const std::vector<ExaminedPhotograph>& good, Findings& findings) {
  std::map<std::pair<int, int>, std::vector<std::string>> groups;  // by longer and shorter side
  std::size_t upright = 0;
  for (const ExaminedPhotograph& photo : good) {
    const auto& [width, height] = std::pair(photo.info.width, photo.info.height);
    groups[{std::max(width, height), std::min(width, height)}].push_back(photo.name);
    upright += (height > width) != (photo.info.orientation >= 5);
  }
  const auto common = std::ranges::max_element(groups, {}, [](const auto& g) { return g.second.size(); });
  findings.fact(fmt::format("{} photographs, most of {}×{} px; {} in portrait orientation", good.size(),
                            common->first.first, common->first.second, upright));
  for (const auto& [size, names] : groups) {
    if (size == common->first) continue;
    const double ratio = double(size.first) * size.second / (double(common->first.first) * common->first.second);
    const bool small = ratio < 0.5;
    findings.add({"size", small ? Severity::warning : Severity::hint,
                  fmt::format("{}: {}×{} px, {} the other photographs.", someOf(names), size.first, size.second,
                              small ? "much smaller than" : "another size than"),
                  small ? "Use the original files: messengers and web pages reduce the resolution."
                        : "Photographs of another camera may differ in size; do not use cropped photographs."});
  }
}

void exposure(const std::vector<ExaminedPhotograph>& good, Findings& findings) {
  const ExaminedPhotograph *least = nullptr, *most = nullptr;
  double low = 0, high = 0;
  for (const ExaminedPhotograph& photo : good) {
    const auto exposed = relativeExposure(photo.info.capture);
    if (!exposed) continue;
    if (!least || *exposed < low) least = &photo, low = *exposed;
    if (!most || *exposed > high) most = &photo, high = *exposed;
  }
  if (!least || !(std::log2(high / low) > kStops)) return;
  findings.add(
      {"exposure", Severity::warning,
       fmt::format("{} has {:.1f} stops more exposure than {}.", most->name, std::log2(high / low), least->name),
       "Lock the exposure before the first photograph, or set the exposure manually: steps in brightness are "
       "visible."});
}

void lenses(const std::vector<ExaminedPhotograph>& good, Findings& findings) {
  std::map<std::tuple<std::string, std::string, std::string>, std::map<double, std::vector<std::string>>> cameras;
  for (const ExaminedPhotograph& photo : good) {
    const CaptureMetadata& facts = photo.info.capture;
    if (facts.focalLength > 0) cameras[{facts.maker, facts.model, facts.lens}][facts.focalLength].push_back(photo.name);
  }
  if (cameras.size() > 1)
    findings.add({"camera", Severity::hint,
                  fmt::format("The photographs come from {} cameras or lenses.", cameras.size()),
                  "Poses are more accurate with one camera and lens."});
  for (const auto& [camera, lengths] : cameras) {
    const auto common = std::ranges::max_element(lengths, {}, [](const auto& l) { return l.second.size(); });
    for (const auto& [length, names] : lengths)
      if (std::max(length, common->first) / std::min(length, common->first) > kZoom)
        findings.add(
            {"zoom", Severity::warning,
             fmt::format("{}: focal length {:g} mm, but {:g} mm in the other photographs.", someOf(names), length,
                         common->first),
             "Do not zoom between photographs; exclude the zoomed photographs (--exclude), or take new ones."});
  }
}

// Sharpness of the most similar photographs of the same size.
std::vector<double> similarSharpness(const std::vector<ExaminedPhotograph>& good, std::size_t i) {
  std::vector<std::pair<double, double>> alike;  // similarity and sharpness
  const std::size_t first = i > kMaxCompared / 2 ? i - kMaxCompared / 2 : 0;
  for (std::size_t j = first; j < std::min(good.size(), first + kMaxCompared); ++j)
    if (j != i && sameSize(good[i], good[j]) && std::isfinite(good[j].sharpness))
      if (const double a = signatureCorrelation(good[i], good[j]); a > kMinCorrelation)
        alike.emplace_back(a, good[j].sharpness);
  std::ranges::sort(alike, std::greater<>());
  std::vector<double> sharpness;
  for (const auto& [a, sharp] : alike)
    if (sharpness.size() < kMaxSimilar) sharpness.push_back(sharp);
  return sharpness;
}

std::string timeText(double seconds) {
  return seconds < 0.5 ? fmt::format("1/{:.0f} s", 1 / seconds) : fmt::format("{:.1f} s", seconds);
}

void sharpness(const std::vector<ExaminedPhotograph>& good, Findings& findings) {
  for (std::size_t i = 0; i < good.size(); ++i) {
    const std::vector<double> alike = similarSharpness(good, i);
    if (alike.size() < kMinSimilar || !(good[i].sharpness < kBlur * median(alike))) continue;
    std::vector<double> all;
    for (const ExaminedPhotograph& photo : good)
      if (sameSize(good[i], photo)) all.push_back(photo.sharpness);
    if (!(good[i].sharpness < kBlur * median(all))) continue;
    const double time = good[i].info.capture.exposureTime;
    findings.add({"blur", Severity::warning,
                  fmt::format("{} is blurred, compared with similar photographs{}.", good[i].name,
                              time > 1.0 / 60 ? fmt::format(" (exposure time {})", timeText(time)) : std::string()),
                  "Hold the camera still or use a shorter exposure, and take the photograph again."});
  }
}

void repetitions(const std::vector<ExaminedPhotograph>& good, Findings& findings) {
  for (std::size_t i = 0; i < std::min(good.size(), kMaxCompared); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const bool identical = good[i].hash == good[j].hash;
      if (!identical && !(signatureCorrelation(good[i], good[j]) > kDuplicateCorrelation)) continue;
      findings.add(
          {"repeated", Severity::hint,
           fmt::format("{} {} {}.", good[i].name, identical ? "is a copy of" : "looks the same as", good[j].name),
           "Keep one of the two; a photograph from a step aside shows more."});
      break;
    }
}

// Names of the readable photographs, and of unreadable ones that have a pose. Other unreadable ones do not count.
std::vector<std::string> namesFor(const PosedModel& model, const std::vector<ExaminedPhotograph>& all,
                                  const std::vector<PhotographFolder::UnreadableFile>& unread, Findings& findings) {
  std::set<std::string> posed;
  for (const PosedImage& image : model.images) posed.insert(image.name);
  std::vector<std::string> names, lost;
  for (const ExaminedPhotograph& photo : all)
    if (photo.readError.empty() || posed.contains(photo.name)) names.push_back(photo.name);
  for (const PhotographFolder::UnreadableFile& file : unread)
    if (posed.contains(file.name)) lost.push_back(file.name);
  if (!lost.empty())
    findings.add({"poses", Severity::serious,
                  fmt::format("{} of the photographs with a pose cannot be read: {}.", lost.size(), someOf(lost)),
                  "Restore the photographs, or exclude them (--exclude)."});
  names.insert(names.end(), lost.begin(), lost.end());
  std::ranges::sort(names);
  return names;
}

void posesOf(const fs::path& folder, const std::vector<ExaminedPhotograph>& all,
             const std::vector<PhotographFolder::UnreadableFile>& unread, const BuildChoices& choices,
             Findings& findings, const Context& context) {
  try {
    const BuildOptions build = buildOptionsOf(choices, folder, context);
    const fs::path file = build.model;
    if (file.empty()) {
      findings.fact("no poses near the photographs: ibr build estimates poses with the program COLMAP");
      return;
    }
    const PosedModel model = readPoses(build, context.log());
    findings.fact(fmt::format("poses: {}, {} photographs and {} points", file.string(), model.images.size(),
                              model.tracks.size()));
    examinePoses(model, namesFor(model, all, unread, findings), findings);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled) throw;
    findings.add({"poses", Severity::serious, fmt::format("The poses cannot be read: {}.", e.what()),
                  "Export the poses again, or remove them: ibr build then estimates new poses."});
  }
}

}  // namespace

void examinePhotographs(const fs::path& folder, const BuildChoices& choices, Findings& findings,
                        const Context& context) {
  PhotographFolder found;
  try {
    found = scanPhotographFolder(folder);
  } catch (const fs::filesystem_error& e) {
    fail(ErrorCode::io, "{}: {}", folder.string(), e.code().message());
  }
  findings.fact(countText(found));
  videos(found.videos, findings);
  reportSkipped(found.unreadable, findings);
  const std::vector<ExaminedPhotograph> all = examineAll(folder, found.pictures, context);
  unreadable(all, findings);
  std::vector<ExaminedPhotograph> good;
  for (const ExaminedPhotograph& photo : all)
    if (photo.readError.empty()) good.push_back(photo);
  if (good.size() < 2) {
    findings.add(
        {"count", Severity::serious,
         good.empty() ? "This folder has no readable photograph." : "This folder has only one readable photograph.",
         "Take at least three photographs: step to the side by a tenth of the distance to the subject, and photograph "
         "the same view again."});
    return;
  }
  sizes(good, findings);
  if (all.size() < kFew)
    findings.add({"count", Severity::hint, fmt::format("There are only {} photographs.", all.size()),
                  "More photographs, each overlapping the next by two thirds, allow a longer walk."});
  exposure(good, findings);
  lenses(good, findings);
  sharpness(good, findings);
  repetitions(good, findings);
  posesOf(folder, all, found.unreadable, choices, findings, context);
  if (!choices.build.masks.empty()) examineMasks(choices.build.masks, all, findings);
}

}  // namespace ibr::app
