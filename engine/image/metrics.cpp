// Numbers and maps of difference, except SSIM and FLIP.
#include "image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"

namespace nf::image {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Image repeat_channel(const Image& image) {
  Image out{image.width, image.height, 3, {}};
  out.pixels.reserve(image.pixels.size() * 3);
  for (const float value : image.pixels) out.pixels.insert(out.pixels.end(), 3, value);
  return out;
}

double gap(float test, float reference) {
  const double difference = test == reference ? 0 : double(test) - double(reference);
  return std::isnan(difference) ? infinite : difference;
}

// The mean over the channels of `error`(test, reference), for every pixel.
template <class Error>
Image map_of(const Pair& pair, const Error& error) {
  Image map{pair.test.width, pair.test.height, 1, std::vector<float>(size_t(pair.test.width) * pair.test.height)};
  const uint32_t channels = pair.test.channels;
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    double sum = 0;
    for (size_t c = 0; c < channels; ++c)
      sum += error(pair.test.pixels[i * channels + c], pair.reference.pixels[i * channels + c]);
    map.pixels[i] = float(sum / channels);
  }
  return map;
}

// The mean of a map in double precision: maps are floats, and sums of squares may be small.
template <class Error>
double mean_of(const Pair& pair, const Error& error) {
  const uint32_t channels = pair.test.channels;
  const size_t pixels = size_t(pair.test.width) * pair.test.height;
  double sum = 0;
  uint64_t count = 0;
  for (size_t i = 0; i < pixels; ++i) {
    if (!pair.counts(i)) continue;
    for (size_t c = 0; c < channels; ++c)
      sum += error(pair.test.pixels[i * channels + c], pair.reference.pixels[i * channels + c]);
    count += channels;
  }
  return count ? sum / double(count) : 0;
}

double absolute(float test, float reference) {
  return std::abs(gap(test, reference));
}
double square(float test, float reference) {
  const double difference = gap(test, reference);
  return difference * difference;
}
double relative_square(float test, float reference, double epsilon) {
  const double relative = square(test, reference) / (double(reference) * double(reference) + epsilon);
  return std::isnan(relative) ? infinite : relative;
}

constexpr MetricInfo rows[] = {
    {Metric::Mae, "mae", false, "mean absolute error"},
    {Metric::Mse, "mse", false, "mean squared error"},
    {Metric::Rmse, "rmse", false, "root of the mean squared error"},
    {Metric::RelMse, "relmse", false, "mean of squared error / (reference^2 + 0.01)"},
    {Metric::Psnr, "psnr", true, "peak signal to noise ratio in dB, peak 1"},
    {Metric::Ssim, "ssim", true, "structural similarity of the luminance, 1 = equal"},
    {Metric::Flip, "flip", false, "FLIP, the difference seen when flipping between the two: 0 to 1"},
};

}  // namespace

Pair make_pair(Image test, Image reference, const Image& mask) {
  if (test.width != reference.width || test.height != reference.height) {
    fail(Exit::Input, "cannot compare the pictures: the test is {}x{}, the reference {}x{}; render both at one size",
         test.width, test.height, reference.width, reference.height);
  }
  if (test.channels == 1 && reference.channels == 3) test = repeat_channel(test);
  if (reference.channels == 1 && test.channels == 3) reference = repeat_channel(reference);
  if (test.channels != reference.channels || test.channels == 0) {
    fail(Exit::Input, "cannot compare the pictures: the test has {} channels, the reference {}; compare layers alike",
         test.channels, reference.channels);
  }
  Pair pair{std::move(test), std::move(reference), {}};
  if (mask.width == 0) return pair;
  if (mask.width != pair.test.width || mask.height != pair.test.height) {
    fail(Exit::Input, "cannot use the mask: it is {}x{}, the pictures are {}x{}; use one of their size", mask.width,
         mask.height, pair.test.width, pair.test.height);
  }
  for (size_t i = 0; i < size_t(mask.width) * mask.height; ++i)
    pair.mask.push_back(mask.pixels[i * mask.channels] > 0.5f);
  return pair;
}

Pair block_means(const Pair& pair, uint32_t side) {
  if (side <= 1) return pair;
  const uint32_t width = pair.test.width / side, height = pair.test.height / side, channels = pair.test.channels;
  Pair out{{width, height, channels, {}}, {width, height, channels, {}}, {}};
  bool any = false;
  for (uint32_t by = 0; by < height; ++by) {
    for (uint32_t bx = 0; bx < width; ++bx) {
      std::vector<double> sums(size_t(channels) * 2);
      bool whole = true;
      for (uint32_t y = by * side; y < (by + 1) * side; ++y) {
        for (uint32_t x = bx * side; x < (bx + 1) * side; ++x) {
          whole &= pair.counts(size_t(y) * pair.test.width + x);
          for (uint32_t c = 0; c < channels; ++c) {
            sums[c] += double(pair.test.at(x, y, c));
            sums[channels + c] += double(pair.reference.at(x, y, c));
          }
        }
      }
      const double pixels = double(side) * side;
      for (uint32_t c = 0; c < channels; ++c) {
        out.test.pixels.push_back(whole ? float(sums[c] / pixels) : 0.0f);
        out.reference.pixels.push_back(whole ? float(sums[channels + c] / pixels) : 0.0f);
      }
      out.mask.push_back(whole);
      any |= whole;
    }
  }
  if (!any) fail(Exit::Input, "no block of {0}x{0} pixels lies wholly inside the mask; use smaller blocks", side);
  return out;
}

Image absolute_error(const Pair& pair) {
  return map_of(pair, absolute);
}
Image squared_error(const Pair& pair) {
  return map_of(pair, square);
}
Image relative_squared_error(const Pair& pair, double epsilon) {
  return map_of(pair, [&](float test, float reference) { return relative_square(test, reference, epsilon); });
}

Pooled pool(const Image& map, const std::vector<uint8_t>& mask) {
  Pooled pooled;
  std::vector<float> values;
  double sum = 0;
  pooled.max = -1;
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    if (!mask.empty() && !mask[i]) continue;
    values.push_back(map.pixels[i]);
    sum += double(map.pixels[i]);
    if (double(map.pixels[i]) > pooled.max) {
      pooled.max = double(map.pixels[i]);
      pooled.worst_x = uint32_t(i % map.width);
      pooled.worst_y = uint32_t(i / map.width);
    }
  }
  pooled.count = values.size();
  if (values.empty()) return {};
  pooled.mean = sum / double(values.size());
  std::sort(values.begin(), values.end());
  const auto percentile = [&](double share) {
    const double at = share * double(values.size() - 1);
    const size_t low = size_t(at), high = std::min(low + 1, values.size() - 1);
    if (values[low] == values[high]) return double(values[low]);  // also where both are infinite
    return double(values[low]) + (double(values[high]) - double(values[low])) * (at - double(low));
  };
  pooled.p50 = percentile(0.5);
  pooled.p95 = percentile(0.95);
  return pooled;
}

std::span<const MetricInfo> metrics() {
  return rows;
}

const MetricInfo* find_metric(std::string_view id) {
  for (const MetricInfo& row : rows)
    if (id == row.id) return &row;
  return nullptr;
}

Measured measure(Metric metric, const Pair& pair, bool hdr, float pixels_per_degree) {
  Measured out;
  // Outside the mask the pictures are taken as equal, so that windows which reach there find no difference.
  const auto masked = [&] {
    Pair copy = pair;
    const uint32_t channels = pair.test.channels;
    for (size_t i = 0; i < pair.mask.size(); ++i)
      for (size_t c = 0; c < channels; ++c)
        if (!pair.mask[i]) copy.test.pixels[i * channels + c] = copy.reference.pixels[i * channels + c] = 0;
    return copy;
  };
  switch (metric) {
    case Metric::Mae:
      out.map = absolute_error(pair);
      out.value = mean_of(pair, absolute);
      break;
    case Metric::Mse:
    case Metric::Psnr:
    case Metric::Rmse:
      out.map = squared_error(pair);
      out.value = mean_of(pair, square);
      if (metric == Metric::Rmse) {
        out.value = std::sqrt(out.value);
        for (float& value : out.map.pixels) value = std::sqrt(value);
      }
      if (metric == Metric::Psnr) out.value = out.value > 0 ? -10 * std::log10(out.value) : infinite;
      break;
    case Metric::RelMse:
      out.map = relative_squared_error(pair);
      out.value = mean_of(pair, [](float t, float r) { return relative_square(t, r, relative_epsilon); });
      break;
    case Metric::Ssim:
      out.map = ssim_error(masked());
      break;
    case Metric::Flip: {
      const Pair clean = masked();
      out.map = (hdr ? flip_hdr : flip_ldr)(clean.test, clean.reference, pixels_per_degree);
      break;
    }
  }
  out.pooled = pool(out.map, pair.mask);
  if (metric == Metric::Ssim) out.value = 1 - out.pooled.mean;
  if (metric == Metric::Flip) out.value = out.pooled.mean;
  return out;
}

double fraction_above(const Pair& pair, double limit) {
  const uint32_t channels = pair.test.channels;
  uint64_t above = 0, count = 0;
  for (size_t i = 0; i < size_t(pair.test.width) * pair.test.height; ++i) {
    if (!pair.counts(i)) continue;
    bool any = false;
    for (size_t c = 0; c < channels; ++c)
      any |= absolute(pair.test.pixels[i * channels + c], pair.reference.pixels[i * channels + c]) > limit;
    above += any;
    ++count;
  }
  return count ? double(above) / double(count) : 0;
}

Bias bias(const Pair& pair) {
  return {mean_of(pair, gap), mean_of(pair, [](float, float reference) { return double(reference); })};
}

}  // namespace nf::image
