// Sums over sequences of pictures.
#include "image/temporal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace nf::image {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

size_t pixels_of(const Image& picture) {
  return size_t(picture.width) * picture.height;
}
bool counts(std::span<const uint8_t> mask, size_t pixel) {
  return mask.empty() || mask[pixel];
}

void expect_same_size(const Image& a, const Image& b) {
  NF_CHECK(a.pixels.size() == b.pixels.size() && a.channels == b.channels, "{}x{} with {} channels and {}x{} with {}",
           a.width, a.height, a.channels, b.width, b.height, b.channels);
}

// Rec. 709; of one channel itself.
double luminance(const Image& picture, size_t pixel) {
  const float* p = picture.pixels.data() + pixel * picture.channels;
  return picture.channels < 3 ? double(p[0]) : 0.2126 * double(p[0]) + 0.7152 * double(p[1]) + 0.0722 * double(p[2]);
}

}  // namespace

void RunningMean::add(const Image& picture) {
  if (count_) expect_same_size(picture, last_);
  sums_.resize(picture.pixels.size(), 0.0);
  for (size_t i = 0; i < sums_.size(); ++i) sums_[i] += double(picture.pixels[i]);
  last_ = picture;
  ++count_;
}

Image RunningMean::mean() const {
  Image out = last_;
  for (size_t i = 0; i < sums_.size(); ++i) out.pixels[i] = float(sums_[i] / count_);
  return out;
}

double spread(std::span<const Image> pictures) {
  if (pictures.size() < 2) return 0;
  RunningMean all;
  for (const Image& picture : pictures) all.add(picture);
  const Image mean = all.mean();
  double squares = 0;
  for (const Image& picture : pictures) {
    const double apart = rms_difference(picture, mean);
    squares += apart * apart;
  }
  return std::sqrt(squares / double(pictures.size() - 1));
}

double mean_luminance(const Image& picture, std::span<const uint8_t> mask) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < pixels_of(picture); ++i)
    if (counts(mask, i)) sum += luminance(picture, i), ++count;
  return count ? sum / double(count) : 0;
}

double rms_difference(const Image& a, const Image& b, std::span<const uint8_t> mask) {
  expect_same_size(a, b);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (!counts(mask, i / a.channels)) continue;
    const double difference = double(a.pixels[i]) - double(b.pixels[i]);
    sum += difference * difference;
    ++count;
  }
  return count ? std::sqrt(sum / double(count)) : 0;
}

double median_relative_error(const Image& test, const Image& reference, std::span<const uint8_t> mask) {
  expect_same_size(test, reference);
  const double least = 1e-3 * mean_luminance(reference, mask);
  std::vector<double> errors;
  for (size_t i = 0; i < pixels_of(test); ++i)
    if (const double truth = luminance(reference, i); counts(mask, i) && truth > least)
      errors.push_back(std::abs(luminance(test, i) / truth - 1));
  if (errors.empty()) return nan;
  const auto middle = errors.begin() + ptrdiff_t(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

double log_log_slope(std::span<const std::pair<double, double>> points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [at, value] : points) {
    if (!(at > 0) || !(value > 0)) continue;
    const double u = std::log(at), v = std::log(value);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  const double spread = n * xx - x * x;
  return n >= 2 && spread > 0 ? (n * xy - x * y) / spread : nan;
}

double share_left(const Image& picture, const Image& from, const Image& to, std::span<const uint8_t> mask) {
  expect_same_size(picture, from);
  expect_same_size(picture, to);
  double along = 0, length = 0;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    if (!counts(mask, i / picture.channels)) continue;
    const double step = double(from.pixels[i]) - double(to.pixels[i]);
    along += (double(picture.pixels[i]) - double(to.pixels[i])) * step;
    length += step * step;
  }
  return length > 0 ? along / length : nan;
}

double half_life(std::span<const double> response) {
  double before = 1;
  for (size_t i = 0; i < response.size(); ++i) {
    if (response[i] <= 0.5) return double(i) + (before - 0.5) / (before - response[i]);
    before = response[i];
  }
  return std::numeric_limits<double>::infinity();
}

double flicker(std::span<const Image> frames) {
  if (frames.size() < 3) return nan;
  double sum = 0, mean = 0;
  size_t count = 0;
  for (size_t n = 1; n + 1 < frames.size(); ++n) {
    expect_same_size(frames[n - 1], frames[n]);
    expect_same_size(frames[n], frames[n + 1]);
    for (size_t i = 0; i < pixels_of(frames[n]); ++i) {
      const double second = luminance(frames[n - 1], i) - 2 * luminance(frames[n], i) + luminance(frames[n + 1], i);
      sum += second * second;
      mean += luminance(frames[n], i);
      ++count;
    }
  }
  return mean > 0 ? std::sqrt(sum / double(count) / 6) / (mean / double(count)) : nan;
}

}  // namespace nf::image
