// Theo1 with all its terms, fast. With h = m/2, c = i + h and u_i = x_i + x_{i+m} the square is
//   [u_i - x_{c-d} - x_{c+d}]^2 = u_i^2 - 2 u_i (x_{c-d} + x_{c+d})
//                                 + x_{c-d}^2 + x_{c+d}^2 + 2 x_{c-d} x_{c+d},
// with weight w_d = 1/(h - d). Summed over c = h .. N-1-h and d = 0 .. h-1 the first part is a
// plain sum, the second a convolution of x with w, the third prefix sums of squares, and the last
// the sum of w over all pairs (p, q) = (c-d, c+d) of samples less those whose middle c lies within
// h of an end: two triangles p + q < 2h, one of them seen in a mirror. p and q are both even or
// both odd, so the pairs are those of the even and of the odd samples at lag d. Reference: D. A.
// Howe and T. N. Tasset, PTTI 2004; NIST SP 1065 section 5.2.14. The way to add it up is our own.
#include "theo1.hpp"

#include <algorithm>
#include <complex>
#include <vector>

#include "goingrate/spectra/spectrum.hpp"
#include "mean_squares.hpp"
#include "square_sums.hpp"

namespace goingrate {
namespace {

using Values = std::vector<double>;

// The next number of the form 2^k or 3 2^k: FFTW is quick on those.
std::size_t quick_size(std::size_t n) {
  std::size_t power = 1;
  while (power < n)
    power *= 2;
  return power >= 4 && power / 4 * 3 >= n ? power / 4 * 3 : power;
}

// w_|d| for |d| < h, else 0.
double weight(std::ptrdiff_t d, std::size_t h) {
  const auto distance = static_cast<std::size_t>(d < 0 ? -d : d);
  return distance < h ? 1.0 / static_cast<double>(h - distance) : 0.0;
}

// result[p] = sum over q of kernel(first + p - q) values[q], p = 0 .. count - 1, by transforms. The
// kernel is 0 from |d| = h on: they are as long as it takes that no other distance falls, going
// round, on one that counts.
template <class Kernel>
Values convolve(std::span<const double> values, std::ptrdiff_t first, std::size_t count,
                std::size_t h, const Kernel& kernel) {
  const auto n = static_cast<std::ptrdiff_t>(values.size()), reach = static_cast<std::ptrdiff_t>(h);
  const auto lowest = first - n + 1, highest = first + static_cast<std::ptrdiff_t>(count) - 1;
  const auto from = std::max(lowest, 1 - reach), to = std::min(highest, reach - 1);
  const auto room = std::max({n, highest - from + 1, to - lowest + 1});
  const std::size_t size = quick_size(static_cast<std::size_t>(room));
  const auto place = [=](std::ptrdiff_t d) { return static_cast<std::size_t>(d - lowest) % size; };
  Values a(size, 0.0), b(size, 0.0);
  for (std::ptrdiff_t d = from; d <= to; ++d)
    a[place(d)] = kernel(d);
  std::copy(values.begin(), values.end(), b.begin());
  auto product = real_transform(a);
  const auto other = real_transform(b);
  for (std::size_t k = 0; k < product.size(); ++k)
    product[k] *= other[k];
  const Values all = inverse_real_transform(product, size);
  Values result(count);
  for (std::size_t p = 0; p < count; ++p)
    result[p] = all[place(first + static_cast<std::ptrdiff_t>(p))];
  return result;
}

double inner(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += a[i] * b[i];
  return sum;
}

// sum of x[a+p] x[b+q] w(a+p-b-q) over 0 <= p, q and p + q < side: half its square and two
// triangles of half the side.
double triangle(std::span<const double> x, std::size_t a, std::size_t b, std::size_t side,
                std::size_t h) {
  constexpr std::size_t plain_sum_side = 192; // below, the plain double sum was the quicker
  const auto lag = static_cast<std::ptrdiff_t>(a) - static_cast<std::ptrdiff_t>(b);
  double sum = 0.0;
  if (side <= plain_sum_side) {
    for (std::size_t p = 0; p < side; ++p)
      for (std::size_t q = 0; p + q < side; ++q)
        sum += x[a + p] * x[b + q] *
               weight(lag + static_cast<std::ptrdiff_t>(p) - static_cast<std::ptrdiff_t>(q), h);
    return sum;
  }
  const std::size_t half = (side + 1) / 2, rest = side - half; // p, q < half are all inside
  const Values filtered =
      convolve(x.subspan(b, half), lag, half, h, [h](std::ptrdiff_t d) { return weight(d, h); });
  sum = inner(x.subspan(a, half), filtered);
  if (a == b) return sum + 2.0 * triangle(x, a + half, b, rest, h); // the other is its mirror image
  return sum + triangle(x, a + half, b, rest, h) + triangle(x, a, b + half, rest, h);
}

Values every_second(std::span<const double> x, std::size_t from) {
  Values taken;
  for (std::size_t i = from; i < x.size(); i += 2)
    taken.push_back(x[i]);
  return taken;
}

// sum over d and c of w_d x_{c-d} x_{c+d} for middles c < h: of ordered pairs p + q < 2h each
// counts half, and the pair p = q whole.
double pairs_near_the_start(std::span<const double> x, std::size_t h) {
  double sum = 0.0;
  for (std::size_t parity = 0; parity < 2; ++parity)
    sum += h > parity ? triangle(every_second(x.first(2 * h), parity), 0, 0, h - parity, h) : 0.0;
  for (std::size_t c = 0; c < h; ++c)
    sum += x[c] * x[c] * weight(0, h);
  return 0.5 * sum;
}

double all_pairs(std::span<const double> x, std::size_t h) {
  double sum = 0.0;
  for (std::size_t parity = 0; parity < 2; ++parity) {
    const Values taken = every_second(x, parity);
    sum += inner(
        taken, convolve(taken, 0, taken.size(), h, [h](std::ptrdiff_t d) { return weight(d, h); }));
  }
  return 0.5 * (sum + inner(x, x) * weight(0, h));
}

} // namespace

double theo1_sum_directly(std::span<const double> x, std::size_t m) {
  constexpr std::size_t block = 1024; // stays in the nearest cache for all d
  const std::size_t h = m / 2;
  double sum = 0.0;
  for (std::size_t begin = 0; begin + m < x.size(); begin += block) {
    const double* p = x.data() + begin;
    const std::size_t starts = std::min(block, x.size() - m - begin);
    for (std::size_t d = 0; d < h; ++d)
      sum += squares_of_bows(p, starts, h, d) / static_cast<double>(h - d);
  }
  return sum;
}

double theo1_sum_by_transform(std::span<const double> x, std::size_t m) {
  const std::size_t h = m / 2, starts = x.size() - m;
  // x_{c-d} + x_{c+d} under w: a convolution, in which d = 0 counts twice
  const Values around =
      convolve(x, static_cast<std::ptrdiff_t>(h), starts, h,
               [h](std::ptrdiff_t d) { return (d == 0 ? 2.0 : 1.0) * weight(d, h); });
  double total_weight = 0.0;
  for (std::size_t d = 0; d < h; ++d)
    total_weight += weight(static_cast<std::ptrdiff_t>(d), h);
  double sum = 0.0;
  for (std::size_t i = 0; i < starts; ++i) {
    const double ends = x[i] + x[i + m];
    sum += ends * (total_weight * ends - 2.0 * around[i]);
  }
  Values squares(x.size() + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    squares[i + 1] = squares[i] + x[i] * x[i];
  for (std::size_t d = 0; d < h; ++d)
    sum += weight(static_cast<std::ptrdiff_t>(d), h) *
           (squares[h - d + starts] - squares[h - d] + squares[h + d + starts] - squares[h + d]);
  const Values mirrored(x.rbegin(), x.rend());
  return sum +
         2.0 * (all_pairs(x, h) - pairs_near_the_start(x, h) - pairs_near_the_start(mirrored, h));
}

MeanSquares theo1_differences(std::span<const double> x) {
  return one_by_one([x](std::size_t m) -> MeanSquare {
    if (m < 2 || m >= x.size()) return {};
    const std::size_t starts = x.size() - m;
    // Measured on 2e4 and 1e5 phases: the transforms cost as much as 650 terms a phase and, for the
    // triangles at the ends, 8500 for each of h.
    const bool few = starts * (m / 2) <= 650 * x.size() + 8500 * (m / 2);
    const double sum = few ? theo1_sum_directly(x, m) : theo1_sum_by_transform(x, m);
    // Theo1 is the sum over 0.75 (N-m) (m tau0)^2; the root will be divided by tau = 0.75 m tau0.
    return {0.75 * sum / static_cast<double>(starts), starts * (m / 2)};
  });
}

} // namespace goingrate
