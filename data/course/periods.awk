# The table of `goingrate rate`: mean and scatter of the periods, and how neighbouring periods go together.
BEGIN { FS = "," }
NR > 1 && $3 != "" {
  period = $3 - 2
  n++; sum += period; squares += period ^ 2
  if (n > 1) products += period * last
  last = period
}
END {
  mean = sum / n
  variance = squares / n - mean ^ 2
  printf "%d periods, mean %.6f s, scatter %.2f ms\n", n, 2 + mean, 1e3 * sqrt(variance)
  printf "correlation of neighbours %.2f\n", (products / (n - 1) - mean ^ 2) / variance
}
