// Turns the TeX of the worksheets into MathML: letters, scripts, fractions, roots, functions.

const letters = { lambda: "λ", varphi: "φ", varepsilon: "ε", pi: "π", mu: "μ", tau: "τ", delta: "δ", sigma: "σ",
  Delta: "Δ", infty: "∞" };
const operators = { cdot: "·", dots: "…", pm: "±", approx: "≈" };
const functions = ["sin", "cos", "ln"];
const accents = { dot: "˙", ddot: "¨" };
const spaces = { qquad: "2em", quad: "1em", ",": "0.17em", " ": "0.33em" };

const mathml = "http://www.w3.org/1998/Math/MathML";
function node(name, children = [], attributes = {}) {
  const made = document.createElementNS(mathml, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const tokensOf = (tex) => tex.match(/\\[a-zA-Z]+|\\.|[0-9]+(?:\.[0-9]+)?|\s+|./gs).filter((token) => token.trim() || token === "\\ ");

class Reader {
  constructor(tex) {
    this.tokens = tokensOf(tex);
  }

  row(end) {
    const parts = [];
    while (this.tokens.length && this.tokens[0] !== end) parts.push(this.scripted());
    this.tokens.shift();
    return node("mrow", parts);
  }

  // An atom with its subscript and superscript.
  scripted() {
    const base = this.atom();
    let below, above;
    while (this.tokens[0] === "_" || this.tokens[0] === "^") {
      if (this.tokens.shift() === "_") below = this.argument();
      else above = this.argument();
    }
    if (below && above) return node("msubsup", [base, below, above]);
    if (below) return node("msub", [base, below]);
    return above ? node("msup", [base, above]) : base;
  }

  atom() {
    const token = this.tokens.shift() ?? "";
    if (token === "{") return this.row("}");
    if (token.startsWith("\\")) return this.command(token.slice(1));
    if (/^[0-9]/.test(token)) return node("mn", [token]);
    if (/^[A-Za-z]/.test(token)) return node("mi", [token]);
    return node("mo", [token === "-" ? "−" : token], "()[]|".includes(token) ? { stretchy: "false" } : {});
  }

  // TeX takes only the first digit of a number without braces.
  argument() {
    const [token] = this.tokens;
    if (/^[0-9]{2,}$/.test(token)) this.tokens.splice(0, 1, token[0], token.slice(1));
    return this.atom();
  }

  command(name) {
    if (name in letters) return node("mi", [letters[name]]);
    if (name in operators) return node("mo", [operators[name]]);
    if (name in spaces) return node("mspace", [], { width: spaces[name] });
    if (functions.includes(name)) return node("mi", [name]);
    if (name in accents) return node("mover", [this.atom(), node("mo", [accents[name]])], { accent: "true" });
    if (name === "frac") return node("mfrac", [this.argument(), this.argument()]);
    if (name === "sqrt") return node("msqrt", [this.argument()]);
    if (name === "left" || name === "right") return node("mo", [this.tokens.shift()], { stretchy: "true" });
    if (name === "rm" || name === "text") return this.upright();
    return node("mtext", [name]);
  }

  // Reads letters up to the end of the group, as one word.
  upright() {
    let word = "";
    const braces = this.tokens[0] === "{";
    if (braces) this.tokens.shift();
    while (this.tokens.length && this.tokens[0] !== "}") word += this.tokens.shift();
    if (braces) this.tokens.shift();
    return node("mtext", [word]);
  }
}

/** TeX between dollar signs; `display`: on a line of its own. */
export function mathematics(tex, display) {
  return node("math", [new Reader(tex).row(null)], display ? { display: "block" } : {});
}
