// Writes numbers for people to read.

const superscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const raised = (power) => String(power).replace("-", "⁻").replace(/\d/g, (digit) => superscripts[digit]);
const minus = (text) => (/[1-9]/.test(text) ? text.replace("-", "−") : text.replace("-", "")); // 0, not −0

/** A few digits, with a power of ten where there would be many zeros: 2.5×10⁻⁴. */
export function shortNumber(value, digits = 3) {
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power >= -2 && power < 5) return minus(String(Number(value.toPrecision(digits))));
  return `${minus(String(Number((value / 10 ** power).toPrecision(digits))))}×10${raised(power)}`;
}

/** A value with its σ to two digits: (2.50028 ± 0.00041)×10⁻⁴. */
export function withSigma(value, sigma) {
  if (value === null || value === undefined) return "undetermined";
  if (!(sigma > 0)) return shortNumber(value, 6);
  const power = Math.floor(Math.log10(Math.max(Math.abs(value), sigma)));
  const scale = power < -2 || power > 4 ? 10 ** power : 1;
  const decimals = Math.max(0, 1 - Math.floor(Math.log10(sigma / scale)));
  const text = `${minus((value / scale).toFixed(decimals))} ± ${(sigma / scale).toFixed(decimals)}`;
  return scale === 1 ? text : `(${text})×10${raised(power)}`;
}
