# Whether the study is certain enough with what is saved.
enough() {
    "$tautline" study merge "$out"/part-*/ --partial --out "$out/so-far" >/dev/null 2>&1 || true
    grep -qs '"stopped": "relative_error"' "$out/so-far/summary.json"
}

