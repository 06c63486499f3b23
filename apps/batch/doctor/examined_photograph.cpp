// SPDX-License-Identifier: Apache-2.0
#include "batch/doctor/examined_photograph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/usage.h"
#include "ibr/author/photographs.h"
#include "ibr/metrics.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr int kSharpnessSide = 1600;  // side of the image for the sharpness, px
constexpr int kSignatureSide = 16;    // side of the image for the signature, px
constexpr double kBytesPerPixel = 8;  // peak memory while an image is read
constexpr double kSmall = 1e6;        // bytes of further memory for a photograph

double sharpnessOf(const Image8& picture) {
  const double scale = std::min(1.0, double(kSharpnessSide) / std::max(picture.width, picture.height));
  const int width = int(picture.width * scale), height = int(picture.height * scale);
  if (std::min(width, height) < 8) return std::numeric_limits<double>::quiet_NaN();
  return sharpness(toGrey(scale < 1 ? downscaled(picture, width, height) : picture),
                   toGrey(downscaled(picture, width / 8, height / 8)));
}

std::vector<float> signatureOf(const Image8& picture) {
  const Image8 small = toGrey(downscaled(picture, kSignatureSide, kSignatureSide));
  std::vector<float> values(small.values.begin(), small.values.end());
  const float mean = std::accumulate(values.begin(), values.end(), 0.0f) / float(values.size());
  float length = 0;
  for (float& v : values) v -= mean, length += v * v;
  if (!(length > float(values.size()))) return {};
  for (float& v : values) v /= std::sqrt(length);
  return values;
}

double bytesToRead(const ImageFileInfo& info) {
  return kSmall + kBytesPerPixel * info.width * info.height;
}

template <class Work>
void attempt(const fs::path& folder, ExaminedPhotograph& photograph, const Work& work) {
  const fs::path file = folder / photograph.name;
  try {
    work(file);
  } catch (const Error& e) {
    photograph.readError = e.what();
    photograph.code = e.code();
    if (const std::string prefix = file.string() + ": "; photograph.readError.starts_with(prefix))
      photograph.readError.erase(0, prefix.size());
  } catch (const std::exception& e) {
    photograph.readError = e.what();
  }
}

void probe(const fs::path& folder, ExaminedPhotograph& photograph) {
  attempt(folder, photograph, [&](const fs::path& file) {
    photograph.info = probeImage(file);
    check(bytesToRead(photograph.info) < memoryLimit(), ErrorCode::unsupported,
          "{}×{} px need {} of memory, but the limit is {}", photograph.info.width, photograph.info.height,
          bytesText(bytesToRead(photograph.info)), bytesText(memoryLimit()));
  });
}

void look(const fs::path& folder, ExaminedPhotograph& photograph) {
  if (!photograph.readError.empty()) return;
  attempt(folder, photograph, [&](const fs::path& file) {
    const Image8 picture = readImage(file);
    photograph.sharpness = sharpnessOf(picture);
    photograph.signature = signatureOf(picture);
  });
  if (!photograph.readError.empty()) return;
  attempt(folder, photograph, [&](const fs::path& file) {
    Hash hash;
    hash.add(readFile(file));
    photograph.hash = hash.value();
  });
}

}  // namespace

double signatureCorrelation(const ExaminedPhotograph& a, const ExaminedPhotograph& b) {
  if (a.signature.empty() || b.signature.empty()) return 0;
  return std::inner_product(a.signature.begin(), a.signature.end(), b.signature.begin(), 0.0);
}

std::vector<ExaminedPhotograph> examineAll(const fs::path& folder, const std::vector<std::string>& names,
                                           const Context& context) {
  std::vector<ExaminedPhotograph> all(names.size());
  double largest = kSmall;
  for (std::size_t i = 0; i < names.size(); ++i) {
    all[i].name = names[i];
    probe(folder, all[i]);
    if (all[i].readError.empty()) largest = std::max(largest, bytesToRead(all[i].info));
  }
  ProgressLine progress(context);
  const bool whole = runJobs(
      all.size(), threadsFor(context.options().threads, largest), [&](std::size_t i) { look(folder, all[i]); },
      [&](std::size_t done) {
        return progress.show({"examining photographs", done, all.size()});
      });
  check(whole, ErrorCode::cancelled, "stopped");
  return all;
}

}  // namespace ibr::app
