// What a sequence of pictures does over time: how fast its mean settles, how long what is gone stays visible, how much
// it flickers. Masks have a byte a pixel, 0 = left out; an empty one takes all.
#pragma once

#include <span>
#include <utility>

#include "image/image.h"

namespace nf::image {

// Mean of pictures of one size, in double precision.
class RunningMean {
 public:
  void add(const Image& picture);
  Image mean() const;
  uint32_t count() const { return count_; }

 private:
  Image last_;
  std::vector<double> sums_;
  uint32_t count_ = 0;
};

double mean_luminance(const Image& picture, std::span<const uint8_t> mask = {});
// Root mean square of all channels' differences.
double rms_difference(const Image& a, const Image& b, std::span<const uint8_t> mask = {});
// How far pictures of the same are apart: root of the mean of all numbers' variance (of the sample: n - 1); 0 for one.
double spread(std::span<const Image> pictures);
// Half of the pixels are nearer to the reference: |luminance / the reference's - 1|. Pixels darker than a thousandth of
// the reference's mean do not count.
double median_relative_error(const Image& test, const Image& reference, std::span<const uint8_t> mask = {});
// The exponent e of y = c x^e by least squares of the logarithms; NaN for fewer than two points.
double log_log_slope(std::span<const std::pair<double, double>> points);
// The t for which to + t (from - to) is nearest to the picture: 1 while all of `from` is left, 0 when it is gone. Noise
// that knows nothing of from - to drops out.
double share_left(const Image& picture, const Image& from, const Image& to, std::span<const uint8_t> mask);
// When a response that was 1 falls to a half, in frames: `response` has the values after 1, 2, ... frames; linear in
// between. Infinite when it never does.
double half_life(std::span<const double> response);
// Standard deviation over time of what changes from frame to frame, over the mean luminance: second differences of
// luminance, divided by sqrt(6), so that steady drift drops out and independent noise of deviation s reads s. NaN for
// fewer than three frames.
double flicker(std::span<const Image> frames);

}  // namespace nf::image
