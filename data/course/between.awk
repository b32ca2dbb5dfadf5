# The table of `goingrate rate` between two cycles: awk -v from=1 -v to=150 -f between.awk TABLE
BEGIN { FS = "," }
NR > 1 && $1 >= from && $1 <= to && $3 != "" { n++; rate += $4; amplitude += $6; bare += $8 }
END {
  printf "cycles %d to %d: rate excess %.3e (%.1f s/day)\n", from, to, rate / n, 86400 * rate / n
  printf "  amplitude %.1f mrad, rate excess without the circular error %.3e\n", 1e3 * amplitude / n, bare / n
}
