# Mean and scatter of the numbers in the first column: awk -f scatter.awk FILE
NR == 1 { shift = $1 }
{ sum += $1 - shift; squares += ($1 - shift) ^ 2 }
END {
  mean = sum / NR
  printf "%d values, mean %.4f, scatter %.4f\n", NR, shift + mean, sqrt((squares - NR * mean ^ 2) / (NR - 1))
}
