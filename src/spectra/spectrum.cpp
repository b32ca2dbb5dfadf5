// Notation: x series, N its length, L segment length, w window, k frequency index, K segments used.
// The only source that includes fftw3.h.
#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <optional>
#include <type_traits>

#include <fftw3.h>

#include "goingrate/base/errors.hpp"

namespace goingrate {
namespace {

// FFTW executes in parallel safely but plans, and destroys plans, only one at a time.
std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct FreeBuffer {
  void operator()(void* buffer) const noexcept { fftw_free(buffer); }
};

struct DestroyPlan {
  void operator()(fftw_plan plan) const noexcept {
    const std::lock_guard lock(planner_mutex());
    fftw_destroy_plan(plan);
  }
};

template <class T> using Buffer = std::unique_ptr<T[], FreeBuffer>;
using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, DestroyPlan>;

template <class T> Buffer<T> make_buffer(std::size_t count) {
  void* memory = fftw_malloc(count * sizeof(T));
  if (memory == nullptr) throw std::bad_alloc();
  return Buffer<T>(static_cast<T*>(memory));
}

int length_for_fftw(std::size_t n) {
  if (n == 0 || n > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw ArgumentError("n", static_cast<double>(n), "from 1 to 2147483647");
  return static_cast<int>(n);
}

template <class Make> Plan planned(Make make) {
  const std::lock_guard lock(planner_mutex());
  fftw_plan plan = make();
  if (plan == nullptr) throw std::bad_alloc(); // all that is left once the arguments are legal
  return Plan(plan);
}

// FFTW_ESTIMATE chooses by rule, not by stopwatch, so results are the same from run to run.
class RealFft {
public:
  explicit RealFft(std::size_t n)
      : n_(n), length_(length_for_fftw(n)), real_(make_buffer<double>(n)),
        complex_(make_buffer<fftw_complex>(n / 2 + 1)) {}

  std::span<double> real() { return {real_.get(), n_}; }
  std::span<fftw_complex> complex() { return {complex_.get(), n_ / 2 + 1}; }

  void forward() {
    if (!forward_)
      forward_ = planned([&] {
        return fftw_plan_dft_r2c_1d(length_, real_.get(), complex_.get(), FFTW_ESTIMATE);
      });
    fftw_execute(forward_.get());
  }

  void backward() { // overwrites complex(), as FFTW's c2r does
    if (!backward_)
      backward_ = planned([&] {
        return fftw_plan_dft_c2r_1d(length_, complex_.get(), real_.get(), FFTW_ESTIMATE);
      });
    fftw_execute(backward_.get());
  }

private:
  std::size_t n_;
  int length_;
  Buffer<double> real_;
  Buffer<fftw_complex> complex_;
  Plan forward_;
  Plan backward_;
};

/// A cosine transform (DCT-II) in place.
class CosineFft {
public:
  explicit CosineFft(std::size_t n)
      : n_(n), values_(make_buffer<double>(n)), plan_(planned([&] {
          return fftw_plan_r2r_1d(length_for_fftw(n), values_.get(), values_.get(), FFTW_REDFT10,
                                  FFTW_ESTIMATE);
        })) {}

  std::span<double> values() { return {values_.get(), n_}; }
  void run() { fftw_execute(plan_.get()); }

private:
  std::size_t n_;
  Buffer<double> values_;
  Plan plan_;
};

std::vector<double> hann_window(std::size_t length) {
  std::vector<double> w(length);
  const double turn = 2.0 * std::numbers::pi / static_cast<double>(length);
  for (std::size_t n = 0; n < length; ++n)
    w[n] = 0.5 * (1.0 - std::cos(turn * static_cast<double>(n)));
  return w;
}

double sum_of_squares(std::span<const double> w) {
  double sum = 0.0;
  for (double v : w)
    sum += v * v;
  return sum;
}

// Removes the mean, and if asked the slope, by least squares.
void detrend(std::span<double> x, bool linear) {
  const double count = static_cast<double>(x.size());
  const double middle = 0.5 * (count - 1.0); // about it, 1 and n - middle are orthogonal
  const double first = x.front();            // off first, so that a large offset costs no digits
  double level = 0.0, tilt = 0.0, spread = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double t = static_cast<double>(n) - middle;
    x[n] -= first;
    level += x[n];
    tilt += t * x[n];
    spread += t * t;
  }
  const double mean = level / count;
  const double slope = linear ? tilt / spread : 0.0;
  for (std::size_t n = 0; n < x.size(); ++n)
    x[n] -= mean + slope * (static_cast<double>(n) - middle);
}

struct Segments {
  std::size_t length;
  std::size_t step;
  std::vector<std::size_t> used; // serial numbers of the segments without NaN
  std::size_t skipped;
};

std::size_t segment_length(std::size_t points, const SpectrumOptions& options) {
  constexpr std::size_t short_series = 256; // 16 segments of it would have hardly 30 values each
  if (options.segment != 0) return options.segment;
  if (points < short_series) return points;
  return static_cast<std::size_t>(static_cast<double>(points) /
                                  (1.0 + 15.0 * (1.0 - options.overlap)));
}

Segments choose_segments(std::span<const double> series, const SpectrumOptions& options) {
  Segments chosen{segment_length(series.size(), options), 1, {}, 0};
  if (chosen.length < 8 || chosen.length > series.size())
    throw ArgumentError("options.segment", static_cast<double>(chosen.length),
                        "0, or from 8 to the length of the series");
  const double step = (1.0 - options.overlap) * static_cast<double>(chosen.length);
  chosen.step = std::max<std::size_t>(1, static_cast<std::size_t>(step));
  std::size_t serial = 0;
  for (std::size_t start = 0; start + chosen.length <= series.size(); start += chosen.step) {
    const auto segment = series.subspan(start, chosen.length);
    if (std::any_of(segment.begin(), segment.end(), [](double v) { return std::isnan(v); }))
      ++chosen.skipped;
    else
      chosen.used.push_back(serial);
    ++serial;
  }
  if (chosen.used.empty())
    throw ArgumentError("series", "NaN in every segment", "free of NaN over at least one segment");
  return chosen;
}

// Correlation of the ordinates of two segments whose starts are `shift` samples apart.
double ordinate_correlation(std::span<const double> w, std::size_t shift) {
  double product = 0.0;
  for (std::size_t n = 0; n + shift < w.size(); ++n)
    product += w[n] * w[n + shift];
  const double share = product / sum_of_squares(w);
  return share * share;
}

double degrees_of_freedom(const Segments& segments, std::span<const double> w) {
  double variance =
      static_cast<double>(segments.used.size()); // in units of one segment's, times K^2
  for (std::size_t j = 1; j * segments.step < segments.length; ++j) {
    std::size_t pairs = 0;
    for (std::size_t serial : segments.used)
      pairs += std::binary_search(segments.used.begin(), segments.used.end(), serial + j) ? 1 : 0;
    variance += 2.0 * static_cast<double>(pairs) * ordinate_correlation(w, j * segments.step);
  }
  const double count = static_cast<double>(segments.used.size());
  return 2.0 * count * count / variance;
}

void check_series(std::span<const double> series, double interval_s,
                  const SpectrumOptions& options) {
  if (series.size() < 8)
    throw ArgumentError("series.size()", static_cast<double>(series.size()), "8 or more");
  if (!(interval_s > 0.0) || !std::isfinite(interval_s))
    throw ArgumentError("interval_s", interval_s, "finite and above 0");
  if (!(options.overlap >= 0.0 && options.overlap <= 0.9))
    throw ArgumentError("options.overlap", options.overlap, "from 0 to 0.9");
  for (double v : series)
    if (std::isinf(v)) throw ArgumentError("series", v, "finite, or NaN for a gap");
}

} // namespace

Spectrum welch_spectrum(std::span<const double> series, double interval_s,
                        const SpectrumOptions& options) {
  check_series(series, interval_s, options);
  const Segments segments = choose_segments(series, options);
  const std::size_t length = segments.length;
  const std::vector<double> w = hann_window(length);
  RealFft fft(length);
  std::vector<double> power(length / 2 + 1, 0.0); // sum over segments of |X[k]|^2
  for (std::size_t serial : segments.used) {
    const auto x = fft.real();
    const auto source = series.subspan(serial * segments.step, length);
    std::copy(source.begin(), source.end(), x.begin());
    detrend(x, options.detrend_linear);
    for (std::size_t n = 0; n < length; ++n)
      x[n] *= w[n];
    fft.forward();
    const auto transform = fft.complex();
    for (std::size_t k = 0; k < power.size(); ++k)
      power[k] += transform[k][0] * transform[k][0] + transform[k][1] * transform[k][1];
  }

  Spectrum spectrum{};
  spectrum.resolution_hz = 1.0 / (static_cast<double>(length) * interval_s);
  spectrum.degrees_of_freedom = degrees_of_freedom(segments, w);
  spectrum.segments = segments.used.size();
  spectrum.segments_skipped = segments.skipped;
  spectrum.segment_length = length;
  const double scale = interval_s / (sum_of_squares(w) * static_cast<double>(segments.used.size()));
  for (std::size_t k = 0; k < power.size(); ++k) {
    const bool alone = k == 0 || 2 * k == length; // has no mirror image at negative frequency
    spectrum.frequency_hz.push_back(static_cast<double>(k) /
                                    (static_cast<double>(length) * interval_s));
    spectrum.density.push_back((alone ? 1.0 : 2.0) * scale * power[k]);
  }
  return spectrum;
}

std::vector<std::complex<double>> real_transform(std::span<const double> series) {
  for (double v : series)
    if (!std::isfinite(v)) throw ArgumentError("series", v, "finite");
  RealFft fft(series.size());
  // Unlike measuring planners, FFTW_ESTIMATE leaves the buffers alone, so they may be filled first.
  std::copy(series.begin(), series.end(), fft.real().begin());
  fft.forward();
  std::vector<std::complex<double>> transform;
  transform.reserve(series.size() / 2 + 1);
  for (const fftw_complex& v : fft.complex())
    transform.emplace_back(v[0], v[1]);
  return transform;
}

std::vector<double> squared_transform(std::span<const double> series, std::size_t length) {
  for (double v : series)
    if (!std::isfinite(v)) throw ArgumentError("series", v, "finite");
  if (length < series.size())
    throw ArgumentError("length", static_cast<double>(length), "at least that of the series");
  RealFft fft(length);
  const std::span<double> values = fft.real();
  std::fill(std::copy(series.begin(), series.end(), values.begin()), values.end(), 0.0);
  fft.forward();
  std::vector<double> squares;
  squares.reserve(length / 2 + 1);
  for (const fftw_complex& v : fft.complex())
    squares.push_back(v[0] * v[0] + v[1] * v[1]);
  return squares;
}

std::vector<double> cosine_transform(std::span<const double> series) {
  for (double v : series)
    if (!std::isfinite(v)) throw ArgumentError("series", v, "finite");
  // Planning takes longer than a short transform, and one length follows another of the same.
  thread_local std::optional<CosineFft> fft;
  if (!fft || fft->values().size() != series.size()) fft.emplace(series.size());
  std::copy(series.begin(), series.end(), fft->values().begin());
  fft->run();
  std::vector<double> transform(fft->values().begin(), fft->values().end());
  const double scale = 1.0 / std::sqrt(2.0 * static_cast<double>(series.size()));
  for (double& v : transform)
    v *= scale;
  return transform;
}

std::vector<double> inverse_real_transform(std::span<const std::complex<double>> transform,
                                           std::size_t n) {
  if (n == 0 || transform.size() != n / 2 + 1)
    throw ArgumentError("transform.size()", static_cast<double>(transform.size()),
                        "n/2 + 1 for the n given, which is 1 or more");
  for (const auto& v : transform)
    if (!std::isfinite(v.real()) || !std::isfinite(v.imag()))
      throw ArgumentError("transform", std::isfinite(v.real()) ? v.imag() : v.real(), "finite");
  RealFft fft(n);
  for (std::size_t k = 0; k < transform.size(); ++k) {
    const bool alone = k == 0 || 2 * k == n;
    fft.complex()[k][0] = transform[k].real();
    fft.complex()[k][1] = alone ? 0.0 : transform[k].imag();
  }
  fft.backward();
  std::vector<double> series(fft.real().begin(), fft.real().end());
  for (double& v : series)
    v /= static_cast<double>(n);
  return series;
}

} // namespace goingrate
