// How far two pictures are apart: the usual numbers, maps of the error by pixel, and pictures of those maps. All
// measures work on linear values; masks and block means apply to every one of them alike.
#pragma once

#include <optional>
#include <string_view>

#include "image/image.h"

namespace nf::image {

// A test picture with the reference it is held against: same size, same channels. `mask` has a byte a pixel, non-zero
// where the pixel counts; empty means all.
struct Pair {
  Image test, reference;
  std::vector<uint8_t> mask;
  bool counts(size_t pixel) const { return mask.empty() || mask[pixel] != 0; }
};

// One channel against three is repeated thrice. Throws nf::Error (Exit::Input) when sizes or channels differ otherwise.
// `mask` may be empty; else pixels whose first channel is above 0.5 count.
Pair make_pair(Image test, Image reference, const Image& mask = {});

// Means over blocks of `side` x `side` pixels that lie wholly inside the mask; other blocks, and what is left at the
// right and at the bottom, do not count. Throws nf::Error (Exit::Input) when no block is left.
Pair block_means(const Pair& pair, uint32_t side);

// --- maps: one channel, one error a pixel; the mean over the channels unless said otherwise. A NaN in either picture,
// or an infinity in one, is an infinite error (1 in the maps that end at 1).
Image absolute_error(const Pair& pair);
Image squared_error(const Pair& pair);
// (test - reference)^2 / (reference^2 + epsilon): Rousselle et al. 2011, section 3, with their epsilon of 0.01.
inline constexpr double relative_epsilon = 0.01;
Image relative_squared_error(const Pair& pair, double epsilon = relative_epsilon);
// 1 - SSIM of the luminance (Wang et al. 2004): Gaussian window of 11 x 11 with sigma 1.5, K1 = 0.01, K2 = 0.03,
// dynamic range 1; edges are repeated.
Image ssim_error(const Pair& pair);

// Pixels per degree of visual angle at 0.7 m from a 0.7 m wide screen of 3840 pixels, FLIP's default.
inline constexpr float default_pixels_per_degree = 67.0206f;
// FLIP of two linear pictures whose values are clamped to [0, 1] (Andersson et al. 2020).
Image flip_ldr(const Image& test, const Image& reference, float pixels_per_degree = default_pixels_per_degree);
// HDR-FLIP (Andersson et al. 2021): the maximum of FLIP over a range of exposures that follows from the reference.
struct Exposures {
  float start = 0, stop = 0;  // EV
  int count = 0;
};
Exposures flip_exposures(const Image& reference);
Image flip_hdr(const Image& test, const Image& reference, float pixels_per_degree = default_pixels_per_degree);

// --- numbers
struct Pooled {
  double mean = 0, p50 = 0, p95 = 0, max = 0;
  uint32_t worst_x = 0, worst_y = 0;
  uint64_t count = 0;
};
// Over the pixels that count; percentiles are of the sorted values, linear between neighbours.
Pooled pool(const Image& map, const std::vector<uint8_t>& mask);

enum class Metric : uint8_t { Mae, Mse, Rmse, RelMse, Psnr, Ssim, Flip };
struct MetricInfo {
  Metric metric;
  const char* id;
  bool more_is_better;
  const char* help;
};
std::span<const MetricInfo> metrics();
const MetricInfo* find_metric(std::string_view id);

struct Measured {
  double value = 0;
  Pooled pooled;  // of `map`
  Image map;      // the error by pixel: its root for RMSE, squares for MSE and PSNR, 1 - SSIM for SSIM
};
// `hdr` chooses between the two FLIPs. PSNR is 10 log10(peak^2 / MSE) with peak 1, infinite for equal pictures.
Measured measure(Metric metric, const Pair& pair, bool hdr, float pixels_per_degree = default_pixels_per_degree);

// Pixels with any channel further from the reference than `limit`, as a share of those that count.
double fraction_above(const Pair& pair, double limit);
// Mean of test - reference, and of the reference, over pixels and channels.
struct Bias {
  double difference = 0, reference = 0;
};
Bias bias(const Pair& pair);

// --- pictures
// Where the test is too bright (red) and too dark (blue): luminance difference, `range` saturates. Masked pixels are
// grey.
Image8 signed_picture(const Pair& pair, float range);
// Error in colours from black to yellow, `range` saturates, with a bar below that is labelled 0 ... range.
Image8 heat_picture(const Image& map, const std::vector<uint8_t>& mask, float range);
// The colours of the heat map: t in [0, 1].
struct Rgb8 {
  uint8_t r, g, b;
};
Rgb8 heat_color(float t);
// The colours in which FLIP is shown: matplotlib's magma, as a polynomial that is within 0.03 of its table.
Rgb8 magma_color(float t);

}  // namespace nf::image
