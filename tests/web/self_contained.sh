#!/usr/bin/env bash
# self_contained.sh PAGE: the page is one file of at most 8 MB, asks for nothing outside of itself, and its policy
# lets no text become a script.
set -euo pipefail
page=$1
bytes=$(stat -c %s "$page")
echo "      $bytes bytes"
[ "$bytes" -le 8000000 ]
policy=$(grep -oE 'Content-Security-Policy" content="[^"]*' "$page" | head -1)
for rule in "default-src 'none'" "'wasm-unsafe-eval'" "base-uri 'none'" "form-action 'none'"; do
  grep -qF "$rule" <<< "$policy" || { echo "the policy lacks $rule"; exit 1; }
done
if grep -oE "script-src [^;]*" <<< "$policy" | grep -qE "'unsafe-(inline|eval)'|https?:|\*"; then
  echo "the policy lets scripts in: $policy"
  exit 1
fi
if grep -qE '<(script|img|link|iframe)[^>]* (src|href)="?https?:' "$page"; then
  echo "the page asks for something outside of itself"
  exit 1
fi
