// The chart with the installed peers: Boost.odeint, GSL and SUNDIALS beside our own methods, all
// measured in one run on one core.
#include "goingrate/report/chart_report.hpp"
#include "peers.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

namespace {

using namespace goingrate;

const ChartRow& row_of(const std::vector<ChartRow>& rows, const std::string& method,
                       const std::string& setting) {
  return *std::find_if(rows.begin(), rows.end(), [&](const ChartRow& row) {
    return row.scenario == "C steady" && row.method == method && row.setting == setting;
  });
}

} // namespace

int main() {
  std::vector<ChartMethod> methods = chart_methods();
  for (const auto& peers : {bench::odeint_peers(), bench::gsl_peers(), bench::sundials_peers()})
    methods.insert(methods.end(), peers.begin(), peers.end());
  const auto rows = measure_chart(chart_scenes(2000), methods, 5);
  std::fputs(chart_text(rows, 2.0).c_str(), stdout);
  const double direct = row_of(rows, "direct", "to rounding").ns_per_period;
  const double map = row_of(rows, "map", "to rounding").ns_per_period;
  const double rk4 = row_of(rows, "rk4", "dt=0.03").ns_per_period;
  const double odeint = row_of(rows, "odeint-f78", "tol=1e-15").ns_per_period;
  const double averaged = row_of(rows, "averaged1", "circular error -lambda^2/16").ns_per_period;
  const double second = row_of(rows, "averaged2", "second order").ns_per_period;
  std::printf("at C steady: rk4 / direct %.2f, odeint-f78 / direct %.2f, direct / map %.1f, "
              "averaged2 / averaged1 %.2f\n",
              rk4 / direct, odeint / direct, direct / map, second / averaged);
}
