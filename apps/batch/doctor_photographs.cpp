// SPDX-License-Identifier: Apache-2.0
// Photographs by themselves: files, sizes, what the camera wrote down, sharpness, repetitions.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "author/parallel.h"
#include "author/photographs.h"
#include "author/picture_folder.h"
#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "batch/build_options.h"
#include "batch/findings.h"
#include "image/sharpness.h"
#include "io/image_file.h"
#include "shared/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr std::size_t kFew = 5;       // photographs
constexpr double kStops = 1.0;        // of exposure, from the least to the most
constexpr double kZoom = 1.03;        // ratio of focal lengths
constexpr double kBlur = 0.35;        // of the sharpness of those before and after, and of the median
constexpr int kSharpnessSide = 1600;  // px
constexpr int kSignatureSide = 16;    // px
constexpr double kSame = 0.9995;      // correlation of two signatures
constexpr double kPixelsEach = 45e6;  // that a photograph may have, to share the memory out
constexpr std::size_t kMostCompared = 3000;

struct Looked {
  std::string name;
  std::string trouble;  // why it cannot be read
  ImageFileInfo info;
  double sharpness = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t hash = 0;
  std::vector<float> signature;  // of mean 0 and length 1; empty for a picture of one grey
};

double sharpnessOf(const Image8& picture) {
  const double scale = std::min(1.0, double(kSharpnessSide) / std::max(picture.width, picture.height));
  const int width = int(picture.width * scale), height = int(picture.height * scale);
  if (std::min(width, height) < 8) return std::numeric_limits<double>::quiet_NaN();
  return ibr::sharpness(greyOf(scale < 1 ? shrunk(picture, width, height) : picture),
                        greyOf(shrunk(picture, width / 8, height / 8)));
}

std::vector<float> signatureOf(const Image8& picture) {
  const Image8 small = greyOf(shrunk(picture, kSignatureSide, kSignatureSide));
  std::vector<float> values(small.values.begin(), small.values.end());
  const float mean = std::accumulate(values.begin(), values.end(), 0.0f) / float(values.size());
  float length = 0;
  for (float& v : values) v -= mean, length += v * v;
  if (!(length > float(values.size()))) return {};
  for (float& v : values) v /= std::sqrt(length);
  return values;
}

void look(const fs::path& folder, Looked& looked) {
  const fs::path file = folder / looked.name;
  try {
    looked.info = probeImage(file);
    const Image8 picture = readImage(file);
    Hash hash;
    hash.add(readFile(file));
    looked.hash = hash.value();
    looked.sharpness = sharpnessOf(picture);
    looked.signature = signatureOf(picture);
  } catch (const Error& e) {
    looked.trouble = e.what();
    if (const std::string prefix = file.string() + ": "; looked.trouble.starts_with(prefix))
      looked.trouble.erase(0, prefix.size());
  } catch (const std::exception& e) {
    looked.trouble = e.what();
  }
}

std::vector<Looked> lookAtAll(const fs::path& folder, const std::vector<std::string>& names, const Context& context) {
  std::vector<Looked> all(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) all[i].name = names[i];
  ProgressLine progress(context);
  const bool whole = runJobs(
      all.size(), threadsFor(context.options().threads, 8 * kPixelsEach), [&](std::size_t i) { look(folder, all[i]); },
      [&](std::size_t done) {
        return progress.show({"looking at photographs", done, all.size()});
      });
  check(whole, ErrorCode::cancelled, "stopped");
  return all;
}

// Pictures that cameras make and that are not read here.
void foreignFiles(const fs::path& folder, Findings& findings) {
  static const std::set<std::string> kRaw{".cr2", ".cr3", ".nef", ".arw", ".dng", ".orf", ".rw2", ".raf", ".pef"};
  static const std::set<std::string> kVideo{".mp4", ".mov", ".avi", ".mkv", ".mts"};
  std::map<std::string, std::vector<std::string>> found;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (!at->is_regular_file(ignored)) continue;
    std::string extension = at->path().extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    const std::string name = at->path().lexically_relative(folder).generic_string();
    try {
      if (kRaw.contains(extension))
        found["raw"].push_back(name);
      else if (kVideo.contains(extension))
        found["videos"].push_back(name);
      else if (const std::string format = foreignImageFormat(at->path()); !format.empty())
        found[format].push_back(name);
    } catch (const Error&) {
    }
  }
  for (const auto& [format, names] : found)
    findings.add({"format", Severity::warning,
                  names.size() == 1
                      ? fmt::format("{} is not read ({}).", names[0], format)
                      : fmt::format("{} files are not read ({}): {}.", names.size(), format, someOf(names)),
                  format == "videos" ? "Save single pictures of it: ffmpeg -i VIDEO -vf fps=2 %04d.png."
                                     : "Save them as JPEG, or set the camera to it."});
}

void unreadable(const std::vector<Looked>& all, Findings& findings) {
  for (const Looked& photo : all)
    if (!photo.trouble.empty())
      findings.add({"file", Severity::serious, fmt::format("{} cannot be read: {}.", photo.name, photo.trouble),
                    "Copy it from the camera again, or take it away."});
}

void sizes(const std::vector<Looked>& good, Findings& findings) {
  std::map<std::pair<int, int>, std::vector<std::string>> groups;  // by longer and shorter side
  std::size_t upright = 0;
  for (const Looked& photo : good) {
    const auto& [width, height] = std::pair(photo.info.width, photo.info.height);
    groups[{std::max(width, height), std::min(width, height)}].push_back(photo.name);
    upright += (height > width) != (photo.info.orientation >= 5);
  }
  const auto common = std::ranges::max_element(groups, {}, [](const auto& g) { return g.second.size(); });
  findings.fact(fmt::format("{} photographs, most of {}×{} px; {} of them held upright", good.size(),
                            common->first.first, common->first.second, upright));
  for (const auto& [size, names] : groups) {
    if (size == common->first) continue;
    const double ratio = double(size.first) * size.second / (double(common->first.first) * common->first.second);
    const bool small = ratio < 0.5;
    findings.add({"size", small ? Severity::warning : Severity::hint,
                  fmt::format("{}: {}×{} px, {} the others.", someOf(names), size.first, size.second,
                              small ? "much less than" : "another size than"),
                  small ? "Use the originals: pictures that messengers and web pages made small lose what they show."
                        : "This is right where they come from another camera, and wrong where they were cut."});
  }
}

void exposure(const std::vector<Looked>& good, Findings& findings) {
  const Looked *least = nullptr, *most = nullptr;
  double low = 0, high = 0;
  for (const Looked& photo : good) {
    const auto exposed = relativeExposure(photo.info.capture);
    if (!exposed) continue;
    if (!least || *exposed < low) least = &photo, low = *exposed;
    if (!most || *exposed > high) most = &photo, high = *exposed;
  }
  if (!least || !(std::log2(high / low) > kStops)) return;
  findings.add(
      {"exposure", Severity::warning,
       fmt::format("{} was exposed {:.1f} stops more than {}.", most->name, std::log2(high / low), least->name),
       "Lock the exposure before the first photograph, or set it by hand: steps in brightness show."});
}

void lenses(const std::vector<Looked>& good, Findings& findings) {
  std::map<std::tuple<std::string, std::string, std::string>, std::map<double, std::vector<std::string>>> cameras;
  for (const Looked& photo : good) {
    const CaptureFacts& facts = photo.info.capture;
    if (facts.focalLength > 0) cameras[{facts.maker, facts.model, facts.lens}][facts.focalLength].push_back(photo.name);
  }
  if (cameras.size() > 1)
    findings.add({"camera", Severity::hint,
                  fmt::format("The photographs come from {} cameras or lenses.", cameras.size()),
                  "That works; poses are better with one."});
  for (const auto& [camera, lengths] : cameras) {
    const auto common = std::ranges::max_element(lengths, {}, [](const auto& l) { return l.second.size(); });
    for (const auto& [length, names] : lengths)
      if (std::max(length, common->first) / std::min(length, common->first) > kZoom)
        findings.add(
            {"zoom", Severity::warning,
             fmt::format("{}: zoomed, at {:g} mm and not {:g} mm as the others.", someOf(names), length, common->first),
             "Do not zoom between photographs; leave these out (--exclude), or take them again."});
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::nth_element(values, values.begin() + std::ptrdiff_t(values.size() / 2));
  return values[values.size() / 2];
}

void sharpness(const std::vector<Looked>& good, Findings& findings) {
  std::vector<double> all;
  for (const Looked& photo : good)
    if (std::isfinite(photo.sharpness)) all.push_back(photo.sharpness);
  const double typical = median(all);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<double> beside;
    for (std::size_t j = i > 2 ? i - 2 : 0; j < std::min(good.size(), i + 3); ++j)
      if (j != i && std::isfinite(good[j].sharpness)) beside.push_back(good[j].sharpness);
    if (!(good[i].sharpness < kBlur * typical) || !(good[i].sharpness < kBlur * median(beside))) continue;
    const double time = good[i].info.capture.exposureTime;
    findings.add({"blur", Severity::warning,
                  fmt::format("{} is blurred, beside those taken before and after it{}.", good[i].name,
                              time > 1.0 / 60 ? fmt::format(" (exposed for 1/{:.0f} s)", 1 / time) : std::string()),
                  "Hold the camera still, or use a shorter exposure, and take it again."});
  }
}

void repetitions(const std::vector<Looked>& good, Findings& findings) {
  for (std::size_t i = 0; i < std::min(good.size(), kMostCompared); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const bool identical = good[i].hash == good[j].hash;
      const auto &a = good[i].signature, &b = good[j].signature;
      if (!identical && (a.empty() || b.empty() || !(std::inner_product(a.begin(), a.end(), b.begin(), 0.0) > kSame)))
        continue;
      findings.add(
          {"repeated", Severity::hint,
           fmt::format("{} {} {}.", good[i].name, identical ? "is a copy of" : "shows the same as", good[j].name),
           "One of them will do; a step aside would show more."});
      break;
    }
}

void posesOf(const fs::path& folder, const std::vector<std::string>& names, Findings& findings,
             const Context& context) {
  BuildChoices choices;
  BuildOptions build;
  try {
    build = buildOptionsOf(choices, folder, context);
    if (build.model.empty()) {
      findings.fact("no poses beside them: ibr build estimates them with the program COLMAP");
      return;
    }
    const PosedModel model = readColmapModel(build.model);
    findings.fact(fmt::format("poses: {}, {} photographs and {} points", build.model.string(), model.images.size(),
                              model.tracks.size()));
    examinePoses(model, names, findings);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled) throw;
    findings.add({"poses", Severity::serious, fmt::format("The poses cannot be read: {}.", e.what()),
                  "Export them again, or take them away: then ibr build estimates poses itself."});
  }
}

std::string lowerExtension(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return extension;
}

}  // namespace

void examinePhotographs(const fs::path& folder, Findings& findings, const Context& context) {
  std::vector<std::string> names;
  try {
    const PictureFolder found = lookInto(folder);
    names = found.pictures;
    for (const auto& [name, reason] : found.unread)  // those of our kinds that cannot be read are examined, too
      if (const std::string end = lowerExtension(name); end == ".jpg" || end == ".jpeg" || end == ".png" ||
                                                        end == ".tif" || end == ".tiff")
        names.push_back(name);
    std::ranges::sort(names);
  } catch (const fs::filesystem_error& e) {
    fail(ErrorCode::io, "{}: {}", folder.string(), e.code().message());
  }
  foreignFiles(folder, findings);
  const std::vector<Looked> all = lookAtAll(folder, names, context);
  unreadable(all, findings);
  std::vector<Looked> good;
  for (const Looked& photo : all)
    if (photo.trouble.empty()) good.push_back(photo);
  if (good.size() < 2) {
    findings.add(
        {"count", Severity::serious,
         good.empty() ? "There is no photograph in this folder that can be read." : "There is one photograph.",
         "Take at least three: step to the side by a tenth of the distance to what you photograph, and take the "
         "same again."});
    return;
  }
  sizes(good, findings);
  if (all.size() < kFew)
    findings.add({"count", Severity::hint, fmt::format("There are {} photographs.", all.size()),
                  "More of them, each with two thirds of its picture in the next, let one walk further."});
  exposure(good, findings);
  lenses(good, findings);
  sharpness(good, findings);
  repetitions(good, findings);
  posesOf(folder, names, findings, context);
}

}  // namespace ibr::app
