// SPDX-License-Identifier: Apache-2.0
#include "ibr/metrics.h"

#include "ibr/view_scores.h"
#include "runtime/bind.h"
#include "support/arrays.h"
#include "support/calls.h"
#include "support/record.h"

namespace py = pybind11;

namespace ibr::python {
namespace {

using Array = py::array;

// Calls a metric of two images, and of a mask if there is one, without the interpreter's lock.
template <class Plain, class Masked>
double compared(const Array& a, const Array& b, const py::object& mask, const Plain& plain, const Masked& masked) {
  const Image8 first = colourOf(a, "a"), second = colourOf(b, "b"), used = maskOf(mask, "mask");
  return unlocked([&] { return used.empty() ? plain(first, second) : masked(first, second, used); });
}

template <class Metric>
auto ofPair(Metric metric) {
  return [metric](const Array& a, const Array& b) {
    const Image8 first = colourOf(a, "a"), second = colourOf(b, "b");
    return unlocked([&] { return metric(first, second); });
  };
}

Image8 allPixels(const Image8& like) {
  return Image8(like.width, like.height, 1, 255);
}

Array flipMapOf(const Array& a, const Array& b, double pixelsPerDegree) {
  const Image8 first = colourOf(a, "a"), second = colourOf(b, "b");
  return toArray(unlocked([&] { return flipMap(first, second, pixelsPerDegree); }));
}

}  // namespace

void bindMetrics(py::module_& module) {
  Record<Detail>(module, "Detail", "Detail of an image compared with that of the truth.")
      .field("energy", &Detail::energy, "Below 1: blur; above 1: ghost edges")
      .field("correlation", &Detail::correlation, "-1 to 1; 1: all edges are in place");
  Record<WorstTile>(module, "WorstTile", "The tile of 32 x 32 px with the largest mean squared error.")
      .field("x", &WorstTile::x, "px")
      .field("y", &WorstTile::y, "px")
      .field("mean_squared", &WorstTile::meanSquared, "Squared 8-bit levels; -1: not measured");
  Record<Difference>(module, "Difference", "Absolute differences of two images over red, green, blue.")
      .field("largest", &Difference::largest, "8-bit levels")
      .field("mean_absolute", &Difference::meanAbsolute, "8-bit levels")
      .field("share_above", &Difference::shareAbove, "Of pixels whose largest difference exceeds the threshold");
  using V = ViewScores;
  Record<V>(module, "ViewScores",
            "Scores of a rendered view, as `ibr eval` reports them. NaN: not measured or undefined.")
      .field("psnr", &V::psnr, "dB; holes count as black")
      .field("ssim", &V::ssim, "-1 to 1")
      .field("flip", &V::flip, "0 to 1, lower is better")
      .field("coverage", &V::coverage, "Share of the pixels that are drawn")
      .field("coverage_tier0", &V::coverageTier0, "Share of the pixels of tier 0")
      .field("coverage_tier2", &V::coverageTier2, "Share of the pixels of tier 2")
      .field("psnr_covered", &V::psnrCovered, "dB, without holes")
      .field("ssim_covered", &V::ssimCovered, "-1 to 1, without holes")
      .field("psnr_gain", &V::psnrGain, "dB, after one gain for each channel")
      .field("psnr_covered_gain", &V::psnrCoveredGain, "dB, without holes, after one gain for each channel")
      .field("ms_ssim", &V::msSsim, "0 to 1")
      .field("detail_energy", &V::detailEnergy, "Detail.energy of the covered pixels")
      .field("detail_correlation", &V::detailCorrelation, "Detail.correlation of the covered pixels")
      .field("torn_tiles", &V::tornTiles, "Share of the tiles")
      .field("worst_tile", &V::worstTile, "WorstTile");

  module.def(
      "psnr",
      [](const Array& a, const Array& b, const py::object& mask) {
        return compared(
            a, b, mask, [](const Image8& p, const Image8& q) { return psnr(p, q); },
            [](const Image8& p, const Image8& q, const Image8& m) { return psnr(p, q, m); });
      },
      py::arg("a"), py::arg("b"), py::arg("mask") = py::none(),
      "Peak signal-to-noise ratio, dB; infinity for equal images. Images: (height, width, 3 or 4), uint8; mask: "
      "(height, "
      "width), uint8, nonzero pixels count. NaN if no pixel counts.");
  module.def(
      "ssim",
      [](const Array& a, const Array& b, const py::object& mask) {
        return compared(
            a, b, mask, [](const Image8& p, const Image8& q) { return ssim(p, q); },
            [](const Image8& p, const Image8& q, const Image8& m) { return ssim(p, q, m); });
      },
      py::arg("a"), py::arg("b"), py::arg("mask") = py::none(),
      "Structural similarity of luma (Wang et al. 2004), -1 to 1. Arguments as psnr().");
  module.def(
      "delta_e",
      [](const Array& a, const Array& b, const py::object& mask) {
        return compared(
            a, b, mask, [](const Image8& p, const Image8& q) { return deltaE(p, q, allPixels(p)); },
            [](const Image8& p, const Image8& q, const Image8& m) { return deltaE(p, q, m); });
      },
      py::arg("a"), py::arg("b"), py::arg("mask") = py::none(),
      "Mean colour difference (CIE 1976). Arguments as psnr().");
  module.def("ms_ssim", ofPair([](const Image8& a, const Image8& b) { return msSsim(a, b); }), py::arg("a"),
             py::arg("b"),
             "Multi-scale structural similarity (Wang et al. 2003), 0 to 1. NaN if a side is shorter than 176 px.");
  module.def(
      "flip",
      [](const Array& a, const Array& b, double pixelsPerDegree) {
        const Image8 first = colourOf(a, "a"), second = colourOf(b, "b");
        return unlocked([&] { return flip(first, second, pixelsPerDegree); });
      },
      py::arg("a"), py::arg("b"), py::arg("pixels_per_degree") = kFlipPixelsPerDegree,
      "Mean perceived difference (LDR-FLIP, Andersson et al. 2020), 0 to 1.");
  module.def("flip_map", &flipMapOf, py::arg("a"), py::arg("b"), py::arg("pixels_per_degree") = kFlipPixelsPerDegree,
             "Perceived difference of each pixel: (height, width), float32.");
  module.def(
      "detail",
      [](const Array& picture, const Array& truth, const py::object& mask) {
        const Image8 first = colourOf(picture, "picture"), second = colourOf(truth, "truth"),
                     used = maskOf(mask, "mask");
        return unlocked([&] { return detail(first, second, used.empty() ? allPixels(first) : used); });
      },
      py::arg("picture"), py::arg("truth"), py::arg("mask") = py::none(),
      "Detail of a picture compared with the truth.");
  module.def(
      "difference",
      [](const Array& a, const Array& b, int threshold) {
        const Image8 first = colourOf(a, "a"), second = colourOf(b, "b");
        return unlocked([&] { return difference(first, second, threshold); });
      },
      py::arg("a"), py::arg("b"), py::arg("threshold") = 0, "Difference of two images; threshold: 8-bit levels.");
  module.def(
      "score_view",
      [](const Array& prediction, const Array& truth, const py::object& mask, bool fitGain) {
        const Image8 drawn = colourOf(prediction, "prediction"), photograph = colourOf(truth, "truth"),
                     used = maskOf(mask, "mask");
        return unlocked([&] { return scoreView(drawn, photograph, fitGain, used); });
      },
      py::arg("prediction"), py::arg("truth"), py::kw_only(), py::arg("mask") = py::none(), py::arg("fit_gain") = false,
      "ViewScores of a picture with AlphaContent.TIER and a black background. mask: nonzero pixels count. fit_gain: "
      "also "
      "measures psnr_gain and psnr_covered_gain.");
}

}  // namespace ibr::python
