// A technique's error in two parts: total = estimator + missing. Estimator: technique against what a perfect estimator
// would make of the same information; missing: that against the truth, which is what the screen does not show.
#pragma once

#include "image/metrics.h"

namespace nf::image {

// Two estimates of one picture whose noise is independent; of a picture that has none, the same one twice.
struct Halves {
  Image a, b;
};
Image mean_of(const Halves& halves);
// The standard error of mean_of, over all pixels that count and channels: half the RMSE of the halves' difference.
double noise_of(const Halves& halves, const std::vector<uint8_t>& mask);

// A byte a pixel, 1 where the first surface is the same to the rasteriser and to the tracer, by their depths (0: none);
// `left_out` grows by those that differ.
std::vector<uint8_t> common_surfaces(const std::vector<float>& seen, const std::vector<float>& traced,
                                     uint64_t& left_out);

// `bias` is the mean of test - reference. `rmse` is the root of the mean of (test.a - reference.a)(test.b -
// reference.b): noise has no part in it, for its product's mean is 0. Where noise takes that below 0 it is 0. What is
// below `floor`, the root of two standard errors of that mean, is not told from none.
struct ErrorPart {
  double bias = 0, rmse = 0, floor = 0;
};
ErrorPart error_between(const Halves& test, const Halves& reference, const std::vector<uint8_t>& mask);

// The biases add up; the RMSEs need not: parts may cancel.
struct ErrorSplit {
  ErrorPart total, estimator, missing;
};
// All three of the same size and channels, as image::make_pair leaves them.
ErrorSplit split_error(const Halves& test, const Halves& same, const Halves& reference,
                       const std::vector<uint8_t>& mask);

// Three heat maps of the absolute error side by side, total, estimator, missing, with one scale and one bar. `range`
// saturates; 0 takes the 95th percentile of the total.
Image8 split_picture(const Image& test, const Image& same, const Image& reference, const std::vector<uint8_t>& mask,
                     float range = 0);

}  // namespace nf::image
