// Compares the results of the native command and of the page's command for one log.

const allowed_sigma = 0.02; // between the fits: what rounding does to a search that ends at a small gain

/** How two fits differ: the largest difference of a value in units of σ, and what is not alike at all. */
export function fitDifference(native, page) {
  const faults = [];
  let largest = 0;
  if (native.status !== page.status) faults.push(`status ${native.status} and ${page.status}`);
  const names = (fit) => (fit.parameters ?? []).map((parameter) => parameter.name).join(" ");
  if (names(native) !== names(page)) faults.push(`parameters ${names(native)} and ${names(page)}`);
  for (const parameter of native.parameters ?? []) {
    const other = page.parameters?.find(({ name }) => name === parameter.name);
    if (!other) continue;
    if (other.status !== parameter.status) faults.push(`${parameter.name} is ${parameter.status} and ${other.status}`);
    if (!(parameter.sigma > 0)) continue;
    const difference = Math.abs(other.value - parameter.value) / parameter.sigma;
    largest = Math.max(largest, difference);
    if (!(difference <= allowed_sigma)) faults.push(`${parameter.name} differs by ${difference.toFixed(3)} sigma`);
    const widths = Math.abs(other.sigma / parameter.sigma - 1);
    if (!(widths <= allowed_sigma)) faults.push(`sigma of ${parameter.name} differs by ${(100 * widths).toFixed(1)} %`);
  }
  return { largest, faults };
}

/** The first lines that differ, in words; nothing if the texts are the same. */
export function textDifference(what, native, page) {
  if (native === page) return [];
  const lines = (text) => (text ?? "").split("\n");
  const at = lines(native).findIndex((line, i) => line !== lines(page)[i]);
  return [`${what}, line ${at + 1}: '${lines(native)[at]}' and '${lines(page)[at]}'`];
}
