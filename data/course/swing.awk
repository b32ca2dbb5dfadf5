# A pendulum of 0.5 m that is let go at 0.25 rad, as a phone or a camera sees it; to try the commands with before
# there is a pendulum. awk -v as=phone -f swing.awk (or as=video).
# Equation: phi'' = -(g/L) sin phi - 2 gamma phi', by steps of half a millisecond (kick, drift, kick).
BEGIN {
  pi = atan2(0, -1)
  T0 = 1.42; w2 = (2 * pi / T0) ^ 2; gamma = 0.0111; L = 0.5
  h = 0.0005; every = (as == "video") ? 66 : 20
  srand(1)
  if (as == "video") print "bob\nt\tx\ty"
  else print "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\""
  phi = 0.25; v = 0
  for (i = 0; i * h < 80; ++i) {
    if (i % every == 0) {
      if (as == "video") printf "%.4f\t%.4f\t%.4f\n", i * h, L * sin(phi) + noise(0.0004), -L * cos(phi) + noise(0.0004)
      else printf "%.9E,%.6E,%.6E,%.6E\n", i * h, v + noise(0.004), noise(0.004), noise(0.004)
    }
    v += 0.5 * h * (-w2 * sin(phi) - 2 * gamma * v)
    phi += h * v
    v += 0.5 * h * (-w2 * sin(phi) - 2 * gamma * v)
  }
}
function noise(rms) { return rms * sqrt(12) * (rand() - 0.5) }
