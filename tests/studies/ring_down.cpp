// Ring-downs drawn from a prior, as users' files: whether Q(A) is stated, whether its intervals and
// that of T0 hold the truth, and whether the right law of friction is found. Arguments: logs per
// scene (100), first seed (1), "each" for a line per log.
#include "support/ring_down_score.hpp"

#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace {

using namespace goingrate;
using namespace goingrate::test;

constexpr std::array laws{
    "linear", "quadratic", "dry", "linear + quadratic", "linear + dry", "linear + quadratic + dry"};

const char* name_of(WatchedBy watched_by) {
  return watched_by == WatchedBy::samples     ? "samples of an angle"
         : watched_by == WatchedBy::crossings ? "crossings alone"
                                              : "photogate";
}

struct Share {
  int of = 0, in68 = 0, in95 = 0;
  void add(const RingDownOutcome::Stated& stated) {
    if (!stated.is_stated) return;
    ++of;
    in68 += stated.in68;
    in95 += stated.in95;
  }
  [[nodiscard]] std::string text() const {
    if (of == 0) return fmt::format("{:>15}", "-");
    return fmt::format("{:4} {:4.0f}% {:3.0f}%", of, 100.0 * in68 / of, 100.0 * in95 / of);
  }
};

struct Score {
  int logs = 0, failed = 0, right = 0, open = 0, wrong = 0;
  std::array<Share, 5> q{};
  Share T0, time_s;
  std::vector<double> sigma; // relative, halfway
  void add(const RingDownOutcome& o, const std::string& law) {
    ++logs;
    failed += !o.described;
    right += o.described && o.law == law;
    open += o.described && o.law_is_open;
    wrong += o.described && !o.law_is_open && o.law != law && o.behind > 6.0;
    for (std::size_t k = 0; k < q.size(); ++k)
      q[k].add(o.q[k]);
    T0.add(o.T0);
    time_s.add(o.time_s);
    if (o.q[2].is_stated) sigma.push_back(o.q[2].relative_sigma);
  }
  void print(const std::string& name) {
    std::sort(sigma.begin(), sigma.end());
    std::string line =
        fmt::format("{:<26} {:4} {:4} {:5} {:5} {:5}", name, logs, failed, right, open, wrong);
    for (const Share& share : q)
      line += " |" + share.text();
    line += " |" + time_s.text() + " |" + T0.text();
    line += fmt::format(" | {:5.1f} %\n", sigma.empty() ? NAN : 100.0 * sigma[sigma.size() / 2]);
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
  }
};

void print_each(const RingDown& d, const RingDownOutcome& o, std::uint64_t seed) {
  std::string q;
  for (const auto& s : o.q)
    q += s.is_stated
             ? fmt::format(" {:+.1f}{}({:.1f}%)", s.z, s.in95 ? "" : "!", 100.0 * s.relative_sigma)
             : " -";
  fmt::print("{}: {} A {:.3f} to {:.3f}, {:.0f} swings, T0 {:.3f}, Q {:.0f}, noise {:.2g}: {} {}{} "
             "{:.1f} Q{} T0 {:+.1f} A {:+.1e}\n",
             seed, d.law, d.first_rad, d.last_rad, d.swings, d.T0,
             quality_factor(d.friction, std::sqrt(d.first_rad * d.last_rad)), d.noise, o.status,
             o.law, o.law_is_open ? "?" : "", o.behind, q, o.T0.is_stated ? o.T0.z : NAN,
             o.amplitude_error);
}

} // namespace

int main(int count, char** words) {
  const auto logs = static_cast<std::size_t>(count > 1 ? std::atoi(words[1]) : 100);
  const auto first_seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  const bool each = count > 3 && std::string(words[3]) == "each";
  std::fputs("logs, of these without a decay; law right, open, wrong without being open;\n"
             "stated and held by the 68 % and 95 % intervals: Q at the last amplitude, a quarter,\n"
             "half, three quarters of the way up to the first, and at the first; decay time; T0;\n"
             "sigma of Q halfway (median)\n",
             stdout);
  std::uint64_t seed = first_seed;
  for (const WatchedBy watched_by :
       {WatchedBy::samples, WatchedBy::crossings, WatchedBy::photogate}) {
    fmt::print("\n{}\n", name_of(watched_by));
    Score all;
    for (const char* law : laws) {
      std::vector<RingDown> drawn(logs);
      std::vector<RingDownOutcome> outcomes(logs);
      const auto half = [&](std::size_t begin) {
        for (std::size_t i = begin; i < logs; i += 2) {
          drawn[i] = RingDownPrior(seed + i).draw(law, watched_by);
          outcomes[i] = outcome_of(drawn[i]);
          drawn[i].text.clear();
        }
      };
      std::thread other(half, 1);
      half(0);
      other.join();
      Score score;
      for (std::size_t i = 0; i < logs; ++i) {
        score.add(outcomes[i], law);
        all.add(outcomes[i], law);
        if (each) print_each(drawn[i], outcomes[i], seed + i);
      }
      score.print(law);
      seed += logs;
    }
    all.print("all");
  }
}
